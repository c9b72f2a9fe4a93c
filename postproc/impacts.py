"""Hits: what two parties give each other at one instant, however many points they touch at.

`/collisions` has a row for each point. A box that lands flat writes four rows with one number of `cluster`; whoever
asks how hard it hit wants their sum. Several pairs may share a cluster (a rack of balls); each pair is a hit of its
own, for impulses on different bodies do not add up to anything.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from postproc.results import Results


@dataclass(frozen=True)
class Hits:
    """In order of time: time (n,), parties a and b (n,), impulse (n, 3) on a, energy lost, points, bounces (n,)."""

    time: np.ndarray
    a: np.ndarray
    b: np.ndarray
    impulse: np.ndarray
    loss: np.ndarray
    points: np.ndarray
    count: np.ndarray

    def __len__(self) -> int:
        return len(self.time)

    @property
    def size(self) -> np.ndarray:
        """Magnitude (n,) of the impulses."""
        return np.linalg.norm(self.impulse, axis=1)


def hits(results: Results) -> Hits:
    """All impacts of a run, the points of a hit together: their impulses and losses summed.

    The time is part of what tells hits apart, since a run that was continued may count its clusters from 0 again.
    """
    rows = results.impacts
    n = len(rows.get("time", ()))
    if n == 0:
        nothing = np.zeros(0)
        return Hits(nothing, nothing, nothing, np.zeros((0, 3)), nothing, nothing, nothing)
    a, b = rows["a"], rows["b"]
    cluster = rows.get("cluster", np.arange(n))
    key = np.column_stack([rows["time"], cluster, np.minimum(a, b), np.maximum(a, b)])
    _, first, which = np.unique(key, axis=0, return_index=True, return_inverse=True)
    which = which.reshape(-1)  # numpy 2.0 alone gives it a second axis
    order = first[np.lexsort((first, rows["time"][first]))]
    place = np.empty(len(first), dtype=int)
    place[which[order]] = np.arange(len(first))
    place = place[which]  # of each row among the hits
    same_way = np.where(a == a[order][place], 1.0, -1.0)
    return Hits(
        rows["time"][order],
        a[order],
        b[order],
        _sums(rows["impulse"] * same_way[:, None], place),
        _sums(rows.get("energy_loss", np.zeros(n))[:, None], place)[:, 0],
        np.bincount(place),
        rows.get("count", np.ones(n, dtype=int))[order],
    )


def _sums(values: np.ndarray, place: np.ndarray) -> np.ndarray:
    """Sums (n, k) of rows (m, k) that have the same place (m,)."""
    return np.column_stack([np.bincount(place, column) for column in values.T])
