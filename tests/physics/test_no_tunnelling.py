"""No ball passes a thin box or a small ball at any step (VALIDATION C): time of impact by conservative advancement."""

import numpy as np
import pytest
from flowgmo_scenes import OPEN, Scene, ball, deck, driven, solid

PARTS, SHOTS, SPEED, PLATE, R = 8, 25, 100.0, 0.01, 0.05


def shots(rng):
    """Balls far from each other, each with a plate in front, shot at a random place of it at a random angle. Returns
    the bodies and the times of the first contacts."""
    bodies, times = [], []
    for k in range(SHOTS):
        middle = np.array([10.0 * (k % 5), 10.0 * (k // 5), 0.0])
        place = middle + [*rng.uniform(-0.9, 0.9, 2), 0.0]
        aim = np.array([*rng.normal(size=2), -1.0])
        v = SPEED * aim / np.linalg.norm(aim)
        late = rng.uniform(0.002, 0.03)
        bodies.append(ball(place - v * late + [0, 0, R], R, v))
        bodies.append(solid(middle - [1, 1, PLATE], middle + [1, 1, 0]))
        times.append(late)
    return bodies, np.array(times)


@pytest.mark.parametrize("part", range(PARTS))
def test_fast_balls_and_thin_plates(part):
    """In all 200 random shots at 100 length/time on 1 cm plates, in steps of 1 ms and with the whole run as one step:
    every one is met at its time. Measured: 2e-17. A search that looks at the ends of a step only misses nearly all."""
    bodies, times = shots(np.random.default_rng(part))
    text = deck(*bodies, lo=(-20, -20, -20), hi=(200, 200, 20), sides=OPEN)
    for dt in (1e-3, 0.04):
        s = Scene(text).to(0.04, dt)
        balls = s.impacts[s.impacts["b"] % 2 == 0]
        first = {int(hit["a"]): hit["time"] for hit in balls[::-1]}
        np.testing.assert_allclose([first[2 * k + 1] for k in range(SHOTS)], times, atol=1e-12)
        assert np.all(s.v[::2, 2] > 0)


@pytest.mark.parametrize("spin", [0.0, 300.0])
def test_a_driven_ball_on_an_arm_sweeps_a_small_ball(spin):
    """A driven ball that turns about a far reference point: its path is a circle, its chord would miss. Sweeps half a
    turn and more in one step."""
    angle = 1.0 + 0.002 * spin
    target = (2.0 * np.cos(angle), 2.0 * np.sin(angle), 0)
    rate = max(spin, 2.0)
    arm = driven((2.0, 0, 0), 0.02, w=(0, 0, rate), more="xref0(#)=0.0, yref0(#)=0.0, zref0(#)=0.0,")
    s = Scene(deck(arm, ball(target, 0.02), e=1.0)).to(2.0 / rate * 1.5)
    assert len(s.impacts) >= 1
    contact = angle - 2 * np.arcsin(0.01)
    assert s.impacts["time"][0] == pytest.approx(contact / rate, rel=1e-9)


@pytest.mark.parametrize("speed", [10.0, 1e3, 1e6])
def test_a_grazing_ball_passes_and_a_touching_one_does_not(speed):
    """Two balls whose paths miss by 1e-9, or overlap by 1e-9 radii."""
    for off, hits in ((1e-9, 0), (-1e-9, 1)):
        x = (-1.0, 0.2 * (1 + off / 2), 0)
        s = Scene(deck(ball(x, 0.1, v=(speed, 0, 0)), ball((0, 0, 0), 0.1))).to(2.0 / speed)
        assert len(s.impacts) == hits
