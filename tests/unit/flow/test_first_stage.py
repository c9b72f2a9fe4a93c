"""What the last pressure gives faces at the surface of liquid one cell deep (first_stage.py)."""

import pytest
from flowgmo_pressure import RHO, block_of, g, level_pool, projector

from flowgmo.flow.fields import G, zeros
from flowgmo.flow.pressure.first_stage import push_by_last_pressure

BLOCK = block_of((4, 3, 4), (0.4, 0.3, 0.4), graded=False)
H, DT = 0.1, 1e-3
TOP = (slice(G, -G), slice(G, -G), G)  # upper faces of the lowest layer


def pushed(height, p):
    """w of the faces above the lowest layer of a level pool at rest that p of the last step acts on."""
    P, F = projector(BLOCK), level_pool(BLOCK, height)
    P.sides.fill_fraction(F)
    P.set_surface(F)
    velocity = [zeros(BLOCK) for _ in range(3)]
    push_by_last_pressure(P, p, DT, velocity)
    return velocity[2][TOP]


def layers(*values):
    """p [Pa] of the layers, from below."""
    p = zeros(BLOCK)
    for k, value in enumerate(values):
        p[:, :, G + k] = value
    return p


@pytest.mark.parametrize("depth", [0.0503, 0.07, 0.099])
def test_film_at_rest_gets_what_gravity_takes(depth):
    assert pushed(depth, layers(RHO * g * (depth - 0.5 * H))) == pytest.approx(g * DT, rel=1e-12)


def test_cell_that_fell_dry_leaves_the_gradient_that_was():
    # water of 1.52 cells a step ago, 1.48 now: by the distance to the surface it was g 1.02 / .98
    p = layers(RHO * g * 1.02 * H, RHO * g * 0.02 * H)
    assert pushed(1.48 * H, p) == pytest.approx(g * DT, rel=1e-12)


def test_surface_that_came_to_the_centre_makes_no_jet_of_the_last_pressure():
    # 2 kPa over a thirtieth of a millimetre: .6 m/s in a step of 1 ms, 600 times what a surface in the face gets
    p, depth = 2e3, 0.0503
    assert pushed(depth, layers(p)) == pytest.approx(2.0 * p * DT / (RHO * H), rel=1e-12)
