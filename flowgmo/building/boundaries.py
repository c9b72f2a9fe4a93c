"""&BCDATA -> the six SidePlans.

All tables of a side are brought to common times: the union of their own, which keeps piecewise linear tables as they
are. What has no effect at a side of its kind is left out (deck/rules_fluid.py tells the user).
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.body import Body
from flowgmo.building.findings import Findings
from flowgmo.deck import Deck
from flowgmo.flow_plan import SidePlan
from flowgmo.mesh import CONTINUATIVE, OUTFLOW, PRESSURE, VELOCITY, WALL, Mesh

BALANCE = 1e-6  # of the flow: what the pressure solution leaves (EPSADJ = 1), and decks' numbers have as many digits
FREE = (CONTINUATIVE, PRESSURE, OUTFLOW)  # kinds through which as much passes as must


def build_sides(found: Findings, mesh: Mesh, void_pressure: float) -> tuple[SidePlan, ...]:
    """What holds at each side of the domain; pressures relative to void_pressure."""
    return tuple(_side(found.deck, side.number, side.kind, void_pressure) for side in mesh.sides)


def _side(deck: Deck, number: int, kind: int, void_pressure: float) -> SidePlan:
    n = number + 1
    wanted: dict[str, str] = {}  # field of the plan: the deck's table
    if kind in (WALL, VELOCITY):
        wanted |= {"u": "UBCT", "v": "VBCT", "w": "WBCT"}
    if kind == PRESSURE:
        wanted["pressure"] = "PBCT"
    if kind in (PRESSURE, VELOCITY):
        wanted["height" if deck.at("IHPBCT", n) == 1 else "fraction"] = "FLHTBCT" if deck.at("IHPBCT", n) else "FBCT"
    series = {name: deck.series(table, n) for name, table in wanted.items()}
    t = np.unique(np.concatenate([s.t for s in series.values()])) if series else np.zeros(1)
    tables = {name: np.interp(t, s.t, s.y) for name, s in series.items()}
    velocity = np.array([tables.pop(name) for name in "uvw" if name in tables]).T
    if "pressure" in tables:
        tables["pressure"] = tables["pressure"] - void_pressure
    return SidePlan(
        number=number,
        kind=kind,
        t=t,
        velocity=velocity if velocity.any() or kind == VELOCITY else None,  # a wall at rest has none
        stagnation=kind == PRESSURE and deck.at("IPBCTP", n) == 1,
        **tables,
    )


def check_directions(found: Findings, mesh: Mesh) -> None:
    """Problems: nothing can flow in a direction with one cell, so that a side across it is closed, or the mesh is."""
    deck, shape = found.deck, mesh.blocks[0].shape
    if max(shape) == 1:
        place, write = ("PX", 2) if deck.given("PX", 2) else ("SIZE",), "Give nxcelt, nycelt, nzcelt, or size"
        for name, follows in (("NTOTAL", 0), ("SIZE", 1)):
            if (deck[name] or 0.0) > 0.0 and deck["IF_SIZE"] != follows:
                place, write = (name,), f"Write if_size={follows}, with which cells follow {name.lower()}"
        found.problem(*place, wrong="the mesh is one cell, in which nothing flows", write=write)
        return
    for axis in (axis for axis in range(3) if shape[axis] == 1):
        letter = "xyz"[axis]
        for side in (side for side in mesh.sides[2 * axis : 2 * axis + 2] if side.kind in (*FREE, VELOCITY)):
            found.problem(
                "IBCT", side.number + 1,
                wrong=f"the mesh has one cell in {letter}, so that nothing flows through {side.name}",
                write=f"Write ibct({side.number + 1})=1, or n{letter}celt=2 or more",
            )  # fmt: skip
        for name in (f"{'UVW'[axis]}I", f"G{letter.upper()}"):
            if deck[name] != 0.0:
                found.notice(name, wrong=f"the mesh has one cell in {letter}, so that this moves no liquid")


def check_balance(found: Findings, sides: tuple[SidePlan, ...], mesh: Mesh, bodies: tuple[Body, ...]) -> None:
    """Problem: what velocity sides bring into a domain that is full, and full of what does not give way, goes nowhere.

    Nothing is said where a solid may cover a part of a velocity side: then only the open fractions know the flow.
    """
    giving = [side for side in sides if side.kind == VELOCITY and mesh.blocks[0].shape[side.axis] > 1]
    if not giving or any(side.kind in FREE for side in sides):
        return
    if any(_covers(body, side, mesh) for body in bodies for side in giving):
        return
    extent = np.ptp(mesh.bounds, axis=0)
    times = np.unique(np.concatenate([side.t for side in giving]))
    inflow = np.zeros((len(giving), len(times)))
    for row, side in zip(inflow, giving, strict=True):
        area = np.prod(np.delete(extent, side.axis))
        row[:] = np.interp(times, side.t, side.velocity[:, side.axis]) * (-area if side.upper else area)
    net = inflow.sum(axis=0)
    worst = int(np.argmax(np.abs(net)))
    if abs(net[worst]) <= BALANCE * np.abs(inflow).sum(axis=0).max():
        return
    side = giving[int(np.argmax(np.abs(inflow[:, worst])))]
    name = "UVW"[side.axis] + "BCT"
    index = next((i for i in found.deck.indices(name) if i[1] == side.number + 1), (1, side.number + 1))
    found.problem(
        name, *index,
        wrong=f"more enters the domain than leaves it, {net[worst]:.4g} in a unit of time at t={times[worst]:.4g}, and "
        "it is full of liquid that does not give way",
        write="Write velocities that balance, or let a side be open, ibct(n)=5 or 8",
    )  # fmt: skip


def _covers(body: Body, side: SidePlan, mesh: Mesh) -> bool:
    """Whether a body reaches a side of the domain."""
    bounds = body.shape.bounds()
    if side.upper:
        return bool(bounds[1, side.axis] >= mesh.bounds[1, side.axis])
    return bool(bounds[0, side.axis] <= mesh.bounds[0, side.axis])
