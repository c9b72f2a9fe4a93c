"""&XPUT, &LIMITS, &PROPS and the parts of the other files -> FluidPlan."""

from __future__ import annotations

from flowgmo.bodies.body import COUPLED, SOLID, Body
from flowgmo.building.boundaries import build_sides, check_balance, check_directions
from flowgmo.building.findings import Findings
from flowgmo.building.gauges import build_loads, build_planes, check_probes
from flowgmo.building.liquid import build_start
from flowgmo.building.memory import check_memory
from flowgmo.building.wet_bodies import check_wet_bodies
from flowgmo.flow_plan import (
    GROWTH,
    MOST_ALONG,
    MOST_COURANT,
    MOST_SUM,
    CleanUp,
    FilmPlan,
    FluidPlan,
    PressurePlan,
    StepPlan,
)
from flowgmo.mesh import Mesh

#: what the pressure does to the step; multigrid needs 3 to 9 iterations at any step, so that their number says nothing
PRESSURE_STEPS = "one whose pressure takes more than itmax iterations is tried again with half its length"
TRACKING = {4: "donor", 6: "plic"}  # 3 and 5 are read as 4 and 6 (deck/store.py)


def build_fluid(found: Findings, mesh: Mesh, bodies: tuple[Body, ...]) -> FluidPlan | None:
    """The liquid of a deck that gives RHOF; None for a dry one, or, with problems, if it cannot be computed."""
    deck = found.deck
    if not deck.given("RHOF"):
        return None
    check_memory(found, mesh)
    check_directions(found, mesh)
    check_probes(found, mesh)
    _check_open(found, mesh, bodies)
    check_wet_bodies(found, mesh, bodies)
    void_pressure = float(deck["PVOID"])
    sides = build_sides(found, mesh, void_pressure)
    if deck["ITB"] == 0 and deck["RCSQL"] == 0.0:
        check_balance(found, sides, mesh, bodies)
    mu = _viscosity(found)
    return FluidPlan(
        rho=float(deck["RHOF"]),
        mu=mu,
        implicit_viscosity=mu is not None and deck["IMPVIS"] > 0,
        no_slip=mu is not None and deck["IWSH"] == 1,
        compressibility=float(deck["RCSQL"]) or None,
        order=int(deck["IORDER"]),
        free_surface=deck["ITB"] == 1,
        tracking=TRACKING[int(deck["IFVOF"])] if deck["ITB"] == 1 else None,
        void_pressure=void_pressure,
        steps=_steps(found, bodies),
        pressure=PressurePlan(float(deck["EPSADJ"]), int(deck["ITMAX"]), plain_sor=deck["IGMRES"] == 0),
        clean_up=_clean_up(found),
        start=build_start(found, mesh, bodies, void_pressure),
        sides=sides,
        planes=build_planes(found, mesh),
        loads=build_loads(found, bodies),
        film=_film(found, bodies, mu),
        coupled_together=deck["IMPMOB"] == 1,
    )


def _viscosity(found: Findings) -> float | None:
    """mu; None where the liquid is not viscous, whichever line says so."""
    deck = found.deck
    mu = float(deck["MU1"])
    name = "MU1" if deck.given("MU1") or not deck.given("MUI") else "MUI"
    if deck["IFVISC"] == 0:
        if mu > 0.0:
            found.notice(name, wrong="ifvisc=0 switches viscosity off", write="Write ifvisc=1 for viscous liquid")
        return None
    if mu == 0.0:
        found.notice("IFVISC", wrong="the viscosity is zero, so that this has no effect", write="Give mu1 in &props")
    return mu or None


