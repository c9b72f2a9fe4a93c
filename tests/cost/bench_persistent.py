"""Prints what the solver of persistent contacts costs: python tests/cost/bench_persistent.py. No test.

Cold: from no impulses. Warm: the next step of the same scene, guess and free twists as a resting scene has them.
Sweeps alone: symmetric block Gauss-Seidel, what the Newton method is to beat.
"""

import os
import sys
import tempfile
import time
from pathlib import Path

os.environ["NUMBA_CACHE_DIR"] = tempfile.mkdtemp()  # so that the first call compiles
sys.path.insert(0, str(Path(__file__).parents[1] / "helpers"))

import contact_scenes as cs
import numpy as np

from flowgmo.collision.contact_groups import find_groups
from flowgmo.collision.contact_newton import start
from flowgmo.collision.links import LINK, SLOT, mass_unit, prepare_link, prepare_slots
from flowgmo.collision.persistent import solve, sweep_until
from flowgmo.kernel import kernel

SCENES = {
    "box on a floor": lambda: cs.stack([1.0]),
    "stack of 10": lambda: cs.stack(np.ones(10)),
    "1000 on 1": lambda: cs.stack([1.0, 1000.0]),
    "pyramid of 55": lambda: cs.pyramid(10),
    "leaning plates": cs.leaning_plates,
    "wedge": cs.wedge,
    "belt": cs.belt,
    "arch": cs.arch,
    "arch that falls": lambda: cs.arch(mu=0.1),
    "crusher": cs.crusher,
}


@kernel
def sweeps_alone(contacts, bias, responses, twists, tolerance, most):
    """Number of sweeps and residual of the largest group."""
    groups, _, queue, n_slots, slot_of, order, n_links = find_groups(contacts, responses)
    group = groups[0]
    unit = mass_unit(contacts, order, group, responses)
    slots = np.empty(n_slots, SLOT)
    lt = np.empty((n_slots, 3, 3))
    lr = np.empty((n_slots, 3, 3))
    links = np.empty(n_links, LINK)
    prepare_slots(slots, group, queue, responses, unit, lt, lr)
    for i in range(group.first, group.last):
        contact = contacts[order[i]]
        links[i].a = slot_of[contact.a]
        links[i].b = slot_of[contact.b]
        prepare_link(links[i], contact, bias, order[i], responses, twists, lt, lr, unit)
    start(links, slots, group)
    count, residual, _ = sweep_until(links, slots, group, tolerance, most)
    return count, residual


def seconds(function, scenes, *arguments):
    began = time.perf_counter()
    for s in scenes:
        result = function(*s, *arguments)
    return (time.perf_counter() - began) / len(scenes), result


def main():
    began = time.perf_counter()
    solve(*cs.stack([1.0]), 1e-9, 1000)
    print(f"compiled in {time.perf_counter() - began:.1f} s")
    sweeps_alone(*cs.stack([1.0]), 1e-9, 1)
    print("scene               tol   contacts | cold steps  status        µs | warm steps       µs | sweeps        µs")
    for name, make in SCENES.items():
        for tolerance in (1e-6, 1e-9, 1e-12):
            cold, (steps, _, status) = seconds(solve, [make() for _ in range(20)], tolerance, 1000)
            done = make()
            solve(*done, tolerance, 1000)
            again = [(done[0].copy(), *make()[1:]) for _ in range(20)]
            warm, (more, _, _) = seconds(solve, again, tolerance, 1000)
            alone, (sweeps, residual) = seconds(sweeps_alone, [make()], tolerance, 3000)
            reached = f"{sweeps:6d}" if residual <= tolerance else f">{sweeps:5d}"
            print(
                f"{name:18s} {tolerance:.0e} {len(done[0]):8d} | {steps:10d} {status:7d} {1e6 * cold:9.0f} |"
                f" {more:10d} {1e6 * warm:8.1f} | {reached} {1e6 * alone:9.0f}"
            )


if __name__ == "__main__":
    main()
