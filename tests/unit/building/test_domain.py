"""Mesh planes: uniform, by intervals, graded, by size, by total; sides of the domain."""

import numpy as np
import pytest


@pytest.fixture
def mesh(build):
    def one(lines, **more):
        lines = f"{lines} py=0., 1., pz=0., 1.,".replace(", ", ",\n ")
        return build(f"t\n&xput\n twfin=1.,\n/\n&bcdata {more.get('sides', '')} /\n&mesh\n {lines}\n/\n").mesh

    return one


@pytest.fixture
def planes(mesh):
    return lambda lines: mesh(lines).blocks[0].x


def widths(x):
    return np.diff(x)


def test_uniform(planes):
    assert planes("px=-1., 1., nxcelt=8,").tolist() == np.linspace(-1, 1, 9).tolist()


def test_default_is_one_cell(mesh):
    made = mesh("")
    assert made.cells == 1 and made.bounds.tolist() == [[0, 0, 0], [1, 1, 1]]


def test_cells_of_each_interval(planes):
    assert planes("px=0., 3., 5., nxcell(1)=3, nxcell(2)=8,").tolist() == [0, 1, 2, 3, *np.arange(3.25, 5.01, 0.25)]


def test_total_is_shared_by_length(planes):
    """3 : 1 of 8 cells."""
    x = planes("px=0., 3., 4., nxcelt=8,")
    assert widths(x) == pytest.approx([0.5] * 6 + [0.5] * 2) and 3.0 in x


def test_total_and_one_interval(planes):
    """What the first interval leaves goes to the others."""
    x = planes("px=0., 1., 2., 4., nxcell(1)=4, nxcelt=10,")
    assert widths(x) == pytest.approx([0.25] * 4 + [0.5] * 2 + [0.5] * 4)


def test_every_interval_gets_a_cell(planes):
    assert len(planes("px=0., 1e-6, 1., nxcelt=2,")) == 3


def test_sizes_at_both_ends(planes):
    """Number from the mean size, ratio of neighbours constant, first : last as given."""
    x = planes("px=0., 1., sizex(1)=.05, sizex(2)=.15,")
    w = widths(x)
    assert len(w) == 10
    assert w[-1] / w[0] == pytest.approx(3.0) and w[1:] / w[:-1] == pytest.approx(np.full(9, 3 ** (1 / 9)))
    assert (x[0], x[-1]) == (0.0, 1.0)


@pytest.mark.parametrize("end", [1, 2])
def test_size_at_one_end(planes, end):
    """The cell at that end has the size, the ratio is constant: a geometric series that fills the interval."""
    w = widths(planes(f"px=0., 1., nxcell(1)=12, sizex({end})=.02,"))
    w = w if end == 1 else w[::-1]
    assert w[0] == pytest.approx(0.02, rel=1e-9) and w.sum() == pytest.approx(1.0)
    assert w[1:] / w[:-1] == pytest.approx(np.full(11, w[1] / w[0])) and w[1] > w[0]


def test_planes_at_anchors_are_exact(planes):
    x = planes("px=0., .1, .7, nxcelt=21, sizex(1)=.01, sizex(2)=.03, sizex(3)=.09,")
    assert 0.1 in x and x[-1] == 0.7 and (np.diff(x) > 0).all()


def test_one_size_for_all(mesh):
    made = mesh("px=0., 2., if_size=1, size=.1,")
    assert made.blocks[0].shape == (20, 10, 10)


def test_total_for_all(mesh):
    """Cubes: 2 x 1 x 1 with 2000 of them."""
    made = mesh("px=0., 2., if_size=0, ntotal=2000,")
    assert made.blocks[0].shape == (20, 10, 10)


def test_sides(mesh):
    made = mesh("", sides="ibct(1)=1, ibct(2)=2, ibct(3)=3, ibct(4)=8, ibct(5)=2, ibct(6)=3")
    assert [side.kind for side in made.sides] == [1, 2, 3, 8, 2, 3]
    assert [side.stops_bodies for side in made.sides] == [True, True, False, False, True, False]
    assert made.blocks[0].neighbours == made.sides


@pytest.mark.parametrize(
    ("lines", "says"),
    [
        ("px=0., 1., nxcelt=2000000000,", ["deck.nml:9: &mesh nxcelt=2000000000", "cells"]),
        ("px=0., 1., sizex(1)=1e-12,", ["deck.nml", "&mesh", "cells"]),
        ("px=0., 1., if_size=1, size=1e-300,", ["deck.nml", "&mesh", "cells"]),
        ("px=-1e308, 1e308, nxcelt=2,", ["deck.nml", "&mesh", "over inf in x"]),
        ("px=0., 1., 2., 3., nxcell(1)=1, nxcell(2)=1,", ["nxcell(3)", "missing"]),
        ("px=0., 1., nxcell(2)=4,", ["nxcell(2)=4", "1 intervals"]),
        ("px=1., 1.,", ["px(2)=1.0", "does not lie beyond"]),
        ("px(1)=0., px(4)=5.,", ["px(3)", "missing"]),
    ],
)
def test_impossible_meshes(problems, lines, says):
    lines = lines.replace(", ", ",\n ")
    found = "\n".join(problems(f"t\n&xput\n twfin=1.,\n/\n&mesh\n py=0., 1., pz=0., 1.,\n {lines}\n/\n"))
    assert all(word in found for word in says), found
