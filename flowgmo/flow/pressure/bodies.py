"""What the pressure equation asks of bodies in the liquid, during one projection."""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING, Protocol

import numpy as np

if TYPE_CHECKING:
    from flowgmo.flow.immersed.coupling import Coupling


class Couple(Protocol):
    """Bodies that the pressure moves, during one projection."""

    def begin(self, diagonal: np.ndarray, right: np.ndarray) -> Coupling:
        """As they are coupled to the cells of the equation (diagonal > 0); takes what they push from `right`."""

    def opening(self, cells: np.ndarray) -> Callable[[np.ndarray], np.ndarray]:
        """After `begin`: what the bodies' velocities with q (mesh) [length2/time] open of cells (n, 3) beyond what
        Opening.opened says, (n,) [length3/time]."""

    def contacts_changed(self, q: np.ndarray) -> bool:
        """Whether with this solution other contacts of the bodies press than was assumed, so that it must be found
        again."""


class Opening(Protocol):
    """Bodies that open cells and close them, during one projection."""

    def source(self, diagonal: np.ndarray, dt: float, ease: float, right: np.ndarray) -> None:
        """What they push out of the cells of the equation (diagonal > 0), from `right`; ease [time]: PUSH of an excess
        leaves in it."""

    def opened(self, cells: np.ndarray, dt: float) -> tuple[np.ndarray, np.ndarray]:
        """Of cells (n, 3): V before they moved (n,), and what they grow by with the velocities that are expected (n,)
        [length3/time], < 0 where they close."""
