"""The arrays that the parts of the contact engine share: parties, poses, paths, responses, and what pairs may do.

Rows are parties: bodies 0 .. n-1, then the domain sides n .. n+5, which stand still.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from flowgmo.bodies.arrays import BODY, DRIVEN, POSE, STILL
from flowgmo.bodies.laws import Laws
from flowgmo.collision.bounds import build_bounds
from flowgmo.collision.contact import RESPONSE, TWIST
from flowgmo.collision.paths import PATH, bring, poses_at
from flowgmo.collision.pieces import build_pieces
from flowgmo.collision.respond import respond_all
from flowgmo.errors import StepFailed
from flowgmo.model import Model
from flowgmo.records import IMPACT

#: What two parties do: whether they may collide, restitution, friction.
PAIR = np.dtype([("allowed", "i8"), ("e", "f8"), ("mu", "f8")], align=True)
LEAST_TOUCH = 1e-12  # radii: searches end in a gap above round-off
MOST_HITS = 64  # stops that one call may record; further ones still act


class Arena:
    """The scene of one run: what is constant, and the step's poses and paths.

    bodies (n+6,) BODY; motion (n+6,) POSE and paths (n+6,) PATH of the step; spare (n+6,) POSE; shapes, reach (n+6,);
    plan (n+6, n+6) PAIR; touch (n+6, n+6) [length]; responses, twists (n+6,); movable (n+6,): an impulse moves it.
    """

    def __init__(self, model: Model, arrays: np.ndarray, laws: Laws | None) -> None:
        n = len(model.bodies)
        self.model, self.laws, self.n = model, laws, n
        self.bodies = np.zeros(n + 6, BODY)
        self.bodies[:n] = arrays
        self.motion, self.spare = np.zeros(n + 6, POSE), np.zeros(n + 6, POSE)
        self.motion["q"][:, 0] = 1.0
        self.paths = np.zeros(n + 6, PATH)
        self.shapes = build_pieces(model)
        self.reach = self.shapes.reach
        self.bounds = build_bounds(self.bodies, laws)
        self.plan = _pairs(model)
        radius = np.where(self.shapes.size > 0.0, 0.5 * self.shapes.size, np.inf)  # of a fixed body, too, its own
        least = np.minimum(radius[:, None], radius)
        self.touch = max(model.contacts.touch, LEAST_TOUCH) * np.where(np.isfinite(least), least, 0.0)
        self.responses, self.twists = np.zeros(n + 6, RESPONSE), np.zeros(n + 6, TWIST)
        motion = self.bodies["motion"]
        taking_part = model.contacts.allowed.any(axis=1)
        self.movable = ((motion != STILL) & (motion != DRIVEN)).astype(np.int64)
        self.movers = np.flatnonzero((motion != STILL) & taking_part)
        self.wakeful = np.ones(n + 6, dtype=np.int64)  # all parties awake
        self.finite_reach = np.where(np.isfinite(self.reach), self.reach, 0.0)
        self.pull = np.zeros((n + 6, 3))  # gravity's acceleration of parties that an impulse can move
        self.pull[self.movable == 1] = model.gravity
        self.gravity = float(np.linalg.norm(model.gravity))
        self.wet: Callable[[int], tuple[np.ndarray, np.ndarray]] | None = None  # wet_impacts.WetImpacts.response
        self.owed = np.zeros((n, 6))
        self._hits, self._hit_body = np.zeros((MOST_HITS, 7)), np.zeros(MOST_HITS, dtype=np.int64)

    def parties_of(self, contacts: np.ndarray, *others: np.ndarray) -> np.ndarray:
        """Parties of contacts (m,) and `others` (k,), each once, ascending."""
        mask = np.zeros(len(self.bodies), dtype=bool)
        mask[contacts["a"]] = True
        mask[contacts["b"]] = True
        for more in others:
            mask[more] = True
        return np.flatnonzero(mask)

    def reload(self, arrays: np.ndarray) -> None:
        """Take bodies (n,) of BODY whose loads have changed, with laws that have changed in place."""
        self.bodies[: self.n] = arrays
        self.bounds[: self.n] = build_bounds(self.bodies[: self.n], self.laws)

    def load(self, motion: np.ndarray, t: float) -> None:
        """Take the poses (n,) of POSE at time t; everything flies freely until told otherwise."""
        self.motion[: self.n] = motion
        self.paths[:] = 0
        self.paths["t"] = t

    def respond(self, which: np.ndarray, rows: np.ndarray | None = None) -> None:
        """Responses and twists of the parties `which` at their present poses, or at those of rows (n+6,) of POSE."""
        respond_all(which, self.bodies, self.motion if rows is None else rows, self.responses, self.twists)

    def wet_responses(self, parties: np.ndarray) -> None:
        """Parties in liquid answer an impact with its inertia too."""
        if self.wet is None:
            return
        for b in parties[(parties < self.n) & (self.movable[parties] == 1)]:
            inverse, added = self.wet(int(b))
            if added.any():
                self.responses["wr"][b] = _six(inverse[3:, 3:])
                if self.bodies["hinge"][b] == 0:
                    self.responses["wt"][b] = _six(inverse[:3, :3])

    def owe(self, parties: np.ndarray, before: np.ndarray) -> None:
        """Book what the liquid gets of the impact that has changed twists from `before` (n+6,) TWIST: A dU."""
        if self.wet is None:
            return
        for b in parties[(parties < self.n) & (self.movable[parties] == 1)]:
            change = np.concatenate([self.twists[name][b] - before[name][b] for name in "vw"])
            if change.any():
                self.owed[b] += self._given(int(b), *np.split(change, 2))

    def given_to_liquid(self, contacts: np.ndarray) -> np.ndarray:
        """(m, 3): what the liquid gets by the impulses of contacts (m,), one by one, after wet_responses: A dU."""
        out = np.zeros((len(contacts), 3))
        for side, sign in (("a", 1.0), ("b", -1.0)) if self.wet is not None else ():
            for c, b in enumerate(contacts[side].tolist()):
                if b >= self.n or self.movable[b] == 0:
                    continue
                J, response = sign * contacts["impulse"][c], self.responses[b]
                turn = np.cross(contacts["point"][c] - response["centre"], J)
                out[c] += self._given(b, _full(response["wt"]) @ J, _full(response["wr"]) @ turn)[:3]
        return out

    def _given(self, b: int, dv: np.ndarray, dw: np.ndarray) -> np.ndarray:
        """(6,): A dU of body b whose centre and spin change by dv, dw (3,)."""
        if self.bodies["hinge"][b] != 0:
            dv = np.cross(dw, self.motion["p"][b] - self.responses["centre"][b])
        return self.wet(b)[1] @ np.concatenate([dv, dw])

    def bring(self, which: np.ndarray, t: float, books: np.ndarray) -> list[tuple[int, np.ndarray]]:
        """Bring parties to time t. Returns the stops they met: body and row of forced.note_hit."""
        found, failed = bring(
            which, self.bodies, self.motion, self.paths, self.laws, books, t, self._hits, self._hit_body
        )  # fmt: skip
        if failed >= 0:
            raise StepFailed(
                f"the motion of body {self.model.bodies[failed].name} could not be integrated before t = {t:.6g}: its "
                "velocities grow without bound. Check its control loads, mass and inertia"
            )
        return [(int(self._hit_body[k]), self._hits[k].copy()) for k in range(found)]

    def poses(self, t: float) -> tuple[np.ndarray, np.ndarray]:
        """Poses (k,) of the movers at time t and what their paths lose until then (4,); nothing is changed."""
        books = np.zeros(4)
        poses_at(
            self.movers, self.bodies, self.motion, self.paths, self.laws, t, self.spare, books, self._hits
        )  # fmt: skip
        return self.spare[self.movers], books

    def name(self, party: int) -> str:
        """A party in words."""
        from flowgmo.mesh import SIDE_NAMES

        return self.model.bodies[party].name if party < self.n else f"side {SIDE_NAMES[party - self.n]}"


def _six(tensor: np.ndarray) -> np.ndarray:
    """xx yy zz xy xz yz of a symmetric tensor (3, 3)."""
    return np.array([tensor[0, 0], tensor[1, 1], tensor[2, 2], tensor[0, 1], tensor[0, 2], tensor[1, 2]])


def _full(six: np.ndarray) -> np.ndarray:
    """(3, 3) of xx yy zz xy xz yz."""
    xx, yy, zz, xy, xz, yz = six
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """a × b of rows (m, 3): np.cross without its overhead."""
    out = np.empty_like(a)
    out[:, 0] = a[:, 1] * b[:, 2] - a[:, 2] * b[:, 1]
    out[:, 1] = a[:, 2] * b[:, 0] - a[:, 0] * b[:, 2]
    out[:, 2] = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    return out


def lengths(a: np.ndarray) -> np.ndarray:
    """(m,) lengths of rows (m, 3)."""
    return np.sqrt(dots(a, a))


def dots(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """(m,) a · b of rows (m, 3): np.einsum takes three times as long for a few rows."""
    x = a * b
    out = x[:, 0] + x[:, 1]
    out += x[:, 2]
    return out


def joined(one: np.ndarray, two: np.ndarray) -> np.ndarray:
    """Two lists of records of one type as one: np.concatenate compares their fields one by one first."""
    if not len(two):
        return one
    out = np.empty(len(one) + len(two), one.dtype)
    out[: len(one)] = one
    out[len(one) :] = two
    return out


def _pairs(model: Model) -> np.ndarray:
    plan = model.contacts
    pairs = np.zeros(plan.allowed.shape, PAIR)
    pairs["allowed"], pairs["e"], pairs["mu"] = plan.allowed, plan.restitution, plan.friction
    return pairs


def party_numbers(party: np.ndarray, n: int) -> np.ndarray:
    """Party numbers as in the record: component numbers, sides -1 .. -6."""
    return np.where(party < n, party + 1, n - 1 - party)


def records_of(contacts: np.ndarray, t: float, n: int, cluster: int) -> np.ndarray:
    """Rows of IMPACT for contacts whose impulses an impact at time t has filled."""
    out = np.zeros(len(contacts), IMPACT)
    out["time"] = t
    out["a"], out["b"] = party_numbers(contacts["a"], n), party_numbers(contacts["b"], n)
    for name in ("point", "normal", "impulse", "e", "mu", "regime"):
        out[name] = contacts[name]
    out["energy_loss"] = contacts["loss"]
    out["cluster"] = cluster
    out["count"] = 1
    return out
