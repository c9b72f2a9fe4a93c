"""&XPUT (and probes of &GRAFIC) -> when to step and when to write."""

from __future__ import annotations

import numpy as np

from flowgmo.deck import Deck
from flowgmo.model import ClockPlan, Intervals, OutputPlan


def build_clock(deck: Deck) -> ClockPlan:
    """End, steps, and their bounds [time]."""
    return ClockPlan(
        end=float(deck["TWFIN"]),
        dt=float(deck["DELT"]),
        dt_min=float(deck["DTMIN"]),
        dt_max=_intervals(deck, "TDTMAX", "TEDITDT"),
        last_step=int(deck["ITWFIN"]),
    )


def build_output(deck: Deck) -> OutputPlan:
    """Intervals of history, snapshots and log, and the probes' places."""
    probes = sorted({k for name in ("XLOC", "YLOC", "ZLOC") for (k,) in deck.indices(name)})
    places = [[float(deck.at(f"{axis}LOC", k) or 0.0) for axis in "XYZ"] for k in probes]
    return OutputPlan(
        history=_intervals(deck, "THPLTD", "TEDIT"),
        snapshots=_intervals(deck, "TPLTD", "TEDIT"),
        selected=_intervals(deck, "TAPLTD", "TEDIT"),
        log=_intervals(deck, "TSPRTD", "TEDIT"),
        restart_wall=float(deck["RESTART_DT"]),
        probes=np.array(places, dtype=float).reshape(-1, 3),
    )


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
