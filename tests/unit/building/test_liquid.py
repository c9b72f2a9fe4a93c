"""The liquid at the start: height, volume, regions with shapes, velocities and pressures of their own."""

import numpy as np
import pytest
from flowgmo_wet import FREE, FULL, MESH, wet


@pytest.fixture
def start(build):
    return lambda fl, **more: build(wet(fl=fl, **more)).fluid.start


def test_height_volume_regions(start):
    assert (start("flht=.4").height, start("flht=.4").volume) == (0.4, None)
    assert (start("vlin=.4").height, start("vlin=.4").volume) == (None, 0.4)
    only = start("iflinittyp=0, nfls=1, fzh(1)=.3")
    assert only.height is only.volume is None and len(only.regions) == 1


def test_uniform_values(start):
    """Pressures are relative to the void's, and regions inherit what they do not give."""
    made = start(
        "flht=.4, ui=1., vi=2., wi=3., presi=700., pvoid=500., nfls=2, vreg(2)=9., preg(2)=500., freg(2)=.5, fzh(1)=.1"
    )
    assert made.velocity.tolist() == [1, 2, 3] and made.pressure == 200.0
    one, two = made.regions
    assert one.velocity.tolist() == [1, 2, 3] and two.velocity.tolist() == [1, 9, 3]
    assert (one.pressure, two.pressure, one.fraction, two.fraction) == (200.0, 0.0, 1.0, 0.5)


def test_regions_keep_their_order(start):
    """Adding, then a hole, then adding again; one that is switched off is not there; names for messages."""
    made = start(
        "nfls=4, fioh(2)=0, if_flreg_enabled(3)=0, fluidregionname(4)='drop', fzh(1)=.5, fzl(2)=.2, frsh(4)=.1"
    )
    assert [region.adds for region in made.regions] == [True, False, True]
    assert [region.name for region in made.regions] == ["region 1", "region 2", "drop"]


POINTS = np.random.default_rng(5).uniform((0, 0, 0), (2, 1, 1.5), (2000, 3))


@pytest.mark.parametrize(
    ("lines", "inside"),
    [
        ("fxl(1)=1.2, fzh(1)=.5", lambda x, y, z: (x > 1.2) & (z < 0.5)),
        ("frah(1)=.4, fzl(1)=.2, ftrnx(1)=1.", lambda x, y, z: ((x - 1) ** 2 + y**2 < 0.16) & (z > 0.2)),
        ("frsh(1)=.5, ftrnz(1)=.7", lambda x, y, z: x**2 + y**2 + (z - 0.7) ** 2 < 0.25),
        (
            "frsl(1)=.5, frsh(1)=.9",
            lambda x, y, z: (x**2 + y**2 + z**2 < 0.81) & (x**2 + y**2 + z**2 > 0.25),
        ),
        ("fcc(1)=-.3, fcx2(1)=.2, fcy(1)=.1, fcz(1)=.5", lambda x, y, z: 0.2 * x**2 + 0.1 * y + 0.5 * z < 0.3),
        ("fcx(1)=1., fcz(1)=2., fcc(1)=-2.", lambda x, y, z: x + 2 * z < 2),
        ("fzh(1)=.2, froty(1)=90., ftrnx(1)=.5", lambda x, y, z: x < 0.7),
        ("frsh(1)=1., fmagnx(1)=2., fmagn(1)=.5", lambda x, y, z: x**2 + (y / 0.5) ** 2 + (z / 0.5) ** 2 < 1),
        (
            "frsh(1)=.4, fmagn(1)=2., fxtrfc(1)=.5, fytrfc(1)=.5",
            lambda x, y, z: (x + 0.5) ** 2 + (y + 0.5) ** 2 + z**2 < 0.64,
        ),
        ("fangll(1)=20., fanglh(1)=70.", lambda x, y, z: np.abs(np.degrees(np.arctan2(y, x)) - 45) < 25),
        ("", lambda x, y, z: x > -1),
    ],
)
def test_shapes_of_regions(start, lines, inside):
    """Membership of points against the formula: quadrics, limiters, transform as for solids."""
    (region,) = start(f"iflinittyp=0, nfls=1, {lines}").regions
    expected = inside(*POINTS.T)
    assert expected.sum() > 0
    assert (region.shape.inside(POINTS) == expected).all()
    assert ((region.shape.distance(POINTS) < 0) == expected).all()


@pytest.mark.parametrize(
    ("fl", "says"),
    [
        ("nfls=1, fzl(1)=1.6", ["fzl(1)=1.6", "region 1", "outside the mesh: z = 1.6 to inf", "0 to 1.5"]),
        ("flht=.5, nfls=1, fioh(1)=0, frsh(1)=.1, ftrnx(1)=-.2", ["frsh(1)=0.1", "outside the mesh"]),
        ("nfls=1, fxl(1)=.5, fxh(1)=.4", ["fxl(1)=0.5", "no usable shape", "leave nothing"]),
        ("nfls=1, fcc(1)=.5", ["fcc(1)=0.5", "no usable shape", "nothing is inside"]),
        ("nfls=1, fcc(1)=.5, fcx2(1)=1.", ["fcc(1)=0.5", "no usable shape"]),
        ("vlin=3.5", ["vlin=3.5", "the domain holds 3 only"]),
        ("", ["rhof=1000.0", "no liquid at the start", "Write flht"]),
        ("flht=-1.", ["rhof=1000.0", "no liquid at the start"]),
        ("nfls=1, fioh(1)=0, fzh(1)=.5", ["rhof=1000.0", "no liquid at the start"]),
    ],
)
def test_starts_that_cannot_be(problems, fl, says):
    (found,) = problems(wet(fl=fl))
    assert all(word in found for word in says), found


@pytest.mark.parametrize(("height", "told"), [(1.5, False), (1.50001, True), (9.0, True)])
def test_a_height_above_the_mesh_is_told(build, height, told):
    """The mesh ends at z = 1.5."""
    notices = [str(notice) for notice in build(wet(fl=f"flht={height},")).notices]
    assert bool(notices) == told
    assert not told or f"flht={height}" in notices[0] and "above the mesh, which ends at z = 1.5" in notices[0]


@pytest.mark.parametrize(
    "bcdata",
    ["ibct(1)=6, ubct(1,1)=1.,", "ibct(1)=5,", "ibct(1)=5, ihpbct(1)=1, flhtbct(1,1)=.3,"],
)
def test_liquid_that_comes_later(build, bcdata):
    """An empty domain fills through a side."""
    assert build(wet(fl="", bcdata=bcdata)).fluid.start.height is None


@pytest.mark.parametrize(
    "bcdata", ["ibct(1)=5, fbct(1,1)=0.,", "ibct(1)=5, ihpbct(1)=1, flhtbct(1,1)=-.3,", "ibct(1)=8,"]
)
def test_liquid_that_never_comes(problems, bcdata):
    assert "no side of the domain brings any" in problems(wet(fl="", bcdata=bcdata))[0]


def test_all_problems_together(problems):
    """Of sides, regions, gauges, memory: one message each."""
    found = problems(
        wet(
            xput=FULL,
            fl="nfls=1, fzl(1)=2.,",
            bcdata="ibct(1)=6, ubct(1,1)=1.,",
            flowgmo="planex(1)=7.,",
            grafic="xloc(1)=9., yloc(1)=.5, zloc(1)=.5,",
            mesh=MESH,
        )
    )
    assert len(found) == 4, found


def test_gravity_that_lies_along_no_axis(start):
    """A volume's surface lies across gravity, whichever way that points."""
    assert start("vlin=.3", xput=FREE + "gx=3.,").volume == 0.3
