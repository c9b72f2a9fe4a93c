"""The films of a scene: which gaps are thin, and what the liquid in them does to the bodies of a step.

Between coupled bodies and all they may meet: bodies, solids, domain sides; not pairs that overlap at the start, and
with collisions only those that may collide. The law is in flow/immersed/film.py, how far a film reaches in
film_patch.py. A film pushes at its middle: it does not resist tilting, so that a plate may be peeled off at an edge.

A side of the domain that is a mirror lets the liquid slide: a quarter of the force. Films that lie partly outside the
domain count by the part inside: a quarter of a ball, cut by two mirrors, has a quarter of the film. Where there is a
free surface they count by the liquid of the cells around. Of a pair that is near at several places whose normals differ
each is a film; places with one normal are one. Places from which the gap only narrows on the way to a narrower one are
none: its film reaches there. Neighbours that face alike, such as those along a ring on which a ball sits, share what
is between them: each reaches half the way to the next, or the ring would count as often as there are places on it.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from flowgmo.bodies.arrays import POSE
from flowgmo.bodies.energy import rotation_matrices
from flowgmo.collision.gaps import Gaps
from flowgmo.film_patch import Patches, measured, of_balls, own_shares
from flowgmo.flow.fields import G
from flowgmo.flow.immersed.contact_rows import rows_of_contacts
from flowgmo.flow.immersed.film import REACH, Films, Squeeze, strength_of
from flowgmo.mesh import SYMMETRY, WALL
from flowgmo.model import Model

Array = np.ndarray

ROUGH = 1e-4  # of the smaller body: polished balls of millimetres have .1 to 1 um (Joseph et al 2001)
FLAT = 1e-2  # of the smaller body: plane faces are not so plane; a box on its bed would be held by h^-3 for minutes
ALIKE = 0.99  # cosine of the angle between normals of one film
PLATE = 3.0  # power of a film that ends at edges all around
OVERLAP = 1e-6  # of the smaller body: deeper at the start, a pair is none (as in building/contacts.py)
NARROW = 1e-9  # along an axis whose part is less a film has no extent
WIDER = 2.0  # times the width of another place: beyond its film, which reaches as far as the gap has doubled
STEEP = 0.25  # growth of the gap along itself: 14 degrees between the surfaces, which only an edge has at its narrowest
RISE = 0.125  # of the width: a way on which the gap widens by less leads on to where it is narrower
WAY = np.arange(1, 8)[:, None, None] / 8.0  # places between two, where the gap is looked at
AROUND = np.indices((3, 3, 3)).reshape(3, -1).T - 1  # a cell and those that touch it
SLIPPERY = 0.25  # of the force: a film between a wall and a surface on which it slides


class Found(NamedTuple):
    """One film: parties a < b, place (3,), normal (3,) from b to a, gap, strength, power, cell, rough as of Films."""

    a: int
    b: int
    place: Array
    normal: Array
    gap: float
    strength: float
    power: float
    cell: float
    rough: float


class StepFilms:
    """The films of one step: squeeze, their law; where they push."""

    def __init__(self, found: list[Found], squeeze: Squeeze, centres: Array) -> None:
        self.found, self.squeeze, self.centres = found, squeeze, centres

    def loads(self, U: Array) -> Array:
        """(n, 6): force and moment about B of the films on every body, when the step ends with U (6 n solved for,)."""
        out = np.zeros((len(self.centres), 6))
        force = self.squeeze.impulses(U) / self.squeeze.dt
        for one, size in zip(self.found, force, strict=True):
            for party, sign in ((one.a, size), (one.b, -size)):
                arm = one.place - self.centres[party]
                out[party] += sign * np.concatenate([one.normal, np.cross(arm, one.normal)])
        return out[:-6]


class Film:
    """Of one scene. coupled: rows of the bodies that the pressure moves; V (mesh): what is open now."""

    def __init__(self, model: Model, coupled: Array, V: Array) -> None:
        self.model, self.V = model, V
        self.n, self.bounds, self.planes = len(model.bodies), model.mesh.bounds, model.mesh.blocks[0].planes
        self.present = np.array([len(x) > 2 for x in self.planes])
        self.widest = max(float(np.diff(x).max()) for x, there in zip(self.planes, self.present, strict=True) if there)
        self.balls = [body.shape.as_sphere() for body in model.bodies]
        self.size = np.array([_radius(body.shape) for body in model.bodies] + [np.inf] * 6)
        self.slippery = {self.n + side.number for side in model.mesh.sides if side.kind == SYMMETRY}
        self.whole = float(np.linalg.norm(np.ptp(self.bounds, axis=0)))
        self.gaps = Gaps(model, self._allowed(coupled))
        start = np.zeros(self.n, POSE)
        start["p"], start["q"][:, 0] = [body.origin for body in model.bodies], 1.0
        deep = [one for one in self.gaps.near(start, 0.0) if one["gap"] < -OVERLAP * self._smaller(one["a"], one["b"])]
        self.overlapping = {(int(one["a"]), int(one["b"])) for one in deep}

    def _smaller(self, a: int, b: int) -> float:
        return float(min(self.size[a], self.size[b], self.whole))

    def _allowed(self, coupled: Array) -> Array:
        """(n + 6, n + 6): pairs that are looked at. A body that reaches out through a side has no film there."""
        n = self.n
        allowed = np.zeros((n + 6, n + 6), bool)
        allowed[coupled, :n] = True
        for side in self.model.mesh.sides:
            axis, upper = divmod(side.number, 2)
            if side.kind not in (SYMMETRY, WALL) or not self.present[axis]:
                continue
            for b in coupled:
                end = self.model.bodies[b].shape.bounds()[upper, axis]
                out = (end - self.bounds[upper, axis]) * (1.0 if upper else -1.0)
                allowed[b, n + side.number] = out <= OVERLAP * self._smaller(b, b)
        allowed |= allowed.T
        np.fill_diagonal(allowed, False)
        return allowed if self.model.contacts is None else allowed & self.model.contacts.allowed

    def of_step(
        self, F: Array | None, motion: Array, wet: list[int], velocity: Array, dt: float, *, mean: bool
    ) -> StepFilms | None:
        """The films of a step from motion (n,) POSE; None where there is none.

        F (mesh) or None; wet: bodies that are solved for; velocity (n, 6): of the others in this step; mean: the gaps
        go the way of the mean of the velocities at both ends of the step, else of the end.
        """
        found = []
        near = self.gaps.near(motion, REACH * self.widest)
        for a, b in np.unique(near[["a", "b"]]).tolist():
            if (a, b) not in self.overlapping:
                groups = self._narrowest(_groups(near[(near["a"] == a) & (near["b"] == b)]), motion)
                found += self._films(groups, F, motion)
        if not found:
            return None
        number = np.full(self.n + 6, -1)
        number[wet] = np.arange(len(wet))
        centres, others = np.zeros((self.n + 6, 3)), np.zeros((self.n + 6, 6))
        centres[: self.n], others[: self.n] = motion["p"], velocity
        a, b, place, normal, *values = (np.array(column) for column in zip(*found, strict=True))
        none = np.zeros(len(a), bool)
        rows = rows_of_contacts(a, b, place, normal, none, centres, others, number, len(wet))
        before = np.hstack([motion["v"], motion["w"]])[wet].reshape(-1)
        rate0 = rows.normal @ before - rows.speed
        gap, strength, power, cell, rough = values
        films = Films(gap, strength, power, cell, rough)
        return StepFilms(found, Squeeze(films, rows.normal, rows.speed, rate0, dt, mean=mean), centres)

    def _narrowest(self, groups: list[Array], motion: Array) -> list[Array]:
        """Those of a pair's groups, each begun by its narrowest place, from which no way leads on to a narrower one."""
        if len(groups) == 1:
            return groups
        first = np.array([group[0] for group in groups])
        width = np.maximum(first["gap"], 0.0) + self._rough(first["a"][0], first["b"][0])[0]
        width_at = self._width(int(first["a"][0]), int(first["b"][0]), motion)
        ways = 0.1 * width * np.concatenate([np.eye(3), -np.eye(3)])[:, :, None]  # (6, 3, k): a tenth of the gap
        around = width_at((first["point"] + ways.transpose(0, 2, 1)).reshape(-1, 3)).reshape(6, -1)
        steep = np.linalg.norm(around[:3] - around[3:], axis=0) > 0.2 * STEEP * width
        dropped = set(np.flatnonzero(steep & (width > width.min())).tolist())
        from_, to = first["point"], np.full(len(first), -1)
        for k in range(len(first)):
            others = np.flatnonzero(WIDER * width < width[k])
            if len(others) and k not in dropped:
                to[k] = others[np.linalg.norm(from_[others] - from_[k], axis=1).argmin()]
        some = np.flatnonzero(to >= 0)
        if len(some):
            along = from_[some] + WAY * (from_[to[some]] - from_[some])
            wide = width_at(along.reshape(-1, 3)).reshape(len(WAY), -1)
            leads = wide.max(axis=0) - first["gap"][some] <= RISE * width[some]
            dropped |= set(some[leads].tolist())
        return [group for k, group in enumerate(groups) if k not in dropped]

    def _rough(self, a: int, b: int) -> tuple[float, ...]:
        """[length]: of round surfaces, of plane ones; one for both where the deck gives it."""
        given, size = self.model.fluid.film.roughness, self._smaller(a, b)
        return (ROUGH * size, FLAT * size) if given is None else (given,)

    def _films(self, groups: list[Array], F: Array | None, motion: Array) -> list[Found]:
        """The films of a pair, from its contacts told apart by their normals: of each group one, or none."""
        gap = np.array([max(float(group["gap"][0]), 0.0) for group in groups])
        middle = np.array([group["point"].mean(axis=0) for group in groups])
        cell = self._cells(middle, np.array([group["normal"][0] for group in groups]))
        reached = gap < REACH * cell
        some, gap = [group for group, there in zip(groups, reached, strict=True) if there], gap[reached]
        if not some:
            return []
        a, b = int(some[0]["a"][0]), int(some[0]["b"][0])
        rough, normal, patches = self._patches(a, b, some, gap, motion)
        h, cell = gap + rough, self._cells(patches.place, normal)
        own, first = np.array([g["point"][0] for g in some]), np.array([g["normal"][0] for g in groups])
        alike = (first[reached] @ first.T > 0.0) & (np.flatnonzero(reached)[:, None] != np.arange(len(groups)))
        share = self._inside(patches, h) * self._wet(patches, h, cell, F) * (SLIPPERY if b in self.slippery else 1.0)
        share *= own_shares(patches, h, own, np.array([g["point"][0] for g in groups]), alike)
        strength = share * strength_of(patches.curvatures, h, self.model.fluid.mu)
        each = zip(patches.place, normal, gap.tolist(), strength.tolist(), patches.power, cell, rough, strict=True)
        there = (share > 0.0) & (gap < REACH * cell)
        return [Found(a, b, *one) for one, yes in zip(each, there, strict=True) if yes]

    def _patches(self, a: int, b: int, groups: list[Array], gap: Array, motion: Array) -> tuple[Array, Array, Patches]:
        """Roughness (k,) [length], normals (k, 3), and how far films of a pair with gaps (k,) reach.

        Films between faces, which end all around, are as rough as faces are.
        """
        round_, *flat = self._rough(a, b)
        rough = np.full(len(groups), round_)
        normal, patches = self._patched(a, b, groups, gap + rough, motion)
        plates = np.flatnonzero(patches.power >= PLATE)
        if flat and len(plates):
            rough[plates] = flat[0]
            some = [groups[k] for k in plates]
            normal[plates], other = self._patched(a, b, some, (gap + rough)[plates], motion)
            for mine, new in zip(patches, other, strict=True):
                mine[plates] = new
        return rough, normal, patches

    def _patched(self, a: int, b: int, groups: list[Array], h: Array, motion: Array) -> tuple[Array, Patches]:
        """Normals (k, 3) and patches of gaps h (k,) [length], about the middle of contacts where the gap doubles."""
        place, normal = np.empty((len(groups), 3)), np.empty((len(groups), 3))
        for k, group in enumerate(groups):
            near = np.maximum(1.0 - (group["gap"] - group["gap"][0]) / h[k], 0.0)
            place[k], normal[k] = near @ group["point"] / near.sum(), near @ group["normal"]
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        radii = [self._ball_radius(a), self._ball_radius(b)]
        if radii[0] is not None and radii[1] is not None:
            return normal, of_balls(place, normal, 1.0 / radii[0] + 1.0 / radii[1])
        return normal, measured(self._width(a, b, motion), place, normal, h, self.whole)

    def _width(self, a: int, b: int, motion: Array) -> Callable[[Array], Array]:
        """Widths (m,) of the gap between two parties at points (m, 3)."""
        one, other = self._distance(a, motion), self._distance(b, motion)
        return lambda x: one(x) + other(x)

    def _ball_radius(self, party: int) -> float | None:
        """Of a ball, infinite of a side of the domain; None of others."""
        if party >= self.n:
            return np.inf
        ball = self.balls[party]
        return None if ball is None else ball[1]

    def _distance(self, party: int, motion: Array) -> Callable[[Array], Array]:
        """Distances (m,) of points (m, 3) from a party where it stands."""
        if party >= self.n:
            axis, upper = divmod(party - self.n, 2)
            return lambda x: np.abs(x[:, axis] - self.bounds[upper, axis])
        body, R = self.model.bodies[party], rotation_matrices(motion["q"][party : party + 1])[0]
        return lambda x: body.shape.distance((x - motion["p"][party]) @ R + body.origin)

    def _cells(self, place: Array, normal: Array) -> Array:
        """Widths (k,) [length] of the cells at places (k, 3) along normals (k, 3)."""
        at = self._cells_at(place)
        widths = np.column_stack([x[k + 1] - x[k] for x, k in zip(self.planes, at.T, strict=True)])
        size = np.linalg.norm(widths * normal * self.present, axis=1)
        return np.where(size > 0.0, size, self.widest)

    def _inside(self, patches: Patches, h: Array) -> Array:
        """Shares (k,) of films that lie in the domain."""
        share = np.ones(len(h))
        for axis in range(3):
            across = patches.lines[:, :, axis]
            reach = np.sqrt((2.0 * h[:, None] / patches.curvatures * across**2).sum(axis=1))
            ends = (self.bounds[:, axis] - patches.place[:, axis, None]) * (-1.0, 1.0)
            extent = np.abs(across).max(axis=1) > NARROW
            part = 0.5 * np.clip(ends / np.where(extent, reach, 1.0)[:, None], -1.0, 1.0).sum(axis=1)
            share *= np.where(extent, part, 1.0)
        return np.maximum(share, 0.0)

    def _wet(self, patches: Patches, h: Array, cell: Array, F: Array | None) -> Array:
        """Shares (k,) of liquid in what is open of the cells around middles of films, and a cell beyond their ends."""
        if F is None:
            return np.ones(len(h))
        ways = (np.sqrt(2.0 * h[:, None] / patches.curvatures) + cell[:, None])[..., None] * patches.lines
        places = patches.place[:, None] + np.concatenate([np.zeros((len(h), 1, 3)), ways, -ways], axis=1)
        at = G + self._cells_at(places)[:, :, None] + AROUND
        i, j, k = np.moveaxis(at, -1, 0)
        V = self.V[i, j, k]
        total = V.sum(axis=(1, 2))
        return (V * F[i, j, k].clip(0.0, 1.0)).sum(axis=(1, 2)) / np.where(total > 0.0, total, 1.0)

    def _cells_at(self, place: Array) -> Array:
        """Numbers (.., 3) of the cells, ghosts not counted, that are nearest to places (.., 3)."""
        at = [np.searchsorted(x, place[..., d]).clip(1, len(x) - 1) - 1 for d, x in enumerate(self.planes)]
        return np.stack(at, axis=-1)


def _groups(contacts: Array) -> list[Array]:
    """Contacts (m,) CONTACT of a pair told apart by their normals, each group begun by its narrowest place."""
    order = np.argsort(contacts["gap"], kind="stable")
    normal, left, groups = contacts["normal"][order], np.ones(len(order), bool), []
    while left.any():
        first = left.argmax()
        alike = left & (normal @ normal[first] > ALIKE)
        alike[first] = True
        groups.append(contacts[order[alike]])
        left &= ~alike
    return groups


def _radius(shape: object) -> float:
    """Half of the largest finite extent of a shape [length]; inf where there is none."""
    extent = np.ptp(shape.bounds(), axis=0)
    return 0.5 * float(extent[np.isfinite(extent)].max(initial=0.0)) or np.inf
