"""Which curves a report shows of bodies that move in a liquid, as plain data: small panels, one for each component.

Where they go and turn, as far as the panels of motion do not say it; what the liquid does to them. Of one body the
force is split into what pressure, shear and films make; of several bodies shear and film have panels of their own.
"""

from __future__ import annotations

import numpy as np

from postproc.palette import COLOURS, INK
from postproc.panels import Line, Panel, colours_of
from postproc.results import Curve, Results
from postproc.turning import LEAST_TURN, angle_turned, fixed_axis

PART = 0.03  # of the largest component, or of the whole force; less is not seen beside it
NOTE = "Forces and torques are the liquid's, means over a step, impacts apart; torques about the body's point"
SPLIT = {
    "force": ("whole", INK),
    "force_pressure": ("pressure", COLOURS[0]),
    "force_shear": ("shear", COLOURS[2]),
    "force_film": ("film", COLOURS[1]),
}
OWN = {"force_shear": "Shear force", "force_film": "Film force"}


def body_panels(results: Results, names: list[str], shown: list[Panel]) -> list[Panel]:
    """Panels of bodies in a liquid beyond the panels `shown` already; [] in a dry scene."""
    wet = [name for name in names if f"bodies/{name}/force" in results.file]
    if not wet:
        return []
    there = {(line.source, panel.quantity) for panel in shown for line in panel.lines}
    return [
        *_ways(results, wet, there),
        *_components(results, wet, "velocity", "Velocity", there),
        *_turns(results, wet, there),
        *_forces(results, wet),
        *_components(results, wet, "torque", "Torque", there, _torque_of_force(results, wet)),
        *_area(results, wet),
        *_drives(results, wet),
    ]


def _components(
    results: Results, names: list[str], quantity: str, title: str, there: set, whole: float = 0.0
) -> list[Panel]:
    """x, y, z of a vector, a curve for each body; without those that are too small to see, or shown already.

    whole: the size beside which they are seen, if not their own.
    """
    curves = [results.curve(f"bodies/{name}/{quantity}") for name in names]
    sizes = [max(_size(c.y[:, k]) for c in curves) for k in range(3)]
    return [
        _by_body(results, f"{title} {letter}", f"{title.lower()} {letter}", curves, [c.y[:, k] for c in curves])
        for k, letter in enumerate("xyz")
        if sizes[k] > PART * max(*sizes, whole) and not _known(curves[0], letter, there)
    ]


def _known(curve: Curve, letter: str, there: set) -> bool:
    """Whether a component is in one of the panels that are shown already."""
    what = curve.name.rsplit("/", 1)[-1]
    return any((curve.name, f"{word} {letter}") in there for word in (what, "height", f"vertical {what}"))


def _ways(results: Results, names: list[str], there: set) -> list[Panel]:
    """How far bodies went from where they were at the start; where they are says nothing unless they go."""
    curves = [results.curve(f"bodies/{name}/position") for name in names]
    ways = [c.y - c.y[:1] for c in curves]
    sizes = [max(_size(way[:, k]) for way in ways) for k in range(3)]
    return [
        _by_body(results, f"Way {letter}", f"way {letter}", curves, [way[:, k] for way in ways])
        for k, letter in enumerate("xyz")
        if sizes[k] > PART * max(sizes) and not _known(curves[0], letter, there)
    ]


def _torque_of_force(results: Results, names: list[str]) -> float:
    """The largest force at the arm of a wall as large as what is wet: torques far below are a sum's rounding."""
    forces = [_size(results.curve(f"bodies/{name}/force").y) for name in names]
    areas = [results.curve(n).y for name in names if (n := f"bodies/{name}/wetted_area") in results.file]
    return max(forces) * max((_size(a) for a in areas), default=0.0) ** 0.5


def _size(y: np.ndarray) -> float:
    return float(np.abs(y).max(initial=0.0))


def _by_body(
    results: Results, title: str, quantity: str, curves: list[Curve], values: list[np.ndarray], unit: str | None = None
) -> Panel:
    names = [curve.name.split("/")[1] for curve in curves]
    colours = colours_of(results, names)
    lines = [Line(n, c.t, y, colours[n], c.name) for n, c, y in zip(names, curves, values, strict=True)]
    return Panel(title, quantity, curves[0].unit if unit is None else unit, tuple(lines))


