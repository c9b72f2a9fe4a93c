"""Travel and angle limits of bodies that contacts hold (a body in free flight minds its own, bodies/stops.py).

A stop is a plastic, frictionless contact with something that cannot move. For a translation it acts at the mass centre
along the axis of the component, for an angle at a distance from the axis of rotation, where it needs no more than a
moment:

    x_k = hi:    normal -e_k at c                          θ = hi:    normal -a × r at the point c + r,  r ⟂ a, |r| = 1

On a HELD path x_k and θ are polynomials of second degree, so that the time of a stop is the root of one. It is an event
like the touching of two bodies: its impact is resolved with all contacts of the body, and from then on, as long as the
body stands at the stop, the stop takes part in every solution for contact forces. Bodies on a fixed point have no
stops: the deck's rules refuse them (deck/rules_motion.py).

The flag POSE.hold means that free flight keeps a component at its stop. It is set only while nothing else presses the
body: then the loads decide alone when it leaves.
"""

from __future__ import annotations

import numpy as np

from flowgmo.collision.arena import Arena, cross, lengths
from flowgmo.collision.contact import CONTACT
from flowgmo.collision.paths import STOP, stop_times
from flowgmo.records import LIMIT

AT_LIMIT = 1e-9  # of its reach (of a radian) that a body may be away from a stop it stands at, as contacts may: `touch`
LEAVES = 1e-9  # of the speeds at hand: what solutions for contact forces leave of a velocity at a stop
FEATURE = -1  # of a contact with a stop: no pair of surfaces has it


