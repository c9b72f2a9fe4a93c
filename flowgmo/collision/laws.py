"""Which law resolves which impact, as the deck chose: impact, dpfrac, multiple, hertz."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flowgmo.model import ContactPlan

Law = Callable[[np.ndarray, np.ndarray, np.ndarray], None]


def choose_law(plan: ContactPlan) -> Law:
    """The law of one island: law(contacts (m,), responses (n,), twists (n,)) changes twists and fills the contacts."""
    raise NotImplementedError
