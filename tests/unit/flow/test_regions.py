"""Regions of connected open cells: against a search from cell to cell, and kept while cells change."""

import numpy as np
import pytest

from flowgmo.flow.fields import G, Open
from flowgmo.flow.pressure.regions import Regions


def random_open(rng, n):
    """Open fractions on n (3,) cells, closed often enough for many regions."""
    shape = tuple(m + 2 * G for m in n)
    V = np.where(rng.random(shape) < 0.25, 0.0, 1.0)
    areas = [np.where(rng.random(shape) < 0.4, 0.0, 0.5) for _ in range(3)]
    return Open(V, *areas)


def search(opened, joined):
    """Numbers of regions in the order of their first cell (mesh), -1 in closed cells and ghosts."""
    V = opened.V
    n = np.array(V.shape) - 2 * G
    label = np.full(V.shape, -1)
    count = 0
    for start in np.ndindex(*n):
        at = tuple(np.add(start, G))
        if V[at] == 0.0 or label[at] >= 0:
            continue
        label[at], todo = count, [at]
        while todo:
            cell = todo.pop()
            for d in range(3):
                for up in (0, 1):
                    other, face = list(cell), list(cell)
                    other[d] += 1 if up else -1
                    face[d] -= 1 - up
                    if not G <= other[d] < n[d] + G:
                        if not joined[d]:
                            continue
                        other[d], face[d] = (G, n[d] + G - 1) if up else (n[d] + G - 1, n[d] + G - 1)
                    o = tuple(other)
                    if opened[1 + d][tuple(face)] > 0.0 and V[o] > 0.0 and label[o] < 0:
                        label[o] = count
                        todo.append(o)
        count += 1
    return label, count


def check(regions, opened, held, joined):
    label, count = search(opened, joined)
    assert np.array_equal(regions.label, label)
    assert np.array_equal(regions.cells, np.bincount(label[label >= 0], minlength=count))
    reached = np.zeros(count, bool)
    for side in np.flatnonzero(held):
        layer = np.moveaxis(label[G:-G, G:-G, G:-G], side // 2, 0)[-(side % 2)]
        reached[layer[layer >= 0]] = True
    assert np.array_equal(regions.reached, reached)


@pytest.mark.parametrize("joined", [(False, False, False), (True, False, True), (False, True, False)])
@pytest.mark.parametrize("n", [(6, 5, 9), (1, 7, 8), (7, 1, 6), (5, 4, 1)])
def test_regions_are_those_of_a_search_and_stay_so(n, joined):
    rng = np.random.default_rng(4)
    held = rng.random(6) < 0.4
    opened = random_open(rng, n)
    regions = Regions(opened, tuple(held), joined)
    check(regions, opened, held, joined)
    for k in range(8):
        cells = rng.integers(0, n, (1 + 2 * k, 3)) + G
        other = random_open(rng, n)
        for cell in cells:
            opened.V[tuple(cell)] = other.V[tuple(cell)]
            for d in range(3):
                for up in (0, 1):
                    face = cell.copy()
                    face[d] -= up
                    opened[1 + d][tuple(face)] = other[1 + d][tuple(face)]
        regions.renew(cells)
        check(regions, opened, held, joined)


def test_only_lines_with_changed_cells_are_read_again():
    opened = random_open(np.random.default_rng(5), (9, 8, 7))
    regions = Regions(opened, (False,) * 6, (False,) * 3)
    regions.renew(np.array([[4, 5, 6], [4, 5, 3], [7, 2, 2]]))
    assert np.flatnonzero(regions.again).tolist() == [(4 - G) * 8 + 5 - G, (7 - G) * 8 + 2 - G]
