"""Liquid that is shut in: regions of the open space that hold no void and touch no pressure side.

There the pressure is known up to a constant only, the matrix is singular, and the flows that are given at its sides
must add up to nothing. Regions are connected open cells; solids that stand still cut them once. Whether one is full is
a count of its liquid cells at every step. Void that is left in liquid cells without a surface that the pressure knows
takes what flows in, as long as there is enough.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flowgmo.flow.columns import cells_in
from flowgmo.flow.fields import G, Open
from flowgmo.flow.pressure.pressure_matrix import open_volume
from flowgmo.flow.pressure.regions import Regions
from flowgmo.kernel import inner, kernel

NOWHERE = tuple(np.zeros(0, np.int64) for _ in range(3))  # index of no cell


class PressedTogether(ValueError):
    """Liquid flows into a full closed space, or out of it; the text says what and what to do.

    region: number of the space; inflow [length3/time].
    """

    def __init__(self, region: int, cells: int, inflow: float) -> None:
        self.region, self.inflow = region, inflow
        super().__init__(_complaint(cells, inflow))


@kernel
def count_liquid(columns, wet, label, right, counts, sums):
    """Per region: liquid cells, and the sum of their right-hand sides. label None: one region."""
    for c in range(columns.shape[0]):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(columns[c, 2], columns[c, 3]):
            if wet[i, j, k] != 0:
                region = np.int64(0)
                if label is not None:
                    region = np.int64(label[i, j, k])
                counts[region] += 1
                sums[region] += right[i, j, k]


@inner
def _room(grid, V, F, i, j, k):
    """Volume of the void in a cell [length3]."""
    return max(1.0 - F[i, j, k], 0.0) * open_volume(grid, V, i, j, k)


@kernel
def sum_rooms(columns, wet, label, grid, V, F, rooms):
    """Per region: the void in its liquid cells [length3]."""
    for c in range(columns.shape[0]):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(columns[c, 2], columns[c, 3]):
            if wet[i, j, k] != 0:
                region = np.int64(0)
                if label is not None:
                    region = np.int64(label[i, j, k])
                rooms[region] += _room(grid, V, F, i, j, k)


@kernel
def fill_rooms(columns, wet, label, grid, V, F, rate, right):
    """right += rate[region] [1/time] times the void in liquid cells."""
    for c in range(columns.shape[0]):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(columns[c, 2], columns[c, 3]):
            if wet[i, j, k] != 0:
                region = np.int64(0)
                if label is not None:
                    region = np.int64(label[i, j, k])
                right[i, j, k] += rate[region] * _room(grid, V, F, i, j, k)


@kernel
def shift(columns, wet, label, amount, a):
    """a += amount[region] in liquid cells."""
    for c in range(columns.shape[0]):
        i = columns[c, 0]
        j = columns[c, 1]
        for k in range(columns[c, 2], columns[c, 3]):
            if wet[i, j, k] != 0:
                region = np.int64(0)
                if label is not None:
                    region = np.int64(label[i, j, k])
                a[i, j, k] += amount[region]


def _complaint(cells: int, inflow: float) -> str:
    what, how = ("pressed together", "in and nothing can leave") if inflow > 0.0 else ("pulled apart", "out only")
    return (
        f"liquid that fills a closed space of {cells} cells is {what}: {abs(inflow):.3g} of volume a unit of time "
        f"flows {how}. Give the space an opening, or rcsql"
    )


class Sealed:
    """The regions of a scene. held (6,): sides whose pressure is given; joined (3,): periodic directions."""

    def __init__(
        self, openings: Open, shape: tuple[int, ...], held: tuple[bool, ...], joined: tuple[bool, ...]
    ) -> None:
        self.label = self.regions = None
        self.cells, self.reached = np.array([np.prod([n - 2 * G for n in shape])]), np.array([any(held)])
        if openings.V is not None:
            self.regions = Regions(openings, held, joined)
            self._take()

    def renew(self, cells: np.ndarray | None = None) -> None:
        """The open fractions have changed: of cells (n, 3) and their lower faces, None: anywhere."""
        if self.regions is not None:
            self.regions.renew(cells)
            self._take()

    def _take(self) -> None:
        self.cells, self.reached = self.regions.cells, self.regions.reached
        self.label = self.regions.label if len(self.cells) != 1 else None

    def _region(self, cells: tuple) -> np.ndarray:
        """Numbers of the regions of cells, given as an index of arrays of mesh size."""
        return np.zeros(len(cells[0]), np.int64) if self.label is None else self.label[cells]

    def may_be_full(self, liquid: int) -> bool:
        """False where so few liquid cells cannot fill a sealed region."""
        return bool((self.cells[~self.reached] <= liquid).any())

    def all_full(self, columns: np.ndarray, wet: np.ndarray, opened: tuple) -> bool:
        """Whether every open cell of the scene is in the equation, and no pressure is given at a side; arguments as in
        `balance`."""
        every = int(self.cells.sum())
        if self.reached.any() or len(opened[0]) or cells_in(columns) < every:
            return False
        return int(np.count_nonzero(wet[G:-G, G:-G, G:-G])) == every

    def balance(
        self,
        columns: np.ndarray,
        wet: np.ndarray,
        right: np.ndarray,
        most: float,
        let_out: Callable[[np.ndarray], np.ndarray] | None = None,
        opened: tuple = NOWHERE,
        shut: tuple = NOWHERE,
        taken: np.ndarray | None = None,
        rooms_of: tuple | None = None,
        dt: float = 1.0,
    ) -> bool:
        """Make the right-hand side of every sealed region add up to zero; whether there is a sealed region.

        let_out(surplus (n,) [length3/time]): lets it leave, also from `right`, and returns what could not (exits.py).
        opened: indices of liquid cells that have a surface inside (lids.py); shut: of those whose void takes no more
        than `taken`, which is in `right`. rooms_of (grid, V, F): where that does not add up, all voids in liquid cells
        take what flows in within dt, each by its volume; without, or where they are too small, raises PressedTogether
        if more than `most` [length3/time] a cell would have to be left out.
        """
        if not self.may_be_full(cells_in(columns)):
            return False
        n = len(self.cells)
        counts, sums = np.zeros(n, np.int64), np.zeros(n)
        count_liquid(columns, wet, self.label, right, counts, sums)
        with_surface = np.bincount(self._region(opened), minlength=n) > 0
        sealed = (counts == self.cells) & ~self.reached & (counts > 0) & ~with_surface
        if not sealed.any():
            return False
        if let_out is not None:
            sums = let_out(np.where(sealed, sums, 0.0))
        many = sealed & (np.abs(sums) > most * counts)
        if many.any():
            if taken is not None:
                undone = np.where(many[self._region(shut)], taken, 0.0)
                right[shut] += undone
                sums += np.bincount(self._region(shut), undone, n)
            rooms = np.zeros(n)
            if rooms_of is not None:
                sum_rooms(columns, wet, self.label, *rooms_of, rooms)
            worst = np.where(many & (np.abs(sums) * dt > rooms), sums, 0.0)
            if worst.any():  # of what is pressed together and what is pulled apart by the same body, the former
                k = int(np.argmax(worst) if worst.max() > 0.0 else np.argmin(worst))
                raise PressedTogether(k, int(counts[k]), float(sums[k]))
            rate = np.where(many, -sums / np.where(rooms > 0.0, rooms, 1.0), 0.0)
            fill_rooms(columns, wet, self.label, *rooms_of, rate, right)
            sums = np.where(many, 0.0, sums)  # to round-off
        shift(columns, wet, self.label, np.where(sealed, -sums / np.maximum(counts, 1), 0.0), right)
        return True
