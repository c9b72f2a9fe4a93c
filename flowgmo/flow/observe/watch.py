"""All that is recorded of the liquid, at one instant: a flat dict of numbers with the names of history.h5.

    fluid/volume  fluid/volume_error  fluid/kinetic_energy  fluid/potential_energy  fluid/wet_share
    fluid/dissipated  fluid/work_boundaries (of sides that slide or are open)
    boundaries/Xmin/volume ...        planes/1/flow ...
    probes/1/p  .../u v w F height    bodies/NAME/force  .../torque force_pressure force_shear wetted_area

Measuring is done at the ends of those steps only in which a row of the history lies; the row is linear between them.
What was measured at the end of one step is kept for the start of the next.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from flowgmo.flow.columns import all_columns
from flowgmo.flow.fields import Flow, G, Grid, Open
from flowgmo.flow.observe.gauges import DUST, Standing, read_probe
from flowgmo.flow.observe.loads import find_wall, pressure_load, shear_load
from flowgmo.flow.observe.measures import Totals, total, volume_error
from flowgmo.flow.observe.planes import find_gate, flow_through
from flowgmo.flow.observe.streams import is_open
from flowgmo.flow.solid_lines import SolidLines
from flowgmo.flow.surface.planes import Planes
from flowgmo.flow.team import Team
from flowgmo.flow_plan import FluidPlan, LoadPlan
from flowgmo.mesh import SIDE_NAMES, SYMMETRY, WALL, Block

if TYPE_CHECKING:
    from flowgmo.flow.liquid import Liquid
    from flowgmo.model import Model

Values = dict[str, float | np.ndarray]
Shear = Callable[[Flow], tuple[np.ndarray, np.ndarray]]  # places (m, 3) and forces (m, 3) on a body's wall


@dataclass(frozen=True)
class Asked:
    """What the scene wants recorded: numbers and points (k, 3) of probes; names of bodies by number; walls: number of
    a body -> its cells (m, 3) [with ghosts] and the shares (m, 6) of their faces; shear: number -> its shear forces;
    still: what solids that stand still leave open, None where nothing moves; momentum: whether that of the liquid is
    wanted."""

    probe_numbers: Sequence[int]
    probe_points: np.ndarray
    names: Mapping[int, str]
    walls: Mapping[int, tuple[np.ndarray, np.ndarray]]
    shear: Mapping[int, Shear]
    still: Open | None = None
    momentum: bool = False


class Watch:
    """Measures the liquid of one scene."""

    def __init__(
        self, plan: FluidPlan, block: Block, grid: Grid, openings: Open, gravity: np.ndarray, team: Team, asked: Asked,
        planes: Planes | None = None, solid_lines: SolidLines | None = None,
    ) -> None:  # fmt: skip
        """planes, solid_lines: the scene's, None: its own."""
        self.planes, self.solid_lines = planes, solid_lines
        self.plan, self.grid, self.openings, self.team, self.asked = plan, grid, openings, team, asked
        self.gravity = np.asarray(gravity, dtype=float)
        self.columns = all_columns(tuple(len(d) for d in grid[:3]))
        self.cells = block.cells
        centres = [_with_ghosts(x) for x in block.planes]
        self.probes = [
            Standing(k, x, block, openings, still=solid_lines is not None and solid_lines.still)
            for k, x in zip(asked.probe_numbers, asked.probe_points, strict=True)
        ]
        self.gates = [(plane.number, find_gate(plane, block)) for plane in plan.planes]
        still = openings if asked.still is None else asked.still
        self.walls = {n: find_wall(*wall, grid, still, centres) for n, wall in asked.walls.items()}
        self._kept: tuple[int, Values] | None = None
        self._whole: tuple[int, Totals, np.ndarray | None] | None = None

    def at(self, step: int, flow: Flow, start: float, passed: np.ndarray) -> Values:
        """The values after `step` steps; measured once for each. start, passed: as in measures.volume_error."""
        if self._kept is None or self._kept[0] != step:
            self._kept = step, self.measure(flow, start, passed, self.whole(step, flow)[0])
        return self._kept[1]

    def whole(self, step: int, flow: Flow) -> tuple[Totals, np.ndarray | None]:
        """All liquid after `step` steps, and its momentum (3,) where that is wanted; found once for each."""
        if self._whole is None or self._whole[0] != step:
            momentum = np.zeros(3) if self.asked.momentum else None
            self._whole = step, self._total(flow, momentum), momentum
        return self._whole[1:]

    def _total(self, flow: Flow, momentum: np.ndarray | None = None) -> Totals:
        of = self.team, self.columns, self.grid, self.openings, flow, self.plan.rho, self.gravity, DUST
        return total(*of, momentum, self.planes, self.solid_lines)

    def measure(self, flow: Flow, start: float, passed: np.ndarray, whole: Totals | None = None) -> Values:
        """The values of a Flow with ghosts filled. Pressures are the deck's, forces those against the void's. whole:
        its Totals, where they are known."""
        plan = self.plan
        whole = self._total(flow) if whole is None else whole
        out: Values = {"fluid/volume": whole.volume}
        if flow.F is not None:
            out["fluid/volume_error"] = volume_error(whole.volume, start, passed)
            out["fluid/wet_share"] = whole.wet / self.cells
        out |= {"fluid/kinetic_energy": whole.kinetic, "fluid/potential_energy": whole.potential}
        if plan.mu:
            out["fluid/dissipated"] = float(flow.friction[0])
        slide = plan.mu and plan.no_slip and any(side.slides for side in plan.sides)
        if slide or any(is_open(side.kind) for side in plan.sides):
            out["fluid/work_boundaries"] = float(flow.friction[1])
        open_sides = [side.number for side in plan.sides if side.kind not in (SYMMETRY, WALL)]
        out |= {f"boundaries/{SIDE_NAMES[s]}/volume": float(passed[s]) for s in open_sides}
        for number, gate in self.gates:
            out[f"planes/{number}/flow"] = flow_through(gate, flow, self.openings)
        for probe in (standing.now() for standing in self.probes):
            values = read_probe(probe, flow, self.openings, self.grid.dz, plan.rho, self.gravity)
            values["p"] += plan.void_pressure
            out |= {f"probes/{probe.number}/{name}": value for name, value in values.items()}
        for load in plan.loads:
            out |= {f"bodies/{self.asked.names[load.body]}/{k}": v for k, v in self._load(load, flow).items()}
        return out

    def _load(self, load: LoadPlan, flow: Flow) -> Values:
        """Load on a stationary body."""
        wall = self.walls.get(load.body)
        if wall is None:  # it lies outside the domain
            zero = np.zeros(3)
            return {"force": zero, "torque": zero, "force_pressure": zero}
        by_p = pressure_load(wall, flow, self.plan.rho, self.gravity, load.point)
        out: Values = {"force": by_p.force, "torque": by_p.torque, "force_pressure": by_p.force}
        if load.body in self.asked.shear:
            force, torque = shear_load(*self.asked.shear[load.body](flow), load.point)
            out |= {"force": by_p.force + force, "torque": by_p.torque + torque, "force_shear": force}
        if load.wetted_area:
            out["wetted_area"] = by_p.wetted_area
        return out


