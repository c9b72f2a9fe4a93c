"""The impact of one pair, from a contact to its collision system and back, with either law."""

from __future__ import annotations

from flowgmo.collision import impact_euler, impact_exact
from flowgmo.collision.contact import push, relative_velocity
from flowgmo.collision.frame import assembled, components, tangents
from flowgmo.collision.inverse_mass import contact_matrix
from flowgmo.kernel import inner, kernel
from flowgmo.vectors import put, scale, triple


@inner
def _in_system(contact, responses, twists):
    """Axes of the collision system, inverse mass and relative velocity in it."""
    n3 = triple(contact.normal)
    n1, n2 = tangents(n3)
    x = triple(contact.point)
    k = contact_matrix(responses[contact.a], responses[contact.b], x, n1, n2, n3)
    return n1, n2, n3, k, components(n1, n2, n3, relative_velocity(contact, responses, twists))


@inner
def _apply(contact, responses, twists, impulse, regime, loss):
    """Write the impulse (triple, space axes, on a) to the contact and push both parties."""
    x = triple(contact.point)
    put(contact.impulse, impulse)
    contact.regime = regime
    contact.loss = loss
    push(responses[contact.a], twists[contact.a], x, impulse)
    push(responses[contact.b], twists[contact.b], x, scale(-1.0, impulse))


@kernel
def strike_exactly(contacts, responses, twists):
    """Resolve contacts[0] by impact_exact: its impulse, regime, loss, and the twists of its parties. Returns status."""
    contact = contacts[0]
    n1, n2, n3, k, v = _in_system(contact, responses, twists)
    impulse, regime, loss, status = impact_exact.impact(k, v, contact.e, contact.mu)
    _apply(contact, responses, twists, assembled(n1, n2, n3, impulse), regime, loss)
    return status


@kernel
def strike_in_steps(contacts, responses, twists, dpfrac):
    """Resolve contacts[0] by impact_euler with steps of dpfrac of the estimated impulse. Returns status."""
    contact = contacts[0]
    n1, n2, n3, k, v = _in_system(contact, responses, twists)
    impulse, regime, loss, status = impact_euler.impact(k, v, contact.e, contact.mu, dpfrac)
    _apply(contact, responses, twists, assembled(n1, n2, n3, impulse), regime, loss)
    return status
