"""Entries to the laws of several contacts from Python.

strike_together(contacts, responses, twists, eta, fraction) is the kernel clusters.resolve itself: one more around it
would optimise all of it once more.
"""

from __future__ import annotations

from flowgmo.collision import sequential
from flowgmo.collision.clusters import resolve as strike_together
from flowgmo.kernel import kernel

__all__ = ["strike_in_turn", "strike_together"]


@kernel
def strike_in_turn(contacts, responses, twists, rest, turns):
    """Resolve contacts (m,) that touch, pair after pair as in the report (sequential.py). Returns status, residual."""
    return sequential.resolve(contacts, responses, twists, rest, turns)
