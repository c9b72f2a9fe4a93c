"""Liquid among full pockets: where void lies beyond them they let it through, and no pressure is without bound."""

import numpy as np
import pytest

from flowgmo.flow.fields import G, Open
from flowgmo.flow.pressure.ways_out import WaysOut

SHAPE = tuple(n + 2 * G for n in (7, 3, 3))
J = K = G + 1  # a channel of one line of cells along x


def row(kinds):
    """(openings, wet, b, pockets, shut) of a line of cells.

    L liquid, P a pocket that is shut, p one that is open, . void, # closed."""
    V, wet, pockets, shut = np.zeros(SHAPE), np.zeros(SHAPE, np.int8), [], []
    for n, kind in enumerate(kinds):
        V[G + n, J, K] = 0.0 if kind == "#" else 1.0
        wet[G + n, J, K] = kind in "LP"
        if kind in "Pp":
            pockets.append((G + n, J, K))
            shut.append(kind == "P")
    Ax = np.zeros(SHAPE)
    Ax[:-1] = (V[:-1] > 0.0) & (V[1:] > 0.0)
    b = [np.zeros(SHAPE) for _ in range(3)]
    for n in range(len(kinds) - 1):  # no b between two cells that were both dry before any was shut
        b[0][G + n, J, K] = 1.0 if "L" in kinds[n : n + 2] and "#" not in kinds[n : n + 2] else 0.0
    return Open(V, Ax, np.zeros(SHAPE), np.zeros(SHAPE)), wet, b, np.array(pockets, np.int32), np.array(shut)


def opened(kinds, lids=()):
    """As row, after WaysOut: which pockets are shut, and which stay open for good."""
    openings, wet, b, pockets, shut = row(kinds)
    ways = WaysOut(openings)
    ways.begin(pockets)
    ways.open(shut, np.array([(G + n, J, K) for n in lids], np.int32).reshape(-1, 3), wet, tuple(b))
    assert not ways.mark.any()
    assert [bool(wet[tuple(at)]) for at in pockets] == list(shut)
    return "".join("P" if s else "p" for s in shut), "".join("k" if s else "-" for s in ways.kept_open)


@pytest.mark.parametrize(
    ("kinds", "shut", "kept"),
    [
        ("#PLP.##", "Pp", "-k"),  # the one with void beyond lets through
        (".PLLP.#", "pp", "kk"),
        ("#PLL.##", "P", "-"),  # the surface is a way out
        ("#PLp.##", "Pp", "--"),  # a pocket with room is one
        ("#PLP###", "PP", "--"),  # full in fact: sealed.py
        ("#PLPL.#", "PP", "--"),  # liquid beyond a full pocket has one
    ],
)
def test_pockets_stay_open_where_they_are_the_only_way_out(kinds, shut, kept):
    assert opened(kinds) == (shut, kept)
    mirrored, kept_there = opened(kinds[::-1])
    assert (mirrored[::-1], kept_there[::-1]) == (shut, kept)


def test_a_surface_inside_a_cell_is_a_way_out():
    assert opened("#PLP.##", lids=[2]) == ("PP", "--")


def test_more_cells_than_the_queue_begins_with():
    n = 600
    V = np.zeros((n + 2 * G, 1 + 2 * G, 1 + 2 * G))
    V[G:-G, G, G] = 1.0
    wet, Ax, b = V.astype(np.int8), V.copy(), V.copy()
    wet[-G - 1, G, G] = 0  # void at the end, behind a pocket
    b[-G - 2 :] = b[:G] = 0.0
    ways = WaysOut(Open(V, Ax, 0.0 * V, 0.0 * V))
    pockets, shut = np.array([[n + G - 2, G, G]], np.int32), np.ones(1, bool)
    ways.begin(pockets)
    ways.open(shut, pockets[:0], wet, (b, 0.0 * V, 0.0 * V))
    assert not shut[0] and ways.kept_open[0] and not ways.mark.any()


def test_more_pockets_than_the_queue_begins_with():
    """Each beside void, so that none needs a look beyond its neighbours."""
    n = 700
    V = np.zeros((n + 2 * G, 1 + 2 * G, 1 + 2 * G))
    V[G:-G, G, G] = 1.0
    wet = np.zeros(V.shape, np.int8)
    pockets = np.array([(G + i, G, G) for i in range(1, n - 1, 2)], np.int32)
    wet[tuple(pockets.T)] = 1
    ways = WaysOut(Open(V, V.copy(), 0.0 * V, 0.0 * V))
    ways.begin(pockets)
    shut = np.ones(len(pockets), bool)
    ways.open(shut, pockets[:0], wet, (V.copy(), 0.0 * V, 0.0 * V))
    assert shut.all() and not ways.kept_open.any() and not ways.mark.any()
