"""What a subcomponent is made of: limiters, a quadric, a torus, a triangle mesh, its place and its role.

A region is the set of points for which every part given holds, in the subcomponent's own frame:

    all limiters   and   quadric <= 0   and   inside the torus   and   inside the mesh
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from flowgmo.geometry.transform import Transform

if TYPE_CHECKING:
    from flowgmo.geometry.stl import StlMesh

Range = tuple[float | None, float | None]
ROLES = ("solid", "hole", "complement")


@dataclass(frozen=True)
class Limits:
    """Lower and upper bound of each coordinate; None = unbounded.

    x, y, z [length]; radius from the z axis; sphere: distance from the origin; angle: azimuth about z [degrees];
    cone: angle from the +z axis [degrees, 0 to 180].
    """

    x: Range | None = (None, None)
    y: Range | None = (None, None)
    z: Range | None = (None, None)
    radius: Range | None = (None, None)
    sphere: Range | None = (None, None)
    angle: Range | None = (None, None)
    cone: Range | None = (None, None)


@dataclass(frozen=True)
class Quadric:
    """c + cx x + cy y + cz z + cxy xy + cxz xz + cyz yz + cx2 x² + cy2 y² + cz2 z² + crxy √(x²+y²) <= 0 inside."""

    c: float = 0.0
    cx: float = 0.0
    cy: float = 0.0
    cz: float = 0.0
    cxy: float = 0.0
    cxz: float = 0.0
    cyz: float = 0.0
    cx2: float = 0.0
    cy2: float = 0.0
    cz2: float = 0.0
    crxy: float = 0.0


@dataclass(frozen=True)
class Torus:
    """Ring about the z axis, centred at the origin; in the plane z = 0 its tube spans the radii inner to outer."""

    inner: float
    outer: float


@dataclass(frozen=True)
class Piece:
    """One subcomponent. density [mass/length³] None: the component's; name: for messages."""

    role: str = "solid"
    limits: Limits = field(default_factory=Limits)
    quadric: Quadric | None = None
    torus: Torus | None = None
    stl: StlMesh | None = None
    transform: Transform = field(default_factory=Transform)
    density: float | None = None
    name: str = ""
