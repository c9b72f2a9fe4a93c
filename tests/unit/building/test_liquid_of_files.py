"""Liquid at the start whose region is an STL file: the same as of its shape, with limiters, transform and order."""

import sys
from pathlib import Path

import numpy as np
import pytest

HELPERS = str(Path(__file__).parents[2] / "helpers")
if HELPERS not in sys.path:
    sys.path.insert(0, HELPERS)

from flow_solids import ball  # noqa: E402
from flowgmo_wet import wet  # noqa: E402
from flowgmo_wet_runs import REAL  # noqa: E402

from flowgmo.building import build_model  # noqa: E402
from flowgmo.deck import DeckError, parse_deck  # noqa: E402
from flowgmo.flow.build import build_liquid, initial_flow  # noqa: E402
from flowgmo.geometry import Component, Limits, Piece  # noqa: E402

LOW, HIGH = (0.23, 0.11, 0.0), (1.17, 0.68, 0.77)
FILE = "iflinittyp=0, nfls=1, ifdis(1)=-1, ffstl(1)='parts/b.stl',"


@pytest.fixture
def deck(tmp_path):
    """Puts a shape's triangles in parts/b.stl, and reads a deck beside it."""
    (tmp_path / "parts").mkdir()

    def read(shape, *detail, fl=FILE):
        vertices, faces = shape.triangles(*detail)
        facet = "facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n"
        corner = "vertex {!r} {!r} {!r}\n"
        text = "".join(facet.format("".join(corner.format(*v) for v in vertices[f].tolist())) for f in faces)
        (tmp_path / "parts" / "b.stl").write_text(f"solid b\n{text}endsolid b\n")
        return parse_deck(wet(fl=fl), tmp_path / "deck.nml")

    return read


def liquid_of(deck):
    """(F, volume) at the start; the mesh has cells of .1 x .1 x .1."""
    model = build_model(deck)
    flow = initial_flow(build_liquid(model, 1), model)
    return flow.F[REAL], flow.start_volume


def corners(low=LOW, high=HIGH):
    return Component([Piece(limits=Limits(*zip(low, high, strict=True)))])


def bounds(low, high):
    return "".join(
        f"f{a}l(1)={float(lo)!r}, f{a}h(1)={float(hi)!r}," for a, lo, hi in zip("xyz", low, high, strict=True)
    )


def test_a_box_of_triangles_is_the_box(deck):
    """F and volume to round-off."""
    F, volume = liquid_of(deck(corners()))
    plain, of_plain = liquid_of(parse_deck(wet(fl="iflinittyp=0, nfls=1," + bounds(LOW, HIGH)), Path("d.nml")))
    np.testing.assert_allclose(F, plain, atol=1e-13)
    assert volume == pytest.approx(np.prod(np.subtract(HIGH, LOW)), rel=1e-13) == of_plain


def test_it_is_moved_and_bounded_as_other_regions(deck):
    """Half as large, shifted, cut off above: the box that this leaves; and taken away from a pool."""
    more = "fmagn(1)=.5, ftrnx(1)=.3, ftrny(1)=.2, fzh(1)=.4,"
    low = np.array(LOW) * 0.5 + [0.3, 0.2, 0.0]
    high = np.minimum(np.array(HIGH), [9.0, 9.0, 0.4]) * 0.5 + [0.3, 0.2, 0.0]
    F, volume = liquid_of(deck(corners(), fl=FILE + more))
    assert volume == pytest.approx(np.prod(high - low), rel=1e-13)
    plain, _ = liquid_of(parse_deck(wet(fl="iflinittyp=0, nfls=1," + bounds(low, high)), Path("d.nml")))
    np.testing.assert_allclose(F, plain, atol=1e-13)
    pool = "flht=1., nfls=1, fioh(1)=0," + FILE.partition("nfls=1,")[2]
    assert liquid_of(deck(corners(), fl=pool))[1] == pytest.approx(2.0 - np.prod(np.subtract(HIGH, LOW)), rel=1e-13)


@pytest.mark.parametrize(("detail", "bound"), [(8, 1e-4), (12, 1e-4), (24, 4e-4)])
def test_a_ball_of_triangles(deck, detail, bound):
    """48, 120, 528 triangles, 8 cells across: error of the volume between them 7.0e-5, 1.3e-5, 2.9e-4, measured. The
    last have more than five planes in a cell (test_orders_of_curved_regions); a ball that is missed: 1."""
    shape = ball(0.4, (1.0, 0.5, 0.7))
    vertices, faces = shape.triangles(detail)
    a, b, c = np.moveaxis(vertices[faces], 1, 0)
    F, volume = liquid_of(deck(shape, detail))
    assert volume == pytest.approx((a * np.cross(b, c)).sum() / 6, rel=bound)
    assert F.min() >= 0.0 and F.max() <= 1.0


@pytest.mark.parametrize(
    ("fl", "variable", "says"),
    [
        ("nfls=1, ffstl(1)='parts/b.stl'", "ffstl(1)='parts/b.stl'", "no effect with ifdis(1)=0"),
        ("nfls=1, ifdis(1)=-1", "ifdis(1)=-1", "file of this region is missing. Give ffstl(1)"),
        ("nfls=1, ifdis(1)=-1, ffstl(1)='no.stl'", "ffstl(1)='no.stl'", "there is no file no.stl beside the deck"),
    ],
)
def test_files_that_are_not_meant_or_not_there(deck, fl, variable, says):
    with pytest.raises(DeckError) as caught:
        deck(corners(), fl=fl)
    (problem,) = caught.value.problems
    assert problem.variable == variable and says in str(problem)


def test_a_file_that_is_no_body(deck):
    """An open surface is a problem of the region's file, and nothing else is said; so is a body beside the mesh."""

    class Open:
        triangles = staticmethod(lambda: (corners().triangles()[0], corners().triangles()[1][1:]))

    for shape, says in ((Open, "Repair the file"), (corners((5, 5, 5), (6, 6, 6)), "lies outside the mesh")):
        with pytest.raises(DeckError) as caught:
            build_model(deck(shape))
        (problem,) = caught.value.problems
        assert problem.variable == "ffstl(1)='parts/b.stl'" and says in str(problem)
