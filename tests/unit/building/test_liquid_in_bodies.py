"""Liquid of a deck inside of bodies runs into nothing: it is said of which region, and of which bodies."""

import pytest
from flowgmo_wet import FREE, wet

BLOCK = "nobs=1, obsid(1)='block', iob(1)=1, xl(1)=.4, xh(1)=.9, yl(1)=.2, yh(1)=.8, zl(1)=.2, zh(1)=.9,"
HALVES = (
    "nobs=2, obsid(1)='left', iob(1)=1, xl(1)=.4, xh(1)=.7, yl(1)=.2, yh(1)=.8, zl(1)=.2, zh(1)=.9, obsid(2)='right', "
    "iob(2)=2, xl(2)=.7, xh(2)=.9, yl(2)=.2, yh(2)=.8, zl(2)=.2, zh(2)=.9,"
)
HOLLOW = BLOCK + "iob(2)=1, ioh(2)=0, rsh(2)=.1, trnx(2)=.6, trny(2)=.5, trnz(2)=.5,"
DROP = "nfls=1, frsh(1)=.15, ftrnx(1)=.6, ftrny(1)=.5, ftrnz(1)=.5,"
INSIDE = "frsh(1)=0.15: region 1 of the liquid lies inside {}: none of it is there"


@pytest.mark.parametrize(
    ("obs", "who"), [(BLOCK, "block"), (HALVES, "left and right"), (BLOCK + "imo(1)=4, rhomvb(1)=500.,", "block")]
)
def test_a_region_inside_is_told(build, problems, obs, who):
    """Beside other liquid, of which one says nothing; where it is all there is the deck is wrong."""
    xput = FREE + ("imobs=1," if "imo" in obs else "")
    (notice,) = build(wet(xput=xput, fl="flht=.1," + DROP, obs=obs)).notices
    assert INSIDE.format(who) in notice
    (problem,) = problems(wet(xput=xput, fl=DROP, obs=obs))
    assert INSIDE.format(who) + ", and there is no other liquid" in problem


def test_a_height_within_a_floor(problems):
    (problem,) = problems(wet(fl="flht=.2,", obs="nobs=1, obsid(1)='floor', iob(1)=1, zh(1)=.25,"))
    assert "flht=0.2: all liquid below flht=0.2 lies inside floor" in problem


def test_liquid_may_come_later(build):
    """Through a side: the region is still told of."""
    (notice,) = build(wet(fl=DROP, obs=BLOCK, bcdata="ibct(1)=5, ihpbct(1)=1, flhtbct(1,1)=.3,")).notices
    assert INSIDE.format("block") in notice


@pytest.mark.parametrize(
    ("obs", "fl"),
    [
        (HOLLOW, DROP),  # some of it in the hole of the body
        (BLOCK, DROP.replace("ftrnx(1)=.6", "ftrnx(1)=.83")),  # a cap outside, 3e-2 of it
        (BLOCK, "flht=.1, nfls=1, fioh(1)=0, frsh(1)=.1, ftrnx(1)=.6, ftrny(1)=.5, ftrnz(1)=.5,"),  # takes away
        ("nobs=1, iob(1)=1, zl(1)=.001,", "flht=.5,"),  # a film under a block
        ("", DROP),
    ],
)
def test_what_is_partly_outside_is_not(build, obs, fl):
    assert build(wet(fl=fl, obs=obs) if obs else wet(fl=fl)).notices == ()
