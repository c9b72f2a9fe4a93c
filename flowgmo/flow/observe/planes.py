"""Flow through rectangles: volume of liquid per time, positive along the axis.

    Q = sum over faces (A u S F_donor)          F_donor: the fraction of the cell that the liquid comes from

S is the part of the face inside the rectangle. A plane between two layers of faces takes both, each the more the nearer
it is: what flows in a channel is the same everywhere, and where it is not that is second order.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flowgmo.flow.fields import Flow, G, Open
from flowgmo.flow_plan import FlowPlane
from flowgmo.mesh import Block


@dataclass(frozen=True)
class Gate:
    """A FlowPlane on the mesh: layers of faces (index with ghosts, weight); area (n, m) of faces inside it, and the
    part (2,) of slices of the two other directions where that is not 0."""

    axis: int
    layers: tuple[tuple[int, float], ...]
    area: np.ndarray
    part: tuple[slice, slice]


def find_gate(plane: FlowPlane, block: Block) -> Gate:
    """Layers and areas of a plane."""
    planes = block.planes[plane.axis]
    x = float(np.clip(plane.position, planes[0], planes[-1]))
    k = int(np.clip(np.searchsorted(planes, x, side="right") - 1, 0, len(planes) - 2))
    share = (x - planes[k]) / (planes[k + 1] - planes[k])
    layers = tuple((k + m + G - 1, w) for m, w in enumerate((1.0 - share, share)) if w > 0.0)
    lengths = [
        np.maximum(np.minimum(p[1:], plane.hi[e]) - np.maximum(p[:-1], plane.lo[e]), 0.0)
        for e, p in enumerate(block.planes)
        if e != plane.axis
    ]
    part, kept = [], []
    for length in lengths:
        inside = np.flatnonzero(length > 0.0)
        first, last = (int(inside[0]), int(inside[-1]) + 1) if len(inside) else (0, 0)
        part.append(slice(first + G, last + G))
        kept.append(length[first:last])
    return Gate(plane.axis, layers, np.multiply.outer(*kept), tuple(part))


def flow_through(gate: Gate, flow: Flow, openings: Open) -> float:
    """Volume of liquid per time [length3/time] through a Gate; F with ghosts filled."""
    d, u = gate.axis, flow.velocity[gate.axis]
    if u is None:
        return 0.0

    def layer(a: np.ndarray, k: int) -> np.ndarray:
        return a[gate.part[:d] + (k,) + gate.part[d:]]

    total = 0.0
    for k, weight in gate.layers:
        rate = gate.area * layer(u, k)
        if openings[1 + d] is not None:
            rate = rate * layer(openings[1 + d], k)
        if flow.F is not None:
            rate = rate * np.where(rate > 0.0, layer(flow.F, k), layer(flow.F, k + 1)).clip(0.0, 1.0)
        total += weight * float(rate.sum())
    return total
