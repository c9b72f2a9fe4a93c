"""Units as text, for attributes and tables: from the deck's UNITS, else combinations of length, mass, and time."""

from __future__ import annotations

_NAMES = {
    "si": ("m", "kg", "s", "N", "J"),
    "cgs": ("cm", "g", "s", "dyn", "erg"),
    "eng": ("ft", "slug", "s", "lbf", "ft lbf"),
    "generic": ("length", "mass", "time", "mass length/time^2", "mass length^2/time^2"),
}
_PRESSURES = {"si": "Pa", "cgs": "dyn/cm^2", "eng": "lbf/ft^2", "generic": "mass/(length time^2)"}


def unit(quantity: str, system: str) -> str:
    """The unit of a quantity ("length", "velocity", "torque" ...) in a system: si, cgs, eng; any other: generic."""
    key = system.strip().lower()
    key = key if key in _NAMES else "generic"
    length, mass, time, force, energy = _NAMES[key]
    return {
        "none": "1",
        "length": length,
        "mass": mass,
        "time": time,
        "velocity": f"{length}/{time}",
        "acceleration": f"{length}/{time}^2",
        "spin": f"rad/{time}",
        "force": force,
        "torque": f"{force} {length}" if force in ("N", "dyn") else energy,
        "energy": energy,
        "impulse": f"{force} {time}" if force in ("N", "dyn", "lbf") else f"{mass} {length}/{time}",
        "inertia": f"{mass} {length}^2",
        "density": f"{mass}/{length}^3",
        "area": f"{length}^2",
        "volume": f"{length}^3",
        "flow": f"{length}^3/{time}",
        "pressure": _PRESSURES[key],
    }[quantity]
