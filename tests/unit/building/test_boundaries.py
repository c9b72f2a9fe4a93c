"""SidePlans: kinds, tables on common times, pressures relative to the void, periodic pairs, flow that balances."""

import numpy as np
import pytest
from flowgmo_wet import FREE, FULL, MESH, wet

from flowgmo.mesh import PRESSURE, VELOCITY, WALL


@pytest.fixture
def sides(build):
    """The sides of a deck with these lines in &bcdata."""
    return lambda lines, **more: build(wet(bcdata=lines, **more)).fluid.sides


def test_every_kind(sides):
    """What a kind has no use for is None."""
    made = sides("ibct=1,2,3,5,6,8,")
    assert [side.number for side in made] == list(range(6)) and [side.kind for side in made] == [1, 2, 3, 5, 6, 8]
    assert [side.axis for side in made] == [0, 0, 1, 1, 2, 2] and [side.upper for side in made] == [False, True] * 3
    has = [[n for n in ("velocity", "pressure", "fraction", "height") if getattr(s, n) is not None] for s in made]
    assert has == [[], [], [], ["pressure", "fraction"], ["velocity", "fraction"], []]
    assert [side.stagnation for side in made] == [False, False, False, True, False, False]
    assert all(side.partner is None and side.t.tolist() == [0.0] for side in made)


def test_periodic_pairs(sides):
    assert [side.partner for side in sides("ibct(3)=4,4,")] == [None, None, 3, 2, None, None]


def test_tables_have_common_times(sides, tmp_path):
    """Own times of a file join those of TIMBCT; every table is as it was at its own times and between them."""
    file = tmp_path / "w.csv"
    file.write_text("0.5 1.\n1.5 3.\n")
    lines = f"ibct(1)=6, timbct=0., 1., 2., ubct(1,1)=1., 0., 2., fbct(1,1)=.5, fwbct(1)='{file}', iwbctc(1)=2,"
    side = sides(lines)[0]
    assert side.kind == VELOCITY and side.t.tolist() == [0, 0.5, 1, 1.5, 2]
    assert side.velocity.tolist() == [[1, 0, 1], [0.5, 0, 1], [0, 0, 2], [1, 0, 3], [2, 0, 3]]
    assert side.fraction.tolist() == [0.5] * 5 and side.pressure is side.height is None
    now = side.at(1.25)
    assert now.velocity.tolist() == [0.5, 0, 2.5] and now.fraction == 0.5 and now.pressure is None
    assert side.at(-1.0).velocity.tolist() == [1, 0, 1] and side.at(9.0).velocity.tolist() == [2, 0, 3]


def test_pressures_are_relative_to_the_void(sides):
    """Absolute or gauge: the same scene gives the same bits, and an open side at the void's pressure has 0."""
    table = "ibct(6)=5, timbct=0., 1., fbct(1,6)=0., pbct(1,6)={},"
    gauge = sides(table.format("0., 500."))[5]
    absolute = sides(
        table.format("1e5, 100500."), props="rhof=1., ipgauge=0, p_reference=9e4,", fl="flht=.5, pvoid=1e5,"
    )[5]
    assert gauge.kind == PRESSURE and gauge.pressure.tolist() == absolute.pressure.tolist() == [0, 500]
    outside = sides("ibct(6)=5, fbct(1,6)=0.,", props="rhof=1., ipgauge=0, units='si',")[5]
    assert outside.pressure.tolist() == [0.0]


def test_heights_in_place_of_fractions(sides):
    side = sides("ibct(1)=5, ihpbct(1)=1, timbct=0., 2., flhtbct(1,1)=.4, -.2, ipbctp(1)=0,")[0]
    assert side.height.tolist() == [0.4, -0.2] and side.fraction is None and not side.stagnation
    assert side.at(1.0).height == pytest.approx(0.1)


def test_walls_that_slide(sides):
    """A wall keeps its tangential velocity, as a table; one at rest has none."""
    side = sides("ibct(5)=2, timbct=0., 1., ubct(1,5)=0., 2.,", xput=FREE + "ifvisc=1,", props="rhof=1., mu1=1.,")[4]
    assert side.kind == WALL and side.velocity.tolist() == [[0, 0, 0], [2, 0, 0]]


# ---- a domain that is full


IN, OUT = "ubct(1,1)={}, ibct(1)=6,", "ubct(1,2)={}, ibct(2)=6,"


@pytest.mark.parametrize(
    "lines",
    [
        IN.format(".5") + OUT.format(".5"),
        IN.format(".5") + "ibct(2)=8,",
        IN.format(".5") + "ibct(2)=5,",
        IN.format(".5") + "ibct(2)=3,",
        IN.format(".5") + "ibct(6)=6, wbct(1,6)=.375,",  # 0.5 x 1.5 through Xmin, .375 x 2 through Zmax
        IN.format(".5, 0., .1") + OUT.format(".5, 0., .1") + "timbct=0., 1., 2.,",
        "ibct(1)=6, vbct(1,1)=1.,",  # along the side only
        IN.format(".5") + OUT.format(".5000001"),  # as much as the pressure solution leaves
    ],
)
def test_flow_that_balances(sides, lines):
    assert len(sides(lines, xput=FULL, fl="")) == 6


@pytest.mark.parametrize(
    ("lines", "says"),
    [
        (IN.format(".5"), ["ubct(1,1)=0.5", "0.75 in a unit of time at t=0"]),
        (IN.format("-.5"), ["ubct(1,1)=-0.5", "-0.75 in a unit of time"]),
        (OUT.format("-.5"), ["ubct(1,2)=-0.5", "0.75 in a unit of time"]),
        (IN.format(".5") + OUT.format(".4999"), ["ubct(1,1)=0.5", "0.00015 in"]),
        (IN.format("0., .5") + "timbct=0., 3.,", ["ubct(1,1)=0.0", "at t=3"]),
        ("ibct(6)=6, wbct(1,6)=.1,", ["wbct(1,6)=0.1", "-0.2 in"]),
    ],
)
def test_flow_that_goes_nowhere(problems, lines, says):
    """All sides closed or with given velocities, no surface, no compressibility."""
    (found,) = problems(wet(xput=FULL, fl="", bcdata=lines))
    assert all(word in found for word in [*says, "full of liquid that does not give way"]), found


@pytest.mark.parametrize(
    "more",
    [
        {"xput": FREE, "fl": "flht=.5,"},  # the surface rises
        {"props": "rhof=1., rcsql=1e-9,"},  # the liquid gives way
        {"obs": "nobs=1, iob(1)=1, xh(1)=.1, zh(1)=.75,"},  # half of Xmin is covered: the open areas will tell
    ],
)
def test_where_the_balance_is_not_known(sides, more):
    sides(IN.format(".5") + OUT.format(".25"), **{"xput": FULL, "fl": "", **more})


def test_balance_in_two_dimensions(sides, problems):
    """A direction with one cell has its area too, and no flow."""
    mesh = MESH.replace("nycelt=10", "nycelt=1")
    assert np.isfinite(sides(IN.format(".5") + OUT.format(".5"), xput=FULL, fl="", mesh=mesh)[0].velocity).all()
    assert len(problems(wet(xput=FULL, fl="", mesh=mesh, bcdata=IN.format(".5")))) == 1
