"""Which curves a report shows, as plain data: two panels of motion, and one of what drives it or what it costs."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from postproc.bounces import vertical_axis
from postproc.look import body_colours
from postproc.palette import COLOURS
from postproc.results import Curve, Results
from postproc.turning import angle_turned, fixed_axis, turns

FIRST = ("energy/kinetic", "energy/potential")
SIDEWAYS = 0.05  # bodies that rise less than this part of their largest travel are shown along that travel instead
INVISIBLE = 1e-6  # of the largest value in the panel


@dataclass(frozen=True)
class Line:
    """One curve: what the legend says, times, values, colour, and the quantity of the history it comes from."""

    text: str
    t: np.ndarray
    y: np.ndarray
    colour: str
    source: str


@dataclass(frozen=True)
class Panel:
    """A set of axes: title, name and unit of the values, curves; `motion` panels carry the marks of the impacts."""

    title: str
    quantity: str
    unit: str
    lines: tuple[Line, ...]
    motion: bool = True


def panels(results: Results, names: list[str]) -> list[Panel]:
    """The motion of these bodies, as travel or as turn, then the books of energy, or else what the drive must push."""
    turning = bool(names) and all(turns(results, name) for name in names)
    motion = _turn(results, names) if turning else _travel(results, names) if names else []
    balance = _energy(results) or _residual(results, names, turning)
    return motion + ([balance] if balance else [])


def shown_axis(results: Results, names: list[str]) -> tuple[int, float]:
    """The direction to show: up, or where the bodies go if they hardly rise or fall."""
    axis, up = vertical_axis(results)
    if not names:
        return axis, up
    travel = np.max([np.ptp(results.curve(f"bodies/{n}/position").y, axis=0) for n in names], axis=0)
    return (axis, up) if travel[axis] >= SIDEWAYS * travel.max() else (int(travel.argmax()), 1.0)


def colours_of(results: Results, names: list[str]) -> dict[str, str]:
    """As in the pictures."""
    numbers = [results.bodies[name] for name in names]
    colours = body_colours(list(results.bodies.values()), numbers)
    return {name: colours[number] for name, number in zip(names, numbers, strict=True)}


def _travel(results: Results, names: list[str]) -> list[Panel]:
    """Position and velocity along one axis, a curve for each body."""
    axis, up = shown_axis(results, names)
    upright = (axis, up) == vertical_axis(results) and up > 0
    letter = "xyz"[axis]
    words = {
        "position": ("Height against time", f"height {letter}"),
        "velocity": ("Vertical velocity against time", f"vertical velocity {letter}"),
    }
    shown = []
    for quantity, (title, name) in words.items():
        curves = {body: results.curve(f"bodies/{body}/{quantity}") for body in names}
        if not upright:
            title, name = f"{quantity.capitalize()} {letter} against time", f"{quantity} {letter}"
        values = {body: curve.y[:, axis] for body, curve in curves.items()}
        shown.append(_by_body(results, title, name, curves, values))
    return shown


def _turn(results: Results, names: list[str]) -> list[Panel]:
    """The angle turned, and the angular velocity: of one body x, y, z, of several that about their axes."""
    speeds = {body: results.curve(f"bodies/{body}/angular_velocity") for body in names}
    turned = {body: results.curve(f"bodies/{body}/orientation") for body in names}
    axes = {body: fixed_axis(curve.y) for body, curve in speeds.items()}
    angles = {body: angle_turned(c.t, c.y, speeds[body].y) for body, c in turned.items()}
    hinged = all(axis is not None for axis in axes.values())
    title = "Angle turned about the axis" if hinged else "Angle to the first orientation"
    angle = _by_body(results, title, "angle", turned, angles, "degrees")
    if len(names) == 1:
        return [angle, _by_component("Angular velocity", "angular velocity", speeds[names[0]])]
    about = {b: np.linalg.norm(c.y, axis=1) if axes[b] is None else c.y @ axes[b] for b, c in speeds.items()}
    title = "Angular velocity about the axis" if hinged else "Angular speed"
    return [angle, _by_body(results, title, "angular velocity", speeds, about)]


def _energy(results: Results) -> Panel | None:
    """All books of energy that are not zero throughout, what moves first; None without any."""
    names = [name for name in results.quantities if name.startswith("energy/")]
    curves = [results.curve(name) for name in sorted(names, key=lambda name: (name not in FIRST, name))]
    curves = _visible(curves)
    if not curves:
        return None
    lines = [
        Line(_energy_name(c.name), c.t, c.y[:, 0], COLOURS[k % len(COLOURS)], c.name) for k, c in enumerate(curves)
    ]
    return Panel("Energy", "energy", curves[0].unit, tuple(lines), motion=False)


def _energy_name(name: str) -> str:
    name = name.split("/")[1].replace("_", " ")
    return {"impacts": "lost in impacts", "dissipated": "lost in friction"}.get(name, name)


def _residual(results: Results, names: list[str], turning: bool) -> Panel | None:
    """What keeps the prescribed motions: torques about the axes of bodies that turn, else forces along the axis shown.

    Where nothing acts along that axis, along the one with the largest force.
    """
    what = "residual_torque" if turning else "residual_force"
    there = [name for body in names if (name := f"bodies/{body}/{what}") in results.file]
    curves = {curve.name.split("/")[1]: curve for curve in _visible([results.curve(name) for name in there])}
    if not curves:
        return None
    if turning and len(curves) == 1:
        return _by_component("Torque that keeps the motion", "residual torque", next(iter(curves.values())), False)
    largest = np.max([np.abs(curve.y).max(axis=0) for curve in curves.values()], axis=0)
    axis, _ = shown_axis(results, names)
    if turning or largest[axis] <= INVISIBLE * largest.max():
        axis = int(largest.argmax())
    values = {body: curve.y[:, axis] for body, curve in curves.items()}
    title = f"{'Torque' if turning else 'Force'} {'xyz'[axis]} that keeps the motion"
    return _by_body(results, title, f"{what} {'xyz'[axis]}", curves, values, motion=False)


def _visible(curves: list[Curve]) -> list[Curve]:
    largest = max((np.abs(curve.y).max(initial=0.0) for curve in curves), default=0.0)
    return [curve for curve in curves if np.abs(curve.y).max(initial=0.0) > INVISIBLE * largest]


def _by_body(
    results: Results,
    title: str,
    quantity: str,
    curves: dict[str, Curve],
    values: dict[str, np.ndarray],
    unit: str | None = None,
    motion: bool = True,
) -> Panel:
    colours = colours_of(results, list(curves))
    lines = [Line(body, c.t, values[body], colours[body], c.name) for body, c in curves.items()]
    first = next(iter(curves.values()))
    return Panel(title, quantity, first.unit if unit is None else unit, tuple(lines), motion)


def _by_component(title: str, quantity: str, curve: Curve, motion: bool = True) -> Panel:
    lines = [Line(c, curve.t, curve.y[:, k], COLOURS[k], curve.name) for k, c in enumerate(curve.columns)]
    return Panel(title, quantity, curve.unit, tuple(lines), motion)
