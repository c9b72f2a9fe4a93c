"""Shapes as signed distance, normal, membership, and mass properties."""

from flowgmo.geometry.component import Component, OrientedBox
from flowgmo.geometry.errors import GeometryError
from flowgmo.geometry.moments import MassProperties, check_inertia
from flowgmo.geometry.piece import Limits, Piece, Quadric, Torus
from flowgmo.geometry.transform import Transform

__all__ = [
    "Component",
    "GeometryError",
    "Limits",
    "MassProperties",
    "OrientedBox",
    "Piece",
    "Quadric",
    "Torus",
    "Transform",
    "check_inertia",
]
