"""Periodic sides are no sides: where the box begins changes nothing."""

import numpy as np
import pytest
from flowgmo_wet import wet
from flowgmo_wet_runs import advance, start

REAL = (slice(2, -2),) * 3
N = 12


def box(axis, solid=(None, None), xput="", bcdata="ibct=4,4,4,4,4,4,", itb=0, fl=""):
    """A unit cube of N^3 cells with gravity across, in it bricks from `solid` along axis, in a corner of the others."""
    obs = ""
    if solid[0] is not None:
        others = [a for a in "xyz" if a != axis]
        spans = [(axis, part) for part in solid]
        obs = f"nobs={len(spans)},"
        for n, (a, (low, high)) in enumerate(spans, 1):
            obs += f"iob({n})={n}, {a}l({n})={low!r}, {a}h({n})={high!r}, {others[0]}h({n})=.3, {others[1]}h({n})=.62,"
    mesh = "".join(f"p{a}=0., 1., n{a}celt={N}," for a in "xyz")
    return wet(
        f"twfin=1., delt=.01, itb={itb}, ifvisc=1, gx=.7, gy=-.4, gz=.5, {xput}", props="rhof=1., mu1=.05,", fl=fl,
        mesh=mesh, bcdata=bcdata, obs=obs,
    )  # fmt: skip


def turned(a, axis, cells):
    """The real cells, moved on by so many along the axis."""
    return np.roll(a[REAL], cells, "xyz".index(axis))


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_a_random_flow_does_not_see_the_sides(axis):
    """Ten steps from a random velocity, and from the same moved on by 5 cells: measured 1e-13 apart in u and p. Without
    pressure across the sides, .1 and more."""
    rng = np.random.default_rng(3)
    fields = [rng.standard_normal((N, N, N)) for _ in range(3)]
    ends = []
    for move in (0, 5):
        liquid, flow, first = start(box(axis, xput="epsadj=1e-6,"))
        for u, a in zip(flow.velocity, fields, strict=True):
            u[REAL] = np.roll(a, move, "xyz".index(axis))
        liquid.sides.fill_velocity(flow.velocity)
        advance(liquid, flow, first, most=10)
        p = flow.p - flow.p[REAL].mean()  # known up to a constant
        ends.append([turned(a, axis, -move) for a in (*flow.velocity, p)])
    for one, other in zip(*ends, strict=True):
        assert np.abs(one - other).max() <= 1e-8 * np.abs(one).max()


@pytest.mark.parametrize("implicit", [0, 3])
@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_a_solid_across_the_sides(axis, implicit):
    """A brick that ends inside cells, in the middle of the box and across its sides: the same flow. Ghosts of open
    fractions that mirror instead of going on give 10 % here."""
    ends = []
    for move, solid in ((0, ((2.3 / N, 6.6 / N),)), (8, ((10.3 / N, 2.0), (-1.0, 2.6 / N)))):
        liquid, flow, first = start(box(axis, solid, xput=f"epsadj=1e-4, impvis={implicit},"))
        advance(liquid, flow, first, end=0.5)
        ends.append([turned(a, axis, -move) for a in flow.velocity])
    for one, other in zip(*ends, strict=True):
        assert np.abs(one - other).max() <= 1e-5 * max(np.abs(a).max() for a in ends[0])
