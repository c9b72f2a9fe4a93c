"""Made-up liquid for tests of what is recorded: graded meshes, boxes as solids, fields given by formulas."""

import numpy as np

from flowgmo.flow.fields import Flow, G, Open
from flowgmo.mesh import SYMMETRY, WALL, Block, Side

RHO, GRAVITY = 1000.0, 9.81
DOWN = np.array([0.0, 0.0, -GRAVITY])


def graded(n, lo, hi, ratio=1.6):
    """n + 1 planes; the last cell is `ratio` times as long as the first."""
    widths = ratio ** (np.arange(n) / max(n - 1, 1))
    planes = lo + (hi - lo) * np.concatenate([[0.0], np.cumsum(widths)]) / widths.sum()
    planes[-1] = hi
    return planes


def block_of(n, lo=(0.0, 0.0, 0.0), hi=(1.0, 1.0, 1.0), ratio=1.6):
    sides = tuple(Side(s, WALL if s > 3 else SYMMETRY) for s in range(6))
    planes = [graded(m, a, b, ratio) for m, a, b in zip(n, lo, hi, strict=True)]
    return Block(*planes, neighbours=sides, name="all")


def with_ghosts(planes):
    """Planes of cells and ghosts, one below each cell and one above the last: (n + 5,); ghosts mirror the inside."""
    d = np.pad(np.diff(planes), G, mode="symmetric" if len(planes) > G else "edge")
    return planes[0] - d[0] - d[1] + np.concatenate([[0.0], np.cumsum(d)])


def centres(block):
    return [0.5 * (x[1:] + x[:-1]) for x in map(with_ghosts, block.planes)]


def at_centres(block, f):
    """f(x, y, z) in cells, ghosts too."""
    return np.array(np.broadcast_to(f(*np.meshgrid(*centres(block), indexing="ij")), [n + 2 * G for n in block.shape]))


def at_faces(block, d, f):
    """f(x, y, z) on the upper faces along d."""
    places = centres(block)
    places[d] = with_ghosts(block.planes[d])[1:]
    return np.array(np.broadcast_to(f(*np.meshgrid(*places, indexing="ij")), [n + 2 * G for n in block.shape]))


def below(block, surface):
    """F of liquid that stands up to z = surface."""
    z = with_ghosts(block.z)
    F = np.clip((surface - z[:-1]) / np.diff(z), 0.0, 1.0)
    return np.array(np.broadcast_to(F, [n + 2 * G for n in block.shape]))


def openings_of(block, boxes):
    """Exact Open of solid boxes (2, 3) that do not overlap, and their walls: cells (m, 3), faces (m, 6)."""
    planes = [with_ghosts(x) for x in block.planes]
    shape = tuple(n + 2 * G for n in block.shape)
    V, A = np.ones(shape), [np.ones(shape) for _ in range(3)]
    walls = []
    for lo, hi in boxes:
        lo = np.where(lo <= [x[0] for x in block.planes], -np.inf, lo)  # what stands on a side goes on behind it
        part = [
            np.clip((np.minimum(p[1:], b) - np.maximum(p[:-1], a)) / np.diff(p), 0, 1)
            for p, a, b in zip(planes, lo, hi, strict=True)
        ]
        V -= np.einsum("i,j,k->ijk", *part)
        shares = []
        for d in range(3):
            on = [
                ((planes[e][1:] > lo[e]) & (planes[e][1:] < hi[e])).astype(float) if e == d else part[e]
                for e in range(3)
            ]
            shares.append(np.einsum("i,j,k->ijk", *on))
            A[d] -= shares[d]
        walls.append(shares)
    V[V < 1e-12] = 0.0  # rounding of 1 - 1
    for d in range(3):
        A[d][A[d] < 1e-12] = 0.0
        A[d][(V == 0.0) | (np.roll(V, -1, axis=d) == 0.0)] = 0.0
    return Open(V, *A), [_wall(V, shares, A) for shares in walls]


def _wall(V, shares, A):
    """Cells (m, 3) that one box touches, and the shares (m, 6) of their faces: what it covers, and closed faces of
    cells beside it."""
    inside = (slice(G, -G),) * 3
    faces = []
    for d in range(3):
        covered = np.where(shares[d] > 0, shares[d], 1.0 - A[d])
        faces += [np.roll(covered, 1, axis=d)[inside], covered[inside]]
    faces = np.stack(faces, axis=-1)
    cells = np.argwhere((faces.max(axis=-1) > 0) & (V[inside] > 0))
    return cells + G, faces[tuple(cells.T)]


def flow_of(block, F=None, p=None, u=None, v=None, w=None):
    """A Flow; what is not given is zero, directions of one cell have no velocity."""
    shape = tuple(n + 2 * G for n in block.shape)
    velocity = [
        None if n == 1 else np.zeros(shape) if a is None else a for a, n in zip((u, v, w), block.shape, strict=True)
    ]
    return Flow(*velocity, np.zeros(shape) if p is None else p, F, 0.0)


def still(block, surface, down=2):
    """Water at rest up to z = surface: F and the pressure that the solver would give, 0 in dry cells."""
    F = below(block, surface)
    z = np.broadcast_to(centres(block)[2], F.shape)
    return flow_of(block, F, np.where(F >= 0.5, RHO * GRAVITY * (surface - z), 0.0))
