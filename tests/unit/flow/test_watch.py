"""Flow through planes, loads of bodies that stand still, and rows of the history."""

from types import SimpleNamespace

import numpy as np
import pytest
from flowgmo_flows import DOWN, GRAVITY, RHO, at_faces, below, block_of, flow_of, openings_of, still, with_ghosts

from flowgmo.flow.fields import G, Open, grid_of
from flowgmo.flow.observe.loads import find_wall, pressure_load, shear_load
from flowgmo.flow.observe.planes import find_gate, flow_through
from flowgmo.flow.observe.watch import Asked, Watch, at_once, between
from flowgmo.flow.team import Team
from flowgmo.flow_plan import FlowPlane, LoadPlan, SidePlan
from flowgmo.mesh import PRESSURE, WALL

NONE = Open(None, None, None, None)
FAR = np.full(3, np.inf)


def through(block, flow, axis, position, lo=-FAR, hi=FAR, openings=NONE):
    return flow_through(find_gate(FlowPlane(1, axis, position, np.array(lo), np.array(hi)), block), flow, openings)


# ---- planes


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("position", [0.0, 0.31, 1.0])
def test_uniform_flow_through_a_rectangle(axis, position):
    """Limits anywhere in the cells; the limits along the axis itself say nothing."""
    block = block_of((7, 6, 9))
    velocity = [np.full((11, 10, 13), x) for x in (2.0, -3.0, 0.5)]
    lo, hi = np.array([0.13, 0.2, 0.31]), np.array([0.57, 9.0, 0.77])
    size = np.minimum(hi, 1.0) - lo
    wanted = velocity[axis][0, 0, 0] * np.prod(np.delete(size, axis))
    assert through(block, flow_of(block, None, None, *velocity), axis, position, lo, hi) == pytest.approx(wanted)


@pytest.mark.parametrize("sign", [-1, 1])
def test_liquid_comes_from_the_cell_upstream(sign):
    block = block_of((8, 4, 5), ratio=1.0)
    F = np.zeros((12, 8, 9))
    F[G + 3] = 0.25  # on the lower side of the plane
    F[G + 4] = 0.75
    flow = flow_of(block, F, None, np.full(F.shape, 2.0 * sign))
    assert through(block, flow, 0, 0.5) == pytest.approx(2.0 * (0.25 if sign > 0 else -0.75))


def test_between_two_layers_of_faces_the_flow_is_linear():
    block = block_of((8, 4, 5))
    flow = flow_of(block, u=at_faces(block, 0, lambda x, y, z: 1.0 + x))
    assert through(block, flow, 0, 0.3333) == pytest.approx(1.3333, rel=1e-14)


def test_solids_leave_their_part_of_the_plane():
    block = block_of((8, 7, 5))
    openings = openings_of(block, [np.array([[0.2, 0.1, 0.15], [0.8, 0.47, 0.6]])])[0]
    flow = flow_of(block, u=np.ones((12, 11, 9)))
    assert through(block, flow, 0, 0.5, openings=openings) == pytest.approx(1.0 - 0.37 * 0.45)


def test_an_absent_direction_has_no_flow():
    block = block_of((8, 1, 5))
    assert through(block, flow_of(block), 1, 0.5) == 0.0


# ---- loads


def wall_of(block, box):
    openings, walls = openings_of(block, [np.array(box)])
    centres = [0.5 * (x[1:] + x[:-1]) for x in map(with_ghosts, block.planes)]
    return find_wall(*walls[0], grid_of(block), openings, centres)


BOX = [[0.23, 0.31, 0.17], [0.61, 0.77, 0.58]]


@pytest.mark.parametrize("box", [BOX, [[0.23, 0.31, -1.0], [0.61, 0.77, 0.58]]])
def test_still_water_lifts_a_box_by_what_it_displaces(box):
    """Off the mesh in every direction; one that stands on the floor is pressed onto it."""
    block = block_of((10, 9, 12))
    load = pressure_load(wall_of(block, box), still(block, 0.95), RHO, DOWN, np.zeros(3))
    lo, hi = np.array(box)
    side = np.prod((hi - lo)[:2])
    lift = RHO * GRAVITY * side * ((hi[2] - lo[2]) if lo[2] > 0 else -(0.95 - hi[2]))
    assert load.force == pytest.approx([0, 0, lift], rel=1e-12, abs=1e-9)
    middle = (lo + hi) / 2
    assert load.torque == pytest.approx(np.cross(middle, load.force), rel=5e-3, abs=1e-9)  # 0.3 %: centres of cells


