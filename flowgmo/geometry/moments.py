"""Volume, mass centre, and inertia from the moments of a region.

V = ∫ dV,  m1 = ∫ x dV,  m2 = ∫ x xᵀ dV;   under x -> A x + b:  V' = |det A| V,  m1' = |det A| (A m1 + b V), ...
inertia about the mass centre:  I = ρ (tr(S) 1 - S),  S = m2 - m1 m1ᵀ / V
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flowgmo.geometry.errors import GeometryError
from flowgmo.geometry.transform import Affine

TENSOR_TOLERANCE = 1e-6  # relative: decks give tensors with some six digits


@dataclass(frozen=True, eq=False)
class Moments:
    """∫ w dV, ∫ w x dV (3,), ∫ w x xᵀ dV (3,3), the weight w being 1 or a density."""

    m0: float
    m1: np.ndarray
    m2: np.ndarray

    def moved(self, place: Affine) -> Moments:
        """The moments of the image under an affine map."""
        factor, b, first = abs(np.linalg.det(place.A)), place.b, place.A @ self.m1
        second = place.A @ self.m2 @ place.A.T + np.outer(first, b) + np.outer(b, first) + self.m0 * np.outer(b, b)
        return Moments(factor * self.m0, factor * (first + self.m0 * b), factor * second)

    def times(self, factor: float) -> Moments:
        """Every moment times a factor."""
        return Moments(factor * self.m0, factor * self.m1, factor * self.m2)

    def plus(self, other: Moments) -> Moments:
        """The sum of two."""
        return Moments(self.m0 + other.m0, self.m1 + other.m1, self.m2 + other.m2)


NOTHING = Moments(0.0, np.zeros(3), np.zeros((3, 3)))


@dataclass(frozen=True, eq=False)
class MassProperties:
    """mass, volume, centre (3,) in space, inertia (3,3) about the centre in space axes.

    error: estimate of the relative error of mass, centre (in sizes) and inertia; 0 where the formulas are closed.
    """

    mass: float
    volume: float
    centre: np.ndarray
    inertia: np.ndarray
    error: float


def mass_properties_from(volume: float, weighted: Moments, error: float = 0.0) -> MassProperties:
    """The properties of a body whose density-weighted moments are given."""
    if not volume > 0 or not weighted.m0 > 0:
        raise GeometryError("the body has no volume or no mass: give it a solid part and a positive density")
    centre = weighted.m1 / weighted.m0
    central = weighted.m2 - np.outer(centre, weighted.m1)
    central = (central + central.T) / 2
    return MassProperties(weighted.m0, volume, centre, np.trace(central) * np.eye(3) - central, error)


def check_inertia(mass: float, inertia: np.ndarray) -> str | None:
    """What keeps a mass and a tensor (3,3) about the mass centre from belonging to any body; None when nothing does.

    A body has mass > 0 and I = Iᵀ with principal moments I1, I2, I3 > 0 and I1 + I2 >= I3 (equal for a flat one).
    """
    tensor = np.asarray(inertia, float)
    if not (np.isfinite(mass) and mass > 0):
        return f"the mass is {mass:g}: write a positive mass"
    if tensor.shape != (3, 3) or not np.isfinite(tensor).all():
        return "the inertia tensor is not a 3 x 3 table of finite numbers: write all nine or the six of one half"
    size = np.abs(tensor).max()
    if np.abs(tensor - tensor.T).max() > TENSOR_TOLERANCE * size:
        i, j = np.unravel_index(np.abs(tensor - tensor.T).argmax(), (3, 3))
        return (
            f"the inertia tensor is not symmetric: element ({i + 1},{j + 1}) is {tensor[i, j]:g} and element "
            f"({j + 1},{i + 1}) is {tensor[j, i]:g}: write the same value in both"
        )
    low, middle, high = np.linalg.eigvalsh((tensor + tensor.T) / 2)
    principal = f"principal moments {low:g}, {middle:g}, {high:g}"
    if low <= 0:
        return (
            f"the inertia tensor has the {principal}, and each must be positive: write a larger diagonal or smaller "
            "products of inertia"
        )
    if low + middle < high * (1 - TENSOR_TOLERANCE):
        return (
            f"no body has the {principal}: the two smaller must add up to at least the largest; check the units and "
            "that the tensor is about the mass centre"
        )
    return None
