"""FluidPlan: everything about the liquid that stays constant during a run. `Model.fluid`, None in a dry scene.

Units are the deck's own. Pressures are relative to the void's, so that p = 0 at the free surface (flow/__init__.py).
Off means absent: what the scene does not have is None, so that nobody asks for a switch where a value does.
Tables of time are linear between their times and constant outside them.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from flowgmo.geometry import Component
from flowgmo.mesh import GHOST_LAYERS, PERIODIC, WALL, Block

CELL_BYTES = 400  # every array of mesh size together, at most (what each part of flow/ may take adds up to this)
MOST_SUM = 0.9  # of the directional CFL numbers: one more tenth and upwind momentum is no longer stable
MOST_ALONG = 0.45  # of each of them then
MOST_COURANT = 0.5  # sum of the directional CFL numbers up to which the split is bounded: Weymouth & Yue 2010, sec. 3
GROWTH = 1.2  # longest step in lengths of the one before: a sudden calm must not leap over what comes next; a choice


class SideValues(NamedTuple):
    """What holds at a side at one time: as in SidePlan, without the time axis. None where it does not act."""

    velocity: np.ndarray | None
    pressure: float | None
    fraction: float | None
    height: float | None


@dataclass(frozen=True, eq=False)
class SidePlan:
    """One of the six sides of the domain; number 0 .. 5 in the order of mesh.SIDE_NAMES, kind as in mesh.py.

    t (n,) [time] strictly increasing; the other tables have the same times, and are None where the kind has no use
    for them:
    velocity (n, 3) [length/time]   of what passes a velocity side; of a wall that slides, 0 along its normal
    pressure (n,) [mass/length/time2]   at a pressure side, relative to the void
    fraction (n,) [-]   liquid fraction of what enters at a pressure or velocity side
    height (n,) [length]   liquid stands up to this z outside; it may lie below the mesh, and then there is none.
        At a pressure side p = pressure + rho (-g_z) (height - z) below it, pressure above. It stands in for fraction.
    stagnation   the pressure is that of liquid at rest far outside, p + rho u²/2 where liquid enters
    """

    number: int
    kind: int
    t: np.ndarray
    velocity: np.ndarray | None = None
    pressure: np.ndarray | None = None
    fraction: np.ndarray | None = None
    height: np.ndarray | None = None
    stagnation: bool = False

    @property
    def axis(self) -> int:
        return self.number // 2

    @property
    def slides(self) -> bool:
        """Whether it is a wall that ever moves along itself."""
        return self.kind == WALL and self.velocity is not None and bool(self.velocity.any())

    @property
    def upper(self) -> bool:
        return self.number % 2 == 1

    @property
    def partner(self) -> int | None:
        """The number of the side that this one goes on at, None where it is not periodic."""
        return self.number ^ 1 if self.kind == PERIODIC else None

    def at(self, time: float) -> SideValues:
        """The values that hold at a time."""

        def value(table: np.ndarray | None) -> float | None:
            return None if table is None else float(np.interp(time, self.t, table))

        velocity = None if self.velocity is None else np.array([value(column) for column in self.velocity.T])
        return SideValues(velocity, value(self.pressure), value(self.fraction), value(self.height))

    def over(self, begin: float, end: float) -> SideValues:
        """The values at `end`, but across the side the mean velocity since `begin`: what a table says comes in."""
        values = self.at(end)
        if self.velocity is not None and len(self.t) > 1 and begin < end:
            across = self.velocity[:, self.number // 2]
            times = np.concatenate([[begin], self.t[(self.t > begin) & (self.t < end)], [end]])
            values.velocity[self.number // 2] = np.trapezoid(np.interp(times, self.t, across), times) / (end - begin)
        return values


@dataclass(frozen=True, eq=False)
class LiquidRegion:
    """A part of space whose liquid at the start is told apart: adds it with this fraction, or takes it away.

    shape in space (distance < 0 inside), maybe without bounds; velocity (3,), pressure of what it adds.
    """

    shape: Component
    adds: bool
    fraction: float
    velocity: np.ndarray
    pressure: float
    name: str


@dataclass(frozen=True, eq=False)
class LiquidStart:
    """The liquid at t = 0: everywhere without a free surface; else up to a height, or a volume, then the regions.

    height [length]   liquid where z is below; volume [length3]   liquid with a surface normal to gravity; both None:
    regions only. velocity (3,) and pressure hold outside the regions. Regions act in their order. hydrostatic: the
    pressure is that of this liquid at rest, in place of the given ones.
    """

    height: float | None
    volume: float | None
    velocity: np.ndarray
    pressure: float
    regions: tuple[LiquidRegion, ...]
    hydrostatic: bool


@dataclass(frozen=True)
class StepPlan:
    """Lengths of steps; the first, the smallest and the largest stand in ClockPlan (dt, dt_min, dt_max).

    adapt   0 every step is dt, 1 steps follow stability and the pressure solution, 2 stability only
    courant   bound of the sum of the directional CFL numbers; above MOST_COURANT each is at most MOST_ALONG
    surface_courant   the same for surface waves
    growth   a step is at most this many times the one before
    """

    adapt: int
    courant: float
    surface_courant: float
    growth: float


@dataclass(frozen=True)
class PressurePlan:
    """How far and how the pressure is solved. tolerance: factor of the largest remaining |div u| dt (flow/projection).

    plain_sor: successive over-relaxation in place of multigrid with conjugate gradients, for comparison.
    """

    tolerance: float
    most_iterations: int
    plain_sor: bool


@dataclass(frozen=True)
class CleanUp:
    """What is done once to the open fractions of what stands still.

    snap   fractions nearer than this to 0 or 1 become 0 or 1
    smallest_volume   lone cells with a smaller open fraction are closed
    sliver   largest ratio of open area to open volume of a cell (of its full ones); None: slivers stay
    """

    snap: float
    smallest_volume: float
    sliver: float | None


@dataclass(frozen=True, eq=False)
class FlowPlane:
    """A rectangle whose flow is recorded: axis 0 1 2, position on it, lo and hi (3,) (±inf: no bound)."""

    number: int
    axis: int
    position: float
    lo: np.ndarray
    hi: np.ndarray


@dataclass(frozen=True, eq=False)
class LoadPlan:
    """A stationary body whose load is recorded: its number, the point (3,) that the torque refers to."""

    body: int
    point: np.ndarray
    wetted_area: bool


@dataclass(frozen=True)
class FilmPlan:
    """Films thinner than the mesh resolves (film.py). roughness [length] of two surfaces together; None: a part of the
    smaller body."""

    roughness: float | None


@dataclass(frozen=True, eq=False)
class FluidPlan:
    """The liquid of a scene.

    rho [mass/length3]; mu [mass/length/time], None without viscosity; implicit_viscosity; no_slip: walls hold viscous
    liquid; compressibility 1/(rho c²) [time2 length/mass], None where the liquid does not give way; order of momentum
    advection, 1 or 3; free_surface: there is void too; tracking of its surface, 'plic', 'donor', or None without one;
    void_pressure: the deck's pressure that is 0 here; film: between bodies, None without; coupled_together: the
    pressure and the bodies that it moves are found together, not one after the other.
    """

    rho: float
    mu: float | None
    implicit_viscosity: bool
    no_slip: bool
    compressibility: float | None
    order: int
    free_surface: bool
    tracking: str | None
    void_pressure: float
    steps: StepPlan
    pressure: PressurePlan
    clean_up: CleanUp
    start: LiquidStart
    sides: tuple[SidePlan, ...]
    planes: tuple[FlowPlane, ...]
    loads: tuple[LoadPlan, ...]
    film: FilmPlan | None = None
    coupled_together: bool = True


def speed_in_sight(fluid: FluidPlan, gravity: np.ndarray, extent: np.ndarray) -> float:
    """The largest speed [length/time] that the deck names: given, of a fall through the domain, or of an outflow under
    the pressures given. gravity (3,) [length/time2], extent (3,) of the domain [length]."""
    given = [fluid.start.velocity, *(region.velocity for region in fluid.start.regions)]
    given += [row for side in fluid.sides if side.velocity is not None for row in side.velocity]
    fall = float(np.abs(gravity) @ extent)
    pressures = [0.0] * fluid.free_surface + [p for s in fluid.sides if s.pressure is not None for p in s.pressure]
    push = (max(pressures) - min(pressures)) / fluid.rho if pressures else 0.0
    return max(max(float(np.linalg.norm(v)) for v in given), np.sqrt(2.0 * fall), np.sqrt(2.0 * push))


def mesh_bytes(block: Block) -> int:
    """Bytes that the arrays of mesh size of a block need at most, ghosts included."""
    nx, ny, nz = (n + 2 * GHOST_LAYERS for n in block.shape)
    return nx * ny * nz * CELL_BYTES
