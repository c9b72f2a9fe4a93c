"""decks/piston: prescribed motion, its stops and its table, and the force that keeps it."""

import numpy as np
import pytest

MASS, AMPLITUDE, OMEGA = 10.0, 0.3, np.pi


@pytest.mark.parametrize("deck", ["piston", "stops", "table"])
def test_reference(deck, runs):
    # Measured: 1e-16 m, 3e-14 N. 1e-8 would reveal a motion summed up step by step, or degrees taken for radians.
    runs.agree("piston", deck, 1e-8)


def test_sinusoid_all_along(runs):
    # Measured: 1e-16 m, 3e-16 m/s, 8e-15 N. u = A cos(w t), x = A/w sin(w t), F = -m A w sin(w t).
    curves = runs.curves("piston", "piston")
    t, piston = curves.time, curves.bodies["piston"]
    assert np.abs(piston["velocity"][:, 0] - AMPLITUDE * np.cos(OMEGA * t)).max() <= 1e-8
    assert np.abs(piston["position"][:, 0] - AMPLITUDE / OMEGA * np.sin(OMEGA * t)).max() <= 1e-8
    assert np.abs(piston["residual_force"][:, 0] + MASS * AMPLITUDE * OMEGA * np.sin(OMEGA * t)).max() <= 1e-8


def test_stops_are_not_passed(runs):
    # Measured: 0 and both stops reached. Every row is where the law, cut at the stops, brings it: a play operator.
    curves = runs.curves("piston", "stops")
    x = curves.bodies["piston"]["position"][:, 0]
    assert x.min() == -0.1
    assert x.max() == 0.05
    expected, start = np.zeros(len(x)), 0.0
    for k, (t0, t1) in enumerate(zip(curves.time[:-1], curves.time[1:], strict=True)):
        start += AMPLITUDE / OMEGA * (np.sin(OMEGA * t1) - np.sin(OMEGA * t0))
        expected[k + 1] = start = min(max(start, -0.1), 0.05)
    # the turns of u lie on rows (0.5, 1.5, ... s), so that cutting row by row is exact; measured 1e-16
    assert np.abs(x - expected).max() <= 1e-8


def test_table_all_along(runs):
    # Measured: 3e-16 m. Trapezoids of speed.csv; kinks lie on rows.
    curves = runs.curves("piston", "table")
    t = curves.time
    u = np.interp(t, [0.0, 0.5, 1.0, 1.5, 2.0, 3.0, 4.0], [0.0, 0.4, 0.4, 0.0, 0.0, -0.3, 0.0])
    x = np.concatenate([[0.0], np.cumsum(0.5 * (u[1:] + u[:-1]) * np.diff(t))])
    assert np.abs(curves.bodies["piston"]["velocity"][:, 0] - u).max() <= 1e-8
    assert np.abs(curves.bodies["piston"]["position"][:, 0] - x).max() <= 1e-8
