"""Collisions of balls with balls and flats: events at their exact times, legs between them in closed form."""
