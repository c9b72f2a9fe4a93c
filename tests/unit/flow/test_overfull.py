"""A chamber full of liquid with more than it can hold, and one slit to a pool beside it."""

import numpy as np
import pytest
from flowgmo_pressure import RHO, block_of, net_outflow, projector

from flowgmo.flow.fields import G, Open, zeros
from flowgmo.flow.pressure.face_flows import PUSH

SIZES, SHAPE = (0.8, 0.4, 0.6), (8, 4, 6)
SLIT = (G + 3, G + 1, G + 2)  # upper face along x of this cell; the chamber ends there
STRENGTH = 8e4  # Pa, of a fall through .4 m
DT = 1e-3


def block():
    """The block of the chamber."""
    return block_of(SHAPE, SIZES, graded=False)


def pushed_out(excess, strength, open_to=0.01):
    """(projector, velocity, p, F) after one projection of liquid at rest; excess [-] of one of the chamber's cells."""
    V = np.ones_like(zeros(block()))
    A = [np.ones_like(V) for _ in range(3)]
    A[0][SLIT[0]] = 0.0
    A[0][SLIT] = open_to
    P = projector(block(), openings=Open(V, *A), gravity=(0.0, 0.0, 0.0))
    F = zeros(block())
    F[G : G + 4, G:-G, G:-G] = 1.0
    F[G + 4 : -G, G:-G, G : G + 4] = 1.0
    F[G + 1, G + 2, G + 3] += excess
    P.sides.fill_fraction(F)
    P.set_surface(F)
    P.strength = strength
    velocity, p = [np.zeros_like(V) for _ in range(3)], zeros(block())
    assert P.project(velocity, p, F, DT, 1e-9, 100).converged
    return P, velocity, p, F


def test_excess_leaves_a_slit_with_no_more_than_the_pressure_of_the_scene():
    # half of 6 % of a cell within 1 ms through a slit of 1 %: 300 m/s, 57 MPa
    _, velocity, p, _ = pushed_out(0.06, np.inf)
    assert p.max() > 100.0 * STRENGTH and abs(velocity[0][SLIT]) > 200.0
    _, velocity, p, _ = pushed_out(0.06, STRENGTH)
    assert 0.9 * STRENGTH < p.max() <= STRENGTH
    assert 0.0 < velocity[0][SLIT] <= STRENGTH * DT / (RHO * 0.1)  # what that pressure gives in a step: .8 m/s


def test_push_goes_down_with_the_pressure_as_that_of_a_spring():
    P, velocity, p, F = pushed_out(0.06, STRENGTH)
    volume = 0.1**3
    s = PUSH * np.maximum(F - 1.0, 0.0)[G:-G, G:-G, G:-G] * volume / DT
    due = s * (1.0 - p[G:-G, G:-G, G:-G] / STRENGTH)
    liquid = P.wet[G:-G, G:-G, G:-G] != 0
    out = net_outflow(block(), velocity, P.openings)
    assert np.abs(out - due)[liquid].max() <= 1e-8 * volume / DT  # the solver's 1e-9 of a cell


def test_small_excess_leaves_as_if_it_were_not_bound():
    # 1e-5 of a cell in 1 ms meets a thousandth of that pressure at an open face
    (_, free, _, _), (_, bound, p, _) = (pushed_out(1e-5, most, open_to=1.0) for most in (np.inf, STRENGTH))
    assert p.max() < 2e-3 * STRENGTH
    assert bound[0][SLIT] == pytest.approx(free[0][SLIT], rel=2e-3)
