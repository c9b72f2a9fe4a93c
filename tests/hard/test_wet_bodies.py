"""Bodies in liquid where programs fail: the decks decks/hard/wet_*.nml.

What must hold in all of them: the end is reached, everything stays finite, liquid is kept, no cell holds much more than
it can, the energy of bodies and liquid does not grow by itself, and bodies do not overlap. Overlaps are found anew, not
by the program's own contact search (decks/measure_scenes.py).
"""

import sys
from pathlib import Path
from typing import NamedTuple

import f90nml
import numpy as np
import pytest
from flowgmo_wet_bodies import begin, hair

from flowgmo.pace import Pace
from flowgmo.step import liquid_values

DECKS = Path(__file__).parents[2] / "decks" / "hard"
sys.path.insert(0, str(DECKS.parent))

from measure_scenes import Solids  # noqa: E402

REAL = (slice(2, -2),) * 3
BOOKS = 1e-10  # of the liquid's volume, after every step; measured 8e-16 at most in all of them
TOUCH = 1e-9  # m that bodies may overlap: 6e-11 measured; 9e-10 is the gap that counts as touching
SIDES = ("xl", "xh", "yl", "yh", "zl", "zh")
# m, of wet_gate's ball; .0006 measured, no more than half of the gate's way in a step: a wedge of 8 degrees with a
# friction of .3 holds by itself, so that no forces let the ball out, as the run says at its end
WEDGED = 1e-3
RATIOS = ("0.001", "0.01", "0.1", "0.5", "0.9", "1.1", "100")


def deck(name, ratio=None):
    text = (DECKS / f"wet_{name}.nml").read_text()
    if ratio is None:
        return text
    assert "rhomvb(1)=100.0," in text
    return text.replace("rhomvb(1)=100.0,", f"rhomvb(1)={1000.0 * float(ratio)!r},")


class Found(NamedTuple):
    """rise: largest of the remainder of the energy in shares of the largest kinetic energy; over: largest V (F - 1);
    books: error of the liquid's volume; speed: largest of liquid and bodies; deepest [m]: overlap of bodies, walls;
    places (n, 3): of the bodies at the end."""

    rise: float
    over: float
    books: float
    speed: float
    deepest: float
    places: np.ndarray


def run(text):
    """What is Found over all steps of a deck."""
    world, state = begin(text)
    pace, liquid = Pace(world.model, state), world.liquid
    cells = np.einsum("i,j,k->ijk", *liquid.grid[:3])
    rows, poses, over, books = [], [], 0.0, 0.0
    while state.t < world.model.clock.end:
        pace.advance(world)
        flow, V = state.fluid, liquid.openings.V
        values = liquid_values(world, state)
        speed = max(*(float(np.abs(u).max()) for u in flow.velocity if u is not None), float(np.abs(state.v_WB).max()))
        rows.append((values["energy/kinetic"], values["energy/remainder"], speed))
        poses.append((state.p_WB.copy(), state.q_WB.copy()))
        if flow.F is not None:
            over = max(over, float(((flow.F - 1.0) * V)[REAL].max()))
            held = float((flow.F * V * cells)[REAL].sum())
            books = max(books, abs(held - flow.start_volume - flow.passed.sum()) / flow.start_volume)
    kinetic, remainder, speed = np.array(rows).T
    rise = float((remainder - np.minimum.accumulate(remainder)).max())
    assert np.isfinite(rows).all() and np.isfinite(state.p_WB).all()
    deepest = deepest_overlap(text, world.model, poses)
    return Found(rise / max(float(kinetic.max()), 1e-300), over, books, float(speed.max()), deepest, state.p_WB.copy())


def deepest_overlap(text, model, poses):
    """Of poses [(p (n, 3), q (n, 4))] of a deck's bodies, with closed sides too, through which prescribed bodies may
    go; -inf where bodies are not balls and boxes."""
    if "ioh" in text or model.contacts is None:
        return -np.inf
    given = f90nml.reads(text.split("\n", 1)[1])
    names = [body.name for body in model.bodies]
    sides = [side for side, kind in zip(SIDES, given["bcdata"]["ibct"], strict=True) if kind in (1, 2)]
    p, q = (np.array(one) for one in zip(*poses, strict=True))
    driven = [body.name for body in model.bodies if not body.coupled]
    return Solids(given, names).deepest({n: (p[:, k], q[:, k]) for k, n in enumerate(names)}, sides, driven)


def holds(found, rise, over, speed, deepest=TOUCH):
    assert found.books <= BOOKS
    assert found.over <= over
    assert found.speed <= speed
    assert found.rise <= rise
    assert found.deepest <= deepest


