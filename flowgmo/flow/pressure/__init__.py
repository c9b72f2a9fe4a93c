"""The pressure: its equation, what bounds it (surface, voids, thin cells), and the solvers."""
