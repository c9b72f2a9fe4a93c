"""What a run says of itself at its end: the final table and run.json."""

from __future__ import annotations

import resource
import sys
import time
from typing import TYPE_CHECKING

import numpy as np

from flowgmo.model import Model
from flowgmo.output import versions
from flowgmo.records import Rows
from flowgmo.state import State

if TYPE_CHECKING:
    from flowgmo.world import World


class Summary:
    """Sums kept while a run goes on: impacts by body, seconds of output, the last rows of its history."""

    def __init__(self, model: Model, command_line: str) -> None:
        self.model, self.command_line = model, command_line
        self.began = time.perf_counter()
        self.writing = 0.0  # [s] of output
        self.per_body: dict[str, dict[str, float]] = {}
        self.stops = 0
        self.last_rows: Rows | None = None

    def count(self, impacts: np.ndarray) -> None:
        """Add impacts (IMPACT records) to the sums."""
        self.stops += int((impacts["b"] == 0).sum())
        sizes = np.linalg.norm(impacts["impulse"], axis=1)
        for side in ("a", "b"):
            for number in np.unique(impacts[side][impacts[side] > 0]):
                mine = impacts[side] == number
                entry = self.per_body.setdefault(self.model.bodies[number - 1].name, {"count": 0, "impulse": 0.0})
                entry["count"] += int(impacts["count"][mine].sum())
                entry["impulse"] += float(sizes[mine].sum())

    def table(self, state: State, world: World | None, status: str, reason: str) -> dict:
        """The contents of run.json. world: None where the run ended before it was made."""
        wall = time.perf_counter() - self.began
        parts = {**world.seconds, "output": self.writing} if world is not None else {}
        parts["set-up and rest"] = max(wall - sum(parts.values()), 0.0)
        energy = self.last_rows.energy if self.last_rows else {}
        return {
            "status": status,
            "reason": reason,
            "steps": state.step,
            "t": state.t,
            "cells": self.model.mesh.cells,
            "wall_seconds": wall,
            "effects": {name: {"seconds": s, "share": s / wall} for name, s in parts.items()},
            "peak_memory_bytes": _peak_memory(),
            "energy": {name: float(values[-1]) for name, values in energy.items()},
            **_liquid(state, world),
            "collisions": {"total": state.impacts, "per_body": self.per_body},
            "limits": self._limits(world),
            "versions": versions(),
            "command_line": self.command_line,
        }

    def _limits(self, world: World | None) -> list[str]:
        """What was met on the way that a user should know of."""
        stops = [f"{self.stops} stops met"] if self.stops else []
        collisions = world.collisions if world is not None else None
        return stops + (collisions.notices() if collisions is not None else [])


def _liquid(state: State, world: World | None) -> dict:
    """What run.json and the final table say of the liquid; {} in a dry scene, or where it did not begin."""
    if world is None or world.watch is None or state.fluid is None:
        return {}
    from flowgmo.step import liquid_values

    values = liquid_values(world, state)
    names = ("volume", "volume_error", "kinetic_energy", "potential_energy", "dissipated", "work_boundaries")
    shown = {name: values[f"fluid/{name}"] for name in names if f"fluid/{name}" in values}
    found = {"volume_error": shown.get("volume_error"), "liquid": shown | world.liquid.tally.summary()}
    wet = world.wet_bodies
    return found if wet is None else found | {"forces": wet.records.spikes.summary(wet.names)}


def _peak_memory() -> int:
    """Bytes this process held at most."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return peak if sys.platform == "darwin" else peak * 1024
