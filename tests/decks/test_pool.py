"""decks/pool: the break on a table, report 4.3."""

import numpy as np
import pytest

pytestmark = pytest.mark.slow  # minutes in all; the tests of tests/physics, hard and identity run every day


def test_smooth(runs):
    # Speeds at 0.16 s as in decks/rack times 0.8. `lift` and `depth`: nothing acts up or down but the slate; 1e-12 m
    # would reveal bounces of balls that rest. Energy: e = 1 keeps it through some hundred impacts.
    bounds = {"balls on the table": 0, "depth in the slate": 1e-12, "energy added": 1e-9, "lift": 1e-12}
    speeds = {name: 1e-3 for name in runs.measure.reference("pool", "smooth") if name.startswith("speed")}
    runs.agree("pool", "smooth", bounds | speeds)


def test_smooth_keeps_its_energy(runs):
    kinetic = runs.curves("pool", "smooth").energy["kinetic"]
    assert np.abs(kinetic / kinetic[0] - 1.0).max() <= 1e-9


def test_smooth_is_symmetric_until_chaos(runs):
    # Until the corner balls meet the cushions: 1e-10 m. The deck is its own mirror image.
    curves = runs.curves("pool", "smooth")
    row = curves.row(0.2)
    for one, two in (("ball2", "ball3"), ("ball7", "ball10"), ("ball11", "ball15"), ("ball12", "ball14")):
        left, right = (curves.bodies[ball]["position"][: row + 1] for ball in (one, two))
        assert np.abs(left - right * [1.0, -1.0, 1.0]).max() <= 1e-10


def test_break(runs):
    # 1e-9 m and 1e-9 of the cue's energy: real balls may hop (friction between them acts up and down) but never sink,
    # and no impact and no rolling adds energy.
    runs.agree("pool", "break", {"balls on the table": 0, "depth in the slate": 1e-9, "energy added": 1e-9})


def test_break_slides_then_rolls(runs):
    # From a ball's last impact with anything but the slate on, friction 0.06 takes 7/2 mu times the normal impulse per
    # mass, g t - w with w upwards at first (hops included), off its slip; then the ball rolls. Measured: 2e-11 m/s
    # where it rolls, 3e-12 off the law where it slides; bound 8e-6 = 1e-6 of the break's 8 m/s.
    curves = runs.curves("pool", "break")
    numbers = {"cue": 1} | {f"ball{k}": k + 1 for k in range(1, 16)}
    a, b, times = (curves.impacts[name] for name in ("a", "b", "time"))
    for ball, number in numbers.items():
        if curves.at(ball, "position")[2] > 0.028575 + 1e-9:
            continue
        others = ((a == number) & (b != 17)) | ((b == number) & (a != 17))
        row = int(np.searchsorted(curves.time, times[others].max(), side="right"))
        left = slip(curves, ball, row) - 3.5 * 0.06 * (
            9.81 * (curves.time[-1] - curves.time[row]) - curves.bodies[ball]["velocity"][row, 2]
        )
        assert abs(slip(curves, ball, -1) - max(left, 0.0)) <= 8e-6, ball


def slip(curves, ball, row):
    """Speed of a ball's lowest point along the slate in a row."""
    body = curves.bodies[ball]
    return np.linalg.norm((body["velocity"][row] + np.cross(body["angular_velocity"][row], [0.0, 0.0, -0.028575]))[:2])
