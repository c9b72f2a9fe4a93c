"""&MESH and &BCDATA -> Mesh: planes of the cells, kinds of the sides. No array of mesh size is made."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flowgmo.deck import Deck
from flowgmo.mesh import Block, Mesh, Side, graded_planes

if TYPE_CHECKING:
    from flowgmo.building.build import Findings

MOST_CELLS = 1_000_000  # along one axis: with a single cell across, more than a machine computes in a day


def build_mesh(found: Findings) -> Mesh | None:
    """The one mesh block of the deck, with its six sides; None, with a problem, if it cannot be made."""
    deck = found.deck
    sides = tuple(Side(n, int(deck.at("IBCT", n + 1))) for n in range(6))
    sizes = _default_size(deck)
    counts = [_counts(found, axis, sizes) for axis in "XYZ"]
    if any(c is None for c in counts):
        return None
    planes = [
        graded_planes(_anchors(deck, axis), c, _end_sizes(deck, axis)) for axis, c in zip("XYZ", counts, strict=True)
    ]
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


def _end_sizes(deck: Deck, axis: str) -> list[float | None]:
    """Cell sizes asked for at the mesh planes of one axis [length]."""
    name, planes = f"SIZE{axis}", range(1, len(_anchors(deck, axis)) + 1)
    return [float(deck.at(name, n)) if deck.given(name, n) else None for n in planes]


def _counts(found: Findings, axis: str, size: float | None) -> list[int] | None:
    """Cells of each interval between the mesh planes of one axis; None, with a problem, if there are too many."""
    deck = found.deck
    lengths = np.diff(_anchors(deck, axis))
    ends = _end_sizes(deck, axis)
    counts = [float(deck.at(f"N{axis}CELL", n) if deck.given(f"N{axis}CELL", n) else 0) for n in range(1, len(ends))]
    total = int(deck[f"N{axis}CELT"]) if deck.given(f"N{axis}CELT") else 0
    for i, length in enumerate(lengths):
        if counts[i]:
            continue
        mean = [s for s in (ends[i], ends[i + 1]) if s]
        if mean and not total:
            counts[i] = max(1.0, np.round(length / float(np.mean(mean))))
        elif size is not None and not total:
            counts[i] = max(1.0, np.round(length / size))
    if not max(sum(counts), total) <= MOST_CELLS or not np.isfinite(lengths.sum()):
        name = next((n for n in (f"N{axis}CELT", f"N{axis}CELL", f"SIZE{axis}") if deck.given(n)), f"P{axis}")
        index = () if name.endswith("CELT") else (min(deck.indices(name), default=(2,)))
        found.problem(
            name, *index, wrong=f"the mesh has {max(sum(counts), total):.3g} cells over {lengths.sum():.3g} in "
            f"{axis.lower()}, no machine computes them", write=f"Write n{axis.lower()}celt={MOST_CELLS} at most",
        )  # fmt: skip
        return None
    counts = [int(n) for n in counts]
    open_ends = [i for i, n in enumerate(counts) if n == 0]
    left = max(total - sum(counts), len(open_ends)) if open_ends else 0
    for i, n in zip(open_ends, _shares(lengths[open_ends], left), strict=True):
        counts[i] = n
    return counts


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
