"""`flowgmo check`: what a deck would compute, without loading a kernel."""

from __future__ import annotations

import math

import numpy as np
from rich.console import RenderableType
from rich.text import Text

from flowgmo.flow_plan import FluidPlan, LiquidStart, SidePlan, mesh_bytes, speed_in_sight
from flowgmo.mesh import SIDE_NAMES
from flowgmo.model import Model
from flowgmo.output import log_tables as tables

STATE_BYTES = 200  # one body: the State's arrays and their copy in a step
ROW_BYTES = 240  # one body in one history row: up to 10 vectors of 8-byte numbers
STEP_SECONDS = 4e-7  # one free body, one step: tests/cost/bench.py on a 2-core virtual machine
STEP_OVERHEAD = 5e-5  # one step of Python around the kernels, from the same
WET_SECONDS = 1e-6  # one cell with liquid, one step: the aim for SPHERIC 2 on two cores, not a measurement yet


def summary(model: Model) -> list[RenderableType]:
    """Domain, bodies, liquid, effects, notices, cells, memory and time."""
    parts: list[RenderableType] = [tables.title(model, ""), tables.domain(model)]
    if model.fluid is not None:
        parts.append(Text("\n".join(f"  {line}" for line in _liquid(model.fluid))))
    if model.bodies:
        parts.append(tables.bodies(model))
    parts.append(tables.effects(model))
    parts.extend(tables.notice(notice) for notice in model.notices)
    rows = len(model.output.history.times(model.clock.end))
    moving = len(model.moving)
    memory = len(model.bodies) * STATE_BYTES + moving * ROW_BYTES * min(rows, 1000)
    if model.fluid is not None:
        return [*parts, _wet_cost(model, model.fluid, memory, rows)]
    steps = _steps(model, model.clock.dt)
    seconds = steps * (STEP_OVERHEAD + moving * STEP_SECONDS)
    parts.append(
        f"{model.mesh.cells} cells (no field arrays: the scene is dry), {steps} steps, {rows} history rows; "
        f"about {_bytes(memory)} beside the program, and {seconds:.2g} s of wall time without impacts and output"
    )
    return parts


def _steps(model: Model, dt: float) -> int:
    end, last = model.clock.end, model.clock.last_step
    return last if dt * last <= end else math.ceil(end / dt)


def _wet_cost(model: Model, fluid: FluidPlan, memory: float, rows: int) -> str:
    memory += sum(mesh_bytes(block) for block in model.mesh.blocks)
    dt = model.clock.dt if fluid.steps.adapt == 0 else _expected_step(model, fluid)
    steps, share = _steps(model, dt), _wet_share(model, fluid)
    seconds = steps * (STEP_OVERHEAD + model.mesh.cells * share * WET_SECONDS)
    return (
        f"{model.mesh.cells} cells, {100 * share:.0f} % with liquid at the start, about {steps} steps of {dt:.2g}, "
        f"{rows} history rows; at most {_bytes(memory)} beside the program, and about {tables.duration(seconds)} of "
        "wall time if the liquid stays as much"
    )


def _expected_step(model: Model, fluid: FluidPlan) -> float:
    """A guess of the steps' length: the Courant number in the smallest cell at the largest speed that is in sight."""
    shape, planes = model.mesh.blocks[0].shape, model.mesh.blocks[0].planes
    size = min(float(np.diff(x).min()) for x, n in zip(planes, shape, strict=True) if n > 1)
    gravity = model.gravity if fluid.free_surface else np.zeros(3)
    speed = speed_in_sight(fluid, gravity, np.ptp(model.mesh.bounds, axis=0))
    largest = min(float(model.clock.dt_max.spacing.max()), model.clock.end)
    step = min(fluid.steps.courant * size / speed, largest) if speed > 0.0 else model.clock.dt
    return max(step, model.clock.dt_min)


def _wet_share(model: Model, fluid: FluidPlan) -> float:
    """About the part of the mesh that holds liquid at the start; regions count as their boxes."""
    start, (lo, hi) = fluid.start, model.mesh.bounds
    if not fluid.free_surface:
        return 1.0
    share = 0.0
    if start.height is not None:
        share = float(np.clip((start.height - lo[2]) / (hi[2] - lo[2]), 0.0, 1.0))
    elif start.volume is not None:
        share = start.volume / float(np.prod(hi - lo))
    for region in start.regions:
        if region.adds:
            box = np.clip(region.shape.bounds(), lo, hi)
            share += float(np.prod((box[1] - box[0]) / (hi - lo)))
    return min(share, 1.0)


def _liquid(fluid: FluidPlan) -> list[str]:
    """The liquid in lines for people."""
    viscosity = f"viscosity {fluid.mu:.6g}" if fluid.mu is not None else "no viscosity"
    lines = [f"liquid of density {fluid.rho:.6g}, {viscosity}; at the start {_start(fluid)}"]
    lines += [f"{SIDE_NAMES[side.number]}: {text}" for side in fluid.sides if (text := _side(side))]
    return lines


def _start(fluid: FluidPlan) -> str:
    start: LiquidStart = fluid.start
    parts = [] if fluid.free_surface else ["everywhere"]
    if start.height is not None:
        parts.append(f"up to z = {start.height:.6g}")
    if start.volume is not None:
        parts.append(f"a volume of {start.volume:.6g}")
    for region in start.regions:
        sign = "and" if region.adds else "without"
        words = region.shape.describe()
        known = "" if "unbounded" in words else f" ({words})"
        parts.append(f"{sign if parts else 'only'} {region.name}{known}")
    return ", ".join(parts) or "none"


def _side(side: SidePlan) -> str:
    """The values of a side at t = 0, empty for one that has none."""
    now, parts = side.at(0.0), []
    if now.velocity is not None:
        parts.append(f"velocity ({', '.join(f'{v:.6g}' for v in now.velocity)})")
    if now.pressure is not None:
        parts.append(f"{'stagnation ' if side.stagnation else ''}pressure {now.pressure:.6g} above the void's")
    if now.height is not None:
        parts.append(f"liquid up to z = {now.height:.6g}")
    if now.fraction is not None:
        parts.append(f"liquid fraction {now.fraction:.6g} of what enters")
    changes = f", at t = 0 of {len(side.t)} times" if len(side.t) > 1 else ""
    return ", ".join(parts) + changes if parts else ""


def _bytes(n: float) -> str:
    for unit in ("B", "KiB", "MiB"):
        if n < 1024:
            return f"{n:.3g} {unit}"
        n /= 1024
    return f"{n:.3g} GiB"
