"""What enters through a side that gives FBCT between 0 and 1: F per volume, however the liquid is moved. The books of
the sides of a domain that is full."""

import sys
from pathlib import Path

import numpy as np
import pytest

HELPERS = str(Path(__file__).parents[2] / "helpers")
if HELPERS not in sys.path:
    sys.path.insert(0, HELPERS)

from flowgmo_wet import wet  # noqa: E402
from flowgmo_wet_runs import REAL, advance, start  # noqa: E402
from liquid_scenes import NO_SOLIDS, even, mesh, mirror  # noqa: E402

from flowgmo.flow.fields import Flow  # noqa: E402
from flowgmo.flow.surface.surface_tracking import move_liquid, tracking_of  # noqa: E402
from flowgmo.flow.team import Team  # noqa: E402

F, U, END, DEPTH = 0.3, 1.0, 0.12, 0.23
CELLS, LENGTH = (10, 6, 9), (1.0, 0.6, 0.9)


def inflow(d, upper, *, thin=None, filled=True, given=f"fbct(1,{{n}})={F},", kind=6, xput="", **blocks):
    """(deck, area of the side): a box into which liquid comes through a side across d, and opposite it may leave. thin:
    the direction of one layer of cells."""
    cells, length, kinds, n = list(CELLS), list(LENGTH), [2] * 6, 2 * d + upper + 1
    if thin is not None:
        cells[thin], length[thin] = 1, 0.1
        kinds[2 * thin] = kinds[2 * thin + 1] = 1
    kinds[n - 1], kinds[2 * d + (not upper)] = kind, 8
    lines = "".join(f"p{x}=0., {a}, n{x}celt={m}," for x, a, m in zip("xyz", length, cells, strict=True))
    speed = f" {'uvw'[d]}bct(1,{n})={-U if upper else U}," if kind == 6 else ""
    sides = "ibct=" + "".join(f"{k}," for k in kinds) + speed + given.format(n=n)
    gravity = "gz=-10.," if thin != 2 else ""
    options = f"twfin=2., delt=.005, itb=1, {gravity} {xput}"
    deck = wet(options, fl=f"flht={DEPTH}," if filled else "", mesh=lines, bcdata=sides, **blocks)
    return deck, float(np.prod(np.delete(length, d)))


def assert_brings(deck, side, area):
    """F U area END came in through the side, to round-off, and it is what is there."""
    liquid, flow, first = start(deck)
    _, over, books = advance(liquid, flow, first, END)
    assert flow.passed[side] == pytest.approx(F * U * area * END, rel=1e-13)
    assert books <= 1e-14
    assert over <= 2e-6 and flow.F[REAL].min() >= -1e-14  # 1.1e-6: the pressure's tolerance


@pytest.mark.parametrize("upper", [False, True])
@pytest.mark.parametrize(("d", "thin"), [(0, None), (1, None), (2, None), (0, 1), (0, 2), (1, 0), (2, 0), (2, 1)])
def test_a_share_of_the_stream_enters(d, thin, upper):
    """To 2e-16 over water. With planes in the ghosts it was .73 of it in a channel over water."""
    deck, area = inflow(d, upper, thin=thin)
    assert_brings(deck, 2 * d + upper, area)


@pytest.mark.parametrize("dt", [0.02, 0.005])
@pytest.mark.parametrize("upper", [False, True])
def test_what_a_table_says_comes_in(upper, dt):
    """The integral of a velocity that rises and falls between the steps, over any of them: to 1e-13. With that of
    each end 10 % too much after .1 s of a rise from nothing in steps of .02 s, 2.5 % in steps of .005."""
    sign = -1.0 if upper else 1.0
    table = ", ".join(repr(sign * u) for u in (0.0, 0.5, 0.2, 0.2))
    n = 1 + upper
    given = f"timbct=0., .073, .117, 5., ubct(1,{n})={table},"
    deck, area = inflow(0, upper, given=given, kind=6, xput=f"tdtmax={dt},")
    liquid, flow, first = start(deck.replace(f"ubct(1,{n})={-U if upper else U},", ""))
    advance(liquid, flow, first, 0.2)
    brought = 0.5 * 0.073 * 0.5 + 0.5 * 0.7 * 0.044 + 0.2 * 0.083
    assert flow.passed[n - 1] == pytest.approx(area * brought, rel=1e-12)


@pytest.mark.parametrize("thin", [None, 1])
@pytest.mark.parametrize("ifvof", [4, 5, 6])
def test_a_share_enters_a_dry_box(ifvof, thin):
    """To 2e-16. With planes in the ghosts .013 of it came in, with the donor's flux .065."""
    deck, area = inflow(0, False, thin=thin, filled=False, xput=f"ifvof={ifvof},")
    assert_brings(deck, 0, area)


