"""Meshes, solids, ghosts and calls for the tests of the momentum equation's terms."""

import numpy as np

from flowgmo.flow.columns import all_columns
from flowgmo.flow.favor.cut_faces import find_cut_faces
from flowgmo.flow.fields import G, Open, grid_of
from flowgmo.flow.momentum.advection import add_advection, make_schemes
from flowgmo.flow.momentum.implicit_viscosity import add_implicit_viscosity
from flowgmo.flow.momentum.viscosity import add_viscosity, make_viscosity
from flowgmo.flow.momentum.wall_shear import find_side_walls
from flowgmo.flow.team import Team
from flowgmo.mesh import Block

NOTHING = Open(None, None, None, None)
ALONE = Team(1)


def planes(n, length=1.0, graded=0.0):
    """n + 1 planes over the length; graded: widths vary by this share, smoothly and periodically."""
    s = np.linspace(0.0, 1.0, n + 1)
    return length * (s - graded * np.sin(2 * np.pi * s) / (2 * np.pi))


def mesh(n, lengths=(1.0, 1.0, 1.0), graded=0.0):
    """Grid of n (3,) cells."""
    return grid_of(Block(*(planes(m, a, graded if m > 1 else 0.0) for m, a in zip(n, lengths, strict=True)), ()))


def upper_planes(d):
    """Coordinates (n + 4,) of upper planes of cells, 0 at the domain's lower side, and of centres."""
    x = np.cumsum(d) - d[:G].sum()
    return x, x - 0.5 * d


def places(grid, c):
    """Coordinates of faces of component c, to be broadcast (n + 4, 1, 1), (1, n + 4, 1), (1, 1, n + 4)."""
    at = [upper_planes(d)[0 if e == c else 1] for e, d in enumerate(grid[:3])]
    return np.ix_(*at)


def shape_of(grid):
    return tuple(len(d) for d in grid[:3])


def inside(a):
    """The real cells."""
    return a[G:-G, G:-G, G:-G]


def wrap(a, directions=(0, 1, 2)):
    """Periodic ghosts, and the lower side's faces, along the directions."""
    for d in directions:
        m = np.moveaxis(a, d, 0)
        n = m.shape[0] - 2 * G
        for ghost in (0, 1, n + 2, n + 3):
            m[ghost] = m[(ghost - G) % n + G]
    return a


def mirror(a, d):
    """Ghosts along d of a component that is not d, as beside walls."""
    m = np.moveaxis(a, d, 0)
    n = m.shape[0] - 2 * G
    for ghost, source in ((1, 2), (0, min(3, n + 1)), (n + 2, n + 1), (n + 3, max(n, 2))):
        m[ghost] = m[source]
    return a


def advection(grid, velocity, order, open=NOTHING, F=None, team=ALONE, columns=None):
    """The acceleration of all real faces."""
    columns = all_columns(shape_of(grid)) if columns is None else columns
    out = tuple(None if q is None else np.zeros(q.shape) for q in velocity)
    cut = find_cut_faces(columns, open)
    add_advection(team, columns, make_schemes(grid, order), open, cut, velocity, F, out)
    return out


def operators(grid, open=NOTHING, no_slip=(False,) * 6, speeds=None, solids_stick=True, team=ALONE):
    present = tuple(len(d) > 1 + 2 * G for d in grid[:3])
    speeds = np.zeros((6, 3)) if speeds is None else speeds
    cut = find_cut_faces(all_columns(shape_of(grid)), open)
    sides = tuple(find_side_walls(grid, open, no_slip, speeds, c, present) if present[c] else None for c in range(3))
    return make_viscosity(team, grid, open, cut, present, solids_stick, sides)


def viscous(grid, velocity, nu, dt, made=None, F=None, team=ALONE, columns=None):
    """The acceleration of all real faces; made: from `operators`."""
    columns = all_columns(shape_of(grid)) if columns is None else columns
    out = tuple(None if q is None else np.zeros(q.shape) for q in velocity)
    add_viscosity(team, columns, made or operators(grid), velocity, F, out, nu, dt)
    return out


def implicit(grid, velocity, nu_dt, made, fill, V=None, F=None, free=(False,) * 3, team=ALONE):
    """In place; returns how the solves ended."""
    scratch = tuple(np.full(shape_of(grid), np.nan) for _ in range(4))
    columns = all_columns(shape_of(grid))
    return add_implicit_viscosity(team, columns, grid, V, made, velocity, F, nu_dt, 1.0, scratch, fill, free)


def layer(grid, bottom, top=None):
    """Open fractions between two flat walls at heights bottom and top (along z), in x and y all through."""
    z = upper_planes(grid.dz)[0]
    low = z - grid.dz
    top = np.inf if top is None else top
    V = np.clip(np.minimum(z, top) - np.maximum(low, bottom), 0.0, None) / grid.dz
    V[V > 1 - 1e-12] = 1.0  # round-off of the planes
    V[V < 1e-12] = 0.0
    Az = np.where((z > bottom - 1e-12 * z[-1]) & (z < top + 1e-12), 1.0, 0.0)
    Az[np.isclose(z, bottom, atol=1e-12) | np.isclose(z, top, atol=1e-12)] = 0.0
    full = np.ones(shape_of(grid))
    return Open(V * full, V * full, V * full, Az * full)


def blocks(grid, rng, count=3):
    """Open fractions of solid boxes of whole cells, and of random cuts around them."""
    n = shape_of(grid)
    V = np.ones(n)
    for _ in range(count):
        low = [int(rng.integers(G, m - G)) for m in n]
        high = [a + int(rng.integers(1, 4)) for a in low]
        V[low[0] : high[0], low[1] : high[1], low[2] : high[2]] = 0.0
    V = np.where((V > 0) & (rng.random(n) < 0.2), rng.random(n), V)
    areas = [np.minimum(V, np.roll(V, -1, axis=d)) for d in range(3)]
    areas = [np.where(a < 1, a * rng.random(n), a) for a in areas]
    return Open(V, *areas)


def random_velocity(grid, rng, open=NOTHING):
    """Normal deviates, 0 on closed faces and absent for single cells."""
    out = []
    for c in range(3):
        if shape_of(grid)[c] == 1 + 2 * G:
            out.append(None)
            continue
        q = rng.standard_normal(shape_of(grid))
        if open[1 + c] is not None:
            q[open[1 + c] == 0] = 0.0
        out.append(q)
    return tuple(out)


def reflected_grid(grid, axis):
    """Mirrored along the axis."""
    out = list(grid)
    out[axis] = grid[axis][::-1].copy()
    out[3 + axis] = np.append(grid[3 + axis][:-1][::-1], grid[3 + axis][0])
    return type(grid)(*out)


def reflected(velocity, axis):
    """Values on upper faces: reversed, the axis' own shifted by one and negated."""
    out = []
    for c, q in enumerate(velocity):
        m = np.flip(q, axis).copy()
        if c == axis:
            m = -np.roll(m, -1, axis)
        out.append(m)
    return tuple(out)


def reflected_open(open, axis):
    areas = [np.flip(a, axis).copy() for a in open[1:]]
    areas[axis] = np.roll(areas[axis], -1, axis)
    return Open(np.flip(open.V, axis).copy(), *areas)
