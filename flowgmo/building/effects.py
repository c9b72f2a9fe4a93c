"""Which effects the scene calls for, and the deck line that turns each on. What is not listed is not there at all."""

from __future__ import annotations

from collections.abc import Iterator

from flowgmo.bodies.body import COUPLED, FIXED_AXIS, FIXED_POINT, PRESCRIBED, Body
from flowgmo.deck import Deck
from flowgmo.flow_plan import FluidPlan
from flowgmo.model import ContactPlan, Effect

Found = Iterator[tuple]  # name, one line for people, and the variable with its index that turns the effect on


def list_effects(
    deck: Deck, bodies: tuple[Body, ...], contacts: ContactPlan | None, fluid: FluidPlan | None
) -> tuple[Effect, ...]:
    """Effects in the order of the step."""
    found = [*_gravity(deck, bodies, fluid)]
    if fluid is not None:
        found += _of_fluid(fluid)
        found += _of_wet_bodies(bodies, fluid)
    found += [*_of_motion(bodies), *_of_held_bodies(deck, bodies)]
    if contacts is not None:
        found += _of_contacts(deck, bodies, contacts)
    return tuple(Effect(name, what, _line(deck, *place)) for name, what, *place in found)


def _gravity(deck: Deck, bodies: tuple[Body, ...], fluid: FluidPlan | None) -> Found:
    coupled = any(body.kind == COUPLED for body in bodies)
    first = next((g for g in ("GX", "GY", "GZ") if deck[g] != 0.0), None)
    if first and (coupled or fluid is not None):
        pulled = ["the liquid"] * (fluid is not None) + ["all coupled bodies"] * coupled
        yield "gravity", f"constant acceleration of {' and '.join(pulled)}", first


def _of_motion(bodies: tuple[Body, ...]) -> Found:
    coupled = [b for b in bodies if b.kind == COUPLED]
    if coupled:
        text = f"equations of motion of {_count(coupled, 'coupled body', 'coupled bodies')}"
        yield "motion", text, "IMO", coupled[0].number
    prescribed = [b for b in bodies if b.kind == PRESCRIBED]
    if prescribed:
        text = f"prescribed motion of {_count(prescribed, 'body', 'bodies')}"
        yield "prescribed", text, "IMO", prescribed[0].number
    for constraint in (FIXED_AXIS, FIXED_POINT):
        held = [b for b in bodies if b.constraint == constraint]
        if held:
            text = f"{_count(held, 'body turns', 'bodies turn')} about a {constraint}"
            yield constraint, text, "IMOAXS", held[0].number


def _of_held_bodies(deck: Deck, bodies: tuple[Body, ...]) -> Found:
    """Loads and limits that the deck puts on bodies."""
    loaded = [b for b in bodies if b.loads is not None]
    if loaded:
        yield "control loads", f"forces and torques on {_count(loaded, 'body', 'bodies')}", "IGF", loaded[0].number
    stopped = [b for b in bodies if b.stops.any]
    if stopped:
        names = [f"D{a}MC{side}" for a in "XYZ" for side in ("MIN", "MAX")] + ["ANGLMIN", "ANGLMAX"]
        first = next(n for n in names if deck.given(n, stopped[0].number))
        yield "stops", f"travel or angle limits of {_count(stopped, 'body', 'bodies')}", first, stopped[0].number
    kept = [b for b in bodies if b.moves and b.mass is not None and _partly_prescribed(b)]
    if kept:
        name = "IPRPMVB" if deck.given("IPRPMVB", kept[0].number) else "RHOMVB"
        text = f"loads that keep the prescribed motion of {_count(kept, 'body', 'bodies')}"
        yield "residual", text, name, kept[0].number


def _of_contacts(deck: Deck, bodies: tuple[Body, ...], contacts: ContactPlan) -> Found:
    yield "collisions", "impacts at their own times, rest, sliding, rolling", "ICLID"
    if (contacts.friction[contacts.allowed] > 0.0).any():
        rough = next((b.number for b in bodies if deck.given("CFRC", b.number) and b.friction > 0.0), None)
        place = ("CFRC", rough) if rough else ("FRCMOB",)
        yield "friction", "Coulomb friction in impacts, sliding and rolling", *place
    if contacts.sleep and not contacts.closed_form:
        yield "sleep", "bodies at rest cost nothing until something touches them", "SLEEP"


def _of_fluid(fluid: FluidPlan) -> Found:
    if fluid.mu is not None:
        how = "implicit" if fluid.implicit_viscosity else "explicit"
        walls = "the liquid sticks to walls" if fluid.no_slip else "walls are smooth"
        yield "viscosity", f"shear stress of the liquid, {how}; {walls}", "IFVISC"
    yield "liquid", "pressure, and velocity that it keeps free of divergence", "RHOF"
    if fluid.free_surface:
        how = {"plic": "as planes in cells", "donor": "by the cell it comes from"}[fluid.tracking]
        yield "free surface", f"liquid and void; the surface moves {how}", "ITB"
    if fluid.film is not None:
        yield "film", "what the mesh misses of the force of liquid squeezed out of narrow gaps", "LUBRICATION"
    if fluid.loads:
        text = f"load of the liquid on {len(fluid.loads)} fixed component{'s' if len(fluid.loads) > 1 else ''}"
        yield "loads", text, "IFRCO", fluid.loads[0].body


def _of_wet_bodies(bodies: tuple[Body, ...], fluid: FluidPlan) -> Found:
    """How bodies that move take part in the pressure equation."""
    moving = [b for b in bodies if b.moves]
    coupled = [b for b in moving if b.kind == COUPLED]
    if coupled:
        text = f"velocities of {_count(coupled, 'body', 'bodies')} " + (
            "solved with the pressure" if fluid.coupled_together else "from the pressure of the step before"
        )
        driven = len(moving) - len(coupled)
        text += f"; {driven} prescribed in its right-hand side only" if driven else ""
        yield "immersed bodies", text, "IMO", coupled[0].number
    elif moving:
        text = f"what {_count(moving, 'body pushes', 'bodies push')} away, in the pressure's right-hand side only"
        yield "immersed bodies", text, "IMO", moving[0].number


def _partly_prescribed(body: Body) -> bool:
    if body.constraint == FIXED_AXIS:
        return not body.drives[3].coupled
    if body.constraint == FIXED_POINT:
        return not all(d.coupled for d in body.drives[3:])
    return not all(d.coupled for d in body.drives)


def _count(bodies: list[Body], one: str, many: str) -> str:
    return f"{len(bodies)} {one if len(bodies) == 1 else many}"


def _line(deck: Deck, variable: str, *index: int) -> str:
    """'line 14: iclid=1', or '(default)' with the value."""
    value = deck.at(variable, *index)
    name = variable.lower() + (f"({','.join(map(str, index))})" if index else "")
    if not deck.given(variable, *index):
        return f"default: {name}={value}"
    return f"line {deck.where(variable, *index).line}: {name}={value}"
