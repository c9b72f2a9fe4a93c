"""The Model: everything that stays constant during a run, frozen.

    deck text -> Deck (checked values) -> build_model -> Model -> State -> step

Deck names end in `building/`, which turns a Deck into a Model; behind it the glossary's names hold (state.py, mesh.py,
bodies/body.py). Importing this module needs neither numba nor pyvista, so that `flowgmo check` answers at once.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from flowgmo.bodies.body import Body
from flowgmo.flow_plan import FluidPlan
from flowgmo.mesh import Mesh


@dataclass(frozen=True)
class Effect:
    """A part of the physics that the scene calls for. What is off is not in `Model.effects`.

    name   one word, as in the log;  because  the deck line that turns it on;  what  one line for people
    """

    name: str
    what: str
    because: str


@dataclass(frozen=True)
class Intervals:
    """Output spacing that may change during a run: spacing[k] holds until ends[k] [time]; the last one to the end."""

    spacing: np.ndarray
    ends: np.ndarray

    def times(self, end: float) -> np.ndarray:
        """All output times in (0, end], the end included; strictly increasing [time]."""
        out: list[np.ndarray] = []
        start = 0.0
        stops = [*self.ends, end] if len(self.ends) < len(self.spacing) else [*self.ends[:-1], end]
        for dt, stop in zip(self.spacing, stops, strict=True):
            stop = min(stop, end)
            if stop > start:
                n = int(np.floor((stop - start) / dt * (1 + 1e-12)))  # 1e-12: a multiple that rounding put just outside
                out.append(start + dt * np.arange(1, n + 1))
                start = stop
        every = np.concatenate([*out, [end]])
        every = every[every <= end]
        keep = np.append(np.diff(every) > 1e-9 * self.spacing.min(), True)  # 1e-9: the same time met twice
        return every[keep]


@dataclass(frozen=True)
class ClockPlan:
    """end, dt, dt_min [time]; largest step dt_max[k] until dt_max_ends[k]; last_step bounds the number of steps."""

    end: float
    dt: float
    dt_min: float
    dt_max: Intervals
    last_step: int


@dataclass(frozen=True)
class OutputPlan:
    """When to write: history rows, full snapshots (landed on), selected snapshots (bodies only), log lines."""

    history: Intervals
    snapshots: Intervals
    selected: Intervals
    log: Intervals
    restart_wall: float  # seconds of wall time between restart files
    probes: np.ndarray  # (k, 3) [length]
    probe_numbers: tuple[int, ...] = ()  # (k,) as in the deck


@dataclass(frozen=True)
class ContactPlan:
    """Who may collide and how. Parties are numbered: bodies 0 .. n-1 (deck number - 1), then sides n .. n+5.

    allowed, restitution, friction (n+6, n+6), symmetric. `touch` is the gap that counts as touching, in radii of
    the smaller body. impact, dpfrac, search, multiple, hertz, resting, sleep: the methods, as in &FLOWGMO; wet: impacts
    in liquid feel its inertia. closed_form: all that collides are balls and flats whose events have closed forms
    (collision/balls); `balls` and `flats` are then the bodies that take part as what.
    """

    allowed: np.ndarray
    restitution: np.ndarray
    friction: np.ndarray
    touch: float
    impact: str
    dpfrac: float
    search: str
    multiple: str
    hertz: float
    resting: str
    sleep: bool
    wet: bool
    closed_form: bool
    balls: tuple[int, ...]
    flats: tuple[int, ...]


@dataclass(frozen=True)
class Model:
    """One scene, ready to run. `fluid` is None in a dry scene, and then no array of mesh size exists anywhere."""

    title: str
    stem: str
    units: str
    resolved_deck: str
    clock: ClockPlan
    output: OutputPlan
    gravity: np.ndarray
    mesh: Mesh
    bodies: tuple[Body, ...]
    contacts: ContactPlan | None
    effects: tuple[Effect, ...]
    fluid: FluidPlan | None
    notices: tuple[str, ...]

    @property
    def moving(self) -> tuple[Body, ...]:
        return tuple(body for body in self.bodies if body.moves)

    def has(self, effect: str) -> bool:
        """Whether an effect is on. For choosing what to build, never inside a step."""
        return any(e.name == effect for e in self.effects)
