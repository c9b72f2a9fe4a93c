"""Tables and sinusoids of time: value, slope, integral, kinks, turns."""

import numpy as np
import pytest
from numba import njit
from scipy.integrate import quad

from flowgmo.bodies import laws
from flowgmo.bodies.body import Sinusoid, Table
from flowgmo.bodies.laws import LawBook


@njit
def all_of(packed, k, t0, t1):
    """value, rate before, rate after, next kink, next turn at t0; the integral to t1."""
    return (
        laws.value(packed, k, t0),
        laws.rate(packed, k, t0, False),
        laws.rate(packed, k, t0, True),
        laws.next_kink(packed, k, t0),
        laws.next_turn(packed, k, t0),
        laws.integral(packed, k, t0, t1),
    )


TABLE = Table(np.array([0.5, 1.0, 2.0, 2.5]), np.array([1.0, -1.0, 3.0, 0.0]))
WAVE = Sinusoid(1.5, 0.8, 0.4)


@pytest.fixture(scope="module")
def packed():
    book = LawBook()
    assert book.add(TABLE) == 0 and book.add(WAVE) == 1
    assert book.add(Sinusoid(2.0, 0.0, 0.7)) == 2 and book.add(Sinusoid(1.0, -0.5, 0.1)) == 3
    return book.pack()


def test_zero_laws_are_absent():
    book = LawBook()
    assert book.add(Table(np.zeros(3), np.zeros(3))) == -1 and book.add(Sinusoid(0.0, 1.0, 1.0)) == -1


def test_no_law_is_zero(packed):
    assert all_of(packed, -1, 0.3, 1.0) == (0.0, 0.0, 0.0, np.inf, np.inf, 0.0)


@pytest.mark.parametrize("t, value, before, after, kink", [
    (0.0, 1.0, 0.0, 0.0, 0.5), (0.5, 1.0, 0.0, -4.0, 1.0), (0.75, 0.0, -4.0, -4.0, 1.0), (1.0, -1.0, -4.0, 4.0, 2.0),
    (2.5, 0.0, -6.0, 0.0, np.inf), (9.0, 0.0, 0.0, 0.0, np.inf),
])  # fmt: skip
def test_a_table(packed, t, value, before, after, kink):
    """Linear between entries, constant outside; both slopes at a kink."""
    assert all_of(packed, 0, t, t + 1)[:4] == (value, before, after, kink)


@pytest.mark.parametrize("k", range(4))
@pytest.mark.parametrize("t0, t1", [(0.0, 3.1), (0.2, 0.7), (1.0, 1.0 + 1e-7), (2.6, 5.0)])
def test_integrals(packed, k, t0, t1):
    """Against quadrature between the kinks. Measured: 1e-15."""
    value = lambda t: all_of(packed, k, t, t)[0]  # noqa: E731
    kinks = [t for t in TABLE.t if t0 < t < t1] if k == 0 else []
    expected = quad(value, t0, t1, points=kinks or None, epsabs=1e-14, limit=200)[0]
    assert all_of(packed, k, t0, t1)[5] == pytest.approx(expected, abs=1e-12)


@pytest.mark.parametrize("k", [0, 1, 3])
def test_between_two_turns_the_sign_does_not_change(packed, k):
    """Walks from turn to turn: no sign change inside, and the walk gets on."""
    t = 0.0
    for _ in range(12):
        turn = all_of(packed, k, t, t)[4]
        assert turn > t
        if turn == np.inf:
            break
        inside = [all_of(packed, k, x, x)[0] for x in np.linspace(t, turn, 9)[1:-1]]
        assert min(inside) >= -1e-12 or max(inside) <= 1e-12
        t = turn
    assert t > 2.0
