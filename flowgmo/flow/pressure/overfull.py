"""Cells that hold more than their volume push it out, but with no more than a pressure that the scene can have.

PUSH of an excess x = (F - 1) V leaves in a step, however hard that is: where bodies leave the liquid no way out but
slits that are open by A, with

    PUSH x h / (A ease)                  h: size of a cell

at whatever pressure that takes. A plug that came to rest on 8 % of a cell (hard/wet_plug_free) had the liquid at 14 m/s
and 20 MPa in the next step but one; the jet bounds the steps, shorter steps have the rest out faster, and so on, to
36 km/s. So the push goes down with the pressure that it meets, to nothing at P, as that of a spring:

    push = s (1 - p / P)            s = PUSH x volume / ease

of which s p / P belongs to the matrix: it adds s rho / (P dt) to the diagonal, and stays symmetric. An excess brings
P x of energy at most, and leaves slits with sqrt(2 P / rho) at most. With

    P = rho STRONG U^2              U: of a fall through the domain, of bodies and sides

pressures that flows have by themselves, rho U^2 / 2, change s by a twentieth. Where p was above P, as in an impact, it
is P, so that it presses no cell together that holds too much already.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from flowgmo.flow.fields import Grid
from flowgmo.flow.pressure.face_flows import PUSH
from flowgmo.kernel import kernel

STRONG = 10.0  # see above; a choice
ROOM = 1 << 16  # cells that are listed in one go; of more after they have been counted
NOTICED = 1e-7  # [-] F - 1: less is below what the solver's tolerance leaves


class Overfull(NamedTuple):
    """cells: index of n cells in arrays of mesh size; give (n,) [length]: what they add to the diagonal."""

    cells: tuple
    give: np.ndarray


def none_overfull() -> Overfull:
    """Where no excess is bounded."""
    return Overfull(tuple(np.zeros(0, np.int64) for _ in range(3)), np.zeros(0))


def strongest(rho: float, speed: float) -> float:
    """P [stress] of liquid of density rho [mass/length3] where the largest speed in sight is U [length/time]."""
    return STRONG * rho * speed**2


@kernel
def _list_over(columns, F, cells):
    """cells (n, 3) of the columns with F > 1, as many as there is room for; their count."""
    count = np.int64(0)
    for c in range(len(columns)):
        i, j = columns[c, 0], columns[c, 1]
        some = False
        for k in range(np.uint64(columns[c, 2]), np.uint64(columns[c, 3])):  # most have none: this loop vectorises
            some |= F[i, j, k] > 1.0 + NOTICED
        if not some:
            continue
        for k in range(columns[c, 2], columns[c, 3]):
            if F[i, j, k] > 1.0 + NOTICED:
                if count < len(cells):
                    cells[count, 0], cells[count, 1], cells[count, 2] = i, j, k
                count += 1
    return count


def overfull(
    columns: np.ndarray, F: np.ndarray, V: np.ndarray, p: np.ndarray, grid: Grid, rho: float, strength: float,
    dt: float, ease: float,
) -> Overfull:  # fmt: skip
    """Those of F [-] > 1 among columns (n, 4), with open volumes V [-] and the last pressure p [stress], all on the
    mesh with ghosts.

    strength [stress]: P; ease [time] in which PUSH of an excess leaves in steps of dt [time].
    """
    found = np.empty((ROOM, 3), np.int64)
    while (count := _list_over(columns, F, found)) > len(found):
        found = np.empty((count, 3), np.int64)
    cells = tuple(found[:count].T)
    volumes = V[cells] * np.prod([d[k] for d, k in zip(grid[:3], cells, strict=True)], axis=0)
    most = np.maximum(p[cells], strength)
    return Overfull(cells, PUSH * (F[cells] - 1.0) * volumes * rho / (ease * dt * most))
