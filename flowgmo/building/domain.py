"""&MESH and &BCDATA -> Mesh: planes of the cells, kinds of the sides. No array of mesh size is made."""

from __future__ import annotations

import numpy as np

from flowgmo.deck import Deck
from flowgmo.mesh import Block, Mesh, Side, graded_planes


def build_mesh(deck: Deck) -> Mesh:
    """The one mesh block of the deck, with its six sides."""
    sides = tuple(Side(n, int(deck.at("IBCT", n + 1))) for n in range(6))
    sizes = _default_size(deck)
    planes = [_planes(deck, axis, sizes) for axis in "XYZ"]
    block = Block(*planes, neighbours=sides, name=str(deck["MESHNAME"] or ""))
    return Mesh(blocks=(block,), sides=sides)


def _anchors(deck: Deck, axis: str) -> np.ndarray:
    """Mesh planes given for one axis [length]; two at least."""
    count = max((n for (n,) in deck.indices(f"P{axis}")), default=2)
    return np.array([deck.at(f"P{axis}", n) for n in range(1, max(count, 2) + 1)], dtype=float)


def _default_size(deck: Deck) -> float | None:
    """Uniform cell size for the directions without a number of cells: SIZE, or the size that gives about NTOTAL."""
    if deck["IF_SIZE"] == 1 and (deck["SIZE"] or 0.0) > 0.0:
        return float(deck["SIZE"])
    if deck["IF_SIZE"] == 0 and (deck["NTOTAL"] or 0) > 0:
        lengths = [float(np.ptp(_anchors(deck, axis))) for axis in "XYZ"]
        return float((np.prod(lengths) / float(deck["NTOTAL"])) ** (1.0 / 3.0))
    return None


def _planes(deck: Deck, axis: str, size: float | None) -> np.ndarray:
    anchors = _anchors(deck, axis)
    lengths = np.diff(anchors)
    ends = [
        float(deck.at(f"SIZE{axis}", n)) if deck.given(f"SIZE{axis}", n) else None for n in range(1, len(anchors) + 1)
    ]
    counts = [int(deck.at(f"N{axis}CELL", n)) if deck.given(f"N{axis}CELL", n) else 0 for n in range(1, len(anchors))]
    total = int(deck[f"N{axis}CELT"]) if deck.given(f"N{axis}CELT") else 0
    for i, length in enumerate(lengths):
        if counts[i]:
            continue
        mean = [s for s in (ends[i], ends[i + 1]) if s]
        if mean and not total:
            counts[i] = max(1, round(length / float(np.mean(mean))))
        elif size is not None and not total:
            counts[i] = max(1, round(length / size))
    open_ends = [i for i, n in enumerate(counts) if n == 0]
    left = max(total - sum(counts), len(open_ends)) if open_ends else 0
    for i, n in zip(open_ends, _shares(lengths[open_ends], left), strict=True):
        counts[i] = n
    return graded_planes(anchors, counts, ends)


def _shares(lengths: np.ndarray, cells: int) -> list[int]:
    """Cells for each interval, one at least, by length; largest remainders first."""
    if len(lengths) == 0:
        return []
    ideal = lengths / lengths.sum() * cells
    counts = np.maximum(np.floor(ideal).astype(int), 1)
    for i in np.argsort(np.floor(ideal) - ideal, kind="stable"):
        if counts.sum() < cells:
            counts[i] += 1
    return counts.tolist()
