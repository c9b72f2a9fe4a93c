"""Bodies in liquid where programs fail: the decks decks/hard/wet_*.nml.

What must hold in all of them: the end is reached, everything stays finite, liquid is kept, no cell holds much more than
it can, and the energy of bodies and liquid does not grow by itself.
"""

from pathlib import Path

import numpy as np
import pytest
from flowgmo_wet_bodies import begin, hair

from flowgmo.pace import Pace
from flowgmo.step import liquid_values

DECKS = Path(__file__).parents[2] / "decks" / "hard"
REAL = (slice(2, -2),) * 3
BOOKS = 1e-5  # of the liquid's volume; 1e-16 but where cells close around what they hold: 2e-6
RATIOS = ("0.001", "0.01", "0.1", "0.5", "0.9", "1.1", "100")


def deck(name, ratio=None):
    text = (DECKS / f"wet_{name}.nml").read_text()
    if ratio is None:
        return text
    assert "rhomvb(1)=100.0," in text
    return text.replace("rhomvb(1)=100.0,", f"rhomvb(1)={1000.0 * float(ratio)!r},")


def run(text):
    """(largest rise of the remainder of the energy in shares of the largest kinetic energy, largest V (F - 1), error of
    the liquid's books, largest speed of liquid and bodies)."""
    world, state = begin(text)
    pace, liquid = Pace(world.model, state), world.liquid
    cells = np.einsum("i,j,k->ijk", *liquid.grid[:3])
    rows, over = [], 0.0
    while state.t < world.model.clock.end:
        pace.advance(world)
        flow, V = state.fluid, liquid.openings.V
        values = liquid_values(world, state)
        speed = max(*(float(np.abs(u).max()) for u in flow.velocity if u is not None), float(np.abs(state.v_WB).max()))
        rows.append((values["energy/kinetic"], values["energy/remainder"], speed))
        if flow.F is not None:
            over = max(over, float(((flow.F - 1.0) * V)[REAL].max()))
    books = 0.0
    if flow.F is not None:
        held = float((flow.F * V * cells)[REAL].sum())
        books = abs(held - flow.start_volume - flow.passed.sum()) / flow.start_volume
    kinetic, remainder, speed = np.array(rows).T
    rise = float((remainder - np.minimum.accumulate(remainder)).max())
    assert np.isfinite(rows).all() and np.isfinite(state.p_WB).all()
    return rise / max(float(kinetic.max()), 1e-300), over, books, float(speed.max())


def holds(found, rise, over, speed):
    assert found[2] <= BOOKS
    assert found[1] <= over
    assert found[3] <= speed
    assert found[0] <= rise