def test_a_share_enters_where_the_side_is_open():
    """A block that cuts cells of the side leaves .6 x .9 - .33 x .47 of it."""
    deck, area = inflow(0, False, obs="nobs=1, iob(1)=1, xh(1)=.2, yh(1)=.33, zh(1)=.47,")
    assert_brings(deck, 0, area - 0.33 * 0.47)


@pytest.mark.parametrize("thin", [None, 1])
def test_a_pressure_side_lets_a_share_enter(thin):
    """F times what its velocities bring in, step by step."""
    deck, _ = inflow(0, False, thin=thin, kind=5, given=f"pbct(1,{{n}})=4000., fbct(1,{{n}})={F},")
    liquid, flow, first = start(deck)
    area, brought = np.multiply.outer(liquid.grid.dy, liquid.grid.dz)[2:-2, 2:-2], []

    def note(t, flow):
        brought.append(F * flow.dt * float((area * flow.u[1, 2:-2, 2:-2].clip(0.0)).sum()))

    _, _, books = advance(liquid, flow, first, END, each=note)
    assert brought[-1] > brought[0] > 0.0
    assert flow.passed[0] == pytest.approx(sum(brought), rel=1e-13)
    assert books <= 1e-14


def test_a_height_says_where_the_liquid_lies():
    """Of a side with FLHTBCT nothing is spread: the cell that holds the level has a plane beyond the side too."""
    spread = start(inflow(0, False)[0])[0].sides.spread
    assert spread == (F, None, None, None, None, None)
    deck, _ = inflow(0, False, given=f"ihpbct({{n}})=1, flhtbct(1,{{n}})={DEPTH},")
    assert start(deck)[0].sides.spread == (None,) * 6


def test_pieces_of_what_entered_fit_their_cells():
    """One layer, through two sides at once: over- and underfull by 2.6e-16, measured. Where the second sweep cut the
    first one's pieces from planes beyond the side, cells would be underfull by 1.3e-3."""
    n, share, dt = 16, 0.3, 0.4 / 16
    _, grid, shape = mesh(even(n), [0, 1 / n], even(n))
    liquid, tracking = np.zeros(shape), tracking_of(grid)

    def fill(F):
        mirror(F)
        F[:2] = F[:, :, :2] = share

    stream, spread = (np.ones(shape), None, np.ones(shape)), (share, None, None, None, share, None)
    for number in range(120):
        flow = Flow(*stream, None, liquid, dt)
        moved = move_liquid(Team(1), tracking, flow, NO_SOLIDS, dt, number, fill, spread=spread)
        tracking.pieces.keep_moments()
        assert moved.over <= 1e-14 and moved.under >= -1e-14
        assert moved.entered[[0, 4]] == pytest.approx(share * dt / n, rel=1e-13)


FULL_SIDES = [
    ("ibct=6,5,2,2,2,2, ubct(1,1)=1., pbct(1,2)=0.,", "", "", {0: U * 0.9 * 0.6}),
    ("ibct=2,2,5,2,2,6, wbct(1,6)=-1.,", "", "nobs=1, iob(1)=1, xh(1)=.3, yl(1)=.2, zl(1)=.7,", {5: U * (0.6 - 0.12)}),
    ("ibct=4,4,1,1,1,1,", "gx=1.,", "", {}),
]


@pytest.mark.parametrize(("sides", "xput", "obs", "brought"), FULL_SIDES)
def test_books_of_a_full_domain(sides, xput, obs, brought):
    """What a velocity side brings is u A t, of its open part, to round-off, and as much leaves: to 4e-9 and 2e-9 of the
    domain, measured; the pressure's tolerance is 1e-6 of each cell and step. Round a periodic domain to the bit."""
    mesh = "px=0., 1., nxcelt=10, py=0., .6, nycelt=6, pz=0., .9, nzcelt=9,"
    blocks = {"obs": obs} if obs else {}
    deck = wet(f"twfin=2., delt=.005, itb=0, {xput}", fl="", mesh=mesh, bcdata=sides, **blocks)
    liquid, flow, first = start(deck)
    advance(liquid, flow, first, END)
    for side, rate in brought.items():
        assert flow.passed[side] == pytest.approx(rate * END, rel=1e-13)
    assert np.abs(flow.passed).max() > 1e-3
    assert abs(flow.passed.sum()) <= (1e-7 * 0.54 if brought else 0.0)
