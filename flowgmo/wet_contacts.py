"""Which of the contacts that bodies keep press, while the pressure is found (flow/immersed/contact_rows.py)."""

from __future__ import annotations

import numpy as np

from flowgmo.flow.immersed.contact_rows import Rows, constrain, rows_of_contacts
from flowgmo.model import Model
from flowgmo.state import State

STICKS = 0.99  # of the friction cone: a contact within is taken to stick
TURNS = 20  # in which the set of contacts that press is looked for; what turns up after is left to the contact engine


class Contacts:
    """Held contacts of a step and which of them press. rows: contact_rows.Rows; mu (k,); active (k,) bool."""

    def __init__(self, rows: Rows, mu: np.ndarray, active: np.ndarray) -> None:
        self.rows, self.mu, self.active = rows, mu, active.copy()
        self.known: dict = {}  # groups that `constrain` has solved in this step

    def pressed(self) -> tuple[np.ndarray, np.ndarray]:
        """Rows and right-hand sides of those that press."""
        return self.rows.pressed(self.active)

    def look(self, U: np.ndarray, free: np.ndarray, inverse: np.ndarray, slack: float) -> bool:
        """Let go what pulls or slips, take up what approaches; whether anything changed.

        U, free (6 n,): velocities with and without the contacts' impulses; inverse: of constrain; slack [length/time].
        """
        rows, speed = self.pressed()
        impulse = -inverse @ (rows @ free - speed)
        count, rub = int(self.active.sum()), self.active & self.rows.stuck
        normal, sides = impulse[:count], impulse[count:].reshape(-1, 2)
        new, stuck = self.active.copy(), self.rows.stuck.copy()
        new[np.flatnonzero(self.active)[normal < -1e-9 * np.abs(normal).max(initial=0.0)]] = False
        of_rub = normal[np.flatnonzero(rub[self.active])]
        stuck[np.flatnonzero(rub)[np.linalg.norm(sides, axis=1) > self.mu[rub] * np.maximum(of_rub, 0.0)]] = False
        approach = self.rows.normal @ U - self.rows.speed
        new |= ~self.active & (approach < -slack)
        changed = bool((new != self.active).any() or (stuck != self.rows.stuck).any())
        self.active, self.rows = new, self.rows._replace(stuck=stuck)
        return changed


def held_contacts(
    model: Model, state: State, motion: np.ndarray, others: np.ndarray, wet: list[int], dt: float
) -> Contacts:
    """The contacts that the bodies `wet` (rows) have kept until now. motion (n,) POSE; others (n, 6): velocities of the
    bodies in the step, those that are not solved for count."""
    number = np.full(len(motion) + 6, -1)
    number[wet] = np.arange(len(wet))
    a, b = state.held_parts[:, 0], state.held_parts[:, 1]
    some = (number[a] >= 0) | (number[b] >= 0)
    a, b, values = a[some], b[some], state.held_values[some]
    sides = np.zeros((6, 6))  # of the domain
    place = np.concatenate([motion["p"], sides[:, :3]])
    own = np.concatenate([np.hstack([motion["v"], motion["w"]]), sides])
    point, normal, push = values[:, :3], values[:, 3:6], values[:, 6:9]
    pressed = (push * normal).sum(axis=1)
    rubbed = np.linalg.norm(push - pressed[:, None] * normal, axis=1)
    slip = slip_of(own, place, a, b, point, normal)
    mu = model.contacts.friction[a, b]
    stuck = (mu > 0.0) & (rubbed <= STICKS * mu * pressed) & (slip <= np.linalg.norm(model.gravity) * dt)
    velocity = np.concatenate([others, sides])
    rows = rows_of_contacts(a, b, point, normal, stuck, place, velocity, number, len(wet))
    return Contacts(rows, mu, pressed > 0.0)


def pressing(contacts: Contacts, inverse_mass: np.ndarray, free: np.ndarray, slack: float) -> np.ndarray:
    """(6 n,) velocities with the impulses of the contacts that press; free (6 n,) without; slack as in `look`."""
    U = free
    for _ in range(TURNS):
        _, U, inverse = constrain(inverse_mass, free, *contacts.pressed(), contacts.known)
        if not contacts.look(U, free, inverse, slack):
            break
    return U


def slip_of(
    velocity: np.ndarray, place: np.ndarray, a: np.ndarray, b: np.ndarray, point: np.ndarray, normal: np.ndarray
) -> np.ndarray:
    """(k,) speeds along the surface of contacts between parties a and b of given velocity (p, 6) and place (p, 3)."""
    at = [velocity[s, :3] + np.cross(velocity[s, 3:], point - place[s]) for s in (a, b)]
    v = at[0] - at[1]
    return np.linalg.norm(v - (v * normal).sum(axis=1)[:, None] * normal, axis=1)
