"""Cells that a prescribed body opens faster than liquid can come: they open as void, and fill from their sides.

A gate that stands on its bed has nothing below it. Lifted with U, it opens a slit of the volume L U dt per width in its
first step, L its thickness, through ends that are U dt / 2 open in the mean. Full at the end of the step, it would
draw L / dt at each end, the faster the shorter the step is. Liquid comes with what its pressure and its motion give it,

    growth / (dt * sum of A S to liquid)   <=   TWICE max(U, sqrt(2 p / rho))     p [stress] above that of the void

for each group of cells that open together; groups that would need more are void. (Once would do, but that a flat wall
that leaves the mesh's planes one by one needs U itself, to round-off. And what gravity gives in the domain counts as U
too: a round body that turns back opens slivers through faces that are open for an instant.) A coupled body is not torn
off: its velocity and the pressure are one solution, in which the liquid holds it back.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from flowgmo.flow.fields import G, Grid

TWICE = 2.0  # once is what a flat wall needs; a choice, not varied


class Around(NamedTuple):
    """What cells that open have beside them; all on the mesh. V: open volumes before the step, areas: those of the
    faces during it, F, p [stress] as they are."""

    V: np.ndarray
    areas: Sequence[np.ndarray]
    F: np.ndarray
    p: np.ndarray


def torn(
    cells: np.ndarray, rates: np.ndarray, speeds: np.ndarray, around: Around, grid: Grid, rho: float, *,
    amid: bool = False,
) -> np.ndarray:  # fmt: skip
    """(n,) bool: cells (n, 3), in C order and closed or nearly void before the step, that liquid cannot fill within it.

    rates (n,) [length3/time] of their open volumes, speeds (n,) [length/time] of the bodies that open them, or what is
    to be expected in the scene, if that is more. amid: only groups amid liquid; where a void is beside them they are
    cells at the surface like others.
    """
    numbers = np.ravel_multi_index(tuple(cells.T.astype(np.int64)), around.V.shape)
    links, inlets, airy = (
        [],
        [],
        np.zeros(len(numbers), bool),
    )  # pairs of these cells; cell, [length2] and p of each of their faces to liquid
    sizes = [d[cells[:, k]] for k, d in enumerate(grid[:3])]
    for d, A in enumerate(around.areas):
        section = sizes[(d + 1) % 3] * sizes[(d + 2) % 3]
        stride = A.strides[d] // A.itemsize
        for face, way in ((numbers, 1), (numbers - stride, -1)):
            beyond, at = numbers + way * stride, cells[:, d] + way
            inside = (at >= G) & (at < A.shape[d] - G)
            area = A.reshape(-1)[face] * section
            other = np.minimum(np.searchsorted(numbers, beyond), len(numbers) - 1)
            also = numbers[other] == beyond
            links.append(np.column_stack([np.arange(len(numbers)), other])[also & (area > 0.0)])
            outside = ~also & (area > 0.0)
            liquid = _liquid(around, beyond)
            airy |= outside & inside & ~liquid & (around.V.reshape(-1)[beyond] > 0.0)
            wet = np.flatnonzero(outside & liquid)
            inlets.append((wet, area[wet], around.p.reshape(-1)[beyond[wet]]))
    count, group = _groups(np.concatenate(links), len(numbers))
    growth, inlet = np.bincount(group, rates, count), np.zeros(count)
    head, speed = np.zeros(count), np.zeros(count)
    np.maximum.at(speed, group, speeds)
    for wet, area, p in inlets:
        np.add.at(inlet, group[wet], area)
        np.maximum.at(head, group[wet], p)
    found = growth > inlet * TWICE * np.maximum(speed, np.sqrt(2.0 * head / rho))
    if amid:
        found &= np.bincount(group, airy, count) == 0.0
    return found[group]


def _liquid(around: Around, numbers: np.ndarray) -> np.ndarray:
    """Whether cells (flat index) were open and hold more liquid than void."""
    return (around.V.reshape(-1)[numbers] > 0.0) & (around.F.reshape(-1)[numbers] > 0.5)


def _groups(links: np.ndarray, n: int) -> tuple[int, np.ndarray]:
    """How many groups n cells are in that pairs (m, 2) join, and the group of each."""
    from scipy.sparse import coo_array  # only scenes with such cells pay for loading it
    from scipy.sparse.csgraph import connected_components

    joined = coo_array((np.ones(len(links), bool), tuple(links.T)), shape=(n, n))
    count, group = connected_components(joined, directed=False)
    return int(count), group
