"""Bodies in liquid at their stops: when they will meet them, what the liquid gives then, when they leave.

A stop is a plastic impact with what cannot move (bodies/stops.py). The liquid that goes with the body stops with it: by
a pressure without time at the end of the step (wet_impacts.py), in which the component that is held does not move,

    impulse of the stop  =  - m U - F        F = rho J^T q: what the liquid gives the body, U the velocities before
    lost                 =  m U^2 / 2  +  F . (U - U+) / 2

of the component, or m and F about the axis. A step in which a body would meet its stop ends there, as with other
impacts: what the liquid has made room for beyond it would be missing elsewhere.

While the body stands at its stop the pressure has a wall there. It leaves when what acts no longer presses against it:
where no contact engine moves bodies they fly without weight and loads (wet_bodies.py), so that nothing in their motion
would ever let them go.
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.arrays import HINGED
from flowgmo.bodies.energy import rotation_matrices
from flowgmo.state import LOST_IN_IMPACTS


def let_go(bodies: np.ndarray, motion: np.ndarray, which: list[int], loads: np.ndarray) -> None:
    """Free, from the next step on, those of the bodies `which` that nothing presses against their stops.

    bodies (n,) BODY, motion (n,) POSE changed in `hold`; loads (which, 6) force and moment about B but for the weight.
    """
    for b, load in zip(which, loads, strict=True):
        hold, body = motion["hold"][b], bodies[b]
        if not hold.any():
            continue
        force = load[:3] + body["mass"] * body["gravity"]
        arm = rotation_matrices(motion["q"][b : b + 1])[0] @ body["arm"]
        turning = body["axis"] @ (load[3:] + np.cross(arm, force))
        hold[hold * np.append(force, turning) < 0.0] = 0


def time_to_stop(body: np.ndarray, row: np.ndarray) -> tuple[float, bool]:
    """Time [time] in which a body of dtype BODY meets its first stop with the velocities of row (POSE); infinity if it
    meets none. And whether it is that of its angle."""
    first, turns = np.inf, body["motion"] == HINGED
    away = [row["angle"]] if turns else row["p"] - body["origin"]
    speeds = [row["w"] @ body["axis"]] if turns else row["v"]
    for k, (x, v) in enumerate(zip(away, speeds, strict=True), 3 if turns else 0):
        if row["hold"][k] == 0 and v != 0.0 and (turns or body["coupled"][k]):
            gap = (body["hi"][k] - x) if v > 0.0 else (body["lo"][k] - x)
            first = min(first, max(gap / v, 0.0))
    return first, bool(turns)


def halted(rows: np.ndarray, which: np.ndarray, met: list[tuple[int, int, np.ndarray]]) -> np.ndarray:
    """(k,) bool: of the bodies which (k,), those that met a stop; rows (k,) POSE: what stops is held in them."""
    out = np.zeros(len(which), bool)
    for b, k, record in met:
        mine = which == b
        rows["hold"][mine, k] = -1 if record["impulse"].sum() > 0.0 else 1
        out |= mine
    return out


def book_hits(
    bodies: np.ndarray, motion: np.ndarray, met: list[tuple[int, int, np.ndarray]], wet: list[int], U: np.ndarray,
    given: np.ndarray, books: np.ndarray,
) -> None:  # fmt: skip
    """Add what the liquid gave to the stops that bodies met to the books and records.

    bodies (n,) BODY, motion (n,) POSE; met: body, component, record; wet: rows of bodies; U (wet, 6): velocities that
    the liquid had followed, given (wet, 6): F.
    """
    for b, k, record in met:
        if b not in wet:
            continue
        own, F = U[wet.index(b)], given[wet.index(b)]
        if k == 3:
            direction, arm = bodies["axis"][b], rotation_matrices(motion["q"][b : b + 1])[0] @ bodies["arm"][b]
            push, speed = direction @ (F[3:] + np.cross(arm, F[:3])), direction @ own[3:]
        else:
            direction, push, speed = np.eye(3)[k], F[k], own[k]
        loss = 0.5 * push * speed
        books[LOST_IN_IMPACTS] += loss
        record["impulse"] -= push * direction
        record["fluid_impulse"] = -F[:3]
        record["energy_loss"] += loss
