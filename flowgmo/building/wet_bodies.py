"""What of bodies that move in liquid a user may not expect: notices, none of which stops a run; the lightest ones."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from flowgmo.bodies.body import COUPLED, FIXED_AXIS, FIXED_POINT, SIX_DEGREES, SOLID, Body
from flowgmo.building.findings import Findings
from flowgmo.geometry import GeometryError
from flowgmo.mesh import Mesh

SAMPLES = 16000  # points of a body's box; 10 ms for a few primitives. Volumes are known to about a hundredth then
WALLS = 600  # of its points beside the surface, for thicknesses
STEPS = 8  # along which a wall is looked through
FEW = 0.05  # of the surface: beside edges any body is thin
OVERLAP = 1e-3  # of a body's volume; a few of its points
LIGHTEST = 1e-4  # of the mass of as much liquid, see with_least_mass; air around a ball has the inertia of 6e-4
WITHIN = 0.1  # the same of bodies that fit in a cell, see with_least_mass; a choice
BEYOND = 1e-9  # of a body's size: what reaches out by less touches a side of the domain


def with_least_mass(found: Findings, mesh: Mesh, bodies: tuple[Body, ...]) -> tuple[Body, ...]:
    """The bodies; where there is a free surface, coupled ones of LIGHTEST of the mass of as much liquid at least, and
    everywhere those that fit in a cell of WITHIN.

    A body that lies on the water is wet by its bottom, and along the surface the liquid has no part in its inertia. The
    air above it would, but voids have none. Without any inertia it goes there as fast as the last digit of the pressure
    says (36 m/s in half a millisecond), and pushes liquid where it was expected: of 8 runs of a box of 1e-6 of the
    liquid's density that differ by a hair the energy rose by its largest kinetic energy in 6 (up to 300 m/s), of 1e-5
    in 2 of 7 by half of it, of 1e-4 by .065 at most. In the liquid added masses are a few tenths: nothing changes.

    Of a body within a cell the pressure sees no more than what it covers of faces, at times nothing: no added mass. Its
    lift is all there, 1e4 g at 1e-4 of the liquid's density: balls of .2 to .8 cells left the water with 30 to 200 m/s,
    and the energy rose by .9 to 1.0 of its largest kinetic energy at 1e-3 and less, by .18 at most at .01 and .03, by
    .07 at most at .1.
    """
    if not found.deck.given("RHOF"):
        return bodies
    return tuple(_with_least_mass(found, mesh, body, float(found.deck["RHOF"])) for body in bodies)


def _fits_in_a_cell(mesh: Mesh, low: np.ndarray, high: np.ndarray) -> bool:
    """Whether a box is as small as the cell where its middle is, along all directions that have more than one."""
    for x, a, b in zip(mesh.blocks[0].planes, low, high, strict=True):
        k = int(np.clip(np.searchsorted(x, 0.5 * (a + b), side="right") - 1, 0, len(x) - 2))
        if len(x) > 2 and not b - a <= (1.0 + BEYOND) * (x[k + 1] - x[k]):
            return False
    return True


def _with_least_mass(found: Findings, mesh: Mesh, body: Body, rho: float) -> Body:
    mass = body.mass
    if body.kind != COUPLED or mass is None or not mass.mass > 0.0:
        return body
    low, high = body.shape.bounds()
    within = _fits_in_a_cell(mesh, low, high)
    least = WITHIN if within else (LIGHTEST if found.deck["ITB"] == 1 else 0.0)
    if mass.mass >= least * rho * float(np.prod(high - low)):  # most are, and volumes take time
        return body
    try:
        displaced = rho * body.shape.mass_properties(1.0).mass
    except GeometryError:  # not closed: its mass is given, and its volume not known
        return body
    if not mass.mass < least * displaced < np.inf:
        return body
    more = least * displaced / mass.mass
    reason = (
        "it fits in a cell, where the inertia of the liquid around it is not known"
        if within
        else "less than the air around it, since nothing else would hold it along the surface"
    )
    found.notice(
        *_place(found, body),
        wrong=f"{body.name} has {mass.mass / displaced:.3g} of the mass of as much liquid; it moves as if it had "
        f"{least:g}: {reason}",
    )
    inertia = None if mass.inertia is None else more * mass.inertia
    axis_moment = None if mass.axis_moment is None else more * mass.axis_moment
    return replace(body, mass=replace(mass, mass=more * mass.mass, inertia=inertia, axis_moment=axis_moment))


def check_wet_bodies(found: Findings, mesh: Mesh, bodies: tuple[Body, ...]) -> None:
    """Notices: bodies that reach outside the domain, overlap others, may leave the plane of the mesh, or are thin, of
    less than two cells."""
    boxes = np.array([body.shape.bounds() for body in bodies]).reshape(-1, 2, 3)
    for body in bodies:
        if not body.moves:
            continue
        points, inside = _points(body, mesh)
        if body.kind == COUPLED:
            _check_reach(found, body, mesh, points, inside)
            _check_plane(found, body, mesh)
            low, high = boxes[body.number - 1]
            near = np.flatnonzero(((boxes[:, 0] < high) & (boxes[:, 1] > low)).all(axis=1))
            _check_overlaps(found, body, [bodies[k] for k in near], points[inside])
        _check_thickness(found, body, mesh, points[inside])


def _points(body: Body, mesh: Mesh) -> tuple[np.ndarray, np.ndarray]:
    """Points (n, 3) spread over a body's box, clipped to the domain where it has no end; which are inside it (n,)."""
    low, high = body.shape.bounds()
    low, high = np.where(np.isfinite(low), low, mesh.bounds[0]), np.where(np.isfinite(high), high, mesh.bounds[1])
    n = 2 * int(0.5 * np.cbrt(SAMPLES))  # none of the points lies on a body's plane of symmetry
    axes = [a + (b - a) * (np.arange(n) + 0.5) / n for a, b in zip(low, high, strict=True)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    return points, body.shape.distance(points) < 0.0


def _check_reach(found: Findings, body: Body, mesh: Mesh, points: np.ndarray, inside: np.ndarray) -> None:
    low, high = body.shape.bounds()
    out = BEYOND * float(np.abs(mesh.bounds).max())
    if (low >= mesh.bounds[0] - out).all() and (high <= mesh.bounds[1] + out).all() or not inside.any():
        return
    if not np.isfinite([low, high]).all():
        found.notice(*_place(found, body), wrong=f"{body.name} has no end; liquid acts on it in the domain only")
        return
    seen = ((points >= mesh.bounds[0]) & (points <= mesh.bounds[1])).all(axis=1) & inside
    whole = float(np.prod(high - low)) * inside.mean()
    if not seen.any():
        found.notice(
            *_place(found, body), wrong=f"{body.name} lies outside the mesh at the start: there is no liquid",
            write="Move it, if that is not meant",
        )  # fmt: skip
        return
    found.notice(
        *_place(found, body),
        wrong=f"{body.name} reaches outside the domain: liquid acts on about "
        f"{whole * seen.sum() / inside.sum():.3g} of its volume of about {whole:.3g}; its mass is that of all of it",
        write="End it at the sides, or give its mass as a whole",
    )  # fmt: skip


def _check_plane(found: Findings, body: Body, mesh: Mesh) -> None:
    """A coupled body that reaches to a side across a direction with one cell, and may go along it or lean.

    Flush with both sides its ends are closed. What a contact, or rounding, opens at one of them lets the liquid press
    on the whole end, however thin it is: a plate of 50 kg/m3 that overlaps its mirror by 1e-4 is put back by 5e-8, then
    has 17 m/s2, leans, and wedges between the sides.
    """
    low, high = body.shape.bounds()
    out = BEYOND * float(np.abs(mesh.bounds).max())
    for d, n in enumerate(mesh.blocks[0].shape):
        apart = low[d] > mesh.bounds[0, d] + out and high[d] < mesh.bounds[1, d] - out
        if n > 1 or apart or body.constraint != SIX_DEGREES:
            continue
        free = [f"{name}({body.number})=0" for name in _out_of_plane(body, d)]
        if free:
            letter = "xyz"[d]
            found.notice(
                *_place(found, body),
                wrong=f"{body.name} reaches to a side of the only cell in {letter}, and may leave the plane: an end "
                "that opens there by a hair is pressed by the liquid as a whole",
                write=f"Write {', '.join(free)} for a motion in the plane",
            )  # fmt: skip


def _out_of_plane(body: Body, d: int) -> list[str]:
    """Variables of the components of a body's motion across the plane that lies across d, of those its loads move."""
    turns = [f"iom{'xyz'[e]}cal" for e in range(3)]
    drives = zip([f"i{'uvw'[d]}mcal", *turns], [body.drives[d], *body.drives[3:]], [-1, 0, 1, 2], strict=True)
    return [name for name, drive, e in drives if drive.coupled and e != d]


def _check_overlaps(found: Findings, body: Body, bodies: list[Body], points: np.ndarray) -> None:
    """A coupled body and others that share its place at the start (points, n x 3, in it) and do not collide with it.

    Those that would collide are a problem (building/contacts.py), a hinge in a solid has a notice there.
    """
    deck = found.deck
    for other in bodies:
        collides = deck["ICLID"] == 1 and deck.at("ICLIDOB", body.number, other.number) == 1
        collides &= deck["ICLID"] == 1 and deck.at("ICLIDOB", other.number, body.number) == 1
        hinge = other.kind == SOLID and body.constraint in (FIXED_AXIS, FIXED_POINT)
        twice = other.kind == COUPLED and other.number <= body.number
        if collides or hinge or twice or not len(points):
            continue
        low, high = other.shape.bounds()
        near = points[((points >= low) & (points <= high)).all(axis=1)]
        share = (other.shape.distance(near) < 0.0).sum() / len(points) if len(near) else 0.0
        if share > OVERLAP:
            collide = "iclid=1" if deck["ICLID"] != 1 else f"iclidob({body.number},{other.number})=1"
            found.notice(
                *_place(found, body),
                wrong=f"about {share:.2g} of {body.name} is inside {other.name} at the start: they do not collide and "
                "move through each other, and liquid acts only on what is outside of both",
                write=f"Move one of them and write {collide}, if that is not meant",
            )  # fmt: skip


def _check_thickness(found: Findings, body: Body, mesh: Mesh, points: np.ndarray) -> None:
    """Look inwards from the surface: two cells deep everything should still be inside."""
    planes, shape = mesh.blocks[0].planes, mesh.blocks[0].shape
    there = np.array([n > 1 for n in shape])
    points = points[((points >= mesh.bounds[0]) & (points <= mesh.bounds[1])).all(axis=1)]
    if not len(points) or not there.any():
        return
    points = points[np.argsort(-body.shape.distance(points), kind="stable")[:WALLS]]  # those nearest to the surface
    normal = body.shape.normal(points) * there
    size = np.linalg.norm(normal, axis=1)
    points, normal = points[size > 0.5], normal[size > 0.5] / size[size > 0.5, None]  # not those that look along z only
    if not len(points):
        return
    at = [
        np.clip(np.searchsorted(x, p, side="right") - 1, 0, len(x) - 2)
        for x, p in zip(planes, points.T, strict=True)
    ]  # fmt: skip
    cells = np.column_stack([np.diff(x)[k] for x, k in zip(planes, at, strict=True)])
    deep = 2.0 * (np.abs(normal) * cells).sum(axis=1)
    surface = points - body.shape.distance(points)[:, None] * normal
    thick = np.full(len(points), np.inf)
    for k in range(STEPS, 0, -1):
        beyond = body.shape.distance(surface - (k / STEPS * deep)[:, None] * normal) > 0.0
        thick[beyond] = 2.0 * k / STEPS
    if np.isfinite(thick).mean() > FEW:
        found.notice(
            *_place(found, body),
            wrong=f"parts of {body.name} are thinner than two cells ({thick.min():.2g} of a cell at the thinnest): "
            "liquid before and behind them shares cells, so that differences of pressure across them and inertia of "
            "the liquid around them are lost; of round parts that are no ball also lift, below half a cell nearly all",
            write="Write smaller cells there",
        )  # fmt: skip


def _place(found: Findings, body: Body) -> tuple:
    return ("OBSID", body.number) if found.deck.given("OBSID", body.number) else ("IMO", body.number)
