"""Bodies that move in the liquid: what they displace in a step, and what they and the pressure do to each other."""
