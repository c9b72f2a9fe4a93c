"""The tables of the log: what a scene holds before a run, what it cost after."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from rich import box
from rich.console import RenderableType
from rich.markup import escape
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from flowgmo.bodies.body import FIXED_AXIS, FIXED_POINT, Body
from flowgmo.mesh import SIDE_KINDS
from flowgmo.model import Model
from flowgmo.output.units import unit

MOST_BODIES = 40  # rows of a table; a rack of bodies does not scroll the rest away
FREEDOMS = ("x", "y", "z", "turn x", "turn y", "turn z")  # of Body.drives
GAP = (1, 0, 0, 0)


def title(model: Model, version: str) -> Text:
    return Text.assemble((model.title or model.stem, "bold"), (f"   flowgmo {version}".rstrip(), "dim"))


def domain(model: Model) -> RenderableType:
    """Bounds and sides; cells only where something is computed on them."""
    length, lines = unit("length", model.units), []
    for axis, name in enumerate("xyz"):
        lo, hi = model.mesh.bounds[:, axis]
        kinds = [SIDE_KINDS.get(side.kind, str(side.kind)) for side in model.mesh.sides[2 * axis : 2 * axis + 2]]
        lines.append(f"  {name}  {lo:.6g} … {hi:.6g} {length}   {' | '.join(kinds)}")
    nx, ny, nz = model.mesh.blocks[0].shape
    cells = f"{model.mesh.cells:,} cells ({nx} × {ny} × {nz})" + ("" if model.fluid else ", none computed: no liquid")
    gravity = ", ".join(f"{g:.6g}" for g in model.gravity)
    lines.append(f"  {cells}")
    lines.append(f"  gravity ({gravity}) {unit('acceleration', model.units)}")
    lines.append(f"  end at t = {model.clock.end:.6g} {unit('time', model.units)}")
    return Text("\n".join(lines))


def bodies(model: Model) -> RenderableType:
    mass, inertia = unit("mass", model.units), unit("inertia", model.units)
    heads = (f"mass [{mass}]", "right"), (f"principal moments [{inertia}]", "right")
    table = _table("", "body", "kind", "moves with", *heads)
    for body in model.bodies[:MOST_BODIES]:
        table.add_row(str(body.number), escape(body.name), body.kind, _freedom(body), *_mass(body))
    if len(model.bodies) > MOST_BODIES:
        table.add_row("", f"… and {len(model.bodies) - MOST_BODIES} more")
    return _below(table)


def _freedom(body: Body) -> str:
    """The constraint; of a coupled body that a deck moves in part also what is left to its loads."""
    if not body.moves:
        return "–"
    first = 3 if body.constraint == FIXED_POINT else 0
    coupled = [drive.coupled for drive in body.drives[first:]]
    if body.constraint == FIXED_AXIS or all(coupled) or not any(coupled):
        return body.constraint
    free = [name for name, is_free in zip(FREEDOMS[first:], coupled, strict=True) if is_free]
    return f"{body.constraint}, {', '.join(free)} free"


def _mass(body: Body) -> tuple[str, str]:
    if body.mass is None:
        return "–", "–"
    mass = f"{body.mass.mass:.6g}"
    if body.constraint == FIXED_AXIS and body.mass.axis_moment is not None:
        return mass, f"{body.mass.axis_moment:.6g} about the axis"
    if body.mass.inertia is None:
        return mass, "–"
    return mass, "  ".join(f"{moment:.6g}" for moment in np.linalg.eigvalsh(body.mass.inertia))


def effects(model: Model) -> RenderableType:
    table = _table("effect", "what", "because")
    for effect in model.effects:
        table.add_row(effect.name, escape(effect.what), escape(effect.because))
    if not model.effects:
        table.add_row("none", "", "")
    return _below(table)


def notice(text: str) -> RenderableType:
    return Text.assemble(("notice  ", "yellow"), text)


def footer(summary: dict, units: str) -> Iterator[RenderableType]:
    """The end of the log; keys as in summary.write_run_json, those absent are left out."""
    colour = {"done": "green", "failed": "red"}.get(summary["status"], "yellow")
    reason = f": {summary['reason']}" if summary.get("reason") else ""
    yield _below(Text.assemble((summary["status"], f"bold {colour}"), reason))
    yield _facts(summary)
    if summary.get("effects"):
        yield _below(_effects_cost(summary["effects"]))
    if summary.get("liquid"):
        yield _below(_liquid(summary["liquid"], units))
    if summary.get("forces"):
        yield _below(_forces(summary["forces"], unit("force", units), unit("time", units)))
    if summary.get("energy"):
        yield _below(_energy(summary["energy"], unit("energy", units)))
    collisions = summary.get("collisions") or {}
    if collisions.get("per_body"):
        yield _below(_collisions(collisions, unit("impulse", units)))
    limits = summary.get("limits") or ()
    if limits:
        yield Text()
    yield from (notice(str(limit)) for limit in limits)


def _facts(summary: dict) -> RenderableType:
    wall, steps = summary.get("wall_seconds"), summary.get("steps", 0)
    facts = [f"t = {summary.get('t', float('nan')):.6g}", f"{steps} steps"]
    if wall is not None:
        facts.append(f"{duration(wall)} wall time" + (f", {duration(wall / steps)} a step" if steps else ""))
    if summary.get("peak_memory_bytes"):
        facts.append(f"peak memory {summary['peak_memory_bytes'] / 2**20:.0f} MiB")
    if summary.get("volume_error") is not None and not summary.get("liquid"):
        facts.append(f"volume error {summary['volume_error']:.2e}")
    total = (summary.get("collisions") or {}).get("total")
    if total is not None and (total or not summary.get("liquid")):
        facts.append(f"{total} impacts")
    return Text("  ·  ".join(facts))


def _effects_cost(costs: dict) -> Table:
    table = _table("time in", ("seconds", "right"), ("share", "right"))
    for name, cost in sorted(costs.items(), key=lambda item: -item[1]["seconds"]):
        table.add_row(escape(name), f"{cost['seconds']:.3f}", f"{100 * cost['share']:.1f} %")
    return table


def _liquid(liquid: dict, units: str) -> Table:
    """Volume and energies at the end, what bounded the steps, how the pressure was solved (flow/observe/tally.py)."""
    table = _table("liquid", ("", "right"))
    for name in ("volume", "kinetic_energy", "potential_energy", "dissipated", "work_boundaries"):
        if liquid.get(name) is not None:
            quantity = "volume" if name == "volume" else "energy"
            table.add_row(name.replace("_", " "), f"{liquid[name]:.6g} {unit(quantity, units)}")
    if liquid.get("volume_error") is not None:
        table.add_row("volume error", f"{liquid['volume_error']:.2e}")
    pressure = liquid.get("pressure") or {}
    if pressure.get("solutions"):
        table.add_row("pressure iterations", f"{pressure['mean']:.1f} mean, {pressure['most']} most")
    courant = liquid.get("courant") or {}
    if courant.get("most") is not None:
        table.add_row("Courant number", f"{courant['mean']:.3f} mean, {courant['most']:.3f} most")
    shares = liquid.get("steps_bounded_by") or {}
    if shares:
        table.add_row("steps bounded by", ", ".join(f"{name} {100 * share:.0f} %" for name, share in shares.items()))
    if liquid.get("shortened"):
        table.add_row("steps tried again, shorter", str(liquid["shortened"]))
    return table


def _forces(forces: dict, of: str, time: str) -> Table:
    """The liquid's force on moving bodies over the time that it touches them (flow/observe/spikes.py)."""
    heads = (f"median [{of}]", "right"), ("99 % below", "right"), ("largest", "right"), (f"at t [{time}]", "right")
    table = _table("force of the liquid on", *heads)
    for name, size in list(forces.items())[:MOST_BODIES]:
        shown = (f"{size[key]:.4g}" for key in ("median", "quantile_99", "largest"))
        table.add_row(escape(name), *shown, f"{size['time']:.6g}")
    if len(forces) > MOST_BODIES:
        table.add_row(f"… and {len(forces) - MOST_BODIES} more")
    return table


