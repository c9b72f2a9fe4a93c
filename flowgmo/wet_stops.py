"""When bodies in liquid leave the stops that hold them, where no contact engine moves them.

Such bodies fly without weight and loads (wet_bodies.py), so that nothing in their motion would ever let them go: a stop
holds as long as what acts presses against it.
"""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.energy import rotation_matrices


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