def test_constant_pressure_gives_no_force():
    """And none of the void: measured 1e-16 of p times the area."""
    block = block_of((10, 9, 12))
    flow = flow_of(block, p=np.full((14, 13, 16), 1e5))
    assert np.abs(pressure_load(wall_of(block, BOX), flow, RHO, 0 * DOWN, np.zeros(3)).force).max() < 1e-10


def test_half_wet_box():
    """The surface at half its height, on a plane of the mesh: lifted by the lower half, half its sides wet."""
    block = block_of((10, 9, 10), ratio=1.0)
    box = np.array([[0.3, 1 / 3, 0.2], [0.7, 2 / 3, 0.6]])
    load = pressure_load(wall_of(block, box), still(block, 0.4), RHO, DOWN, np.zeros(3))
    assert load.force == pytest.approx([0, 0, RHO * GRAVITY * 0.4 / 3 * 0.2], rel=1e-12, abs=1e-9)
    assert load.wetted_area == pytest.approx(0.4 / 3 + 2 * 0.2 * (0.4 + 1 / 3), rel=0.08)  # corner cells: |a| of both


def test_shear_is_summed_with_its_moment():
    places, forces = np.random.default_rng(2).normal(size=(2, 7, 3))
    force, torque = shear_load(places, forces, np.array([1.0, 2.0, 3.0]))
    assert force == pytest.approx(forces.sum(axis=0))
    assert torque == pytest.approx(np.cross(places - [1, 2, 3], forces).sum(axis=0))


# ---- all together


def watch_of(block, openings=NONE, walls=None, planes=(), **asked):
    sides = tuple(SidePlan(s, PRESSURE if s == 1 else WALL, np.zeros(1)) for s in range(6))
    loads = tuple(LoadPlan(n, np.zeros(3), True) for n in (2, 3)) if walls else ()
    plan = SimpleNamespace(rho=RHO, void_pressure=1e5, mu=None, planes=planes, loads=loads, sides=sides)
    values = {"probe_numbers": (3,), "probe_points": [[0.1, 0.2, 0.3]], "names": {2: "rock", 3: "away"}}
    values |= {"walls": walls or {}, "shear": {}} | asked
    return Watch(plan, block, grid_of(block), openings, DOWN, Team(1), Asked(**values))


def test_names_and_values():
    block = block_of((10, 9, 12))
    openings, walls = openings_of(block, [np.array(BOX)])
    plane = FlowPlane(4, 0, 0.9, -FAR, FAR)
    passed = np.array([0, 0.01, 0, 0, 0, 0])
    watch = watch_of(block, openings, {2: walls[0]}, (plane,))
    flow = still(block, 0.95)
    volume = 0.95 - np.prod(np.ptp(BOX, axis=0))
    found = watch.measure(flow, volume - 0.01, passed)
    assert found["fluid/volume"] == pytest.approx(volume, rel=1e-13)
    assert abs(found["fluid/volume_error"]) < 1e-13 and found["planes/4/flow"] == 0.0
    assert {k for k in found if k.startswith("boundaries")} == {"boundaries/Xmax/volume"}
    assert found["boundaries/Xmax/volume"] == 0.01
    assert found["probes/3/p"] == pytest.approx(1e5 + RHO * GRAVITY * 0.65), "the deck's pressure"
    assert found["probes/3/height"] == pytest.approx(0.95)
    assert found["bodies/rock/force"][2] == pytest.approx(RHO * GRAVITY * np.prod(np.ptp(BOX, axis=0)))
    assert not found["bodies/away/force"].any()
    full = watch.measure(flow_of(block), 1.0, passed)
    assert full.keys() >= {"fluid/volume", "probes/3/p"} and full["boundaries/Xmax/volume"] == 0.01


def test_shear_joins_the_pressure():
    block = block_of((10, 9, 12))
    openings, walls = openings_of(block, [np.array(BOX)])
    shear = {2: lambda flow: (np.array([[0.0, 1.0, 0.0]]), np.array([[5.0, 0.0, 0.0]]))}
    found = watch_of(block, openings, {2: walls[0]}, shear=shear).measure(still(block, 0.9), 1.0, np.zeros(6))
    assert found["bodies/rock/force_shear"].tolist() == [5, 0, 0]
    assert found["bodies/rock/force"] == pytest.approx(found["bodies/rock/force_pressure"] + [5, 0, 0])


def test_a_state_is_measured_once():
    block = block_of((5, 5, 5))
    watch, flow = watch_of(block), still(block, 0.5)
    first = watch.at(7, flow, 0.5, np.zeros(6))
    assert watch.at(7, flow, 0.5, np.zeros(6)) is first and watch.at(8, flow, 0.5, np.zeros(6)) is not first


