"""Which effects the scene calls for, and the deck line that turns each on. What is not listed is not there at all."""

from __future__ import annotations

from flowgmo.bodies.body import COUPLED, FIXED_AXIS, FIXED_POINT, PRESCRIBED, Body
from flowgmo.deck import Deck
from flowgmo.model import ContactPlan, Effect


def list_effects(deck: Deck, bodies: tuple[Body, ...], contacts: ContactPlan | None) -> tuple[Effect, ...]:
    """Effects in the order of the step."""
    coupled = [b for b in bodies if b.kind == COUPLED]
    effects = []

    def on(name: str, what: str, variable: str, *index: int) -> None:
        effects.append(Effect(name, what, _line(deck, variable, *index)))

    if coupled and any(deck[g] != 0.0 for g in ("GX", "GY", "GZ")):
        first = next(g for g in ("GX", "GY", "GZ") if deck[g] != 0.0)
        on("gravity", "constant acceleration of all coupled bodies", first)
    if coupled:
        on(
            "motion",
            f"equations of motion of {_count(coupled, 'coupled body', 'coupled bodies')}",
            "IMO",
            coupled[0].number,
        )
    prescribed = [b for b in bodies if b.kind == PRESCRIBED]
    if prescribed:
        text = f"prescribed motion of {_count(prescribed, 'body', 'bodies')}"
        on("prescribed", text, "IMO", prescribed[0].number)
    for constraint in (FIXED_AXIS, FIXED_POINT):
        held = [b for b in bodies if b.constraint == constraint]
        if held:
            on(
                constraint,
                f"{_count(held, 'body turns', 'bodies turn')} about a {constraint}",
                "IMOAXS",
                held[0].number,
            )
    loaded = [b for b in bodies if b.loads is not None]
    if loaded:
        on("control loads", f"forces and torques on {_count(loaded, 'body', 'bodies')}", "IGF", loaded[0].number)
    stopped = [b for b in bodies if b.stops.any]
    if stopped:
        names = [f"D{a}MC{side}" for a in "XYZ" for side in ("MIN", "MAX")] + ["ANGLMIN", "ANGLMAX"]
        first = next(n for n in names if deck.given(n, stopped[0].number))
        on("stops", f"travel or angle limits of {_count(stopped, 'body', 'bodies')}", first, stopped[0].number)
    kept = [b for b in bodies if b.moves and b.mass is not None and _partly_prescribed(b)]
    if kept:
        name = "IPRPMVB" if deck.given("IPRPMVB", kept[0].number) else "RHOMVB"
        text = f"loads that keep the prescribed motion of {_count(kept, 'body', 'bodies')}"
        on("residual", text, name, kept[0].number)
    if contacts is not None:
        on("collisions", "impacts at their own times, rest, sliding, rolling", "ICLID")
        if (contacts.friction[contacts.allowed] > 0.0).any():
            rough = next((b.number for b in bodies if deck.given("CFRC", b.number) and b.friction > 0.0), None)
            on(
                "friction",
                "Coulomb friction in impacts, sliding and rolling",
                *(("CFRC", rough) if rough else ("FRCMOB",)),
            )
        if contacts.sleep and not contacts.closed_form:
            on("sleep", "bodies at rest cost nothing until something touches them", "SLEEP")
    return tuple(effects)


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
