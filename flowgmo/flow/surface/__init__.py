"""The free surface: the liquid's share of each cell, its planes, and how it is carried along."""
