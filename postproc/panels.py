"""Which curves a report shows, as plain data: two panels of motion, and one of what drives it or what it costs."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from postproc.bounces import bouncing_body, vertical_axis
from postproc.impacts import hits
from postproc.look import body_colours
from postproc.palette import COLOURS, INK
from postproc.results import Curve, Results
from postproc.steps import stepped
from postproc.turning import angle_turned, fixed_axis, turns

#: Books of energy -> what the legend says, colour (the same in every report), sign in the sum that stays the same.
BOOKS = {
    "kinetic": ("kinetic", COLOURS[0], 1),
    "potential": ("potential", COLOURS[1], 1),
    "impacts": ("lost in impacts", COLOURS[3], 1),
    "dissipated": ("lost in friction", COLOURS[2], 1),
    "work_prescribed": ("work of drives", COLOURS[4], -1),
    "work_loads": ("work of control loads", COLOURS[5], -1),
    "work_boundaries": ("work at boundaries", COLOURS[7], -1),
}
SIDEWAYS = 0.25  # bodies that rise less than this part of their largest travel are shown along that travel instead
INVISIBLE = 1e-6  # of the largest value in the panel
THIN = 0.004  # of the same: the width of a line


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
    note: str = ""


def panels(results: Results, names: list[str]) -> list[Panel]:
    """The motion of these bodies, as travel or as turn, then the books of energy, or else what the drive must push."""
    turning = bool(names) and all(turns(results, name) for name in names)
    motion = _turn(results, names) if turning else _travel(results, names) if names else []
    balance = _energy(results) or _residual(results, names, turning)
    return motion + ([balance] if balance else [])


def shown_axis(results: Results, names: list[str]) -> tuple[int, float]:
    """The direction to show: up, or where the bodies go if they rise or fall much less; up of one that bounces."""
    axis, up = vertical_axis(results)
    if not names or bouncing_body(results) is not None:
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
    shown[1] = replace(
        shown[1], lines=tuple(_jumping(line, results, results.bodies[line.text]) for line in shown[1].lines)
    )
    return shown


def _jumping(line: Line, results: Results, body: int | None = None) -> Line:
    """A curve that jumps at the impacts of a body, or at all."""
    found = hits(results)
    times = found.time if body is None else found.time[(found.a == body) | (found.b == body)]
    t, y = stepped(line.t, line.y, np.unique(times))
    return replace(line, t=t, y=y)


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
    """The books of energy that can be seen, and their sum: level where they close. None where all are zero.

    kinetic + potential + lost in impacts + lost in friction - work put in = its value at the start + remainder
    """
    there = {name: results.curve(f"energy/{name}") for name in BOOKS if f"energy/{name}" in results.file}
    if "potential" in there:
        y = there["potential"].y
        there["potential"] = replace(there["potential"], y=y - y[:1])
    largest = max((np.abs(curve.y).max(initial=0.0) for curve in there.values()), default=0.0)
    if largest == 0:
        return None
    seen = {name: curve for name, curve in there.items() if np.abs(curve.y).max() > THIN * largest}
    lines = [Line(BOOKS[name][0], c.t, c.y[:, 0], BOOKS[name][1], c.name) for name, c in seen.items()]
    first = next(iter(seen.values()))
    title = "Energy of bodies and liquid" if "fluid/volume" in results.file else "Energy"
    missed = results.curve("energy/remainder") if "energy/remainder" in results.file else None
    if missed is not None and np.abs(missed.y).max(initial=0.0) > THIN * largest:  # the sum, from its start
        lines.append(Line("remainder", missed.t, missed.y[:, 0], INK, missed.name))
    elif len(lines) > 1:
        rows = min(len(curve.t) for curve in there.values())
        total = sum(BOOKS[name][2] * curve.y[:rows, 0] for name, curve in there.items())
        worked = any(BOOKS[name][2] < 0 for name in seen)
        lines.append(Line("sum less work" if worked else "sum", first.t[:rows], total, INK, "energy/sum"))
    lines = [_jumping(line, results) for line in lines]
    return Panel(title, "energy", first.unit, tuple(lines), False, _energy_note(results, lines, largest))


def _energy_note(results: Results, lines: list[Line], largest: float) -> str:
    """What the panel means, and what the books miss as part of the largest energy."""
    texts = [line.text for line in lines]
    note = ["potential energy counts from the start"] if "potential" in texts else []
    if "energy/remainder" in results.file:
        missed = np.abs(results.curve("energy/remainder").y).max(initial=0.0) / largest
        less = " − work" if any(BOOKS[name][2] < 0 for name in BOOKS if f"energy/{name}" in results.file) else ""
        if "remainder" in texts:
            note += [f"remainder: what the books miss, the change of kinetic + potential + lost{less}"]
            return "Energy: " + "; ".join(note)
        to = f"but for {missed:.0e} of the largest" if missed else "exactly"
        note += [f"kinetic + potential + lost{less} stays the same {to}"]
    return "Energy: " + "; ".join(note) if note else ""


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
