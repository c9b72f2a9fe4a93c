"""All accelerations but the pressure's, and the velocity beside the liquid."""
