"""`flowgmo check`: what a deck would compute, without loading a kernel."""

from __future__ import annotations

import math

from rich.console import RenderableType

from flowgmo.model import Model
from flowgmo.output import log_tables as tables

STATE_BYTES = 200  # one body: the State's arrays and their copy in a step
ROW_BYTES = 240  # one body in one history row: up to 10 vectors of 8-byte numbers
STEP_SECONDS = 4e-7  # one free body, one step: tests/cost/bench.py on a 2-core virtual machine
STEP_OVERHEAD = 5e-5  # one step of Python around the kernels, from the same


def summary(model: Model) -> list[RenderableType]:
    """Domain, bodies, effects, notices, cells, memory and time."""
    parts: list[RenderableType] = [tables.title(model, ""), tables.domain(model)]
    if model.bodies:
        parts.append(tables.bodies(model))
    parts.append(tables.effects(model))
    parts.extend(tables.notice(notice) for notice in model.notices)
    steps = min(math.ceil(model.clock.end / model.clock.dt), model.clock.last_step)
    rows = len(model.output.history.times(model.clock.end))
    moving = len(model.moving)
    memory = len(model.bodies) * STATE_BYTES + moving * ROW_BYTES * min(rows, 1000)
    seconds = steps * (STEP_OVERHEAD + moving * STEP_SECONDS)
    parts.append(
        f"{model.mesh.cells} cells (no field arrays: the scene is dry), {steps} steps, {rows} history rows; "
        f"about {_bytes(memory)} beside the program, and {seconds:.2g} s of wall time without impacts and output"
    )
    return parts


def _bytes(n: float) -> str:
    for unit in ("B", "KiB", "MiB"):
        if n < 1024:
            return f"{n:.3g} {unit}"
        n /= 1024
    return f"{n:.3g} GiB"
