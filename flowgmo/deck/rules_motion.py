"""Rules of motion, its limits, and collisions."""

from collections.abc import Iterator

from .deck import Deck
from .errors import DeckError, Notice, Problem
from .rules_bodies import components
from .series import Series

SHIFTS, TURNS = ("U", "V", "W"), ("OMX", "OMY", "OMZ")
FLAGS = ("IUMCAL", "IVMCAL", "IWMCAL", "IOMXCAL", "IOMYCAL", "IOMZCAL")
NO_LIMIT = 1e19  # the format's default, larger than any way
Finding = Iterator[Problem | Notice]


def switches(deck: Deck) -> Finding:
    """Motion needs IMOBS, collisions need it too."""
    moving = [m for m in components(deck) if deck.at("IMO", m) > 0]
    if moving and not deck["IMOBS"]:
        yield deck.problem("IMO", moving[0], wrong="bodies move only with imobs=1", write="Write imobs=1 in &xput")
    if deck["ICLID"] and not deck["IMOBS"]:
        yield deck.problem("ICLID", wrong="collisions need imobs=1", write="Write imobs=1, or iclid=0")


def pairs(deck: Deck) -> Finding:
    """What the deck says about collisions has an effect, and says one thing about each pair."""
    names = ("CRSTRNG", "CFRC", "ICLIDOB")
    if not deck["ICLID"]:
        off = {"CRSTRNG": deck["STRNGMOB"], "CFRC": deck["FRCMOB"], "ICLIDOB": 0}
        for name in names:
            index = next((i for i in deck.indices(name) if deck.at(name, *i) != off[name]), None)
            if index:
                yield deck.notice(name, *index, wrong="iclid=0 switches all collisions off")
        yield from _forgotten(deck)
    for a, b in deck.indices("ICLIDOB"):
        if a < b and deck.given("ICLIDOB", b, a) and deck.at("ICLIDOB", a, b) != deck.at("ICLIDOB", b, a):
            wrong = f"iclidob({b},{a}) says the opposite; a 0 in either order lets the pair pass"
            yield deck.notice("ICLIDOB", a, b, wrong=wrong)


def _forgotten(deck: Deck) -> Finding:
    """Restitution or friction of all bodies, some of which move, and not a word of ICLID: they would pass through."""
    if deck.given("ICLID") or not any(deck.at("IMO", m) > 0 for m in components(deck)):
        return
    for name, off in (("STRNGMOB", 1.0), ("FRCMOB", 0.0)):
        if deck[name] != off:
            wrong = "no effect without iclid=1; bodies pass through each other and through walls"
            yield deck.notice(name, wrong=wrong, write="Write iclid=1, or iclid=0 if that is meant")
            return


def axes(deck: Deck) -> Finding:
    """AXISX, AXISY, AXISZ give the direction of a fixed axis with IMOAXS=1, and not zero."""
    names = ("AXISX", "AXISY", "AXISZ")
    for m in components(deck):
        given = [name for name in names if deck.given(name, m)]
        if not given:
            continue
        axis = tuple(deck.at(name, m) for name in names)
        kind = deck.at("IMOAXS", m)
        if kind == 1:
            if not any(axis):
                wrong = "the direction of the axis is zero"
                yield deck.problem(given[0], m, wrong=wrong, write="Give one component that is not 0")
            continue
        # A direction along the axis that IMOAXS names says the same thing twice and is let pass.
        same = kind in (2, 3) and all((deck.at(n, m) != 0) == (k == kind - 1) for k, n in enumerate(names))
        if not same:
            wrong = f"the direction of an axis needs imoaxs({m})=1"
            yield deck.problem(given[0], m, wrong=wrong, write=f"Write imoaxs({m})=1, or remove it")


def limits(deck: Deck) -> Finding:
    """Limits of travel are for free bodies, limits of the angle for fixed axes."""
    for m in components(deck):
        if deck.at("IMO", m) not in (3, 4):
            continue
        kind = deck.at("IMOAXS", m)
        for name in (f"D{axis}MC{end}" for axis in "XYZ" for end in ("MIN", "MAX")):
            if kind != 0 and deck.at(name, m) < NO_LIMIT:
                wrong = f"limits of travel need imoaxs({m})=0"
                yield deck.problem(name, m, wrong=wrong, write="Remove it, or limit the angle by anglmin, anglmax")
        for name in ("ANGLMIN", "ANGLMAX"):
            if kind not in (1, 2, 3) and deck.at(name, m) < NO_LIMIT:
                wrong = "limits of the angle need a fixed axis, imoaxs 1 to 3"
                yield deck.problem(name, m, wrong=wrong, write="Remove it, or give the body a fixed axis")


