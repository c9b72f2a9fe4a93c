"""Rules of the liquid: its start, its sides, what the deck says about it without effect. Geometry is not known yet."""

from collections.abc import Callable, Iterator

from .deck import Deck
from .defaults import default_of
from .errors import DeckError, Notice, Problem
from .rules_bodies import missing_file
from .rules_mesh import SIDES
from .store import Index
from .variables import REGISTRY

Finding = Iterator[Problem | Notice]
NO_LIQUID = -1e7  # FLHTBCT at or below such a height means no liquid; decks write -1e8, the default is -1e10
MIRROR, WALL, PRESSURE, VELOCITY = 1, 2, 5, 6
# Kinds of sides at which each table acts. A mirror has no velocity at all; through the others the flow finds its own.
ACTS = {
    **dict.fromkeys(("UBCT", "VBCT", "WBCT"), (WALL, VELOCITY)),
    "PBCT": (PRESSURE,),
    **dict.fromkeys(("FBCT", "FLHTBCT"), (PRESSURE, VELOCITY)),
}


def described(deck: Deck) -> list[tuple[str, Index]]:
    """Variables that describe liquid."""
    found: list[tuple[str, Index]] = []
    if deck.given("FLHT"):
        found.append(("FLHT", ()))
    found += [(name, ()) for name in ("VLIN", "NFLS") if deck[name] > 0]
    for name, none in (("FBCT", 0.0), ("FLHTBCT", NO_LIQUID)):
        for index in deck.indices(name):
            if deck.at("IBCT", index[1]) in ACTS[name] and deck.at(name, *index) > none:
                found.append((name, index))
                break
    return found


def density(deck: Deck) -> Finding:
    """Liquid is described without its density."""
    if deck.given("RHOF") or "RHOF" in deck.broken:
        return
    for name, index in described(deck):
        wrong = "this describes liquid, and the deck gives no density rhof"
        yield deck.problem(name, *index, wrong=wrong, write="Give rhof in &props, or remove this to run the bodies dry")


def start(deck: Deck) -> Finding:
    """IFLINITTYP has the value it speaks of, and that value is not given in vain."""
    mode = deck["IFLINITTYP"]
    for name, value, word in (("FLHT", 1, "the height"), ("VLIN", 2, "the volume")):
        if mode == value and not deck.given(name):
            wrong = f"{word} of the liquid at the start is missing"
            yield deck.problem("IFLINITTYP", wrong=wrong, write=f"Give {name.lower()} in &fl, or write iflinittyp=0")
        elif mode != value and deck.given(name) and deck[name] != 0.0:
            wrong = f"this has no effect with iflinittyp={mode}"
            yield deck.notice(name, wrong=wrong, write=f"Write iflinittyp={value}")
    if mode == 2 and not any(deck[f"G{axis}"] for axis in "XYZ"):
        wrong = "the surface of a volume lies across gravity, and there is none"
        yield deck.problem("VLIN", wrong=wrong, write="Give gz, or write iflinittyp=1 and flht")


def surface(deck: Deck) -> Finding:
    """Without a free surface nothing is empty; with one the liquid moves."""
    if deck["ITB"] == 1:
        if deck["IFVOF"] == 0:
            wrong = "the liquid has a free surface, and this does not move it"
            yield deck.problem("IFVOF", wrong=wrong, write="Write ifvof=6, or itb=0 for a domain full of liquid")
        return
    partly = [("FLHT", ())] if deck["IFLINITTYP"] == 1 and _lower_than_domain(deck) else []
    partly += [("VLIN", ())] if deck["IFLINITTYP"] == 2 else []
    regions = [r for r in range(1, deck["NFLS"] + 1) if deck.at("IF_FLREG_ENABLED", r)]
    partly += [("FIOH", (r,)) for r in regions if deck.at("FIOH", r) == 0]
    partly += [("FREG", (r,)) for r in regions if deck.at("FREG", r) < 1.0]
    for index in deck.indices("FBCT"):
        if deck.at("IBCT", index[1]) in ACTS["FBCT"] and deck.at("FBCT", *index) < 1.0:
            partly.append(("FBCT", index))
    for name, index in partly[:1]:
        wrong = "this leaves space without liquid, and with itb=0 all open space is full"
        yield deck.problem(name, *index, wrong=wrong, write="Write itb=1 in &xput, or remove this")


def weight(deck: Deck) -> Finding:
    """A free surface that nothing levels: forgotten more often than meant, which gz=0. says."""
    if deck["ITB"] == 1 and not any(deck.given(name) or name in deck.broken for name in ("GX", "GY", "GZ")):
        wrong = "the liquid has a free surface and the deck gives no gravity"
        yield deck.notice("ITB", wrong=wrong, write="Give gz in &xput; gz=0. if there is none")


def _lower_than_domain(deck: Deck) -> bool:
    top = deck.at("PZ", max((n for (n,) in deck.indices("PZ")), default=2))
    return deck["FLHT"] is not None and top is not None and deck["FLHT"] < top