# Rise of the energy, overfull cells, speed that are allowed, and what was measured with g a hair apart and on several
# states of one day; the largest speed is that of one cell in one step (a jet in a slit), allowed is half more than the
# largest measured. A program that is not stable here ends at 1e2 to 1e15 m/s. Gravity alone gives 2.8 m/s.
SCENES = {
    "aground": (0.015, 0.06, 5.0),  # .004 to .010, .02 to .039, 3
    "bubbles": (0.04, 0.01, 3.0),  # 0, .002, 2
    "feather": (0.08, 0.12, 5.0),  # 0 to .031, .046, 2 to 3; 1.1 and 300 m/s where nothing but its own
    # inertia, 1e-6 of the water's, held it along the surface
    "gate": (0.08, 0.1, 8.0),  # .02 to .04, .015 to .067, 5; .29: impacts paid for late
    "hit": (0.06, 0.04, 7.5),  # .039, .016, 2 to 5; .23 likewise
    "hollow": (0.06, 0.01, 20.0),  # .008 to .036, .002, 7 to 13: jets as it nears the lid; 0 to .009, .04 where what
    # closes left its room to pockets
    "one_cell": (0.0, 0.0, 0.0),  # nothing moves
    "pile": (0.05, 0.03, 10.0),  # .002 to .006, .002 to .008, 5 to 7; .063, 21 by a jet through .024 of a face
    "piston": (0.25, 0.01, 1.6),  # .13, 1e-5 to 1e-4, 1
    "plug": (0.12, 0.02, 5.2),  # .08; .09 where liquid beside the plug does not move with it, .006, 3.4
    "shell": (0.06, 0.015, 6.0),  # .001 to .026, .001 to .005, 4
    "slam": (0.02, 0.04, 4.7),  # .004, .025, 3
    "slam_driven": (0.01, 1e-4, 6.0),  # 2e-13, 3e-5, 4; .07 where the plate's velocity counts before the water has it
    "spin": (0.02, 0.005, 60.0),  # 0 (of 601 J), .001, 40: the corners of the box, 76
    "spin_ball": (1e-9, 1e-6, 100.0),  # 3e-14, 2e-12, 70: the ball itself, 104; 2e-8 by round-off of potential energy
    # .003, .001, 5; .043 where potential energy does not know where in a cell balls are
    "tiny": (0.03, 0.02, 7.5),
}
PLUG_FREE = (0.3, 0.2, 4.5)  # .07 to .21, .06 to .20, 1 to 3 in 28 of 29 draws; .54 in a step of one, by the books
# a film of less than a cell, squeezed out faster and faster; an overlap of 7e-5 m in one of four draws, else 2e-11
BRIMFUL = (0.85, 0.01, 7.5, 1.2e-4)  # .56 to .69, .001 to .005, 4 to 5
SHUT_IN = (0.85, 0.0, 5.7)  # .54 to .68: the same without a surface
JAM = {  # rise, over, speed, deepest [m], of balls of .05
    "0.001": (0.04, 0.07, 5.9, 1.2e-4),  # .010 to .013, .023 to .046, 3.5 to 3.9, 3.6e-5 to 6.1e-5 in two draws
    "0.1": (0.04, 0.04, 5.3, 1.2e-4),  # .008 to .009, .018 to .023, 3.5, 4.2e-5 to 7.9e-5 in three
}
STREAMS = {  # over, speed; the streams bring energy
    "bed": (0.05, 3.4),  # .02, 2
    "leave": (0.03, 3.0),  # .026, 2: a box that slides goes by the mean of velocities; .01 in other steps
    "pressed": (0.08, 6.0),  # .03, 4
}
RELEASED = {  # over: .045 to .12 where a ball goes by the mean of its velocities, .006 to .07 where it is expected to
    # go on at its speed; VALIDATION E asks for .03
    "0.001": (0.1, 0.01, 6.6),  # 0 to .05, .002, 4
    "0.01": (0.1, 0.01, 7.5),  # .006, .002, 5
    "0.1": (0.03, 0.01, 5.3),  # 0, .0015, 3.5
    "0.5": (0.02, 0.02, 2.4),  # 0, .008, 1.6
    "0.9": (0.02, 0.005, 0.6),  # .0015, .0002, .4
    "1.1": (0.03, 0.005, 0.6),  # .0014, .0001, .3; .14 to .18 where it goes by the mean
    "100": (0.01, 0.05, 5.3),  # .003, .027 at its first impact (in 3 draws), 3.5
}
THROWN = {  # rise: of a light ball that has stopped the largest kinetic energy is small
    "0.001": (0.2, 0.01, 5.3),  # .04 to .11, .003, 3.5
    "0.01": (0.04, 0.01, 5.3),  # .008 to .013, .001, 3.5
    "0.1": (0.03, 0.03, 5.3),  # .004 to .008, .009, 3.5
    "0.5": (0.01, 0.01, 7.5),  # 0 to .003, .002, 3.5 to 5
    "0.9": (0.05, 0.02, 6.5),  # .002 to .018, .004, 4; .41 and 74 by jets through slits
    "1.1": (0.08, 0.02, 18.0),  # .01 to .03, .001 to .007, 5 to 12
    "100": (0.005, 0.05, 24.0),  # .001, .006 to .016, 16
}


