"""&XPUT (and probes of &GRAFIC) -> when to step and when to write."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from flowgmo.deck import Deck
from flowgmo.model import ClockPlan, Intervals, OutputPlan

if TYPE_CHECKING:
    from flowgmo.building.build import Findings

MOST_TIMES = 10_000_000  # of one kind of output: 80 MB of times in memory, and at least that on disk


def build_clock(found: Findings) -> ClockPlan:
    """End, steps, and their bounds [time]. Problems: steps with which the clock would not advance."""
    deck = found.deck
    clock = ClockPlan(
        end=float(deck["TWFIN"]),
        dt=float(deck["DELT"]),
        dt_min=float(deck["DTMIN"]),
        dt_max=_largest_steps(deck),
        last_step=int(deck["ITWFIN"]),
    )
    least = max(clock.dt_min, float(np.spacing(min(clock.end, _reach(deck, clock)))))  # t + dt must differ from t
    if not clock.dt >= least:
        name = "DELT" if deck.given("DELT") else "TWFIN"
        found.problem(
            name, wrong=f"the step {clock.dt:.3g} is too small to advance the clock to twfin={clock.end:.6g}",
            write="Write a larger delt, or other units of time",
        )  # fmt: skip
        return clock
    for k, dt in enumerate(clock.dt_max.spacing):
        if dt < least:
            found.problem(
                "TDTMAX", k + 1, wrong=f"the largest step is smaller than the smallest one, dtmin={least:.3g}",
                write="Write a larger tdtmax, or a smaller dtmin",
            )  # fmt: skip
    return clock


def _largest_steps(deck: Deck) -> Intervals:
    """TDTMAX; with AUTOT=0 no step of a wet scene is longer than DELT either (one of a dry scene is DELT anyway)."""
    largest = _intervals(deck, "TDTMAX", "TEDITDT")
    if deck.given("RHOF") and deck["AUTOT"] == 0.0:
        return Intervals(spacing=np.minimum(largest.spacing, float(deck["DELT"])), ends=largest.ends)
    return largest


def build_output(found: Findings, clock: ClockPlan) -> OutputPlan:
    """Intervals of history, snapshots and log, and the probes' places. Problems: more times than can be kept."""
    deck = found.deck
    probes = sorted({k for name in ("XLOC", "YLOC", "ZLOC") for (k,) in deck.indices(name)})
    probes = [k for k in probes if deck.at("IF_PROBE_ENABLED", k)]
    places = [[float(deck.at(f"{axis}LOC", k) or 0.0) for axis in "XYZ"] for k in probes]
    return OutputPlan(
        history=_output_intervals(found, "THPLTD", clock),
        snapshots=_output_intervals(found, "TPLTD", clock),
        selected=_output_intervals(found, "TAPLTD", clock),
        log=_output_intervals(found, "TSPRTD", clock),
        restart_wall=float(deck["RESTART_DT"]),
        probes=np.array(places, dtype=float).reshape(-1, 3),
        probe_numbers=tuple(probes),
    )


def _reach(deck: Deck, clock: ClockPlan) -> float:
    """A time that the number of steps cannot pass; infinity in a wet scene, whose steps grow beyond DELT.

    In a dry scene only the last step before an output time is longer than dt.
    """
    return np.inf if deck.given("RHOF") else (clock.last_step + 1) * clock.dt


def _output_intervals(found: Findings, name: str, clock: ClockPlan) -> Intervals:
    """Intervals of one kind of output; times that the number of steps cannot reach are left out."""
    intervals = _intervals(found.deck, name, "TEDIT")
    reach = _reach(found.deck, clock)
    if reach < clock.end:
        before = intervals.ends < reach
        n = int(before.sum())
        intervals = Intervals(
            spacing=np.append(intervals.spacing[: n + 1], clock.end), ends=np.append(intervals.ends[before], reach)
        )
    starts = np.concatenate([[0.0], np.minimum(intervals.ends, clock.end)])
    with np.errstate(divide="ignore", invalid="ignore"):  # twfin/1000 may underflow to zero
        counts = np.diff(np.append(starts, clock.end)) / intervals.spacing
    k = int(np.argmax(counts))
    if counts[k] > MOST_TIMES:
        found.problem(
            name, k + 1, wrong=f"this gives {counts[k]:.3g} rows or pictures until twfin={clock.end:.6g}",
            write=f"Write {name.lower()}({k + 1})={clock.end / 1000:.3g} or the like",
        )  # fmt: skip
    return intervals


def _intervals(deck: Deck, name: str, ends: str) -> Intervals:
    """Values 1 .. n of `name`, each until the same element of `ends`; a missing element goes on with the one before."""
    last = max((n for (n,) in deck.indices(name)), default=1)
    stops = [float(deck.at(ends, n)) for (n,) in deck.indices(ends) if (deck.at(ends, n) or 0.0) > 0.0]
    values: list[float] = []
    for n in range(1, last + 1):
        value = deck.at(name, n) if n == 1 or deck.given(name, n) else values[-1]
        values.append(float(value))
    count = min(len(values), len(stops) + 1)
    return Intervals(spacing=np.array(values[:count]), ends=np.array(stops[: count - 1]))