# Rise of the energy, overfull cells, speed that are allowed, and what was measured with g a hair apart and on several
# states of one day; the largest speed is that of one cell in one step (a jet in a slit). A program that is not stable
# here ends at 1e2 to 1e15 m/s. Gravity alone gives 2.8 m/s.
FAST = 40.0
SCENES = {
    "aground": (0.015, 0.06, FAST),  # .004 to .010, .02 to .032, 3
    "bubbles": (0.04, 0.01, FAST),  # 0, .002, 2
    "feather": (0.08, 0.12, 20.0),  # 0 to .016, .046, 2 to 3; 1.1 and 300 m/s where nothing but its own
    # inertia, 1e-6 of the water's, held it along the surface
    "gate": (0.08, 0.1, FAST),  # .02 to .04, .015 to .067, 5; .29: impacts paid for late
    "hit": (0.06, 0.04, FAST),  # .039, .016, 2 to 5; .23 likewise
    "hollow": (0.06, 0.01, FAST),  # .008 to .036, .002, 7 to 10: jets as it nears the lid; 0 to .009, .04 where what
    # closes left its room to pockets
    "one_cell": (0.0, 0.0, 0.0),  # nothing moves
    "pile": (0.05, 0.03, FAST),  # .002 to .006, .002 to .008, 5 to 7; .063, 21 by a jet through .024 of a face
    "piston": (0.25, 0.01, FAST),  # .13, 1e-5 to 1e-4, 1
    "plug": (0.12, 0.02, FAST),  # .08; .09 where liquid beside the plug does not move with it, .006, 3
    "shell": (0.06, 0.015, FAST),  # .001 to .026, .001 to .005, 4
    "slam": (0.02, 0.04, FAST),  # .004, .025, 3
    "slam_driven": (0.01, 1e-4, FAST),  # 2e-13, 3e-5, 4; .07 where the plate's velocity counts before the water has it
    "spin": (0.02, 0.005, 60.0),  # 0 (of 601 J), .001, 40: the corners of the box, 76
    "spin_ball": (1e-9, 1e-6, 100.0),  # 3e-14, 2e-12, 70: the ball itself, 104; 2e-8 by round-off of potential energy
    "tiny": (0.03, 0.02, FAST),  # .01, .005, 2
}
PLUG_FREE = (0.3, 0.2, 20.0)  # .07 to .21, .06 to .20, 1 to 3 in 28 of 29 draws; .54 in a step of one, by the books
BRIMFUL = (0.85, 0.01, FAST)  # .56 to .69, .001, 4 to 5: a film of less than a cell, squeezed out faster and faster
SHUT_IN = (0.85, 0.0, FAST)  # .54 to .68: the same without a surface
STREAMS = {  # over, speed; the streams bring energy
    "bed": (0.05, FAST),  # .02, 2
    "leave": (0.03, FAST),  # .026, 2: a box that slides goes by the mean of velocities; .01 in other steps
    "pressed": (0.08, FAST),  # .03, 4
}
RELEASED = {  # over: .045 to .12 where a ball goes by the mean of its velocities, .006 to .07 where it is expected to
    # go on at its speed; VALIDATION E asks for .03
    "0.001": (0.1, 0.01, FAST),  # 0 to .05, .002, 4
    "0.01": (0.1, 0.01, FAST),  # .006, .002, 5
    "0.1": (0.03, 0.01, FAST),  # 0, .0015, 3.5
    "0.5": (0.02, 0.02, FAST),  # 0, .008, 1.6
    "0.9": (0.02, 0.005, FAST),  # .0015, .0002, .4
    "1.1": (0.03, 0.005, FAST),  # .0014, .0001, .3; .14 to .18 where it goes by the mean
    "100": (0.01, 0.05, FAST),  # .003, .027 at its first impact (in 3 draws), 3.5
}
THROWN = {  # rise: of a light ball that has stopped the largest kinetic energy is small
    "0.001": (0.2, 0.01, FAST),  # .05 to .11, .003, 3.5
    "0.01": (0.04, 0.01, FAST),  # .008 to .013, .001, 3.5
    "0.1": (0.03, 0.03, FAST),  # .004 to .008, .009, 3.5
    "0.5": (0.01, 0.01, FAST),  # 0 to .003, .002, 3.5 to 5
    "0.9": (0.05, 0.02, FAST),  # .002 to .018, .004, 4; .41 and 74 by jets through slits
    "1.1": (0.08, 0.02, FAST),  # .01 to .03, .001 to .007, 5 to 12
    "100": (0.005, 0.05, FAST),  # .001, .006 to .016, 16
}


@pytest.mark.parametrize("name", SCENES)
def test_goes_to_its_end_and_makes_no_energy(name):
    holds(run(deck(name)), *SCENES[name])


def test_plug_let_go_seldom_draws_a_jet():
    # Gravity a hair apart: which way the plug wedges is chance. Where excess leaves at any pressure draws 8, 15 and 16
    # had .98, 1.0, .33 and 55, 36 000, 3 m/s. Two of twenty still rise by .37 and .85 in the step of an impact, with 10
    # m/s in slits of a thousandth of a cell, not the same ones on each machine; the next step takes it back.
    text, calm = deck("plug_free"), 0
    for draw in (0, 8, 15, 16, 18):
        found = run(hair(text, draw))
        assert found[2] <= BOOKS
        calm += all(a <= b for a, b in zip((found[0], found[1], found[3]), PLUG_FREE, strict=True))
    assert calm >= 4


@pytest.mark.parametrize("draw", (2, 5))
def test_ball_squeezed_by_a_gate_with_gravity_a_hair_apart(draw):
    # .03, .02; up to .14 in five of ten where voids that the contacts first assumed have shut stay shut with others
    holds(run(hair(deck("gate"), draw)), *SCENES["gate"])


def test_box_in_a_tank_that_is_full_but_for_a_film():
    holds(run(deck("brimful")), *BRIMFUL)


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