@pytest.mark.parametrize("name", SCENES)
def test_goes_to_its_end_and_makes_no_energy(name):
    holds(run(deck(name)), *SCENES[name], WEDGED if name == "gate" else TOUCH)


def test_plug_let_go_seldom_draws_a_jet():
    # Gravity a hair apart: which way the plug wedges is chance. Where excess leaves at any pressure draws 8, 15 and 16
    # had .98, 1.0, .33 and 55, 36 000, 3 m/s. Two of twenty still rise by .37 and .85 in the step of an impact, with 10
    # m/s in slits of a thousandth of a cell, not the same ones on each machine; the next step takes it back.
    text, calm = deck("plug_free"), 0
    for draw in (0, 8, 15, 16, 18):
        found = run(hair(text, draw))
        assert found.books <= BOOKS
        calm += all(a <= b for a, b in zip((found.rise, found.over, found.speed), PLUG_FREE, strict=True))
    assert calm >= 4


@pytest.mark.parametrize("draw", (2, 5))
def test_ball_squeezed_by_a_gate_with_gravity_a_hair_apart(draw):
    # .03, .02; up to .14 in five of ten where voids that the contacts first assumed have shut stay shut with others
    holds(run(hair(deck("gate"), draw)), *SCENES["gate"], WEDGED)


def test_box_in_a_tank_that_is_full_but_for_a_film():
    holds(run(deck("brimful")), *BRIMFUL)


@pytest.mark.slow
@pytest.mark.parametrize("ratio", JAM)
def test_twenty_balls_lie_under_a_lid(ratio):
    # All of them under it from t = .7 s on. The overlap is that of a ball that lies at the lid, with the lid: what
    # others' impacts make of its velocity through the liquid (WetImpacts.settle) knows of no contact, so that it goes
    # on into the lid for half of the next step; a shift takes it back in the one after.
    found = run(deck("bubbles_jam").replace("=100.0,", f"={1000.0 * float(ratio)!r},"))
    holds(found, *JAM[ratio])
    assert np.abs(found.places[:, 2] - 0.45).max() <= 1e-3


@pytest.mark.parametrize("name", STREAMS)
def test_bodies_in_streams(name):
    holds(run(deck(name)), np.inf, *STREAMS[name])


@pytest.mark.parametrize("ratio", RATIOS)
def test_ball_of_any_density_released_under_water(ratio):
    holds(run(deck("released", ratio)), *RELEASED[ratio])


@pytest.mark.parametrize("draw", (1, 2))
@pytest.mark.parametrize("ratio", ("0.001", "0.01", "0.1"))
def test_light_ball_released_with_gravity_a_hair_apart(ratio, draw):
    holds(run(hair(deck("released", ratio), draw)), *RELEASED[ratio])


@pytest.mark.parametrize("ratio", ("0.001", "0.1", "100"))
def test_ball_that_gains_speed_under_water_leaves_cells_full(ratio):
    # Steps of 5 ms, from rest: most V (F - 1) of the first five .0016, .0020, .0005; .045, .038, .027 where a ball that
    # may collide goes by the mean of the velocities and the liquid by those of the end.
    world, state = begin(deck("released", ratio))
    pace, over = Pace(world.model, state), 0.0
    for _ in range(5):
        pace.advance(world)
        over = max(over, float(((state.fluid.F - 1.0) * world.liquid.openings.V)[REAL].max()))
    assert over <= 4e-3


@pytest.mark.parametrize("ratio", RATIOS)
def test_ball_of_any_density_thrown_in(ratio):
    holds(run(deck("thrown", ratio)), *THROWN[ratio])


def test_box_that_sinks_to_the_bed_of_a_tank_without_a_surface():
    # It ended with "pulled apart" where the box was expected in the bed.
    holds(run(deck("shut_in")), *SHUT_IN)
