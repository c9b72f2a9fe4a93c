"""Which law resolves which impact, as the deck chose: impact, dpfrac, multiple, hertz.

Every law has one signature, law(contacts (m,), responses (n,), twists (n,)): it changes the twists and fills the
contacts' impulse, regime and loss. What a scene does not call is never compiled.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flowgmo.collision.sequential import AT_REST, TURNS
from flowgmo.collision.single import strike_exactly, strike_in_steps
from flowgmo.collision.together import strike_in_turn, strike_together
from flowgmo.model import ContactPlan

Law = Callable[[np.ndarray, np.ndarray, np.ndarray], object]
FRACTION = 0.03  # step of a cluster's springs, of their fastest swing: velocities to about 1e-4 of the largest


def choose_law(plan: ContactPlan) -> Law:
    """The law of one island of contacts."""
    single = strike_exactly
    if plan.impact == "euler":

        def single(contacts: np.ndarray, responses: np.ndarray, twists: np.ndarray) -> int:
            return strike_in_steps(contacts, responses, twists, plan.dpfrac)

    def together(contacts: np.ndarray, responses: np.ndarray, twists: np.ndarray) -> object:
        if len(contacts) == 1:
            return single(contacts, responses, twists)
        if plan.multiple == "sequential":
            return strike_in_turn(contacts, responses, twists, AT_REST, TURNS)
        return strike_together(contacts, responses, twists, plan.hertz, FRACTION)

    return together
