"""What contacts that stay are asked for: speeds at which gaps close (hold.py)."""

from types import SimpleNamespace

import numpy as np
from arenas import arena_of, loose
from flowgmo_scenes import Scene, ball, deck, number

from flowgmo.collision.contact import CONTACT
from flowgmo.collision.hold import CLOSING, SOON, Holder, least_of_pairs

G, LEG = 981.0, 1e-3  # cm, s
BLOCK = (0.758, 2.19, 4.178)  # cm, with gaps of 2.191: the dominoes of the report 4.4
ASKEW = 1e-5  # rad/s; measured 2e-7, what impacts leave; 1 where forces drift, or a step leads away from the solution
RISES = 1e-12  # of the energy; measured 4e-16; 2e-6 without landing.py
FLOOR = (3, 3, 3, 3, 2, 3)


def pairs(*numbers):
    contacts = np.zeros(len(numbers), CONTACT)
    contacts["a"], contacts["b"] = np.array(numbers).T
    contacts["normal"] = (0.0, 0.0, 1.0)
    return contacts


def test_the_least_of_each_pair():
    values = np.array([3.0, 1.0, 2.0, 5.0, 4.0])
    found = least_of_pairs(pairs((0, 1), (0, 1), (0, 2), (1, 2), (1, 2)), values)
    np.testing.assert_array_equal(found, [1.0, 1.0, 2.0, 4.0, 4.0])


def test_points_of_one_pair_close_as_one_where_their_gaps_hardly_differ():
    """To the bit, or points that stick get velocities that contradict each other; a tilt that is one keeps its own."""
    scene = loose(ball((0, 0, 0), r=1.0), ball((0, 0, 3), r=1.0))
    arena = arena_of(scene)
    arena.gravity = G
    holder = Holder(arena, SimpleNamespace(located=True))
    holder.leg = LEG
    soon, touch = SOON * G * LEG**2, arena.touch[0, 1]
    rows = pairs((0, 1), (0, 1))
    for gaps, closes in (
        ((0.2 * soon, 0.3 * soon), CLOSING * 0.2 * soon),
        ((0.9 * soon, 1.1 * soon), CLOSING * 0.9 * soon),
        ((20.0 * soon, 20.5 * soon), 20.0 * soon),
        ((20.0 * soon, 30.0 * soon), np.array([20.0, 30.0]) * soon),
        ((0.0, 0.5 * soon), 0.0),
        ((-0.5 * touch, 0.5 * soon), -CLOSING * 0.5 * touch),
        ((-20.0 * touch, 0.0), -CLOSING * touch),
    ):
        rows["gap"] = gaps
        found = holder._closing(rows, np.zeros(2), LEG)
        np.testing.assert_allclose(found, np.broadcast_to(closes, 2) / LEG, rtol=1e-12)
        assert found[0] == found[1] or np.ptp(gaps) > soon


def test_a_row_of_dominoes_falls_straight_and_gains_no_energy():
    """Eight blocks, the first turning, until seven have been hit: they lean on each other and stick to the floor.

    Fails where corners of one edge, 1e-10 cm apart in height, are to close at speeds that sticking forbids: the
    redundant forces drift from leg to leg; and where the solver goes on with steps that lead away from the solution
    (contact_newton.py): from .40 s on the row turns.
    """
    x, y, z = BLOCK
    limits = (
        f"xl(#)=0.0, xh(#)={number(x)}, yl(#)={number(-y / 2)}, yh(#)={number(y / 2)}, zl(#)=0.0, zh(#)={number(z)},"
    )
    blocks = [f"imo(#)=4, rhomvb(#)=1.2, iob(#)=#, {limits} trnx(#)={number(2.949 * k)}," for k in range(8)]
    blocks[0] += " utobs(1,#)=20.89, wtobs(1,#)=3.79, omytobs(1,#)=10.0,"
    s = Scene(deck(*blocks, lo=(-2, -3, 0), hi=(40, 3, 8), sides=FLOOR, g=(0, 0, -G), e=0.0, mu=0.176))
    askew, totals = 0.0, []
    for k in range(1, 451):
        s.to(k * LEG, LEG)
        askew = max(askew, np.abs(s.w[:, 2]).max())
        totals.append(s.kinetic() + G * np.sum(s.masses * s.p[:, 2]))
    assert len(np.unique(s.impacts["a"])) >= 6, "the row has not fallen"
    assert askew <= ASKEW
    assert np.diff(totals).max() <= RISES * totals[0]