def _turns(results: Results, names: list[str], there: set) -> list[Panel]:
    """The angle turned and the angular velocity, of one body by components, of several as their sizes."""
    curves = [results.curve(f"bodies/{name}/orientation") for name in names]
    speeds = [results.curve(f"bodies/{name}/angular_velocity") for name in names]
    angles = [angle_turned(c.t, c.y[: len(w.y)], w.y) for c, w in zip(curves, speeds, strict=True)]
    most = max(np.abs(a).max(initial=0.0) for a in angles)
    if most < np.degrees(LEAST_TURN) or (curves[0].name, "angle") in there:
        return []
    hinged = all(fixed_axis(w.y) is not None or not w.y.any() for w in speeds)
    title = "Angle about the axis" if hinged else "Angle to the start"
    panels = [_by_body(results, title, "angle", curves, angles, "degrees")]
    if len(names) > 1:
        sizes = [np.linalg.norm(w.y, axis=1) for w in speeds]
        return [*panels, _by_body(results, "Angular speed", "angular speed", speeds, sizes)]
    spins = speeds[0].y
    seen = [k for k in range(3) if np.abs(spins[:, k]).max() > PART * np.abs(spins).max()]
    lines = tuple(Line("xyz"[k], speeds[0].t, spins[:, k], COLOURS[k], speeds[0].name) for k in seen)
    letter = f" {lines[0].text}" if len(lines) == 1 else ""
    return [*panels, Panel(f"Angular velocity{letter}", "angular velocity", speeds[0].unit, lines)]


def _forces(results: Results, names: list[str]) -> list[Panel]:
    """x, y, z of the liquid's force; its parts where they can be seen."""
    whole = [results.curve(f"bodies/{name}/force") for name in names]
    largest = max(_size(c.y) for c in whole)
    parts = {}
    for part in SPLIT:
        curves = [results.curve(n) for name in names if (n := f"bodies/{name}/{part}") in results.file]
        if any(_size(c.y) > PART * largest for c in curves):
            parts[part] = curves
    panels = _components(results, names, "force", "Force", set())
    if not set(parts) & set(OWN):
        return panels
    if len(names) == 1:
        return [_split(panel, {part: curves[0] for part, curves in parts.items()}) for panel in panels]
    return panels + [
        panel
        for part in OWN
        if part in parts
        for panel in _components(results, [c.name.split("/")[1] for c in parts[part]], part, OWN[part], set(), largest)
    ]


def _split(panel: Panel, parts: dict[str, Curve]) -> Panel:
    """One body's panel of a component, with the parts of the force in place of the whole alone."""
    k = "xyz".index(panel.quantity[-1])
    lines = tuple(Line(SPLIT[part][0], c.t, c.y[:, k], SPLIT[part][1], c.name) for part, c in parts.items())
    return Panel(panel.title, panel.quantity, panel.unit, lines)


def _area(results: Results, names: list[str]) -> list[Panel]:
    """The wetted area, where it changes."""
    curves = [results.curve(n) for name in names if (n := f"bodies/{name}/wetted_area") in results.file]
    values = [c.y[:, 0] for c in curves]
    if not any(np.ptp(y) > PART * _size(y) for y in values if len(y)):
        return []
    return [_by_body(results, "Wetted area", "area", curves, values)]


def _drives(results: Results, names: list[str]) -> list[Panel]:
    """What keeps prescribed motions, where it is more than the opposite of what the liquid does: mass has a part."""
    panels = []
    for what, load, title in (
        ("residual_force", "force", "Drive force"),
        ("residual_torque", "torque", "Drive torque"),
    ):
        there = [name for name in names if f"bodies/{name}/{what}" in results.file]
        pairs = [[results.curve(f"bodies/{name}/{part}").y for part in (what, load)] for name in there]
        if any(_size(drive + liquid) > PART * max(_size(drive), _size(liquid)) for drive, liquid in pairs):
            panels += _components(results, there, what, title, set())
    return panels
