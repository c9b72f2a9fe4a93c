"""Rows of contacts beside the pressure equation: what they make of the bodies' answer, group by group."""

import numpy as np
import pytest

from flowgmo.flow.immersed import contact_rows
from flowgmo.flow.immersed.contact_rows import constrain


def scene(pairs, n=6, seed=3):
    """(W, U*, rows, speed) of n bodies; pairs (a, b): six rows between a and b, b < 0 a partner that is not moved."""
    rng = np.random.default_rng(seed)
    W = np.zeros((6 * n, 6 * n))
    for b in range(n):
        root = rng.normal(size=(6, 6))
        W[6 * b : 6 * b + 6, 6 * b : 6 * b + 6] = root @ root.T + np.eye(6)
    rows = np.zeros((6 * len(pairs), 6 * n))
    for k, pair in enumerate(pairs):
        for b in pair:
            if b >= 0:  # four of six say something of their own, as corners of a box on a floor
                rows[6 * k : 6 * k + 6, 6 * b : 6 * b + 6] = rng.normal(size=(6, 4)) @ rng.normal(size=(4, 6))
    wanted = rng.normal(size=6 * n)
    return W, rng.normal(size=6 * n), rows, rows @ wanted  # right-hand sides that can be met


PILES = [(0, -1), (3, -1), (1, 4), (4, -1), (5, 2)]


def test_groups_answer_as_all_of_them_together():
    # Measured: 2e-15. A row or a body in the wrong group would be of order one off.
    W, start, rows, speed = scene(PILES)
    order = np.random.default_rng(5).permutation(len(rows))
    rows, speed = rows[order], speed[order]
    found, whole = constrain(W, start, rows, speed), contact_rows._constrain_group(W, start, rows, speed)
    for a, b in zip(found, whole, strict=True):
        assert np.abs(a - b).max() <= 1e-11 * np.abs(b).max()


def test_rows_are_met_and_bodies_without_any_are_left_alone():
    W, start, rows, speed = scene([(0, -1), (1, 4)])
    answer, U, inverse = constrain(W, start, rows, speed)
    assert np.abs(rows @ U - speed).max() <= 1e-12 * np.abs(speed).max()
    assert np.abs(rows @ answer).max() <= 1e-12 * np.abs(W).max() * np.abs(rows).max()
    impulse = -inverse @ (rows @ start - speed)
    assert np.abs(start + W @ rows.T @ impulse - U).max() <= 1e-11 * np.abs(U).max()
    for b in (2, 3, 5):
        own = slice(6 * b, 6 * b + 6)
        assert np.array_equal(answer[own, own], W[own, own])
        assert np.array_equal(U[own], start[own])


def test_a_group_does_not_feel_how_heavy_another_one_is():
    """What is small beside the largest counts as nothing: beside the largest of its own group. With all bodies in one
    the rows of a pebble on a bed were dropped where others were 4e15 times as light."""
    W, start, rows, speed = scene([(0, -1), (1, 4)])
    light = W.copy()
    light[6:12, 6:12] *= 2.0**52
    light[24:30, 24:30] *= 2.0**52
    alone, beside = constrain(W, start, rows, speed)[1], constrain(light, start, rows, speed)[1]
    assert np.array_equal(alone[:6], beside[:6])


@pytest.mark.parametrize(("pairs", "sizes"), [(PILES, [1, 1, 2, 2]), ([(0, 1), (1, 2), (2, 3)], [4]), ([(5, -1)], [1])])
def test_groups_are_what_rows_join(pairs, sizes):
    W, _, rows, _ = scene(pairs)
    groups = contact_rows._groups(W, rows)
    assert sorted(len(bodies) // 6 for _, bodies in groups) == sizes
    assert sum(len(of) for of, _ in groups) == len(rows)
    W[0, 35] = W[35, 0] = 1.0  # what joins bodies otherwise joins them here
    joined = [set(bodies // 6) for _, bodies in contact_rows._groups(W, rows)]
    assert all((0 in g) == (5 in g) for g in joined)


def test_groups_that_are_known_are_looked_up():
    """Another right-hand side for one group: that one alone is solved anew, and all is as found without knowing."""
    W, start, rows, speed = scene(PILES)
    known = {}
    first = constrain(W, start, rows, speed, known)
    before = len(known)
    speed[0] += 1.0
    again, plain = constrain(W, start, rows, speed, known), constrain(W, start, rows, speed)
    assert before == 4 and len(known) == 5
    assert all(np.array_equal(a, b) for a, b in zip(again, plain, strict=True))
    assert not np.array_equal(first[1], again[1])
