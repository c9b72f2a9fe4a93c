"""Velocities that bodies are expected to have at the end of a step, before its pressure is known.

The open fractions of a step are found at the poses where bodies are expected. What a body of another velocity U takes
of the cells before it, and opens behind it, follows from its fluxes J, the mean of the expected way:

    V1(U) - V1(U_e) = - dt J (U - U_e)  + O(dt^2 |U - U_e| |U| / cell^2)      of a cell

What the second term has too much or lacks a cell holds too much or lacks afterwards. With U_e the velocity at the begin
of the step U - U_e is a dt: a ball of half the water's density that rises from rest left .036 of a cell too much behind
it in steps of .02 s, one of a thousandth .039, one that sinks .071 at its bed. So the velocity is expected to change
as it did, by what its last two steps agree on:

    U_e = U_0 + dt minmod(a_1, a_2)                                           a: change of velocity / dt

of which .008, .002 and .027 are left. Where the load turns (a plate meets the water, a ball its bed) they do not agree,
and nothing is expected of the next step; with a_1 alone a plate that slams overfills .048 of a cell, with this .025.
Bodies that contacts hold are left alone, and what an impact has changed says nothing of the next step.
"""

from __future__ import annotations

import numpy as np

SAME = 1e-6  # of a cell that a body goes in a step: what its velocity may differ from that of the pressure


def expected_motion(motion: np.ndarray, rates: np.ndarray, which: np.ndarray, dt: float) -> np.ndarray:
    """motion (n,) POSE with the velocities that bodies `which` (k,) are expected to have dt later; rates (n, 2, 6)
    [velocity/time, spin/time] of State."""
    told, (one, two) = motion.copy(), rates[which].swapaxes(0, 1)
    gained = dt * np.where(one * two > 0.0, np.sign(one) * np.minimum(np.abs(one), np.abs(two)), 0.0)
    told["v"][which] += gained[:, :3]
    told["w"][which] += gained[:, 3:]
    return told


def next_rates(
    rates: np.ndarray, which: np.ndarray, U: np.ndarray, before: np.ndarray, after: np.ndarray, reach: np.ndarray,
    dt: float,
) -> np.ndarray:  # fmt: skip
    """(n, 2, 6): rates after a step of dt in which the pressure gave bodies `which` (k,) the velocities U (k, 6); zero
    of all others, and where something else has changed them by more than SAME.

    before, after (n,) POSE; reach (k, 2) [1/velocity, 1/spin]: what makes ways of a cell of velocities, times dt.
    """
    found = np.zeros_like(rates)
    started, ended = (np.hstack([motion["v"][which], motion["w"][which]]) for motion in (before, after))
    off = np.abs(ended - U) * np.repeat(reach, 3, axis=1)
    same = (dt * off <= SAME).all(axis=1)
    found[which[same], 0] = (U - started)[same] / dt
    found[which[same], 1] = rates[which[same], 0]
    return found
