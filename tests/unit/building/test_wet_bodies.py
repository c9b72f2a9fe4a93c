"""Notices about bodies that move in liquid."""

from pathlib import Path

import pytest
from flowgmo_wet import FREE, MESH, wet

from flowgmo.building import build_model
from flowgmo.deck import parse_deck

BALL = "nobs=1, obsid(1)='ball', imo(1)=4, rhomvb(1)=500., iob(1)=1, rsh(1)=.3,"
INSIDE = "trnx(1)=1., trny(1)=.5, trnz(1)=.6,"
PLATE = "nobs=1, imo(1)=3, iob(1)=1, xl(1)=.5, xh(1)=.57, yl(1)=.2, yh(1)=.8, zl(1)=.2, zh(1)=.9, utobs(1,1)=.1,"


def notices(obs: str) -> tuple[str, ...]:
    return build_model(parse_deck(wet(xput=FREE + "imobs=1,", obs=obs), Path("t.nml"))).notices


@pytest.mark.parametrize(
    ("obs", "part"),
    [
        (BALL + "trnx(1)=0., trny(1)=.5, trnz(1)=.6,", "liquid acts on about 0.0563 of its volume of about 0.113"),
        (BALL + "trnx(1)=-4., trny(1)=.5, trnz(1)=.6,", "ball lies outside the mesh at the start"),
        (PLATE, "thinner than two cells (0.75 of a cell at the thinnest)"),
    ],
)
def test_notice(obs: str, part: str) -> None:
    """Volumes: of half a ball of radius .3, .0565, to the sampling's hundredth; thickness in quarters of a cell."""
    found = notices(obs)
    assert len(found) == 1 and part in found[0], found


TWO = BALL.replace("nobs=1", "nobs=2") + INSIDE
BESIDE = "iob(2)=2, rsh(2)=.3, trnx(2)=1.3, trny(2)=.5, trnz(2)=.6,"
CUT = "about 0.31 of ball is inside obs2 at the start: they do not collide"  # 5/16 of a ball are in one a radius away


@pytest.mark.parametrize(
    ("other", "xput"),
    [
        ("imo(2)=4, rhomvb(2)=500.,", ""),
        ("imo(2)=3,", ""),
        ("imo(2)=0,", ""),
        ("imo(2)=0,", "iclid=1,"),
    ],
)
def test_bodies_that_overlap_and_do_not_collide(other: str, xput: str) -> None:
    """Two coupled ones have one notice between them; pairs that collide have a problem of their own."""
    obs = TWO + BESIDE + other + ("iclidob(1,2)=0," if xput else "")
    model = build_model(parse_deck(wet(xput=FREE + "imobs=1," + xput, obs=obs), Path("t.nml")))
    assert len(model.notices) == 1 and CUT in model.notices[0], model.notices
    apart = obs.replace("trnx(2)=1.3", "trnx(2)=1.61")
    assert build_model(parse_deck(wet(xput=FREE + "imobs=1," + xput, obs=apart), Path("t.nml"))).notices == ()


def test_a_hinge_in_a_solid_is_no_overlap() -> None:
    assert not [n for n in notices(TWO + BESIDE + "imo(2)=0, imoaxs(1)=2,") if "inside obs2" in n]


@pytest.mark.parametrize("obs", [BALL + INSIDE, BALL.replace("imo(1)=4", "imo(1)=3") + "trnz(1)=.6, trny(1)=.5,"])
def test_silent(obs: str) -> None:
    """A ball of six cells across inside, and a prescribed one that enters through a side."""
    assert notices(obs) == ()


def test_featherweights_count_as_a_ten_thousandth() -> None:
    """Mass and moments together, with a notice; heavier ones and tanks without a surface are as the deck says."""
    light = BALL.replace("rhomvb(1)=500.", "rhomvb(1)=1e-3") + INSIDE
    model = build_model(parse_deck(wet(xput=FREE + "imobs=1,", obs=light), Path("t.nml")))
    (notice,) = model.notices
    assert "ball has 1e-06 of the mass of as much liquid" in notice and "as if it had 0.0001" in notice
    (body,) = model.bodies
    volume = 4.0 / 3.0 * 3.141592653589793 * 0.3**3
    assert body.mass.mass == pytest.approx(0.1 * volume, rel=1e-9)
    assert body.mass.inertia[0, 0] == pytest.approx(0.4 * 0.1 * volume * 0.3**2, rel=1e-9)
    heavier = build_model(parse_deck(wet(xput=FREE + "imobs=1,", obs=light.replace("1e-3", ".2")), Path("t.nml")))
    assert heavier.notices == () and heavier.bodies[0].mass.mass == pytest.approx(0.2 * volume, rel=1e-9)
    tank = wet(xput=FREE.replace("itb=1", "itb=0") + "imobs=1,", obs=light, fl="")
    full = build_model(parse_deck(tank, Path("t.nml")))
    assert full.bodies[0].mass.mass == pytest.approx(1e-3 * volume, rel=1e-9)


PLANE = MESH.replace("nycelt=10", "nycelt=1")
BAR = "nobs=1, obsid(1)='bar', imo(1)=4, rhomvb(1)=500., iob(1)=1, xl(1)=.5, xh(1)=.9, zl(1)=.4, zh(1)=.8,"


@pytest.mark.parametrize(
    ("ends", "free"),
    [
        ("yl(1)=0., yh(1)=1.,", "ivmcal(1)=0, iomxcal(1)=0, iomzcal(1)=0"),
        ("yl(1)=.1, yh(1)=1., ivmcal(1)=0,", "iomxcal(1)=0, iomzcal(1)=0"),
        ("yl(1)=0., yh(1)=1., ivmcal(1)=0, iomxcal(1)=0, iomzcal(1)=0,", None),
        ("yl(1)=.1, yh(1)=.9,", None),  # both ends in the cell: what presses them is the same
        ("yl(1)=0., yh(1)=1., imoaxs(1)=2, xaxs0(1)=.7, zaxs0(1)=.6,", None),
    ],
)
def test_bodies_that_may_leave_the_plane(ends: str, free: str | None) -> None:
    """In a mesh of one cell in y, those that reach to a side of it."""
    deck = wet(xput=FREE + "imobs=1,", mesh=PLANE, obs=BAR + ends)
    told = [n for n in build_model(parse_deck(deck, Path("t.nml"))).notices if "only cell in y" in n]
    assert len(told) == (free is not None) and all(f"Write {free} for a motion in the plane" in n for n in told), told
