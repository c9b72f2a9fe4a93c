"""Shapes as signed distance, normal, membership, and mass properties."""

from flowgmo.geometry.component import Component, OrientedBox
from flowgmo.geometry.errors import GeometryError
from flowgmo.geometry.moments import MassProperties, check_inertia
from flowgmo.geometry.overlap import overlap_depth
from flowgmo.geometry.piece import Limits, Piece, Quadric, Torus
from flowgmo.geometry.stl import StlMesh, mesh_from, read_stl
from flowgmo.geometry.transform import Transform

__all__ = [
    "Component",
    "GeometryError",
    "Limits",
    "MassProperties",
    "OrientedBox",
    "Piece",
    "Quadric",
    "StlMesh",
    "Torus",
    "Transform",
    "check_inertia",
    "mesh_from",
    "overlap_depth",
    "read_stl",
]