class Limits:
    """All stops of an arena's movable bodies. `any` is False where there are none: then nothing is asked."""

    def __init__(self, arena: Arena) -> None:
        self.arena = arena
        found = []
        for b in np.flatnonzero((arena.bodies["stopped"] == 1) & (arena.movable == 1)):
            body = arena.bodies[b]
            for k in (3,) if body["hinge"] == 1 else np.flatnonzero(body["coupled"][:3]):
                found += [(b, k, side) for side, end in ((1, body["hi"][k]), (-1, body["lo"][k])) if np.isfinite(end)]
        self.stops = np.array(found, STOP)
        self.any = len(found) > 0
        self.loose = arena.bodies  # as if there were no stops: for velocities without contact forces
        if self.any:
            self.loose = arena.bodies.copy()
            self.loose["stopped"] = 0
        self.near = np.zeros(len(found), dtype=bool)  # stops that take part in the solution of the present leg
        self.times = np.full(len(found), np.inf)

    def next(self) -> tuple[float, np.ndarray]:
        """Time of the next stop of a held body, and the rows of STOP that are met then; infinity: none."""
        if not self.any:
            return np.inf, self.stops
        arena = self.arena
        stop_times(self.stops, arena.bodies, arena.motion, arena.paths, self.times)
        self.times[self.near] = np.inf
        first = float(self.times.min())
        return first, self.stops[self.times <= first] if np.isfinite(first) else self.stops[:0]

    def snap(self, met: np.ndarray) -> None:
        """Put the bodies of stops met where these are, to the last bit."""
        bodies, rows = self.arena.bodies, self.arena.motion
        for b, k, side in met[met["k"] < 3]:
            rows["p"][b, k] = bodies["origin"][b, k] + bodies["hi" if side > 0 else "lo"][b, k]

    def contacts(self, parties: np.ndarray) -> np.ndarray:
        """Contacts (k,) of the parties with the stops that they stand at now."""
        if not self.any:
            return np.zeros(0, CONTACT)
        arena = self.arena
        stops = self.stops[self._stands() & np.isin(self.stops["body"], parties)]
        out = np.zeros(len(stops), CONTACT)
        if not len(stops):
            return out
        arena.respond(parties)
        out["a"], out["b"], out["feature"], out["fresh"] = stops["body"], len(arena.bodies) - 1, FEATURE, 1
        for row, (b, k, side) in zip(out, stops, strict=True):
            row["normal"] = -side * (np.eye(3)[k] if k < 3 else cross(arena.bodies["axis"][b][None], self._arm(b))[0])
        self.place(out)
        return out

    def place(self, contacts: np.ndarray) -> None:
        """Bring the points of contacts with stops to where arena.responses have the centres of their bodies."""
        for i in np.flatnonzero(contacts["feature"] == FEATURE) if self.any else ():
            b = contacts["a"][i]
            contacts["point"][i] = self.arena.responses["centre"][b] + self._arm(b)[0]

    def grip(self, parties: np.ndarray, pressed: np.ndarray) -> None:
        """Set POSE.hold of the parties: at a stop, where no contact presses (n+6,) and the body does not leave it."""
        if not self.any:
            return
        rows = self.arena.motion
        mine = np.isin(self.stops["body"], parties)
        stands = self._stands()
        self.near[mine] = stands[mine] & (pressed[self.stops["body"][mine]] == 1)
        for b, k, _ in self.stops[mine]:
            rows["hold"][b, k] = 0
        for b, k, side in self.stops[mine & stands & (pressed[self.stops["body"]] == 0)]:
            if abs(self._speed(b, k)) <= LEAVES * self._scale(b, k):  # else it leaves, or its flight meets the stop
                rows["hold"][b, k] = side
                if k < 3:
                    rows["v"][b, k] = 0.0
                else:
                    rows["w"][b] = 0.0
                    rows["v"][b] = 0.0

    def _stands(self) -> np.ndarray:
        """(m,) whether a body is at its stop, or beyond it by round-off."""
        arena, stops = self.arena, self.stops
        b, k = stops["body"], stops["k"]
        turns = k == 3
        slide = np.minimum(k, 2)
        at = np.where(turns, arena.motion["angle"][b], arena.motion["p"][b, slide] - arena.bodies["origin"][b, slide])
        end = np.where(stops["side"] > 0, arena.bodies["hi"][b, k], arena.bodies["lo"][b, k])
        near = AT_LIMIT * np.where(turns, 1.0, arena.finite_reach[b])
        return stops["side"] * (end - at) <= near

    def _arm(self, b: int) -> np.ndarray:
        """(1, 3) from a body's centre to where its stop acts: across the axis, of length 1; zero without an axis."""
        body = self.arena.bodies[b]
        if body["hinge"] != 1:
            return np.zeros((1, 3))
        across = cross(body["axis"][None], np.eye(3)[[int(np.argmin(np.abs(body["axis"])))]])
        return across / lengths(across)[:, None]

    def _speed(self, b: int, k: int) -> float:
        row = self.arena.motion[b]
        return float(row["v"][k] if k < 3 else row["w"] @ self.arena.bodies["axis"][b])

    def _scale(self, b: int, k: int) -> float:
        """Speed [length/time], or rate [rad/time], that round-off is a part of."""
        row, reach = self.arena.motion[b], float(self.arena.finite_reach[b])
        speed = np.linalg.norm(row["v"]) + np.linalg.norm(row["w"]) * reach + np.sqrt(self.arena.gravity * reach)
        return float(speed if k < 3 or reach == 0.0 else speed / reach)


def mark_limits(group: np.ndarray, rows: np.ndarray, arena: Arena) -> None:
    """Make the rows of IMPACT of contacts with stops (m,) those of a limit: partner 0, an angle's moment (DESIGN 6)."""
    for i in np.flatnonzero(group["feature"] == FEATURE):
        contact, row = group[i], rows[i]
        b = contact["a"]
        row["b"], row["regime"] = 0, LIMIT
        row["point"] = arena.motion["p"][b]
        if arena.bodies["hinge"][b] == 1:
            arm = contact["point"] - arena.responses["centre"][b]
            row["impulse"] = np.cross(arm, contact["impulse"])
            row["normal"] = np.cross(arm, contact["normal"])
