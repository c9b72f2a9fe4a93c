"""Open fractions of cells and faces (FAVOR): what solids leave to the liquid, and the planes that cut cells."""