def _film(found: Findings, bodies: tuple[Body, ...], mu: float | None) -> FilmPlan | None:
    """Where the liquid sticks to walls and moves bodies, together with the pressure."""
    deck = found.deck
    moved = any(body.kind == COUPLED for body in bodies)
    apart = deck["IMPMOB"] != 1
    if mu is None or deck["IWSH"] != 1 or not moved or apart or not deck["LUBRICATION"]:
        for name in ("LUBRICATION", "FILMROUGH"):
            if deck.given(name) and deck["LUBRICATION"]:
                why = "no body is moved by the liquid" if not moved else "the liquid is not viscous"
                why = "the liquid slides along walls (iwsh=0)" if moved and mu is not None else why
                why = "bodies move after the liquid (impmob=0)" if moved and apart else why
                found.notice(name, wrong=f"no effect: {why}")
            elif name == "FILMROUGH" and deck.given(name):
                found.notice(name, wrong="no effect: lubrication=.false. switches the film off")
        return None
    return FilmPlan(float(deck["FILMROUGH"]) if deck.given("FILMROUGH") else None)


def _steps(found: Findings, bodies: tuple[Body, ...]) -> StepPlan:
    deck = found.deck
    courant, most = float(deck["CON"]), MOST_SUM
    moved = any(body.kind != SOLID for body in bodies)
    why = "beyond which the velocity is no longer stable"
    if moved or MOST_ALONG < courant <= MOST_COURANT:
        most, why = MOST_ALONG, f"a tenth less than {MOST_COURANT:g}, for what grows within a step"
    if moved:
        why += f": up to {MOST_COURANT:g} the liquid's fractions stay within bounds beside bodies that move"
    if courant > most:
        found.notice("CON", wrong=f"taken as con={most:g}, {why}")
        courant = most
    if deck["AUTOT"] == 0.0:
        found.notice("AUTOT", wrong="steps are delt, and shorter where longer ones would not be stable")
    elif deck["AUTOT"] == 2.0:
        found.notice("AUTOT", wrong=f"taken as autot=1: {PRESSURE_STEPS}")
    if deck.given("ITDTMX"):
        found.notice("ITDTMX", wrong=f"this shortens no step: {PRESSURE_STEPS}")
    return StepPlan(
        adapt=int(deck["AUTOT"]), courant=courant, surface_courant=float(deck["CONFS"]), growth=GROWTH,
    )  # fmt: skip


def _clean_up(found: Findings) -> CleanUp:
    """AVRCK acts with IAVRCK=1, its sign does not (decks write -3.1). Off by default: slivers cost no step here
    (flow/surface/spill_over.py), and raising their volumes moves walls."""
    deck = found.deck
    raises = deck["IAVRCK"] == 1 and deck["AVRCK"] != 0.0
    if raises:
        found.notice(
            "IAVRCK", wrong="slivers get more volume than is open, which moves walls by up to a third of a cell"
        )
    elif deck.given("AVRCK") and not deck.given("IAVRCK"):
        found.notice("AVRCK", wrong="slivers keep their volume: they cost no step here", write="Or write iavrck=1")
    sliver = abs(float(deck["AVRCK"])) if raises else None
    return CleanUp(snap=float(deck["EPS"]), smallest_volume=float(deck["VFCLEAN"]), sliver=sliver)


def _check_open(found: Findings, mesh: Mesh, bodies: tuple[Body, ...]) -> None:
    """Problem: one body holds all eight corners of the domain, and being convex all of it.

    What several solids fill together is found when the open fractions are made.
    """
    lo, hi = mesh.bounds
    corners = [[(lo, hi)[k >> axis & 1][axis] for axis in range(3)] for k in range(8)]
    for body in bodies:
        convex = body.shape.as_sphere() is not None or len(body.shape.as_boxes() or ()) == 1
        if convex and (body.shape.distance(corners) <= 0.0).all():
            at_start = "" if body.kind == SOLID else " at the start"
            found.problem(
                "OBSID" if found.deck.given("OBSID", body.number) else "NOBS",
                *((body.number,) if found.deck.given("OBSID", body.number) else ()),
                wrong=f"{body.name} fills the whole mesh{at_start}, there is no room for liquid",
                write="Check its limits, or the mesh planes",
            )  # fmt: skip
