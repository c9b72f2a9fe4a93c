"""Free-surface flow on a fixed rectilinear mesh: one file per term or stage; `step.py` calls them in order.

Conventions that all files share
--------------------------------
Arrays of mesh size have GHOST_LAYERS = 2 ghost cells on every side: shape (nx + 4, ny + 4, nz + 4), C order, z fastest.
Real cells are 2 .. n + 1. Cell centres: p, F (liquid volume / open volume), V (open volume / cell volume).
Faces: u[i, j, k] lies on the upper x-face of cell (i, j, k), between it and (i + 1, j, k), and so does Ax (open area /
face area); v and Ay on upper y-faces, w and Az on upper z-faces. So u[1] and u[nx + 1] lie on the domain's sides.

Off means absent. A direction with one cell is skipped: its velocity is None. A scene without solids has V, Ax, Ay, Az
None; one without a free surface (ITB=0) has F None. Kernels branch on `is None`, which numba prunes.

Only wet cells cost time. Loops run over columns (columns.py): rows (i, j, k0, k1) of an int32 array, one for each
vertical line of cells that holds something, k0 <= k < k1. A kernel takes `columns, first, last, ...` and works on
columns[first:last]; team.py gives each thread its part. A kernel writes to its own column only, so that the result is
the same bits for any number of threads. Sums are written per column and added up in Python.

Velocity u [length/time], pressure p [mass/length/time2] relative to the void's, so that it is 0 at the free surface.
"""
