"""Rules of bodies that move in liquid: how they are solved for. building/wet_bodies.py looks at their geometry."""

from collections.abc import Callable, Iterator

from .deck import Deck
from .errors import Notice, Problem
from .rules_bodies import components

Finding = Iterator[Problem | Notice]


def solved_together(deck: Deck) -> Finding:
    """Coupled bodies are solved for together with the pressure, by the solver that can."""
    coupled = any(deck.at("IMO", m) == 4 for m in components(deck))
    if not coupled or not deck["IMOBS"]:
        return
    if deck["IMPMOB"] == 0:
        late = "the liquid's load on a body is that of the step before, which grows without end on one that is lighter"
        yield deck.notice("IMPMOB", wrong=f"{late} than its added mass", write="Write impmob=1 but for comparison")
        if deck["WETIMPACT"] == "wet" and deck.given("WETIMPACT"):
            yield deck.notice("WETIMPACT", wrong="impacts do not feel the liquid with impmob=0", write="Write impmob=1")
        return
    if deck["IGMRES"] == 0 and deck.given("IGMRES"):
        wrong = "known but not computed: relaxation of the pressure with bodies that the liquid moves"
        if deck["IGNORE_UNSUPPORTED"]:
            deck.drop("IGMRES")
            yield deck.notice("IGMRES", wrong=wrong, write="Write igmres=1")
        else:
            yield deck.problem("IGMRES", wrong=wrong, write="Write igmres=1, or &flowgmo ignore_unsupported=.true.")


def recorded(deck: Deck) -> Finding:
    """What the records of moving bodies have in any case, and what they do not have."""
    for m in components(deck):
        if deck.at("IMO", m) not in (3, 4):
            continue
        if deck.at("IBUOYO", m) == 1:
            wrong = "the centre of buoyancy is always recorded, the metacentric height is not computed"
            yield deck.notice("IBUOYO", m, wrong=wrong)
        other = "IPREF" if deck.at("IPREF", m) == 2 else "PREFMBW" if deck.at("PREFMBW", m) != deck["PVOID"] else None
        if other is not None:
            yield deck.notice(other, m, wrong="the load on a body that moves is that against pvoid")


RULES: tuple[Callable[[Deck], Finding], ...] = (solved_together, recorded)