def watch_of(
    model: Model, liquid: Liquid, walls: Mapping[int, tuple[np.ndarray, np.ndarray]], shear: Mapping[int, Shear]
) -> Watch:
    """The Watch of a wet Model; walls and shear as in Asked."""
    names = {body.number: body.name for body in model.bodies}
    still = liquid.immersed.covers.still if liquid.immersed is not None else None
    moving = still is not None and model.fluid.coupled_together  # else there is no book of momentum
    asked = Asked(model.output.probe_numbers, model.output.probes, names, walls, shear, still, moving)
    (block,) = model.mesh.blocks
    scene = liquid.grid, liquid.openings, model.gravity, liquid.team
    return Watch(model.fluid, block, *scene, asked, liquid.planes, liquid.solid_lines)


def between(before: Values, after: Values, t0: float, t1: float, asked: np.ndarray) -> dict[str, np.ndarray]:
    """Values at times asked (k,) in (t0, t1], linear between those at t0 and t1; name -> (k,) or (k, 3).

    At t1 they are those of t1, whatever was before: an energy beyond the range of numbers is infinite, and 0 times that
    is not a number.
    """
    share = (np.asarray(asked, dtype=float) - t0) / (t1 - t0)
    within = share < 1.0
    out = {}
    for name, last in after.items():
        first, last = np.asarray(before[name], dtype=float), np.asarray(last, dtype=float)
        s = share[within].reshape(-1, *[1] * last.ndim)
        values = np.repeat(last[None], len(share), axis=0)
        values[within] = (1.0 - s) * first + s * last
        out[name] = values
    return out


def at_once(values: Values) -> dict[str, np.ndarray]:
    """Values of one instant as one row of each."""
    return {name: np.asarray(value, dtype=float)[None] for name, value in values.items()}


def _with_ghosts(planes: np.ndarray) -> np.ndarray:
    """Centres (n + 4,) of cells; those of ghosts are not used."""
    return np.pad(0.5 * (planes[1:] + planes[:-1]), G, mode="edge")
