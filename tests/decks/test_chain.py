"""decks/chain: a push through five balls with gaps."""

import numpy as np


def test_speeds(runs):
    # Measured: 1e-16 m/s. 1e-10 would reveal an impact resolved with a third ball that does not touch.
    runs.agree("chain", "chain", 1e-10)


def test_momentum_is_kept_and_impacts_follow(runs):
    # Measured: 0, times 2e-16 s. Four impacts, each when its gap of 0.05 m is used up.
    curves = runs.curves("chain", "chain")
    total = sum(body["velocity"][:, 0] for body in curves.bodies.values())
    assert np.abs(total - 1.0).max() <= 1e-12
    hits = np.cumsum(0.05 / 0.95 ** np.arange(4))
    assert np.abs(curves.impacts["time"] - hits).max() <= 1e-12
