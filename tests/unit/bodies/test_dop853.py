"""Coefficients of the integrator: typed from a table, so that a wrong digit would go unnoticed for long."""

import numpy as np
from numpy.testing import assert_allclose, assert_array_equal
from scipy.integrate import DOP853

from flowgmo.bodies import dop853


def test_each_stage_lies_where_its_weights_say():
    assert_allclose(dop853.A.sum(axis=1), dop853.C, rtol=0, atol=4e-15)
    assert_array_equal(np.triu(dop853.A), 0.0)  # explicit


def test_the_step_integrates_polynomials_to_eighth_order():
    for power in range(8):
        assert_allclose(dop853.B @ dop853.C**power, 1.0 / (power + 1), rtol=0, atol=1e-14)


def test_errors_vanish_for_a_constant_derivative():
    for weights in (dop853.E3, dop853.E5):
        assert abs(weights.sum()) <= 1e-14


def test_every_digit_is_that_of_another_table():
    assert_array_equal(dop853.A, DOP853.A[: dop853.STAGES, : dop853.STAGES])
    for ours, theirs in ((dop853.B, DOP853.B), (dop853.E3, DOP853.E3), (dop853.E5, DOP853.E5)):
        assert_array_equal(ours, theirs)
    assert_array_equal(dop853.C, DOP853.C[: dop853.STAGES])
