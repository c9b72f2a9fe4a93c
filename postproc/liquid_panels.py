"""Which curves of the liquid a report shows, as plain data: gauges, flow through planes, forces, energy, volume."""

from __future__ import annotations

import numpy as np

from postproc.palette import COLOURS, INK
from postproc.panels import Line, Panel
from postproc.results import Results

MOST_CURVES = 6  # curves that an eye can follow
LEVEL = 1e-6  # of its largest value; a curve that changes less says nothing


def liquid_panels(results: Results) -> list[Panel]:
    """Panels of what the history holds of a liquid; [] in a dry scene."""
    if "fluid/volume" not in results.file:
        return []
    gauges = [
        _gauges(results, "probes", "p", "Pressure at the probes", "pressure"),
        _gauges(results, "probes", "height", "Surface at the probes", "height z"),
        _gauges(results, "planes", "flow", "Flow through the planes", "flow"),
        _forces(results),
    ]
    full = "fluid/volume_error" not in results.file  # no surface: the volume is that of the space
    volume = None if full else _volume(results)
    return [panel for panel in (*gauges, _energy(results), volume) if panel is not None]


def _gauges(results: Results, group: str, name: str, title: str, quantity: str) -> Panel | None:
    """One quantity of all probes or planes, by their numbers."""
    there = sorted(results.file.get(group, {}), key=int)
    curves = {number: results.curve(f"{group}/{number}/{name}") for number in there[:MOST_CURVES]}
    lines = tuple(
        Line(f"{group[:-1]} {number}", c.t, c.y[:, 0], COLOURS[k], c.name)
        for k, (number, c) in enumerate(curves.items())
    )
    if not any(_varies(line.y) for line in lines):
        return None
    note = f"{title}: the first {MOST_CURVES} of {len(there)}" if len(there) > MOST_CURVES else ""
    return Panel(title, quantity, results.curve(lines[0].source).unit, lines, False, note)


def _forces(results: Results) -> Panel | None:
    """Components of the liquid's force on bodies that stand still; of several bodies the largest component of each."""
    names = [name for name in results.file.get("bodies", {}) if name not in results.bodies]
    curves = {name: results.curve(f"bodies/{name}/force") for name in names if f"bodies/{name}/force" in results.file}
    if not curves:
        return None
    if len(curves) == 1:
        name, curve = next(iter(curves.items()))
        lines = [Line(c, curve.t, curve.y[:, k], COLOURS[k], curve.name) for k, c in enumerate("xyz")]
        title = f"Force of the liquid on {name}"
    else:
        chosen = {name: int(np.ptp(c.y, axis=0).argmax()) if len(c.y) else 0 for name, c in curves.items()}
        lines = [
            Line(f"{name} {'xyz'[chosen[name]]}", c.t, c.y[:, chosen[name]], COLOURS[k], c.name)
            for k, (name, c) in enumerate(list(curves.items())[:MOST_CURVES])
        ]
        title = "Force of the liquid on what stands still"
    return Panel(title, "force", next(iter(curves.values())).unit, tuple(lines), False)


def _energy(results: Results) -> Panel:
    """Kinetic energy; where it changes potential energy from its start, and their sum."""
    kinetic, potential = (results.curve(f"fluid/{name}_energy") for name in ("kinetic", "potential"))
    change = potential.y[:, 0] - potential.y[0, 0]
    rows = min(len(kinetic.y), len(change))
    moving = Line("kinetic", kinetic.t, kinetic.y[:, 0], COLOURS[0], kinetic.name)
    if not change.any():
        return Panel("Kinetic energy of the liquid", "energy", kinetic.unit, (moving,), False, "")
    lines = (
        moving,
        Line("potential", potential.t, change, COLOURS[1], potential.name),
        Line("sum", kinetic.t[:rows], kinetic.y[:rows, 0] + change[:rows], INK, "fluid/energy"),
    )
    note = "Energy of the liquid: potential energy counts from the start"
    return Panel("Energy of the liquid", "energy", kinetic.unit, lines, False, note)


def _volume(results: Results) -> Panel:
    """The volume, and what came in through open sides."""
    volume = results.curve("fluid/volume")
    lines = [Line("liquid", volume.t, volume.y[:, 0], COLOURS[0], volume.name)]
    for k, side in enumerate(results.file.get("boundaries", {})):
        c = results.curve(f"boundaries/{side}/volume")
        if c.y.any():
            lines.append(Line(f"in through {side}", c.t, c.y[:, 0], COLOURS[1 + k], c.name))
    error = np.abs(results.curve("fluid/volume_error").y).max(initial=0.0)
    note = f"Volume: the books close but for {error:.0e}" if error else "Volume: the books close exactly"
    return Panel("Volume of the liquid", "volume", volume.unit, tuple(lines), False, note)


def _varies(y: np.ndarray) -> bool:
    return len(y) > 0 and float(np.ptp(y)) > LEVEL * float(np.abs(y).max())