def reference(deck: Deck) -> Finding:
    """Absolute pressures need the pressure that they are compared with."""
    if deck["IPGAUGE"] == 1 or deck["P_REFERENCE"] is not None:
        return
    sides = [n for n in range(1, 7) if deck.at("IBCT", n) == PRESSURE]
    if not deck.given("PVOID") or any((n,) not in deck.tabled("PBCT") for n in sides):
        wrong = "absolute pressures need the one of the surroundings, and neither p_reference nor units give it"
        yield deck.problem("IPGAUGE", wrong=wrong, write="Write p_reference=..., or units='si', or ipgauge=1")


def regions(deck: Deck) -> Finding:
    """No region beyond NFLS is described; one Problem for each that is."""
    beyond: dict[int, str] = {}
    for row in REGISTRY.values():
        if row.block == "FL" and row.shape == ("r",):
            for (r,) in deck.indices(row.name):
                if r > deck["NFLS"]:
                    beyond.setdefault(r, row.name)
    for r, name in sorted(beyond.items()):
        wrong = f"there is no region {r} of the liquid, nfls={deck['NFLS']}"
        yield deck.problem(name, r, wrong=wrong, write=f"Write nfls={max(beyond)}, or remove the region")


def meshes(deck: Deck) -> Finding:
    """Regions with IFDIS -1 name an STL file, which is there, and others name none."""
    for r in range(1, deck["NFLS"] + 1):
        if not deck.at("IF_FLREG_ENABLED", r):
            continue
        named, wanted = bool(deck.at("FFSTL", r)), deck.at("IFDIS", r) == -1
        if wanted and not named:
            wrong = "the STL file of this region is missing"
            yield deck.problem("IFDIS", r, wrong=wrong, write=f"Give ffstl({r})='...', or write ifdis({r})=0")
        elif named and not wanted:
            wrong = f"this has no effect with ifdis({r})={deck.at('IFDIS', r)}"
            yield deck.problem("FFSTL", r, wrong=wrong, write=f"Write ifdis({r})=-1, or remove it")
        elif named:
            yield from missing_file(deck, "FFSTL", r)


def walls(deck: Deck) -> Finding:
    """No velocity points into a wall or a mirror."""
    for n in range(1, 7):
        name = "UVW"[(n - 1) // 2] + "BCT"
        if deck.at("IBCT", n) in (MIRROR, WALL) and (place := _acting(deck, name, n, 0.0)):
            wrong = f"the velocity points into the side {SIDES[n - 1]}, which lets nothing through"
            yield deck.problem(*place, wrong=wrong, write=f"Write ibct({n})=6, or remove it")


def heights(deck: Deck) -> Finding:
    """A pressure or fraction that follows a height needs that height, and gravity along z."""
    for n in range(1, 7):
        if deck.at("IBCT", n) not in ACTS["FLHTBCT"]:
            continue
        if deck.at("IHPBCT", n) == 1 and (n,) not in deck.tabled("FLHTBCT"):
            wrong = "the height of the liquid outside is missing"
            yield deck.problem("IHPBCT", n, wrong=wrong, write=f"Give flhtbct(1,{n}), or write ihpbct({n})=0")
        elif deck.at("IHPBCT", n) == 1 and (deck["GX"] or deck["GY"]):
            wrong = "liquid outside stands level in z, and gravity points elsewhere too"
            yield deck.notice("IHPBCT", n, wrong=wrong, write="Give gravity along z only")


def idle(deck: Deck) -> Finding:
    """Values of the sides that say something and have no effect."""
    for name, kinds in ACTS.items():
        normal = "UVW".find(name[0])
        for n in range(1, 7):
            off = NO_LIQUID if name == "FLHTBCT" else default_of(deck, deck.row(name), (1, n))
            kind = deck.at("IBCT", n)
            place = _acting(deck, name, n, off)
            if place is None or kind in (MIRROR, WALL) and normal == (n - 1) // 2:
                continue  # into a wall: an error, see walls
            if kind not in kinds:
                wrong = f"this has no effect at the side {SIDES[n - 1]} with ibct({n})={kind}"
                yield deck.notice(*place, wrong=wrong)
            elif kind == WALL and not (deck["IFVISC"] and deck["IWSH"]):
                wrong = "a wall takes liquid along only with ifvisc=1 and iwsh=1"
                yield deck.notice(*place, wrong=wrong)
            elif name == "FLHTBCT" and deck.at("IHPBCT", n) == 0:
                wrong = f"this has no effect with ihpbct({n})=0"
                yield deck.notice(*place, wrong=wrong, write=f"Write ihpbct({n})=1")
            elif name == "FBCT" and deck.at("IHPBCT", n) == 1:
                yield deck.notice(*place, wrong=f"this has no effect with ihpbct({n})=1, which follows the height")


def _acting(deck: Deck, name: str, n: int, off: float) -> tuple | None:
    """The first element of a side's table that is not the value without effect (above it for heights)."""

    def says(value: float) -> bool:
        return value > off if name == "FLHTBCT" else value != off

    for index in deck.indices(name):
        if index[1] == n and says(deck.at(name, *index)):
            return name, *index
    if deck.at(f"F{name}", n):
        try:
            values = deck.series(name, n).y
        except DeckError:  # rules_time reports it
            return None
        return (f"F{name}", n) if any(says(value) for value in values) else None
    return None


RULES: tuple[Callable[[Deck], Finding], ...] = (
    *(start, surface, weight, reference),
    *(regions, meshes, walls, heights, idle),
)
