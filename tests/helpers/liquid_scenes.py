"""Scenes for tests of the liquid tracking: meshes, velocities on faces from potentials, ghosts, known liquids."""

import numpy as np

from flowgmo.flow.fields import Flow, Open, grid_of
from flowgmo.flow.surface.plic import volume_under
from flowgmo.flow.surface.surface_tracking import move_liquid, tracking_of
from flowgmo.flow.team import Team
from flowgmo.kernel import kernel
from flowgmo.mesh import Block

NO_SOLIDS = Open(None, None, None, None)


def mirror(F):
    """Ghosts mirror the inside on all sides; one cell repeats itself."""
    for axis in range(3):
        a = np.moveaxis(F, axis, 0)
        n = a.shape[0] - 4
        a[:2] = a[[3, 2]] if n > 1 else a[2]
        a[-2:] = a[[n + 1, n]] if n > 1 else a[2]


def periodic(F):
    for axis in range(3):
        a = np.moveaxis(F, axis, 0)
        n = a.shape[0] - 4
        a[:2], a[-2:] = (a[[n, n + 1]], a[[2, 3]]) if n > 1 else (a[2], a[2])


def even(n, length=1.0):
    return np.linspace(0.0, length, n + 1)


def graded(n, ratio=1.05, length=1.0):
    x = np.append(0.0, np.cumsum(ratio ** np.arange(n)))
    return x * (length / x[-1])


def mesh(x, y, z):
    """(block, grid, shape with ghosts)."""
    block = Block(np.asarray(x), np.asarray(y), np.asarray(z), ())
    return block, grid_of(block), tuple(n + 4 for n in block.shape)


def fractions(block, inside, sub=8):
    """F with ghosts (mirrored) of inside(x, y, z) -> bool, by sub^3 points a cell (one in a direction of one cell)."""
    at = [
        (p[:-1, None] + (np.arange(s) + 0.5) / s * np.diff(p)[:, None]).ravel()
        for p, s in ((p, sub if len(p) > 2 else 1) for p in block.planes)
    ]
    hit = inside(at[0][:, None, None], at[1][None, :, None], at[2][None, None, :])
    s = [sub if n > 1 else 1 for n in block.shape]
    shape = [m for n, f in zip(block.shape, s, strict=True) for m in (n, f)]
    F = np.zeros([n + 4 for n in block.shape])
    F[2:-2, 2:-2, 2:-2] = (
        np.broadcast_to(hit, [a * b for a, b in zip(block.shape, s, strict=True)]).reshape(shape).mean((1, 3, 5))
    )
    mirror(F)
    return F


def swirl(block, potential):
    """(u, None, w) on faces of one layer of cells in y from the stream function psi(x, z), free of divergence."""
    x, _, z = block.planes
    psi = potential(x[:, None], z[None, :])
    shape = [n + 4 for n in block.shape]
    u, w = np.zeros(shape), np.zeros(shape)
    u[1:-2, :, 2:-2] = (-np.diff(psi, axis=1) / np.diff(z))[:, None, :]
    w[2:-2, :, 1:-2] = (np.diff(psi, axis=0) / np.diff(x)[:, None])[:, None, :]
    return u, None, w


def random_velocity(shape, rng, size=1.0):
    """Velocities of a closed box that are anything but free of divergence."""
    out = []
    for axis in range(3):
        q = size * rng.uniform(-1, 1, shape)
        a = np.moveaxis(q, axis, 0)
        a[:2] = a[-3:] = 0.0
        out.append(q if shape[axis] > 5 else None)
    return out


def volume(F, grid, V=None):
    """Liquid inside."""
    liquid = F if V is None else F * V
    cells = grid.dx[:, None, None] * grid.dy[None, :, None] * grid.dz
    return float((liquid * cells)[2:-2, 2:-2, 2:-2].sum())


def largest_cfl(q, grid):
    """Largest sum over directions of |u| / dx [1/time] of the cells, with the faster of the two faces."""
    total = 0.0
    for axis, (v, d) in enumerate(zip(q, (grid.dx, grid.dy, grid.dz), strict=True)):
        if v is not None:
            a = np.abs(v)
            faster = np.maximum(a, np.roll(a, 1, axis))
            total = total + faster / d.reshape([-1 if i == axis else 1 for i in range(3)])
    return float(total[2:-2, 2:-2, 2:-2].max())


def carry(F, grid, steps, fill=mirror, opened=NO_SOLIDS, threads=1, **options):
    """Moves F in place through (velocity triple, dt) steps; returns (largest over, least under, entered (6,))."""
    tracking, team = tracking_of(grid, **options), Team(threads)
    over = under = 0.0
    entered = np.zeros(6)
    for number, (q, dt) in enumerate(steps):
        moved = move_liquid(team, tracking, Flow(*q, None, F, dt), opened, dt, number, fill)
        if tracking.pieces is not None:
            tracking.pieces.keep_moments()
        over, under, entered = max(over, moved.over), min(under, moved.under), entered + moved.entered
    return over, under, entered


@kernel
def _half_space(x, y, z, s, beta, level, V, Ax, Ay, Az, F):
    for i in range(2, V.shape[0] - 2):
        for j in range(2, V.shape[1] - 2):
            for k in range(2, V.shape[2] - 2):
                dx, dy, dz = x[i - 1] - x[i - 2], y[j - 1] - y[j - 2], z[k - 1] - z[k - 2]
                m = (s[0] * dx, s[1] * dy, s[2] * dz)
                b = beta - s[0] * x[i - 2] - s[1] * y[j - 2] - s[2] * z[k - 2]
                V[i, j, k] = volume_under(m, b)
                Ax[i, j, k] = volume_under((0.0, m[1], m[2]), b - m[0])
                Ay[i, j, k] = volume_under((m[0], 0.0, m[2]), b - m[1])
                Az[i, j, k] = volume_under((m[0], m[1], 0.0), b - m[2])
                Ax[i - 1, j, k] = volume_under((0.0, m[1], m[2]), b)
                Ay[i, j - 1, k] = volume_under((m[0], 0.0, m[2]), b)
                Az[i, j, k - 1] = volume_under((m[0], m[1], 0.0), b)
                h = min(max((level - z[k - 2]) / dz, 0.0), 1.0)
                if h > 0.0 and V[i, j, k] > 0.0:
                    F[i, j, k] = min(h * volume_under((m[0], m[1], m[2] * h), b) / V[i, j, k], 1.0)


def half_space(block, s, beta, level):
    """(Open, F): everything beyond s . x = beta is solid, level liquid up to z = level: both exact; mirrored ghosts."""
    shape = [n + 4 for n in block.shape]
    arrays = [np.zeros(shape) for _ in range(5)]
    V, Ax, Ay, Az, F = arrays
    _half_space(*block.planes, np.asarray(s, float), float(beta), float(level), V, Ax, Ay, Az, F)
    mirror(V)
    mirror(F)
    for axis, A in enumerate((Ax, Ay, Az)):
        a, n = np.moveaxis(A, axis, 0), A.shape[axis] - 4
        a[0], a[n + 2] = a[2], a[n]
        for other in {0, 1, 2} - {axis}:
            a, n = np.moveaxis(A, other, 0), A.shape[other] - 4
            a[:2] = a[[3, 2]] if n > 1 else a[2]
            a[-2:] = a[[n + 1, n]] if n > 1 else a[2]
    return Open(V, Ax, Ay, Az), F
