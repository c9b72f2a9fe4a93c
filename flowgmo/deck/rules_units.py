"""Rules of units: a deck's numbers have no units, so that what does not fit shows in gravity alone."""

from collections.abc import Callable, Iterator
from math import hypot

from .deck import Deck
from .errors import Notice

KNOWN = ("", "si", "cgs", "eng", "cust")  # the format's; '' and 'cust' name none
EARTH = {"si": (9.81, "m/s^2"), "cgs": (981.0, "cm/s^2"), "eng": (32.2, "ft/s^2")}  # gravity at the surface
NEAR = 0.02  # between pole and equator it differs by .005; 9.8 and 32 are in use


def known_units(deck: Deck) -> Iterator[Notice]:
    """A system of units that no table of results has a name for."""
    if deck["UNITS"].strip().lower() not in KNOWN:
        wrong = "there is no such system of units; results will be in 'length', 'mass', 'time'"
        yield deck.notice("UNITS", wrong=wrong, write="Write units='si', 'cgs', 'eng', or 'cust'")


def gravity_in_other_units(deck: Deck) -> Iterator[Notice]:
    """Gravity is that of the Earth in another system than UNITS."""
    units = deck["UNITS"].strip().lower()
    names = [name for name in ("GX", "GY", "GZ") if deck[name]]
    if units not in EARTH or not names:
        return
    g = hypot(*(deck[name] for name in names))
    for other, (value, unit) in EARTH.items():
        if other != units and abs(g - value) < NEAR * value:
            right, here = EARTH[units]
            wrong = f"gravity of {g:g} {here} is that of the Earth in {unit}, and the deck has units='{units}'"
            write = f"Write units='{other}', or gravity of {right:g}, and see that all else has these units too"
            yield deck.notice(max(names, key=lambda name: abs(deck[name])), wrong=wrong, write=write)


RULES: tuple[Callable[[Deck], Iterator[Notice]], ...] = (known_units, gravity_in_other_units)
