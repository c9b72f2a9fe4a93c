"""`flowgmo check`: what a deck would compute, without loading a kernel."""

from __future__ import annotations

import math

import numpy as np
from rich.console import RenderableType
from rich.text import Text

from flowgmo import __version__
from flowgmo.bodies.body import Sinusoid
from flowgmo.flow_plan import FluidPlan, LiquidStart, SidePlan, mesh_bytes, speed_in_sight
from flowgmo.mesh import SIDE_NAMES
from flowgmo.model import Model
from flowgmo.output import log_tables as tables

STATE_BYTES = 200  # one body: the State's arrays and their copy in a step
ROW_BYTES = 240  # one body in one history row: up to 10 vectors of 8-byte numbers
STEP_SECONDS = 4e-7  # one free body, one step: tests/cost/bench.py on a 2-core virtual machine
STEP_OVERHEAD = 5e-5  # one step of Python around the kernels, from the same
# One step of liquid: overhead, and one cell with liquid [seconds]. A fit, to a factor of 2, of decks on a 2-core
# virtual machine. With a surface: ritter 2.7 ms (1360 wet cells), still 3.5 (1850), wall_impact 3.3 (2600), coarse 19
# to 22 (10 700), spheric2 62 to 94 (84 000 to 100 000). Without: plane .6 ms (64), cavity 1.4 (4100), re1000 2.3
# (9200), cylinder 3.8 (10 300)
WET_STEP = {True: (2e-3, 9e-7), False: (1e-3, 2.5e-7)}
BODY_STEP = 1e-2  # of bodies that move in it: half, full (8192 cells, a ball 6 across) 9 to 12 ms more, from the same
START_SECONDS = 1.0  # loading kernels, set-up, the first and the last output, from the same
BESIDE = 1.5  # times its own speed the liquid flows beside a body: a sphere's, in potential flow
SAMPLES = 64000  # points of the domain in which liquid at the start is looked for: 10 ms for a few boxes


def summary(model: Model) -> list[RenderableType]:
    """Domain, bodies, liquid, effects, notices, cells, memory and time."""
    parts: list[RenderableType] = [tables.title(model, __version__), tables.domain(model)]
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
    height, wet = _at_start(model, fluid)
    dt = _expected_step(model, fluid, height, wet)
    steps, share = _steps(model, dt), float(wet.mean())
    overhead, each = WET_STEP[fluid.free_surface]
    overhead += BODY_STEP * bool(model.moving)
    seconds = START_SECONDS + steps * (overhead + model.mesh.cells * share * each)
    time = tables.duration(float(f"{seconds:.2g}"))  # no more digits than a guess has
    return (
        f"{model.mesh.cells} cells, {100 * share:.0f} % with liquid at the start, about {steps} steps of {dt:.2g}, "
        f"{rows} history rows; at most {_bytes(memory)} beside the program, and about {time} of "
        "wall time on two cores if the liquid stays as much"
    )


def _expected_step(model: Model, fluid: FluidPlan, height: np.ndarray, wet: np.ndarray) -> float:
    """A guess of the steps' length by what bounds them (flow/time_step.py); height, wet as of _at_start.

    The Courant number is a sum over directions; liquid that falls or splashes is taken to cross cells along each at
    half of the largest speed. In mean steps of whole runs: still 1.0, cavity 1.0, wall_impact 1.05, coarse 1.2,
    cylinder 1.4, martin_moyce .65, sloshing .6, ritter .45; spheric2 2, which throws thin jets.
    """
    shape, planes = model.mesh.blocks[0].shape, model.mesh.blocks[0].planes
    sizes = np.array([float(np.diff(x).min()) for x, n in zip(planes, shape, strict=True) if n > 1])
    g = float(np.linalg.norm(model.gravity))
    least = model.clock.end
    with np.errstate(over="ignore", divide="ignore"):
        bodies = _speed_of_bodies(model)
        speed = max(speed_in_sight(fluid, np.zeros(3), np.zeros(3)), BESIDE * bodies)
        least = min(least, 0.5 * sizes.min() / np.float64(bodies))  # TRAVEL of wet_ways.py
        if fluid.free_surface:
            speed = max(speed, np.sqrt(2.0 * g * _fall(fluid, model, height, wet)))
            least = min(least, fluid.steps.surface_courant * np.sqrt(sizes.min() / (np.pi * np.float64(g))))
        rate = speed * (1.0 / sizes).sum() / min(len(sizes), 2) / fluid.steps.courant
        if fluid.mu is not None and not fluid.implicit_viscosity:
            rate += fluid.mu / fluid.rho * (2.0 / sizes**2).sum()
        least = min(least, 1.0 / np.float64(rate))
    if rate == 0.0 and not fluid.free_surface:
        return model.clock.dt  # what sets it in motion is not known
    return max(min(least, float(model.clock.dt_max.spacing.max())), model.clock.dt_min)


def _speed_of_bodies(model: Model) -> float:
    """Largest speed [length/time] of a moving body's mass centre that the deck names, turning apart."""
    speeds = [float(np.linalg.norm(body.velocity)) for body in model.moving]
    for body in model.moving:
        laws = [drive.law for drive in body.drives[:3] if not drive.coupled]
        most = [abs(law.amplitude) if isinstance(law, Sinusoid) else float(np.abs(law.y).max()) for law in laws]
        speeds.append(float(np.linalg.norm(most)))
    return max(speeds, default=0.0)


def _at_start(model: Model, fluid: FluidPlan) -> tuple[np.ndarray, np.ndarray]:
    """Height against gravity [length] of points spread over the domain, and which lie in liquid at the start (n,).

    Solids are left out of account: they may be meshes of many triangles.
    """
    directions = [n > 1 for n in model.mesh.blocks[0].shape]
    count = int(SAMPLES ** (1.0 / max(sum(directions), 1)))
    lo, hi = model.mesh.bounds
    shares = [(np.arange(n) + 0.5) / n for n in (count if there else 1 for there in directions)]
    axes = [a + (b - a) * x for a, b, x in zip(lo, hi, shares, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    height = points @ _upwards(model)
    start = fluid.start
    if not fluid.free_surface:
        return height, np.ones(len(points), bool)
    wet = np.zeros(len(points), bool)
    if start.height is not None:
        wet = points[:, 2] < start.height
    elif start.volume is not None:
        wet = height <= np.quantile(height, min(start.volume / float(np.prod(hi - lo)), 1.0))
    for region in start.regions:
        wet[region.shape.distance(points) < 0.0] = region.adds
    return height, wet


def _upwards(model: Model) -> np.ndarray:
    g = float(np.linalg.norm(model.gravity))
    return -model.gravity / g if g > 0.0 else np.array([0.0, 0.0, 1.0])


def _fall(fluid: FluidPlan, model: Model, height: np.ndarray, wet: np.ndarray) -> float:
    """From the highest point with liquid, at the start or outside a side, to the lowest without [length]; 0: level."""
    if wet.all():
        return 0.0
    highest = [float(height[wet].max())] if wet.any() else []
    up, bounds = _upwards(model), model.mesh.bounds
    for side in fluid.sides:
        if side.height is not None:
            highest.append(min(float(side.height.max()) * up[2], float(height.max())))
        elif side.fraction is not None and side.fraction.max() > 0.0:
            ends = np.where(up > 0.0, bounds[1], bounds[0])
            ends[side.axis] = bounds[int(side.upper), side.axis]
            highest.append(float(ends @ up))
    return max(max(highest, default=0.0) - float(height[~wet].min()), 0.0)


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
