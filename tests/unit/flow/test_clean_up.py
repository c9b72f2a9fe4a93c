"""Slivers are closed once, what is closed is reported, and cleaning up ends."""

import sys
from pathlib import Path

import numpy as np
import pytest

HELPERS = str(Path(__file__).parents[2] / "helpers")
if HELPERS not in sys.path:
    sys.path.insert(0, HELPERS)

from flow_solids import INNER, HalfSpace, ball, box, graded_block  # noqa: E402
from flowgmo_wet import wet  # noqa: E402

from flowgmo.building import build_model  # noqa: E402
from flowgmo.deck import parse_deck  # noqa: E402
from flowgmo.flow.build import build_liquid  # noqa: E402
from flowgmo.flow.favor.clean_up import close_slivers  # noqa: E402
from flowgmo.flow.favor.cut_pairs import cell_volumes  # noqa: E402
from flowgmo.flow.favor.fractions import open_fractions  # noqa: E402

SOLIDS = [box((0.3, 0.2, 0.25), (0.4, 0.4, 0.4), (20, 30, 40)), ball(0.2, (0.6, 0.6, 0.5))]


def ones(n=4):
    return tuple(np.ones((n + 4,) * 3) for _ in range(4))


def test_fractions_near_zero_and_one_become_zero_and_one():
    fields = ones()
    fields[0][3, 3, 3], fields[0][4, 4, 4], fields[1][3, 4, 4] = 1 - 5e-5, 0.3, 5e-5
    close_slivers(*fields, 1e-4, 0.0, None)
    assert fields[0][3, 3, 3] == 1.0
    assert fields[0][4, 4, 4] == 0.3
    assert fields[1][3, 4, 4] == 0.0


def test_a_closed_cell_has_closed_faces_and_a_locked_cell_is_closed():
    """A full cell behind six closed faces holds no liquid that could move; closing one may lock the next."""
    V, Ax, Ay, Az = fields = ones()
    Ax[3, 4, 4] = Ax[4, 4, 4] = Ay[4, 3, 4] = Ay[4, 4, 4] = Az[4, 4, 3] = Az[4, 4, 4] = 0.0
    V[2, 2, 2] = 0.0
    close_slivers(*fields, 0.0, 0.0, None)
    assert V[4, 4, 4] == 0.0
    assert Ax[1, 2, 2] == Ax[2, 2, 2] == Ay[2, 1, 2] == Az[2, 2, 2] == 0.0
    assert (V[INNER] == 0.0).sum() == 2


def test_lone_small_cells_are_closed_and_others_kept():
    """Two cells of 3 % that touch only each other go; one of 3 % beside a full one stays (VFCLEAN)."""
    V, Ax, Ay, Az = fields = ones(6)
    for a in fields:
        a[2:5, 2:5, 2:5] = 0.0
    V[3, 3, 3] = V[3, 3, 2] = 0.03
    Az[3, 3, 2] = 0.5
    V[6, 6, 6] = 0.03
    close_slivers(*fields, 0.0, 0.05, None)
    assert V[3, 3, 3] == V[3, 3, 2] == 0.0
    assert Az[3, 3, 2] == 0.0
    assert V[6, 6, 6] == 0.03


def test_volumes_are_raised_only_where_it_is_asked_for():
    """AVRCK: V >= largest A / 3.1."""
    block = graded_block(12)
    plain = open_fractions(block, SOLIDS)
    raised = open_fractions(block, SOLIDS, area_ratio=3.1)
    V, Ax, Ay, Az = (a[INNER] for a in raised.open)
    largest = np.max([Ax, Ay, Az], axis=0)
    assert (largest[V > 0] <= 3.1 * V[V > 0] + 1e-12).all()
    assert (plain.open.V[INNER] <= V).all()
    assert raised.lost.added > plain.lost.added


@pytest.mark.parametrize("least", [0.0, 1e-4, 0.05, 0.4])
def test_what_was_closed_and_added_is_reported(least):
    block = graded_block(12)
    raw, clean = open_fractions(block, SOLIDS, least=0.0, lone=0.0), open_fractions(block, SOLIDS, least=least)
    change = ((clean.open.V - raw.open.V)[INNER] * cell_volumes(block)).sum()
    assert change == pytest.approx(clean.lost.added - clean.lost.closed, abs=1e-15)
    assert clean.lost.closed >= 0.0
    if least == 1e-4:
        assert clean.lost.closed < 1e-6


def test_a_sliver_along_a_wall():
    """A wall 1e-5 of a cell short of a mesh plane: its cells are closed, the faces behind them are the wall."""
    block = graded_block(10, grade=0.0)
    wall = HalfSpace([0, 0, 1], block.z[4] - 1e-5 / 9)
    solids = open_fractions(block, [wall])
    V, Ax, Ay, Az = solids.open
    assert (V[2:-2, 2:-2, 2:6] == 0.0).all()
    assert (V[2:-2, 2:-2, 6:-2] == 1.0).all()
    assert (Az[2:-2, 2:-2, 5] == 0.0).all()
    s = solids.shares[0]  # nothing of these faces was covered: the closed cells' solid takes them
    assert len(s.cells) == 110
    assert (s.cells[:, 2] == 6).all()
    np.testing.assert_array_equal(s.faces, np.tile([0, 0, 0, 0, 1.0, 0], (110, 1)))


def test_the_deck_raises_volumes():
    """IAVRCK=1, AVRCK=-3.1 reaches the mesh: V >= largest A / 3.1 there; without, thinner slivers stay."""
    obs = "nobs=1, iob(1)=1, xh(1)=.6, zh(1)=.705, roty(1)=3.,"
    least = []
    for more in ("", "avrck=-3.1,", "iavrck=1, avrck=-3.1,"):
        model = build_model(parse_deck(wet(obs=obs + more, fl="flht=1.2,"), Path("t.nml")))
        V, Ax, Ay, Az = (a[INNER] for a in build_liquid(model, 1).openings)
        largest = np.max([Ax, Ay, Az], axis=0)
        least.append((V[V > 0] / largest[V > 0]).min())
    assert least[0] == least[1] < 0.2
    assert least[2] >= (1 - 1e-12) / 3.1
