"""Free flight and fall from rest (VALIDATION A): parabolas are exact at any step. Closed form x = u t, g t²/2."""

import numpy as np
import pytest
from flowgmo_scenes import Scene, ball, deck, rigid

from flowgmo.deck import DeckError

G = (0.3, -0.2, -9.81)


@pytest.mark.parametrize("dt", [1e-3, 0.1, 3.0])
def test_a_body_without_gravity_moves_on_uniformly(dt):
    """Measured: exact. Fails if a step adds more than round-off per step, or drifts with the number of steps."""
    s = Scene(deck(ball((0, 0, 0), v=(1.0, -2.0, 0.5)), collide=False, end=3.0)).to(3.0, dt)
    np.testing.assert_allclose(s.p[0], [3.0, -6.0, 1.5], rtol=1e-12)
    np.testing.assert_array_equal(s.v[0], [1.0, -2.0, 0.5])
    assert s.remainder() == 0.0


@pytest.mark.parametrize("collide", [False, True])
@pytest.mark.parametrize("dt", [1e-3, 0.1, 3.0])
def test_fall_from_rest_is_exact_at_any_step(dt, collide):
    """Measured: 2e-12 over 3000 steps. A first-order update of the position would be wrong by g t dt/2."""
    s = Scene(deck(ball((1, 2, 3)), g=G, collide=collide, sides=(5,) * 6, end=3.0)).to(3.0, dt, asked=[1.3])
    np.testing.assert_allclose(s.p[0] - [1, 2, 3], np.multiply(G, 4.5), rtol=1e-12)
    np.testing.assert_allclose(s.v[0], np.multiply(G, 3.0), rtol=1e-12)
    np.testing.assert_allclose(s.row("p_WB")[0, 0] - [1, 2, 3], np.multiply(G, 1.3**2 / 2), rtol=1e-12)
    assert abs(s.remainder()) < 1e-12 * s.kinetic()


def test_a_ball_with_different_moments_does_not_collide_yet():
    """In flight it would tumble (tested in test_free_top.py); legs of colliding balls turn evenly: it is refused.

    Fails if it is let in: then it flies with constant angular velocity and loses energy of rotation.
    """
    tumbling = rigid(np.diag([1.0, 2.0, 3.0]) * 1e-3, w=(0.1, 1.0, 0.1), v=(1, 0, 0))
    with pytest.raises(DeckError, match="different moments of inertia"):
        Scene(deck(tumbling, collide=True, sides=(2,) * 6))
