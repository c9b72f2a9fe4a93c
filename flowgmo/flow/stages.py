"""The stages of one step of the liquid, in the order in which step.py calls them.

    predict        u* = u + dt a: advection, gravity, viscosity
    project        u, p: the faces of every liquid cell let out what they let in; velocities beside the liquid
    move_liquid    d(V F)/dt + div(A u F) = 0 with the projection's fluxes

A stage leaves the Flow as it is; new values lie in the Liquid's scratch arrays until `store`.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flowgmo.errors import StepFailed, StepTooLong
from flowgmo.flow.fields import Flow, G
from flowgmo.flow.immersed.coupling import Coupling
from flowgmo.flow.liquid import DUST, Liquid
from flowgmo.flow.momentum.extrapolation import continue_velocity, find_sources
from flowgmo.flow.momentum.implicit_viscosity import add_change
from flowgmo.flow.momentum.prediction import accelerate, fill
from flowgmo.flow.momentum.viscous_work import put
from flowgmo.flow.observe.streams import energy_heads
from flowgmo.flow.pressure.bodies import Couple
from flowgmo.flow.pressure.conjugate_gradients import Solved
from flowgmo.flow.pressure.first_stage import push_by_last_pressure
from flowgmo.flow.pressure.sealed import PressedTogether
from flowgmo.flow.surface.surface_tracking import move_liquid as carry_liquid
from flowgmo.flow_plan import MOST_ALONG, MOST_COURANT

REST = 1e-11  # share of a cell for the pressure at the start: still water must stay still
AGED = 2.5  # lengths of the last step: in longer ones its pressure is no measure (momentum/prediction.py); a choice
MISSED = 1e-5  # share of a cell by which it may get too full or too empty in a long step; a choice
TOLERANCE = 1e-6  # share of a cell that its faces may miss within a step, times EPSADJ (DESIGN 4)


def predict(liquid: Liquid, flow: Flow, t1: float, dt: float) -> None:
    """liquid.predicted = u + dt (advection, gravity, viscosity); the pressure equation fits the present surface."""
    run, new = liquid.team.run, liquid.predicted
    old = [flow.u, flow.v, flow.w]
    liquid.sides.set_time(t1, t1 - dt)
    liquid.find_columns(flow.F)
    liquid.clear_beyond()
    liquid.projector.set_surface(flow.F, lasting=liquid.planes_last)
    if liquid.immersed is not None:
        liquid.immersed.reach_slits(liquid.projector.wet, liquid.projector.matrix.b)
    _look_beside(liquid, flow.F)
    for a in liquid.acceleration:
        if a is not None:
            run(fill, liquid.about, 0.0, a)
    add = liquid.momentum.add_accelerations
    if liquid.momentum.work is not None:
        liquid.momentum.work.begin(liquid.faces)
    gradients = liquid.projector.gradients(flow.p, liquid.momentum.slivers, old)
    liquid.sides.loosen(old, flow.F, DUST)
    add(liquid.faces, old, flow.F, liquid.acceleration, dt, gradients, t1 - dt)
    if flow.F is not None:
        liquid.sides.tighten(old)
    _advance(liquid, old, flow.F, 1.0, dt, new)
    if liquid.plan.order == 1 or _is_aged(flow, dt):
        _diffuse(liquid, flow, dt, new)
        return
    push_by_last_pressure(liquid.projector, flow.p, dt, new)
    _continue(liquid, flow, new)
    liquid.sides.loosen(new, flow.F, DUST)
    add(liquid.faces, new, flow.F, liquid.acceleration, dt, gradients)
    _advance(liquid, old, flow.F, 0.5, dt, new)
    _diffuse(liquid, flow, dt, new)


def _is_aged(flow: Flow, dt: float) -> bool:
    """Whether the last pressure is no measure for a step as long as dt; that of the start is."""
    return dt > AGED * flow.dt > 0.0


def _diffuse(liquid: Liquid, flow: Flow, dt: float, new: list) -> None:
    """new [u, v, w] += the change by implicit viscosity of what the last pressure leaves of it (implicit_viscosity.py).

    A pressure that is no measure is left out. The accelerations are in `new` already: their arrays keep it while the
    pressure acts. Raises StepTooLong.
    """
    momentum, run = liquid.momentum, liquid.team.run
    if not momentum.implicit:
        return
    for u, kept in zip(new, liquid.acceleration, strict=True):
        if u is not None:
            run(put, liquid.about, u, kept)
    if not _is_aged(flow, dt):
        push_by_last_pressure(liquid.projector, flow.p, dt, new)
        _continue(liquid, flow, new)
    momentum.diffuse(liquid.faces, new, flow.F, dt)
    for u, kept, change in zip(new, liquid.acceleration, momentum.work.changes, strict=True):
        if u is not None:
            run(put, liquid.about, kept, u)
            run(add_change, liquid.faces, change, u)
    liquid.sides.fill_velocity(new)  # joined sides changed on one side only


def _advance(liquid: Liquid, old: list, F: np.ndarray | None, share: float, dt: float, new: list) -> None:
    """new = old + share dt a, with what the sides give."""
    for d, (a, u, out) in enumerate(zip(liquid.acceleration, old, new, strict=True)):
        if a is not None:
            liquid.team.run(accelerate, liquid.about, liquid.openings[1 + d], liquid.lines, u, a, share * dt, out)
    if liquid.immersed is not None:
        liquid.immersed.hold(new, [g * dt for g in liquid.gravity])
    liquid.sides.let_out(old, new, dt, F)
    if liquid.momentum.implicit:
        liquid.sides.fill_velocity(new)
    else:
        liquid.sides.fill_normal(new)  # the pressure comes next, which needs no more


def _look_beside(liquid: Liquid, F: np.ndarray | None) -> None:
    """Find which faces beside the liquid are continued from which others; the surface is set."""
    if F is not None:
        find_sources(
            liquid.team, liquid.about, liquid.marked, liquid.projector.matrix.b, liquid.openings[1:], liquid.lines, F,
            liquid.sides.periodic, DUST, liquid.beside,
        )  # fmt: skip
        liquid.marked = liquid.about


def _continue(liquid: Liquid, flow: Flow, velocity: list) -> None:
    """Velocities beside the liquid continue those that the pressure acted on; ghosts are filled."""
    if flow.F is not None:
        continue_velocity(liquid.team, liquid.about, velocity, liquid.beside)
        liquid.sides.follow(velocity, liquid.projector.matrix.b)
    liquid.sides.fill_velocity(velocity)


def project(liquid: Liquid, flow: Flow, dt: float, couple: Couple | None = None) -> Solved:
    """liquid.predicted becomes the new velocity, liquid.p its pressure; couple: as of Projector.project.

    On return every liquid cell's faces fit to the tolerance, velocities two cells beside the liquid continue it, and
    ghosts are filled. Raises StepTooLong where a shorter step may do.
    """
    plan, new = liquid.plan, liquid.predicted
    liquid.courant = liquid.stride = 0.0  # not known yet, for a step that has to be tried again
    liquid.friction[:] = 0.0
    liquid.p[...] = flow.p
    if liquid.immersed is not None:
        liquid.immersed.rest_in_slits(new, dt)
    try:
        solved = liquid.projector.project(
            new,
            liquid.p,
            flow.F,
            dt,
            TOLERANCE * plan.pressure.tolerance,
            plan.pressure.most_iterations,
            flow.p_before,
            liquid.immersed,
            couple,
        )
    except PressedTogether as error:
        raise StepFailed(str(error)) from error
    liquid.tally.note_solution(solved.iterations)
    if not solved.converged:
        text = f"the pressure did not converge in {solved.iterations} iterations"
        raise StepTooLong(text, advice="Write a larger itmax in &limits, or a larger epsadj in &xput")
    _continue(liquid, flow, new)
    rates = liquid.rates(flow.F, new)
    liquid.courant, liquid.stride = rates.summed * dt, rates.trying * dt / MOST_COURANT
    if liquid.stride > 1.0:
        raise StepTooLong(f"the liquid crosses {liquid.courant:.3g} of a cell in a step")
    if liquid.momentum.work is not None:
        held = None if liquid.immersed is None else [None if one is None else one[0] for one in liquid.immersed.held]
        liquid.friction[:] = liquid.momentum.work.close(liquid.faces, flow.velocity, new, flow.F, dt, held)
    if flow.F is None:
        liquid.entered, brought = _enter_full(liquid, flow, dt)
        liquid.friction[1] += brought
    return solved


def _heads(liquid: Liquid, flow: Flow, dt: float) -> list[np.ndarray | None]:
    """What a volume that passes the sides in this step brings of energy (observe/streams.py)."""
    of = liquid.projector
    return energy_heads(liquid.sides, flow.velocity, liquid.predicted, liquid.p, of.q, of.matrix.diagonal, dt)


def _enter_full(liquid: Liquid, flow: Flow, dt: float) -> tuple[np.ndarray, float]:
    """(6,) [length3]: what comes in through each side of a domain that is full, sum over its faces (A u) dt; the energy
    that it brings."""
    entered, brought, inside = np.zeros(6), 0.0, (slice(G, -G),) * 2
    heads = _heads(liquid, flow, dt)
    for d, (u, A) in enumerate(zip(liquid.predicted, liquid.openings[1:], strict=True)):
        if u is not None:
            area = np.multiply.outer(*(width for e, width in enumerate(liquid.grid[:3]) if e != d))
            for upper, side in enumerate((G - 1, u.shape[d] - G - 1)):
                face = (slice(None),) * d + (side,)
                rate = area * u[face] * (1.0 if A is None else A[face])
                into = -dt if upper else dt
                entered[2 * d + upper] = into * float(rate[inside].sum())
                head = heads[2 * d + upper]
                brought += 0.0 if head is None else into * float((rate * head)[inside].sum())
    return entered, brought


def answer_impulses(
    liquid: Liquid, flow: Flow, source: Callable[[np.ndarray], None], coupling: Coupling, dt: float
) -> np.ndarray:
    """liquid.predicted answers what impacts have made of the bodies' velocities; q [length2/time] that did it.

    source(right) adds to right [length3/time] what the bodies bring out of cells by them; coupling: bodies that q
    moves; dt: of the step, for the tolerance. Raises StepTooLong where a shorter step may do.
    """
    projector, new = liquid.projector, liquid.predicted
    projector.right.fill(0.0)
    source(projector.right)
    solved = projector.answer(new, coupling, TOLERANCE * liquid.plan.pressure.tolerance / dt)
    liquid.tally.note_solution(solved.iterations)
    if not solved.converged:
        raise StepTooLong(f"the pressure of an impact did not converge in {solved.iterations} iterations")
    _continue(liquid, flow, new)
    rates = liquid.rates(flow.F, new)
    liquid.courant = max(liquid.courant, rates.summed * dt)
    liquid.stride = max(liquid.stride, rates.trying * dt / MOST_COURANT)
    return projector.q


def move_liquid(liquid: Liquid, flow: Flow, dt: float, number: int) -> None:
    """liquid.F = the fraction after dt with the projection's velocities; number of the step orders the sweeps.

    The sweeps are bounded for sums of Courant numbers up to MOST_COURANT, by the worst that a cell of a stream without
    sources may meet. Raises StepTooLong in a step beyond the usual ones where a cell met more than it holds.
    """
    np.copyto(liquid.F, flow.F)
    moved = Flow(*liquid.predicted, liquid.p, liquid.F, dt)
    change = liquid.immersed.change if liquid.immersed is not None else None
    fill_ghosts, heads = liquid.sides.fill_fraction, _heads(liquid, flow, dt)
    if liquid.immersed is not None:
        liquid.immersed.narrow.lean(liquid.predicted, 1.0)
    if liquid.immersed is not None:
        liquid.planes.outdate()
    if liquid.planes_last:
        liquid.planes.pass_on(flow.F, liquid.F)
    else:
        liquid.forget_planes()
    scene = liquid.openings, dt, number, fill_ghosts, change, liquid.sides.spread, heads
    found = carry_liquid(liquid.team, liquid.tracking, moved, *scene)
    if liquid.immersed is not None:
        liquid.immersed.narrow.lean(liquid.predicted, -1.0)
    longer = liquid.plan.steps.courant > MOST_COURANT and liquid.courant > MOST_ALONG and change is None
    if longer and max(found.over, -found.under) > MISSED:
        over, under = _extremes(flow.F, liquid.openings.V)
        if found.over - over > MISSED or under - found.under > MISSED:
            liquid.stride = liquid.courant / MOST_ALONG
            raise StepTooLong("more liquid met in a cell than it holds, or left it")
    liquid.entered = found.entered
    liquid.friction[1] += found.brought
    liquid.sides.fill_fraction(liquid.F)


def _extremes(F: np.ndarray, V: np.ndarray | None) -> tuple[float, float]:
    """(over, under) [-] as of surface_tracking.Moved, of liquid that is there."""
    inside = (slice(G, -G),) * 3
    liquid, room = (F, 1.0) if V is None else (F * V, V[inside])
    return max(float((liquid[inside] - room).max()), 0.0), min(float(liquid[inside].min()), 0.0)


def settle_pressure(liquid: Liquid, flow: Flow, dt: float) -> None:
    """flow.p becomes the pressure that holds the liquid at rest in gravity: hydrostatic under a level surface."""
    at_rest = [None if a is None else np.zeros_like(a) for a in flow.velocity]
    for a, g, A in zip(at_rest, liquid.gravity, liquid.openings[1:], strict=True):
        if a is not None:
            a[...] = g * dt
            if A is not None:
                a[A == 0.0] = 0.0
    liquid.sides.set_time(0.0)
    for c, a in enumerate(at_rest):
        if a is not None:
            liquid.sides.fill_change(c, a)  # at rest nothing comes in: a stream that starts is no weight to be held
    liquid.projector.set_surface(flow.F)
    flow.p.fill(0.0)
    try:
        liquid.projector.project(at_rest, flow.p, flow.F, dt, REST, liquid.plan.pressure.most_iterations)
    except PressedTogether as error:
        raise StepFailed(f"no pressure holds the liquid at rest: {error}") from error
