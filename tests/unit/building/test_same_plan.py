"""The same scene said in another way gives the same FluidPlan: resolved deck, other units, mirrored sides."""

import dataclasses
from pathlib import Path

import numpy as np
from flowgmo_wet import wet

from flowgmo.building import build_model
from flowgmo.deck import parse_deck

RICH = {
    "xput": "twfin=2., itb=1, gx=.5, gz=-9.75, ifvisc=1, con=.3, ipdis=1, tdtmax=.125, delt=1e-3,",
    "props": "rhof=1000., mu1=.125, rcsql=1e-9, ipgauge=0, p_reference=1024.,",
    "bcdata": (
        "ibct=5,6,2,2,1,5, timbct=0.,1., ubct(1,2)=-.5,-1., ubct(1,3)=.25, ihpbct(1)=1, flhtbct(1,1)=.5,.25,"
        "pbct(1,1)=1024.,1536., fbct(1,6)=0., fbct(1,2)=1.,.5, ipbctp(6)=0,"
    ),
    "fl": (
        "vlin=.5, pvoid=1024., presi=1280., nfls=2, fxl(1)=1., fxh(1)=1.5, frsh(2)=.25, ftrnx(2)=1.,"
        "fioh(2)=0, ureg(1)=.5, froty(1)=10., fcz2(2)=1., fcc(2)=-.5,"
    ),
    "obs": "nobs=1, iob(1)=1, zh(1)=.1, ifrco(1)=1, xfrco(1)=.5,",
    "flowgmo": "planez(2)=.25, planexh(2)=1.,",
}


def leaves(value, path=""):
    """All numbers, words and arrays of a plan, by the way to them; shapes by their distances."""
    if dataclasses.is_dataclass(value):
        for field in dataclasses.fields(value):
            yield from leaves(getattr(value, field.name), f"{path}.{field.name}")
    elif isinstance(value, tuple):
        for k, one in enumerate(value):
            yield from leaves(one, f"{path}[{k}]")
    else:
        yield path, value


def same(a, b):
    if hasattr(a, "distance"):
        x = np.random.default_rng(2).uniform((0, 0, 0), (2, 1, 1.5), (200, 3))
        a, b = a.distance(x), b.distance(x)
    return np.array_equal(a, b)


def test_the_resolved_deck_gives_the_same_plan():
    """What is stored beside the results computes the same liquid."""
    deck = parse_deck(wet(**RICH), Path("deck.nml"))
    first, again = build_model(deck), build_model(parse_deck(deck.resolved(), Path("deck.nml")))
    one, two = dict(leaves(first.fluid)), dict(leaves(again.fluid))
    assert one.keys() == two.keys() and len(one) > 60
    assert [key for key in one if not same(one[key], two[key])] == []
    assert [e.name for e in first.effects] == [e.name for e in again.effects]


def test_other_units_give_the_same_bits():
    """Length, mass, time in units of 4, 1/8, and 2: every value of the plan is the old one times a power of two."""
    L, M, T = 0.25, 8.0, 0.5
    xput = f"twfin={2 * T}, itb=1, gz={-9.75 * L / T**2}, ifvisc=1, ipdis=1,"
    props = f"rhof={1000 * M / L**3}, mu1={0.125 * M / L / T}, rcsql={1e-9 * T**2 * L / M},"
    bcdata = (
        f"ibct(2)=6,1,1,1,5, timbct=0.,{T}, ubct(1,2)={-0.3 * L / T},{-1.1 * L / T}, pbct(1,6)={700 * M / L / T**2},"
    )
    mesh = f"px=0., {2 * L}, nxcelt=20, py=0., {L}, nycelt=10, pz=0., {1.5 * L}, nzcelt=15,"
    fl = f"vlin={0.3 * L**3}, ui={0.7 * L / T}, presi={9 * M / L / T**2}, nfls=1, frsh(1)={0.1 * L},"
    old = wet(
        xput="twfin=2., itb=1, gz=-9.75, ifvisc=1, ipdis=1,",
        props="rhof=1000., mu1=.125, rcsql=1e-9,",
        bcdata="ibct(2)=6,1,1,1,5, timbct=0.,1., ubct(1,2)=-.3,-1.1, pbct(1,6)=700.,",
        fl="vlin=.3, ui=.7, presi=9., nfls=1, frsh(1)=.1,",
    )
    a = build_model(parse_deck(old, Path("a.nml"))).fluid
    b = build_model(parse_deck(wet(xput, props, fl, mesh, bcdata=bcdata), Path("b.nml"))).fluid
    assert (b.rho, b.mu) == (a.rho * M / L**3, a.mu * M / L / T)
    assert b.compressibility == a.compressibility * T**2 * L / M
    assert (b.steps, b.pressure, b.clean_up) == (a.steps, a.pressure, a.clean_up)
    assert b.start.volume == a.start.volume * L**3 and b.start.pressure == a.start.pressure * M / L / T**2
    assert (b.start.velocity == a.start.velocity * L / T).all()
    assert (b.sides[1].velocity == a.sides[1].velocity * L / T).all() and (b.sides[1].t == a.sides[1].t * T).all()
    assert (b.sides[5].pressure == a.sides[5].pressure * M / L / T**2).all()
