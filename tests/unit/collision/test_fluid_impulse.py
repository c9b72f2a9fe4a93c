"""What the liquid gets of an impact: `fluid_impulse` in the records, what is owed to it, and the energy that is lost.

The response of a party in liquid is (M + A)^-1; here A is given, so that everything is known.
"""

import numpy as np
import pytest
from arenas import TENSOR, arena_of, loose
from flowgmo_scenes import ball, on_axis, rigid

from flowgmo.bodies.inverse_masses import inverse_masses
from flowgmo.collision.contact import CONTACT
from flowgmo.collision.laws import choose_law
from flowgmo.collision.strike import Striker
from flowgmo.flow.immersed.added_mass import wet_inverse

E, MU = 0.5, 0.2
SIDE = 2 + 5  # Zmax of the domain, after the body and another far away


def added(seed, *, joined):
    """A (6, 6), symmetric and positive; joined: with the parts in which a push makes a turn."""
    parts = np.random.default_rng(seed).normal(size=(6, 6))
    A = parts @ parts.T
    if not joined:
        A[:3, 3:] = A[3:, :3] = 0.0
    return A


def strike(text, A, contact):
    """Resolve one contact in liquid: (record, change of v and w (n, 6), owed, arena); A: added masses by body."""
    arena = arena_of(text)
    inverse = inverse_masses(arena.bodies[: arena.n], arena.motion[: arena.n])
    arena.wet = lambda b: (wet_inverse(inverse[b], A[b]), A[b]) if b < len(A) else (inverse[b], np.zeros((6, 6)))
    before = np.hstack([arena.motion["v"], arena.motion["w"]])[: arena.n]
    found = np.zeros(1, CONTACT)
    for name, value in {"fresh": 1, "e": E, "mu": MU, **contact}.items():
        found[name] = value
    outcome = Striker(arena, choose_law(arena.model.contacts)).strike(found, 0.0, 1e-9, 0.0, np.zeros(4))
    (record,) = outcome.records[0]
    after = np.hstack([arena.motion["v"], arena.motion["w"]])[: arena.n]
    return record, after - before, before, arena


AGAINST_SIDE = {"a": 0, "b": SIDE, "normal": (0, 0, -1.0), "point": (0.3, -0.2, 0.5)}


def test_body_and_liquid_get_the_impulse_of_the_contact():
    """m dv + fluid_impulse = impulse, and what is owed is the same, with its moment. Measured: 3e-16."""
    text = loose(rigid(TENSOR, 1.5, v=(0.4, 0.1, 2), w=(0.3, -0.2, 0.5)), g=(0, 0, 0))
    A = added(1, joined=False)
    record, change, _, arena = strike(text, [A], AGAINST_SIDE)
    mass = arena.bodies["mass"][0]
    assert record["a"] == 1 and np.linalg.norm(record["fluid_impulse"]) > 0.1 * np.linalg.norm(record["impulse"])
    assert mass * change[0, :3] + record["fluid_impulse"] == pytest.approx(record["impulse"], abs=1e-13)
    assert arena.owed[0, :3] == pytest.approx(record["fluid_impulse"], abs=1e-13)
    turn = np.cross(record["point"] - arena.motion["p"][0], record["impulse"])
    assert TENSOR @ change[0, 3:] + arena.owed[0, 3:] == pytest.approx(turn, abs=1e-12)


def test_what_the_liquid_gets_is_what_the_record_says():
    """A dU also where A makes a turn of a push: that much leaves the next pressure the velocities of the law.

    The contact's law has the blocks of (M + A)^-1 alone, so that its impulse is not all of m dv + fluid_impulse then.
    """
    text = loose(rigid(TENSOR, 1.5, v=(0.4, 0.1, 2), w=(0.3, -0.2, 0.5)), g=(0, 0, 0))
    A = added(1, joined=True)
    record, change, _, arena = strike(text, [A], AGAINST_SIDE)
    assert arena.owed[0] == pytest.approx(A @ change[0], rel=1e-12)
    assert record["fluid_impulse"] == pytest.approx(arena.owed[0, :3], rel=1e-12)


def test_two_bodies_give_all_they_lose_to_the_liquid():
    """sum of m dv + fluid_impulse = 0 in a collision of two bodies, both in liquid. Measured: 2e-16."""
    text = loose(ball((0, 0, -0.1), v=(0.2, 0, 1)), ball((0, 0, 0.1), v=(0, 0.3, -0.5)), g=(0, 0, 0))
    A = [added(2, joined=False), added(3, joined=False)]
    record, change, _, arena = strike(text, A, {"a": 0, "b": 1, "normal": (0, 0, -1.0)})
    mass = arena.bodies["mass"][: len(change)]
    assert mass @ change[:, :3] + record["fluid_impulse"] == pytest.approx(np.zeros(3), abs=1e-12)
    assert arena.owed[:2, :3].sum(axis=0) == pytest.approx(record["fluid_impulse"], abs=1e-12)


def test_the_energy_lost_is_that_of_body_and_liquid():
    """½ U (M + A) U before less after, the law's (1 - e²) of it along the normal. Measured: 2e-16 of it."""
    text = loose(rigid(TENSOR, 1.5, v=(0.4, 0.1, 2), w=(0.3, -0.2, 0.5)), g=(0, 0, 0))
    A = added(4, joined=False)
    record, change, before, arena = strike(text, [A], AGAINST_SIDE)
    M = np.zeros((6, 6))
    M[:3, :3], M[3:, 3:] = arena.bodies["mass"][0] * np.eye(3), TENSOR
    U = before[0], before[0] + change[0]
    lost = 0.5 * (U[0] @ (M + A) @ U[0] - U[1] @ (M + A) @ U[1])
    assert record["energy_loss"] == pytest.approx(lost, rel=1e-12)
    assert lost > 0.0


def test_a_body_on_an_axis_pushes_liquid_too():
    """Its liquid gets A dU; the axis takes the rest of the impulse."""
    text = loose(on_axis(0.7, (0, 1, 0), 2.0, (0.3, 0, 0), rate=1.5), g=(0, 0, 0))
    A = added(5, joined=True)
    contact = {"a": 0, "b": SIDE, "normal": (0, 0, 1.0), "point": (0.6, 0.0, 0.0)}
    record, change, _, arena = strike(text, [A], contact)
    assert np.linalg.norm(change[0, 3:]) > 0.0
    arm = arena.motion["p"][0] - arena.responses["centre"][0]
    dU = np.concatenate([np.cross(change[0, 3:], arm), change[0, 3:]])
    assert record["fluid_impulse"] == pytest.approx((A @ dU)[:3], rel=1e-12)


def test_dry_impacts_give_the_liquid_nothing():
    text = loose(ball((0, 0, 0.4), v=(0.2, 0, 1)), g=(0, 0, 0))
    record, _, _, arena = strike(text, [np.zeros((6, 6))], AGAINST_SIDE)
    assert not record["fluid_impulse"].any() and not arena.owed.any() and record["impulse"].any()