def _energy(energy: dict, of: str) -> Table:
    table = _table("energy", (f"[{of}]", "right"))
    for name, value in energy.items():
        table.add_row(name.replace("_", " "), "–" if value is None else f"{value:.6g}")
    return table


def _collisions(collisions: dict, of: str) -> Table:
    table = _table("impacts of", ("count", "right"), (f"sum of impulses [{of}]", "right"))
    for name, of in list(collisions["per_body"].items())[:MOST_BODIES]:
        table.add_row(escape(name), str(of["count"]), f"{of['impulse']:.6g}")
    if len(collisions["per_body"]) > MOST_BODIES:
        table.add_row(f"… and {len(collisions['per_body']) - MOST_BODIES} more")
    return table


def duration(seconds: float) -> str:
    """Wall time in the unit that reads best."""
    if seconds >= 120:
        minutes, rest = divmod(int(round(seconds)), 60)
        return f"{minutes // 60} h {minutes % 60} min" if minutes >= 60 else f"{minutes} min {rest} s"
    for size, name in ((1.0, "s"), (1e-3, "ms")):
        if seconds >= size:
            return f"{seconds / size:.3g} {name}"
    return f"{seconds / 1e-6:.3g} µs"


def _below(what: RenderableType) -> RenderableType:
    """With an empty line above."""
    return Padding(what, GAP, expand=False)


def _table(*columns: str | tuple[str, str]) -> Table:
    table = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1), show_edge=False)
    for column in columns:
        name, justify = (column, "left") if isinstance(column, str) else column
        table.add_column(escape(name), justify=justify)
    return table
