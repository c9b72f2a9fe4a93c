"""Who may collide with whom, and how (ICLID, ICLIDOB, CRSTRNG, CFRC, STRNGMOB, FRCMOB, IBCT).

A pair takes the smaller restitution and the smaller friction of its two partners.
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.body import FIXED_AXIS, FIXED_POINT, SOLID, Body, Sinusoid, Table
from flowgmo.building.findings import Findings
from flowgmo.deck import Deck
from flowgmo.geometry import overlap_depth
from flowgmo.mesh import SYMMETRY, Mesh, Side
from flowgmo.model import ContactPlan

OVERLAP = 1e-6  # part of the smaller body's size by which two may overlap at the start (DESIGN 6)
ISOTROPIC = 1e-9  # relative spread of the moments of inertia up to which a body counts as a ball


def build_contacts(found: Findings, bodies: tuple[Body, ...], mesh: Mesh) -> ContactPlan | None:
    """The contact plan, None where nothing can collide. Problems: overlaps at the start."""
    deck = found.deck
    if deck["ICLID"] != 1:
        return None
    n = len(bodies)
    allowed = _allowed(found, bodies, mesh)
    _drop_hinges(found, bodies, allowed)
    restitution, friction = _coefficients(found, bodies, mesh.sides)
    _drop_pierced(found, bodies, mesh, allowed)
    if not allowed.any():
        return None
    _check_overlaps(found, bodies, allowed)
    touch = float(deck["TOUCH"])
    taking_part = [i for i in range(n) if allowed[i].any()]
    return ContactPlan(
        allowed=allowed,
        restitution=restitution,
        friction=friction,
        touch=touch,
        impact=str(deck["IMPACT"]),
        dpfrac=float(deck["DPFRAC"]),
        search=str(deck["SEARCH"]),
        multiple=str(deck["MULTIPLE"]),
        hertz=float(deck["HERTZ"]),
        resting=str(deck["RESTING"]),
        sleep=bool(deck["SLEEP"]),
        wet=deck["WETIMPACT"] == "wet" and deck["IMPMOB"] == 1,  # impmob=0 has no common equation to ask
        closed_form=_only_balls(bodies, allowed, friction, touch) and _is_default(deck),
        balls=tuple(i for i in taking_part if bodies[i].shape.as_sphere() is not None),
        flats=tuple(i for i in taking_part if _is_flat(bodies[i])),
    )


def _allowed(found: Findings, bodies: tuple[Body, ...], mesh: Mesh) -> np.ndarray:
    """(n + 6, n + 6): at least one partner coupled, both orders of ICLIDOB, neither (m, m) zero."""
    deck, n = found.deck, len(bodies)
    wanted = np.ones((n, n), dtype=bool)  # ICLIDOB is 1 by default here: ICLID is
    for i, j in deck.indices("ICLIDOB"):
        wanted[i - 1, j - 1] = bool(deck.at("ICLIDOB", i, j))
    takes_part = wanted.diagonal().copy()
    coupled = np.array([body.coupled for body in bodies], dtype=bool)
    allowed = np.zeros((n + 6, n + 6), dtype=bool)
    pairs = wanted & wanted.T & np.outer(takes_part, takes_part) & (coupled[:, None] | coupled)
    np.fill_diagonal(pairs, False)
    allowed[:n, :n] = pairs
    for side in mesh.sides:
        if side.stops_bodies:
            allowed[:n, n + side.number] = allowed[n + side.number, :n] = coupled & takes_part
    return allowed


def _coefficients(found: Findings, bodies: tuple[Body, ...], sides: tuple[Side, ...]) -> tuple[np.ndarray, np.ndarray]:
    """Restitution and friction of all pairs; a mirror is elastic and smooth whatever the deck says."""
    deck, n = found.deck, len(bodies)
    e = np.array([b.restitution for b in bodies] + [float(deck["STRNGMOB"])] * 6)
    mu = np.array([b.friction for b in bodies] + [float(deck["FRCMOB"])] * 6)
    restitution, friction = np.minimum(e[:, None], e), np.minimum(mu[:, None], mu)
    for side in sides:
        if side.kind == SYMMETRY:
            k = n + side.number
            restitution[k], restitution[:, k] = 1.0, 1.0
            friction[k], friction[:, k] = 0.0, 0.0
    return restitution, friction


def _is_default(deck: Deck) -> bool:
    """Whether the deck asks for the methods that the closed forms of balls are part of."""
    wanted = {"IMPACT": "exact", "SEARCH": "surface", "MULTIPLE": "simultaneous", "RESTING": "constraint"}
    return all(deck[name] == value for name, value in wanted.items())


def _is_flat(body: Body) -> bool:
    return body.kind == SOLID and body.shape.as_sphere() is None and bool(body.shape.as_boxes())


def _drop_hinges(found: Findings, bodies: tuple[Body, ...], allowed: np.ndarray) -> None:
    """A body on a fixed axis or point may stick in a stationary solid: that is its hinge, not a contact."""
    for i, body in enumerate(bodies):
        if body.constraint not in (FIXED_AXIS, FIXED_POINT):
            continue
        for j, other in enumerate(bodies):
            if allowed[i, j] and other.kind == SOLID and _depth(body, other) > OVERLAP * _size(body):
                allowed[i, j] = allowed[j, i] = False
                found.notice(
                    "ICLIDOB", i + 1, j + 1,
                    wrong=f"{body.name} turns about a fixed axis or point and overlaps {other.name}, which is taken as "
                    "its hinge: this pair does not collide",
                )  # fmt: skip


def _drop_pierced(found: Findings, bodies: tuple[Body, ...], mesh: Mesh, allowed: np.ndarray) -> None:
    """A body that pierces a side of the domain at the start (every two-dimensional deck) does not collide with it."""
    n = len(bodies)
    for i, body in enumerate(bodies):
        if not allowed[i, n:].any():
            continue
        lo, hi = body.shape.bounds()
        for side in mesh.sides:
            k, upper = divmod(side.number, 2)
            if not allowed[i, n + side.number]:
                continue
            depth = hi[k] - mesh.bounds[1, k] if upper else mesh.bounds[0, k] - lo[k]
            if depth <= OVERLAP * _size(body):
                continue
            if depth >= hi[k] - lo[k]:
                found.problem(
                    "OBSID" if found.deck.given("OBSID", i + 1) else "IMO", i + 1,
                    wrong=f"{body.name} starts outside the domain, beyond its side {side.name}, which is a wall",
                    write="Move the body or the mesh planes, or let the side be open",
                )  # fmt: skip
                continue
            allowed[i, n + side.number] = allowed[n + side.number, i] = False
            found.notice(
                "IBCT", side.number + 1,
                wrong=f"{body.name} pierces the side {side.name} by {depth:.4g} at the start: they do not collide",
                write="Move the body or the mesh plane where they should",
            )  # fmt: skip


def _only_balls(bodies: tuple[Body, ...], allowed: np.ndarray, friction: np.ndarray, touch: float) -> bool:
    """Whether everything that can collide is a ball whose events have closed forms (collision/balls), or a flat."""
    n = len(bodies)
    for i, body in enumerate(bodies):
        if not allowed[i].any():
            continue
        if body.shape.as_sphere() is None:
            if body.coupled or (not _is_flat(body) and any(allowed[i, :n])):
                return False
        elif not _is_plain_ball(body, rough=bool((friction[i][allowed[i]] > 0.0).any())):
            return False
    return not _balls_touch(bodies, allowed, touch)


def _is_plain_ball(body: Body, rough: bool) -> bool:
    """A solid, free or driven sphere that closed forms cover."""
    if body.kind == SOLID:
        return True
    centre, radius = body.shape.as_sphere()
    if body.stops.any:
        return False
    if not body.coupled:
        turning = sum(not _is_zero(d.law) for d in body.drives[3:])
        return turning <= 1 or body.constraint == FIXED_AXIS
    if body.constraint == FIXED_POINT:
        return False
    if body.constraint == FIXED_AXIS:
        return not body.drives[3].coupled or not rough
    if not all(d.coupled for d in body.drives):
        return False
    if np.linalg.norm(centre - body.origin) > ISOTROPIC * radius:
        return False
    moments = np.linalg.eigvalsh(body.mass.inertia)
    return bool(np.ptp(moments) <= ISOTROPIC * moments[-1])


def _balls_touch(bodies: tuple[Body, ...], allowed: np.ndarray, touch: float) -> bool:
    """Whether two balls touch at the start: several may then be hit at once."""
    balls = [(i, *body.shape.as_sphere()) for i, body in enumerate(bodies) if body.shape.as_sphere() is not None]
    if len(balls) < 3:
        return False
    rows = np.array([i for i, _, _ in balls])
    centre, radius = np.array([c for _, c, _ in balls]), np.array([r for _, _, r in balls])
    for k in range(len(balls)):
        gap = np.linalg.norm(centre[k + 1 :] - centre[k], axis=1) - radius[k + 1 :] - radius[k]
        near = gap <= touch * np.minimum(radius[k + 1 :], radius[k]) + 1e-12 * radius[k]  # 1e-12: rounding of decks
        if (near & allowed[rows[k], rows[k + 1 :]]).any():
            return True
    return False


def _is_zero(law: Table | Sinusoid) -> bool:
    return law.amplitude == 0.0 if isinstance(law, Sinusoid) else law.is_zero


def _check_overlaps(found: Findings, bodies: tuple[Body, ...], allowed: np.ndarray) -> None:
    n = len(bodies)
    bounds = np.array([body.shape.bounds() for body in bodies]).reshape(n, 2, 3)
    for i in range(n):
        near = np.all((bounds[:, 0] <= bounds[i, 1]) & (bounds[i, 0] <= bounds[:, 1]), axis=1)
        for j in np.flatnonzero(near[i + 1 :] & allowed[i, i + 1 : n]) + i + 1:
            depth = _depth(bodies[i], bodies[j])
            if depth > OVERLAP * min(_size(bodies[i]), _size(bodies[j])):
                found.problem(
                    "OBSID" if found.deck.given("OBSID", j + 1) else "IMO", j + 1,
                    wrong=f"{bodies[i].name} and {bodies[j].name} overlap at the start by {depth:.6g}",
                    write=f"Move one of them, or write iclidob({i + 1},{j + 1})=0",
                )  # fmt: skip


def _depth(a: Body, b: Body) -> float:
    return overlap_depth(a.shape, b.shape, min(_size(a), _size(b)))


def _size(body: Body) -> float:
    """Largest finite extent of a body [length]."""
    extent = np.ptp(body.shape.bounds(), axis=0)
    finite = extent[np.isfinite(extent)]
    return float(finite.max()) if finite.size else np.inf
