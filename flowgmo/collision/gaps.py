"""How near parties are to each other: places, normals and gaps.

A ball and a ball, a side of the domain, or anything of one convex piece have one narrowest place, which the distance of
the ball's centre tells. All other pairs are looked at as contacts are (gather.py), which is compiled only where a scene
has such.
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.arrays import POSE
from flowgmo.bodies.energy import rotation_matrices
from flowgmo.collision.arena import PAIR
from flowgmo.collision.contact import CONTACT
from flowgmo.collision.gather import gather, no_contacts
from flowgmo.collision.pieces import build_pieces
from flowgmo.collision.shapes import POLYTOPE
from flowgmo.collision.touching import MOST_POINTS
from flowgmo.model import Model

Array = np.ndarray


class Gaps:
    """Of the parties of a scene. allowed (n+6, n+6): the pairs that are looked at."""

    def __init__(self, model: Model, allowed: Array) -> None:
        n = self.n = len(model.bodies)
        self.model, self.shapes = model, build_pieces(model, allowed)
        pieces, first = self.shapes.pieces["kind"], self.shapes.first_piece
        convex = np.array([b - a == 1 and pieces[a] <= POLYTOPE for a, b in zip(first[:-1], first[1:], strict=True)])
        convex[n:] = True
        balls = [body.shape.as_sphere() for body in model.bodies]
        self.radius = np.array([np.nan if ball is None else ball[1] for ball in balls] + [np.nan] * 6)
        self.middle = np.array([
            np.zeros(3) if ball is None else ball[0] - body.origin
            for ball, body in zip(balls, model.bodies, strict=True)
        ]).reshape(n, 3)  # fmt: skip
        round_ = np.isfinite(self.radius)
        pairs = np.argwhere(np.triu(allowed)).astype(np.int64)
        a, b = pairs.T
        near = (round_[a] & convex[b]) | (round_[b] & convex[a])
        self.of_balls, self.others = pairs[near], pairs[~near]
        self.rows = np.zeros(n + 6, POSE)
        self.rows["q"][:, 0] = 1.0
        self.plan = np.zeros((n + 6, n + 6), PAIR)
        self.out, self.room = np.zeros(64, CONTACT), np.zeros((64, 2), dtype=np.int64)
        self.points = np.zeros(MOST_POINTS, CONTACT)

    def near(self, motion: Array, within: float) -> Array:
        """Contacts (m,) CONTACT, by pair, of all pairs with gaps <= within [length]; motion (n,) POSE of the bodies.

        Of faces several points, a of lower number than b. Only a, b, point (halfway), normal (from b to a), gap hold.
        """
        self.rows[: self.n] = motion
        found = np.concatenate([self._beside_balls(within), self._others(within)])
        return found[np.lexsort((found["b"], found["a"]))]

    def _far(self, pairs: Array, within: float) -> Array:
        """(k,) whether the balls around the parties of pairs are farther apart; no such balls, no answer."""
        a, b = pairs.T
        reach = self.shapes.reach
        return np.linalg.norm(self.rows["p"][a] - self.rows["p"][b], axis=1) > reach[a] + reach[b] + within

    def _beside_balls(self, within: float) -> Array:
        pairs = self.of_balls[~self._far(self.of_balls, within)]
        a, b = pairs.T
        first = np.isfinite(self.radius[a])
        ball, other = np.where(first, a, b), np.where(first, b, a)
        turns = rotation_matrices(self.rows["q"])
        centre = self.rows["p"].copy()
        centre[: self.n] += np.einsum("bij,bj->bi", turns[: self.n], self.middle)
        gap, away = np.zeros(len(pairs)), np.zeros((len(pairs), 3))
        for party in np.unique(other):
            some = other == party
            gap[some], away[some] = self._distance(int(party), centre[ball[some]], centre, turns)
        gap -= self.radius[ball]
        some = gap <= within
        out = np.zeros(int(some.sum()), CONTACT)
        out["a"], out["b"], out["gap"] = a[some], b[some], gap[some]
        out["point"] = (centre[ball] - (self.radius[ball] + 0.5 * gap)[:, None] * away)[some]
        out["normal"] = (away * np.where(first, 1.0, -1.0)[:, None])[some]
        return out

    def _distance(self, party: int, x: Array, centre: Array, turns: Array) -> tuple[Array, Array]:
        """Of points (m, 3) from a party: (m,) and outward normals (m, 3)."""
        if party >= self.n:
            axis, upper = divmod(party - self.n, 2)
            inward = np.zeros(3)
            inward[axis] = -1.0 if upper else 1.0
            return (x[:, axis] - self.model.mesh.bounds[upper, axis]) * inward[axis], np.broadcast_to(inward, x.shape)
        if np.isfinite(self.radius[party]):
            r = x - centre[party]
            size = np.linalg.norm(r, axis=1)
            return size - self.radius[party], r / np.where(size > 0.0, size, 1.0)[:, None]
        body, R = self.model.bodies[party], turns[party]
        at = (x - self.rows["p"][party]) @ R + body.origin
        return body.shape.distance(at), body.shape.normal(at) @ R.T

    def _others(self, within: float) -> Array:
        pairs = self.others[~self._far(self.others, within)]
        touch = np.full(self.plan.shape, within)
        first = np.zeros((len(pairs), 2), dtype=np.int64)
        while len(pairs):
            total, most, _ = gather(
                self.shapes, pairs, len(pairs), self.rows, self.plan, touch, no_contacts(), first, self.out, self.room,
                self.points,
            )  # fmt: skip
            if total <= len(self.out) and most <= len(self.room):
                return self.out[:total].copy()
            self.out = np.zeros(max(2 * total, len(self.out)), CONTACT)
            self.room = np.zeros((max(2 * most, len(self.room)), 2), dtype=np.int64)
        return no_contacts()