def test_rows_are_linear_between_the_ends_of_a_step_and_exact_at_its_end():
    before, after = {"a": 1.0, "b": np.array([1.0, 2.0, 3.0])}, {"a": 0.1, "b": np.array([0.3, 2.0, 7.0])}
    rows = between(before, after, 1.0, 2.0, np.array([1.25, 2.0]))
    assert rows["a"] == pytest.approx([0.775, 0.1]) and rows["a"][1] == 0.1
    assert rows["b"][0] == pytest.approx([0.825, 2, 4]) and rows["b"][1].tolist() == [0.3, 2, 7]
    assert at_once(before)["b"].shape == (1, 3) and at_once(before)["a"].shape == (1,)


@pytest.mark.filterwarnings("error")
def test_rows_of_energies_beyond_the_range_of_numbers():
    """As with rhof=1e308: infinite, without a warning (0 x infinity), and what is at the end is there to the bit."""
    ends = {
        "grows": (3.0, np.inf),
        "falls": (np.inf, 0.1),
        "stays": (np.inf, np.inf),
        "vector": ([np.inf] * 3, [0.1] * 3),
    }
    before, after = ({name: np.array(both[end]) for name, both in ends.items()} for end in (0, 1))
    rows = between(before, after, 1.0, 3.0, np.array([2.0, 3.0, 2.5, 3.0]))
    inf = np.inf
    assert rows["grows"].tolist() == [inf] * 4 and rows["stays"].tolist() == [inf] * 4
    assert rows["falls"].tolist() == [inf, 0.1, inf, 0.1] and rows["vector"][1].tolist() == [0.1] * 3
    assert between(before, after, 1.0, 3.0, np.array([3.0]))["falls"].tolist() == [0.1]


def test_a_kept_value_does_not_follow_the_books():
    """`passed` goes on growing in place."""
    block, passed = block_of((5, 5, 5)), np.zeros(6)
    watch = watch_of(block)
    kept = watch.at(1, flow_of(block, below(block, 0.5)), 0.5, passed)
    passed[1] = 3.0
    assert kept["boundaries/Xmax/volume"] == 0.0


def measured(scale, rho, rate):
    """All values of a made-up flow around a box; lengths times `scale`, times divided by `rate`."""
    block = block_of((10, 9, 12), hi=(scale,) * 3)
    openings, walls = openings_of(block, [scale * np.array(BOX)])
    random = np.random.default_rng(11)
    F = np.clip(random.normal(0.6, 0.5, (14, 13, 16)), 0, 1)
    p = random.random(F.shape) * 1e3 * rho * (scale * rate) ** 2
    flow = flow_of(block, F, p, *(random.normal(size=F.shape) * scale * rate for _ in range(3)))
    sides = tuple(SidePlan(s, PRESSURE, np.zeros(1)) for s in range(6))
    lo = scale * np.array([0.1, 0.2, 0.3])
    planes = (FlowPlane(1, 1, scale * 0.37, lo, 2 * lo),)
    plan = SimpleNamespace(rho=rho, void_pressure=0.0, mu=None, planes=planes, sides=sides)
    plan.loads = (LoadPlan(1, scale * np.array([0.5, 0.1, 0.3]), True),)
    points = scale * random.random((20, 3))
    asked = Asked(range(20), points, {1: "rock"}, {1: walls[0]}, {})
    gravity = DOWN * scale * rate**2
    watch = Watch(plan, block, grid_of(block), openings, gravity, Team(1), asked)
    return watch.measure(flow, 0.4 * scale**3, np.full(6, 0.01 * scale**3))


def test_scaled_by_powers_of_two_gives_the_same_bits():
    """length x 4, mass x 32, time / 2: every value is a power of two of what it was."""
    here, there = measured(1.0, 1000.0, 1.0), measured(4.0, 500.0, 2.0)
    for name, value in here.items():
        nonzero = np.asarray(value) != 0
        ratio = np.asarray(there[name])[nonzero] / np.asarray(value)[nonzero]
        assert (np.frexp(ratio)[0] == 0.5).all() and len(set(ratio.tolist())) <= 1, name


def test_nothing_is_nan_in_a_dry_or_closed_mesh():
    """No liquid at all; a mesh that is all but closed."""
    block = block_of((5, 4, 6))
    openings, _ = openings_of(block, [np.array([[-1, -1, -1], [0.9, 2, 2]])])
    for flow in (flow_of(block, np.zeros((9, 8, 10))), flow_of(block)):
        found = watch_of(block, openings).measure(flow, 0.0, np.zeros(6))
        assert all(np.isfinite(value).all() for value in found.values())
