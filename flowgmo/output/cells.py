"""The liquid as files show it: real cells only, single precision, the deck's pressure, velocity at the centres.

Where there is no liquid (F below DUST, or a closed cell) velocity is 0 and pressure the void's: what the solver's
arrays hold there means nothing.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from flowgmo.mesh import GHOST_LAYERS as G

if TYPE_CHECKING:
    from flowgmo.flow.fields import Flow

DUST = 1e-6  # of a cell: less is not shown as moving liquid; about the rounding of single precision


class Cells(NamedTuple):
    """p [pressure], F [-] of shape (nx, ny, nz) and velocity (nx, ny, nz, 3), float32; F None without a surface."""

    p: np.ndarray
    F: np.ndarray | None
    velocity: np.ndarray


def real(a: np.ndarray) -> np.ndarray:
    """The real cells of an array with ghosts, a view."""
    return a[G:-G, G:-G, G:-G]


def cells_of(flow: Flow, V: np.ndarray | None, void_pressure: float) -> Cells:
    """What is written of a Flow. V with ghosts, None without solids."""
    shown = np.ones(real(flow.p).shape, bool) if flow.F is None else real(flow.F) > DUST
    if V is not None:
        shown &= real(V) > 0.0
    p = np.where(shown, real(flow.p), 0.0)
    p += void_pressure
    velocity = np.zeros((*p.shape, 3), np.float32)
    for d, a in enumerate(flow.velocity):
        if a is not None:
            below = tuple(slice(G - (e == d), a.shape[e] - G - (e == d)) for e in range(3))
            np.multiply(a[below] + real(a), 0.5, out=velocity[..., d], where=shown, casting="same_kind")
    F = None if flow.F is None else real(flow.F).clip(0.0, 1.0).astype(np.float32)
    return Cells(p.astype(np.float32), F, velocity)
