"""Notices about bodies that move in liquid."""

from pathlib import Path

import pytest
from flowgmo_wet import FREE, wet

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


@pytest.mark.parametrize("obs", [BALL + INSIDE, BALL.replace("imo(1)=4", "imo(1)=3") + "trnz(1)=.6, trny(1)=.5,"])
def test_silent(obs: str) -> None:
    """A ball of six cells across inside, and a prescribed one that enters through a side."""
    assert notices(obs) == ()
