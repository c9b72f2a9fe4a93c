"""Entries to the laws of several contacts from Python."""

from __future__ import annotations

from flowgmo.collision import clusters, sequential
from flowgmo.kernel import kernel


@kernel
def strike_together(contacts, responses, twists, eta, fraction):
    """Resolve contacts (m,) that touch, together (clusters.py). Returns status and the residual."""
    return clusters.resolve(contacts, responses, twists, eta, fraction)


@kernel
def strike_in_turn(contacts, responses, twists):
    """Resolve contacts (m,) that touch, pair after pair as in the report (sequential.py). Returns status, residual."""
    return sequential.resolve(contacts, responses, twists, 0.0, 0.0)
