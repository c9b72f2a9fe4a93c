"""From a Model to the Liquid that steps it, and to the Flow it starts from."""

from __future__ import annotations

from functools import partial

import numpy as np

from flowgmo.errors import FlowgmoError
from flowgmo.flow.boundary import Sides
from flowgmo.flow.columns import all_columns
from flowgmo.flow.favor.fractions import Solids, open_fractions
from flowgmo.flow.favor.moving_openings import MovingOpenings
from flowgmo.flow.favor.near_surface import Pose
from flowgmo.flow.fields import Flow, G, Open, grid_of
from flowgmo.flow.immersed.immersed import Immersed
from flowgmo.flow.liquid import DUST, Liquid, default_threads
from flowgmo.flow.observe.measures import total
from flowgmo.flow.pressure.projection import Projector
from flowgmo.flow.stages import settle_pressure
from flowgmo.flow.surface.initial_liquid import Region, initial_liquid
from flowgmo.flow.surface.level_at_start import fit_level
from flowgmo.mesh import PERIODIC
from flowgmo.model import Model


def build_liquid(model: Model, threads: int | None = None) -> Liquid:
    """Grid, open fractions, sides, solver of a wet scene. Raises FlowgmoError where nothing is open."""
    (block,) = model.mesh.blocks
    plan = model.fluid
    grid = grid_of(block)
    solids = _solids(model)
    fixed = [body for body in model.bodies if not body.moves]
    covers = _covers(model, solids, fixed)
    openings = solids.open if covers is None else covers.mean
    sides = Sides(plan.sides, grid, block.z, plan.rho, model.gravity, _streams(model), openings[1:])
    threads = threads or default_threads()
    liquid = Liquid(plan, grid, openings, sides, model.gravity, threads, solids.open)
    for body, share in zip(fixed, solids.shares, strict=False):
        liquid.walls[body.number] = (share.cells, share.faces)
    liquid.solid_lines.still = covers is None
    if covers is not None:
        centres = [np.pad(0.5 * (x[1:] + x[:-1]), G, mode="edge") for x in block.planes]
        covers.share(liquid.team)
        covers.on_write = liquid.solid_lines.mark
        liquid.immersed = Immersed(covers, grid, centres, liquid.renew, partial(_is_full, liquid.projector))
        if liquid.planes is not None:
            liquid.immersed.on_fill = liquid.planes.touch
    return liquid


def _is_full(projector: Projector) -> bool:
    """Whether all open space is liquid of the equation, as its voids are shut now."""
    return projector.sealed.all_full(projector.matrix.columns, projector.wet, projector.voids.open_lids)


def _covers(model: Model, solids: Solids, fixed: list) -> MovingOpenings | None:
    """Open fractions with the bodies that move, at t = 0; None where there are none."""
    if not model.moving:
        return None
    (block,) = model.mesh.blocks
    start = [Pose(np.eye(3), np.zeros(3)) for _ in model.moving]
    return MovingOpenings(block, solids, [b.shape for b in fixed], [b.shape for b in model.moving], start)


