"""A body as the deck describes it: frozen, everything that does not change during a run.

Axes. Space axes x, y, z are fixed. Body axes are parallel to them at t = 0 and turn with the body; R_WB turns body
components into space components. The body's point B is its mass centre; where a body has no mass it is the reference
point of its prescribed motion.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from flowgmo.geometry import Component

SOLID, PRESCRIBED, COUPLED = "solid", "prescribed", "coupled"
SIX_DEGREES, FIXED_AXIS, FIXED_POINT = "six degrees", "fixed axis", "fixed point"


@dataclass(frozen=True)
class Table:
    """A function of time, linear between its entries and constant outside them.

    t [time] (n,) strictly increasing; y (n,) in the unit of what it describes.
    """

    t: np.ndarray
    y: np.ndarray

    @property
    def is_zero(self) -> bool:
        return not np.any(self.y)


@dataclass(frozen=True)
class Sinusoid:
    """y(t) = amplitude sin(2 π frequency t + phase); frequency [1/time], phase [rad]."""

    amplitude: float
    frequency: float
    phase: float


@dataclass(frozen=True)
class Drive:
    """One of the six velocity components of a body: solved for (coupled), or prescribed by a table or sinusoid."""

    coupled: bool
    law: Table | Sinusoid


@dataclass(frozen=True)
class PointLoad:
    """A control force (3 tables) that acts at a point fixed to the body; point in space axes at t = 0."""

    force: tuple[Table, Table, Table]
    point: np.ndarray
    in_body_axes: bool


@dataclass(frozen=True)
class ControlLoads:
    """Total force at the mass centre and total torque, plus forces at points.

    The torque is about the mass centre (six degrees), the fixed point, or the fixed axis.
    """

    force: tuple[Table, Table, Table]
    torque: tuple[Table, Table, Table]
    in_body_axes: bool
    points: tuple[PointLoad, ...] = ()


@dataclass(frozen=True)
class Stops:
    """How far a body may go from its start: displacement of B [length] (3,), angle about a fixed axis [rad].

    Bounds are signed (lo <= 0 <= hi), infinite where the deck gives none.
    """

    lo: np.ndarray = field(default_factory=lambda: np.full(3, -np.inf))
    hi: np.ndarray = field(default_factory=lambda: np.full(3, np.inf))
    angle_lo: float = -np.inf
    angle_hi: float = np.inf

    @property
    def any(self) -> bool:
        return bool(np.isfinite([*self.lo, *self.hi, self.angle_lo, self.angle_hi]).any())


@dataclass(frozen=True)
class MassData:
    """mass [mass]; centre (3,) [length] space axes at t = 0; inertia (3, 3) [mass length²] about the centre, body axes.

    `error` is the relative error of properties integrated from a shape (0: closed form, or given in the deck).
    A fixed-axis body given by its moment about the axis carries it as `axis_moment` and has no tensor.
    """

    mass: float
    centre: np.ndarray
    inertia: np.ndarray | None
    axis_moment: float | None = None
    error: float = 0.0


@dataclass(frozen=True)
class Body:
    """One component of the deck.

    number     1-based, as in the deck; name as in OBSID
    shape      in space axes at t = 0
    kind       solid (stationary), prescribed, coupled
    origin     B at t = 0 (3,) [length]
    constraint six degrees, fixed axis (point, axis), fixed point (point)
    drives     u, v, w of the point that moves (space axes), then the three rotations (body axes); fixed axis: only
               drives[3] counts, about `axis`
    reference  the point whose translation the drives give, at t = 0 (3,)
    velocity   of B at t = 0 (3,) [length/time] space axes; spin (3,) [rad/time] body axes;
               fixed axis: spin[0] about axis
    """

    number: int
    name: str
    shape: Component
    kind: str
    origin: np.ndarray
    constraint: str = SIX_DEGREES
    point: np.ndarray | None = None
    axis: np.ndarray | None = None
    mass: MassData | None = None
    drives: tuple[Drive, ...] = ()
    reference: np.ndarray | None = None
    velocity: np.ndarray = field(default_factory=lambda: np.zeros(3))
    spin: np.ndarray = field(default_factory=lambda: np.zeros(3))
    stops: Stops = field(default_factory=Stops)
    loads: ControlLoads | None = None
    restitution: float = 1.0
    friction: float = 0.0

    @property
    def moves(self) -> bool:
        return self.kind != SOLID

    @property
    def coupled(self) -> bool:
        return self.kind == COUPLED