def flags(deck: Deck) -> Finding:
    """The flags of coupled components fit the kind of motion."""
    for m in components(deck):
        motion, kind = deck.at("IMO", m), deck.at("IMOAXS", m)
        if motion != 4:
            for name in FLAGS:
                if deck.given(name, m):
                    yield deck.notice(name, m, wrong=f"no effect with imo({m})={motion}")
            continue
        free = _freedoms(FLAGS, kind)
        for name in FLAGS:
            if name not in free and deck.at(name, m) == 0:
                yield deck.notice(name, m, wrong=f"no effect with imoaxs({m})={kind}, the body cannot move that way")
        if not any(deck.at(name, m) for name in free):
            wrong = "all that the body can do is prescribed"
            yield deck.problem(free[0], m, wrong=wrong, write=f"Write imo({m})=3, or {free[0].lower()}({m})=1")


def _freedoms(names: tuple[str, ...], kind: int) -> tuple[str, ...]:
    """Those of six names, for u v w and the turns about x y z, that IMOAXS leaves free."""
    return {0: names, 4: names[3:]}.get(kind, names[2 + kind : 3 + kind])


def velocities(deck: Deck) -> Finding:
    """Velocities are given for what can move, and tables of them for what is prescribed."""
    names = tuple(f"{name}TOBS" for name in SHIFTS + TURNS)
    given = {name: {m for (m,) in deck.tabled(name)} for name in names}
    for m in components(deck):
        motion, kind = deck.at("IMO", m), deck.at("IMOAXS", m)
        for name, flag in zip(names, FLAGS, strict=True):
            if m not in given[name] or motion not in (3, 4):
                continue
            element = (name, 1, m) if deck.given(name, 1, m) else (f"F{name}", m)
            try:
                table = deck.series(name, m)
            except DeckError:
                continue  # the tables have a rule of their own
            if name not in _freedoms(names, kind):
                if table.y.any():
                    wrong = f"no effect with imoaxs({m})={kind}, the body cannot move that way"
                    yield deck.notice(*element, wrong=wrong)
            elif motion == 4 and deck.at(flag, m) and len(table.y) > 1:
                wrong = f"only the first value has an effect, the initial one; {flag.lower()}({m})=0 makes it a table"
                yield deck.notice(*element, wrong=wrong)
            elif len(table.y) > 1 and not deck.at(f"I{name[:-4]}PRE", m):
                yield from _ends_early(deck, table, element)


def _ends_early(deck: Deck, table: Series, element: tuple) -> Finding:
    """A table that ends before the run does, with a speed that goes on."""
    if table.y[-1] and table.t[-1] < deck["TWFIN"]:
        wrong = f"the table ends at t = {table.t[-1]:g}, before twfin={deck['TWFIN']:g}"
        then = f"the last value, {table.y[-1]:g}, holds from there on"
        yield deck.notice(*element, wrong=f"{wrong}: {then}", write="Give times up to twfin, or a last value 0")


def sinusoids(deck: Deck) -> Finding:
    """Amplitudes are switched on by the flags of their components."""
    for m in components(deck):
        for name in SHIFTS + TURNS:
            flag = f"I{name}PRE"
            if deck.at(f"{name}AMP", m) != 0 and deck.at(flag, m) == 0:
                yield deck.notice(f"{name}AMP", m, wrong=f"no effect with {flag.lower()}({m})=0", write="")
            if deck.at(flag, m) == 1 and any(deck.at(f"{name}TOBS", *i) for i in _table(deck, f"{name}TOBS", m)):
                wrong = f"no effect with {flag.lower()}({m})=1, the sinusoid holds"
                first = _table(deck, f"{name}TOBS", m)[0]
                if deck.at("IMO", m) == 3:
                    yield deck.notice(f"{name}TOBS", *first, wrong=wrong)


def _table(deck: Deck, name: str, m: int) -> list[tuple[int, ...]]:
    return [index for index in deck.indices(name) if index[1] == m]


def control(deck: Deck) -> Finding:
    """Control loads are switched on by IGF and act on coupled bodies."""
    used = {1: ("FXTOBS", "FYTOBS", "FZTOBS", "TXTOBS", "TYTOBS", "TZTOBS"), 2: ("FXTOBSM", "FYTOBSM", "FZTOBSM")}
    for kind, names in used.items():
        for name in names:
            for m in sorted({index[0] for index in deck.tabled(name)}):
                if m <= deck["NOBS"] and (deck.at("IGF", m) != kind or deck.at("IMO", m) != 4):
                    index = next((i for i in deck.indices(name) if i[1] == m), None)
                    if index is None or any(deck.at(name, *i) for i in deck.indices(name) if i[1] == m):
                        wrong = f"no effect: control loads of this kind need imo({m})=4 and igf({m})={kind}"
                        yield deck.notice(name, *(index or ()), wrong=wrong)


RULES = (switches, pairs, axes, limits, flags, velocities, sinusoids, control)