def _streams(model: Model) -> list[int]:
    """Sides towards which liquid moves at the start: there it goes on outside as well (boundary.let_out)."""
    start = model.fluid.start
    speeds = [start.velocity, *(region.velocity for region in start.regions if region.adds)]
    return [n for n in range(6) if any(v[n // 2] * (1 if n % 2 else -1) > 0.0 for v in speeds)]


def _solids(model: Model) -> Solids:
    (block,) = model.mesh.blocks
    shapes = [body.shape for body in model.bodies if not body.moves]
    if not shapes:
        return Solids(Open(None, None, None, None), (), np.zeros(0), None)
    clean_up = model.fluid.clean_up
    least, lone = clean_up.snap, clean_up.smallest_volume
    try:
        solids = open_fractions(block, shapes, least=least, lone=lone, area_ratio=clean_up.sliver)
    except ValueError as error:
        raise FlowgmoError(str(error)) from error
    _join_sides(solids.open, model)
    return solids


def _join_sides(openings: Open, model: Model) -> None:
    """Ghosts beyond periodic sides hold what stands at the other side; joined faces are as open as both sides allow."""
    for d, n in enumerate(model.mesh.blocks[0].shape):
        if model.fluid.sides[2 * d].kind != PERIODIC:
            continue
        for a in (a for a in openings if a is not None):
            layers = np.moveaxis(a, d, 0)
            if a is openings[1 + d]:
                layers[n + 1] = np.minimum(layers[1], layers[n + 1])
            layers[[0, 1, n + G, n + G + 1]] = layers[[n, n + 1, G, G + 1] if n > 1 else [G] * 4]


def initial_flow(liquid: Liquid, model: Model) -> Flow:
    """The liquid at t = 0, with ghosts filled, and with the pressure it has at rest or is given."""
    (block,) = model.mesh.blocks
    start = model.fluid.start
    velocity = [
        np.full(liquid.shape, x) if there else None for x, there in zip(start.velocity, liquid.present, strict=True)
    ]
    p = np.full(liquid.shape, start.pressure)
    F = None
    if model.fluid.free_surface:
        F = _liquid_at_start(liquid, model)
    for region in start.regions:
        if region.adds:
            _set_region(block, region, velocity, p)
    for u, A in zip(velocity, liquid.openings[1:], strict=True):
        if u is not None and A is not None:
            u[A == 0.0] = 0.0
    flow = Flow(*velocity, p, F, 0.0, moments=None if F is None else liquid.planes.moments)
    liquid.sides.fill_fraction(F)
    liquid.sides.fill_velocity(flow.velocity)
    if F is not None:
        p[F <= DUST] = 0.0
    if start.hydrostatic or _viscosity_needs_pressure(liquid, p):
        settle_pressure(liquid, flow, model.clock.dt)
    columns = all_columns(liquid.shape)
    of = liquid.team, columns, liquid.grid, liquid.openings, flow, model.fluid.rho, liquid.gravity, DUST
    whole = total(*of, planes=liquid.planes, solid_lines=liquid.solid_lines)
    liquid.forget_planes()  # what begins may still be given another F
    flow.start_volume, flow.start_energy = whole.volume, whole.kinetic + whole.potential
    return flow


def _viscosity_needs_pressure(liquid: Liquid, p: np.ndarray) -> bool:
    """Whether viscosity, which acts on what the last pressure leaves, would see liquid fall in the first step.

    Liquid that gives way keeps the pressure it is given: its volume depends on it.
    """
    return bool(liquid.plan.mu) and liquid.projector.beta is None and not p.any()


def _liquid_at_start(liquid: Liquid, model: Model) -> np.ndarray:
    """F at t = 0. Raises FlowgmoError where the volume asked for is more than the solids leave open."""
    start = model.fluid.start
    F = _filled(liquid, model, start.regions)
    if start.height is not None:
        before = _filled(liquid, model, ()) if start.regions else F
        cells = np.argwhere(F == before)  # no region has a say there
        fit_level(model.mesh.blocks[0].planes, liquid.openings, start.height, cells, F)
    return F


def _filled(liquid: Liquid, model: Model, regions: tuple) -> np.ndarray:
    (block,) = model.mesh.blocks
    start = model.fluid.start
    try:
        return initial_liquid(
            block,
            liquid.openings,
            [body.shape for body in model.bodies],
            [Region(region.shape, region.adds, region.fraction) for region in regions],
            start.height,
            start.volume,
            tuple(model.gravity) if np.any(model.gravity) else (0.0, 0.0, -1.0),
        )
    except ValueError as error:
        raise FlowgmoError(f"{error}. Write a smaller vlin") from error


def _set_region(block: object, region: object, velocity: list, p: np.ndarray) -> None:
    """Velocity and pressure of a region, where centres or faces lie inside."""
    inner = (slice(G, -G),) * 3
    centres = [0.5 * (a[1:] + a[:-1]) for a in block.planes]
    p[inner][_inside(region.shape, centres)] = region.pressure
    for d, u in enumerate(velocity):
        if u is not None:
            at = [block.planes[e][1:] if e == d else centres[e] for e in range(3)]
            u[inner][_inside(region.shape, at)] = region.velocity[d]


def _inside(shape: object, at: list) -> np.ndarray:
    """Which points (nx, ny, nz) of a lattice lie in a shape."""
    points = np.stack(np.meshgrid(*at, indexing="ij"), axis=-1).reshape(-1, 3)
    return (shape.distance(points) < 0.0).reshape([len(a) for a in at])
