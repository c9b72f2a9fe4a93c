"""How far each step goes: DELT, what the liquid allows, landings on output times, shorter steps where one failed."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flowgmo.errors import StepFailed, StepTooLong
from flowgmo.model import Model
from flowgmo.state import State

if TYPE_CHECKING:
    from flowgmo.flow.liquid import Liquid
    from flowgmo.step import Report
    from flowgmo.world import World

LEAST = 0.25  # of a step that the liquid crosses too fast: what it is tried again with at least
LAND = 1e-6  # a step this part of itself short of a landing time is stretched to it, not followed by a tiny one


class Pace:
    """The times of a run's output, and its steps between them.

    landings: times that steps end on (snapshots); history, selected: times at which values within steps are wanted.
    """

    def __init__(self, model: Model, state: State) -> None:
        self.model, self.state = model, state
        self.history = model.output.history.times(model.clock.end)
        self.landings = model.output.snapshots.times(model.clock.end)
        self.selected = _apart_from(self.landings, model.output.selected.times(model.clock.end))
        self.cuts = 0
        self.wanted, self.bounded_by = 0.0, ""
        self.free = 0.0  # how long the step in progress might be but for the impacts that cut it

    def advance(self, world: World) -> tuple[Report, bool]:
        """One step, as long as it may be; shorter ones where the liquid asks for it. Returns whether it was a landing.

        Raises StepFailed where a step of dt_min fails too; the state is then the last good one.
        """
        from flowgmo.step import step

        state, clock = self.state, self.model.clock
        most, self.free = np.inf, 0.0
        while True:
            t1, landing = self.next_time(world, most)
            asked = np.union1d(_between(self.history, state.t, t1), _between(self.selected, state.t, t1))
            try:
                began_at = state.t
                report = step(world, state, t1, asked, landing)
                self._note_step(world, state.t - began_at, most)
                return report, landing
            except StepTooLong as error:
                if world.liquid is None:
                    raise StepFailed(f"{error}. Steps are DELT long where there is no liquid") from error
                most = (error.share or _shorter(world.liquid)) * (t1 - state.t)
                if error.share is not None:  # an impact; it says nothing about the flow
                    self.free = max(self.free, t1 - state.t)
                else:
                    self.free = min(self.free, most)
                self.cuts += 1
                if most < clock.dt_min:
                    text = f"{error}, and a step below dtmin={clock.dt_min:.3g} would be needed"
                    raise StepFailed(f"{text}. {error.advice}" if error.advice else text) from error

    def _note_step(self, world: World, dt: float, most: float) -> None:
        """Book what bounded the step of the liquid, the forces on bodies in it, and what the next one grows from."""
        liquid = world.liquid
        if liquid is None:
            return
        if liquid.regains:
            self.state.fluid.pace = max(dt, self.free)
        bounded = "tried again" if most < np.inf else "output" if dt < self.wanted else self.bounded_by
        liquid.tally.note_step(bounded, liquid.courant)
        liquid.tally.shortened = self.cuts
        if world.wet_bodies is not None:
            records = world.wet_bodies.records
            records.spikes.note(records.loads.total[:, :3], self.state.t, dt)

    def next_time(self, world: World, most: float) -> tuple[float, bool]:
        """Where the next step of at most `most` ends, and whether that is a landing."""
        state, clock = self.state, self.model.clock
        k = np.searchsorted(self.landings, state.t, side="right")
        landing = float(self.landings[min(k, len(self.landings) - 1)])
        if world.liquid is not None:
            return self._next_wet_time(world, min(most, _bound(clock.dt_max, state.t)), landing)
        return self._next_dry_time(landing)

    def _next_wet_time(self, world: World, most: float, landing: float) -> tuple[float, bool]:
        """As long as the liquid allows; the last two steps before a landing share what is left."""
        t, clock = self.state.t, self.model.clock
        state, wet = self.state, world.wet_bodies
        bodies = wet.ways.longest_step(state.v_WB, state.w_WB, state.p_WB) if wet is not None else np.inf
        longest = world.liquid.longest_step(state.fluid, clock.dt, bodies)
        if longest < clock.dt_min and world.liquid.limiting != "growth":
            raise StepFailed(
                f"the next step would be {longest:.3g}, bounded by: {world.liquid.limiting}, and none may be below "
                f"dtmin={clock.dt_min:.3g}. Check the speeds in the deck"
            )
        dt = min(most, longest)
        self.wanted = dt * (1.0 - LAND)  # a step shorter than that is shared before a landing
        self.bounded_by = world.liquid.limiting if longest <= most else "largest step"
        left = landing - t
        if left <= dt * (1.0 + LAND):
            return landing, True
        return t + min(dt, 0.5 * left), False

    def _next_dry_time(self, landing: float) -> tuple[float, bool]:
        """Steps of DELT that count from the last landing: no drift."""
        state, clock = self.state, self.model.clock
        dt = min(clock.dt, _bound(clock.dt_max, state.t))
        t1 = state.landed + (state.since_landing + 1) * dt
        if dt < clock.dt or t1 <= state.t:
            t1 = state.t + dt
        if t1 >= landing - LAND * dt:
            return landing, True
        return t1, False


def _shorter(liquid: Liquid | None) -> float:
    """Share of a step that was too long to try next: what its velocities allow, with a twentieth to spare, or half.

    In a shorter step a jet in a slit is as fast: of 1.11 and 1.2 of a cell .57 and .62 were left in half a step
    (stones), which had to be tried a third time.
    """
    if liquid is None or liquid.stride <= 1.0:  # something else than its Courant number
        return 0.5
    return min(max(0.95 / liquid.stride, LEAST), 0.9)


def _between(times: np.ndarray, t0: float, t1: float) -> np.ndarray:
    """The times in (t0, t1]."""
    a, b = np.searchsorted(times, [t0, t1], side="right")
    return times[a:b]


def _apart_from(times: np.ndarray, others: np.ndarray) -> np.ndarray:
    """Those of `others` that are not, up to rounding, among `times` (not empty, ascending)."""
    after = np.clip(np.searchsorted(times, others), 1, len(times) - 1) if len(times) > 1 else np.zeros(len(others), int)
    gap = np.minimum(np.abs(others - times[after]), np.abs(others - times[after - 1]))
    return others[gap > 1e-9 * times[-1]]


def _bound(intervals: object, t: float) -> float:
    """The value of an interval table that holds at t."""
    k = int(np.searchsorted(intervals.ends, t, side="right"))
    return float(intervals.spacing[min(k, len(intervals.spacing) - 1)])
