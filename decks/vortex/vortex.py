"""A disc in a vortex that turns back: the tracking of the liquid alone.

    python decks/vortex/vortex.py [picture.png]

    psi = sin^2(pi x) sin^2(pi z) / pi        u = - d psi / dz,  w = d psi / dx,  both times cos(pi t / T), T = 8

draws a disc of radius .15 at (.5, .75) into a spiral, less than a cell wide where there are 32, and back into the disc
(Rider & Kothe 1998). No deck can prescribe a velocity field: the tracking's own functions are called. Steps are equally
long ways, sum of the directional CFL numbers 1/2 at most, as the cosine lets them be.
"""

from __future__ import annotations

import sys

import numpy as np

from flowgmo.flow.fields import Flow, Grid, Open, grid_of, zeros
from flowgmo.flow.surface.surface_tracking import move_liquid, tracking_of
from flowgmo.flow.team import Team
from flowgmo.mesh import Block

PERIOD, RADIUS, CENTRE = 8.0, 0.15, (0.5, 0.75)
SUB = 32  # points each way in a cell to fill the disc: 1e-4 of its area
REAL = (slice(2, -2), 2, slice(2, -2))
NO_SOLIDS = Open(None, None, None, None)


def mirror(F: np.ndarray) -> None:
    """Ghosts of F: the mirror image inside."""
    for axis in range(3):
        a = np.moveaxis(F, axis, 0)
        n = a.shape[0] - 4
        a[:2] = a[[3, 2]] if n > 1 else a[2]
        a[-2:] = a[[n + 1, n]] if n > 1 else a[2]


def square(n: int) -> Block:
    """n x 1 x n cells on the unit square."""
    planes = np.linspace(0.0, 1.0, n + 1)
    return Block(planes, np.array([0.0, 1.0 / n]), planes, ())


def disc(block: Block) -> np.ndarray:
    """F of the disc, with ghosts."""
    n = block.shape[0]
    at = (np.arange(n * SUB) + 0.5) / (n * SUB)
    inside = (at[:, None] - CENTRE[0]) ** 2 + (at[None, :] - CENTRE[1]) ** 2 < RADIUS**2
    F = zeros(block)
    F[REAL] = inside.reshape(n, SUB, n, SUB).mean(axis=(1, 3))
    mirror(F)
    return F


def swirl(block: Block) -> tuple[np.ndarray, None, np.ndarray]:
    """u, w at their fastest on faces, free of divergence: differences of psi along the faces' edges."""
    x, _, z = block.planes
    psi = np.outer(np.sin(np.pi * x) ** 2, np.sin(np.pi * z) ** 2) / np.pi
    u, w = zeros(block), zeros(block)
    u[1:-2, 2, 2:-2] = -np.diff(psi, axis=1) / np.diff(z)
    w[2:-2, 2, 1:-2] = np.diff(psi, axis=0) / np.diff(x)[:, None]
    return u, None, w


def courant_rate(q: tuple, grid: Grid) -> float:
    """Largest sum over directions of |velocity| / width, of the faster of a cell's two faces."""
    faster = [np.maximum(np.abs(v), np.roll(np.abs(v), 1, axis)) for v, axis in ((q[0], 0), (q[2], 2))]
    return float((faster[0][REAL] / grid.dx[2] + faster[1][REAL] / grid.dz[2]).max())


def turn(n: int, courant: float = 0.5, shots: list | None = None) -> dict[str, float]:
    """There and back on n x n cells: error sum |F - F0| h^2, what the volume gained, over- and underfull cells, steps.

    shots: is filled with F (n, n) at the start, at T/2 and at the end.
    """
    block = square(n)
    grid = grid_of(block)
    F, q = disc(block), swirl(block)
    start = F[REAL].copy()
    way = PERIOD / np.pi  # of each half, in units of the fastest: the integral of cos(pi t / T) over T / 2
    steps = int(np.ceil(way * courant_rate(q, grid) / courant))
    dt = way / steps
    back = tuple(None if v is None else -v for v in q)
    tracking, team = tracking_of(grid), Team(1)
    over = under = 0.0
    pictures = [start]
    for number in range(2 * steps):
        flow = Flow(*(q if number < steps else back), F, F, dt)
        moved = move_liquid(team, tracking, flow, NO_SOLIDS, dt, number, mirror)
        tracking.pieces.keep_moments()
        over, under = max(over, moved.over), min(under, moved.under)
        if number + 1 in (steps, 2 * steps):
            pictures.append(F[REAL].copy())
    if shots is not None:
        shots.extend(pictures)
    return {
        "error": float(np.abs(F[REAL] - start).sum()) / n**2,
        "volume": float(F[REAL].sum() / start.sum()) - 1.0,
        "over": over,
        "under": under,
        "steps": 2 * steps,
    }


def draw(path: str, n: int = 64) -> None:
    """The liquid at T/2 and at the end, with the disc it started from."""
    import matplotlib as mpl

    mpl.use("Agg")
    import matplotlib.pyplot as plt

    shots: list[np.ndarray] = []
    turn(n, shots=shots)
    figure, axes = plt.subplots(1, 2, figsize=(8.0, 4.2), layout="constrained")
    at = (np.arange(n) + 0.5) / n
    for axis, F, title in zip(axes, shots[1:], ("t = T/2", "t = T"), strict=True):
        axis.pcolormesh(at, at, F.T, cmap="Blues", vmin=0.0, vmax=1.0, rasterized=True)
        axis.contour(at, at, shots[0].T, [0.5], colors="tab:red", linewidths=1.0)
        axis.set(title=title, aspect="equal", xlabel="x", ylabel="z")
    figure.savefig(path, dpi=100)


def main() -> None:
    """Print the table; with a file's name on the command line, draw it too."""
    for n in (32, 64, 128):
        found = turn(n)
        print(
            f"{n:4} cells   error {found['error']:.4f}   volume {found['volume']:.0e}   over {found['over']:.0e}   "
            f"under {found['under']:.0e}   {found['steps']} steps"
        )
    if len(sys.argv) > 1:
        draw(sys.argv[1])


if __name__ == "__main__":
    main()
