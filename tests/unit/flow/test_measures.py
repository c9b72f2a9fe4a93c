"""Volume and energies of the liquid as a whole."""

import numpy as np
import pytest
from flowgmo_flows import DOWN, GRAVITY, RHO, at_faces, below, block_of, flow_of, openings_of, with_ghosts

from flowgmo.flow.columns import all_columns
from flowgmo.flow.fields import G, Open, grid_of
from flowgmo.flow.observe.measures import total, volume_error
from flowgmo.flow.team import Team

NONE = Open(None, None, None, None)


def totals(block, flow, gravity=DOWN, openings=NONE, threads=1, rho=RHO):
    columns = all_columns(tuple(n + 2 * G for n in block.shape))
    return total(Team(threads), columns, grid_of(block), openings, flow, rho, gravity, 1e-9)


@pytest.mark.parametrize("surface", [0.0, 0.03, 0.41, 0.999, 1.0])
@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("sign", [-1, 1])
def test_still_liquid_has_its_exact_potential_energy(surface, axis, sign):
    """The surface anywhere in a cell, along each direction. With centres of cells the error would be rho g dz^2 / 8."""
    turned = block_of(tuple(np.roll((7, 6, 9), axis - 2)), ratio=1.6)
    others = [turned.shape[k] for k in range(3) if k != axis]
    F = np.moveaxis(below(block_of((*others, turned.shape[axis])), surface), 2, axis)
    assert F.shape == tuple(n + 2 * G for n in turned.shape)
    if sign > 0:
        F = 1.0 - F
    gravity = sign * GRAVITY * np.eye(3)[axis]
    depth = 1.0 - surface if sign > 0 else surface
    found = totals(turned, flow_of(turned, F), gravity)
    assert found.volume == pytest.approx(depth, rel=1e-14, abs=1e-16)
    assert found.potential == pytest.approx(RHO * GRAVITY * depth**2 / 2, rel=1e-13, abs=1e-12)


def test_a_tilted_surface_is_second_order():
    """Measured: errors 1.7e-3, 4.7e-4, 1.3e-4; with centres of cells 9.3e-3, 2.5e-3, 6.4e-4."""
    errors = []
    for n in (8, 16, 32):
        block = block_of((n, 1, n), ratio=1.0)
        x, z = (with_ghosts(p) for p in (block.x, block.z))
        fine = (np.arange(400) + 0.5) / 400
        s = 0.35 + 0.3 * (x[:-1, None] + np.diff(x)[:, None] * fine)
        F = np.clip((s[:, :, None] - z[:-1]) / np.diff(z), 0, 1).mean(axis=1)
        F = np.repeat(F[:, None, :], 1 + 2 * G, axis=1)
        exact = RHO * GRAVITY * (0.5 * (0.35**2 + 0.35 * 0.3 + 0.3**2 / 3))
        errors.append(abs(totals(block, flow_of(block, F)).potential / exact - 1))
    assert errors[0] < 2.5e-3  # 9e-3: the lean is lost
    assert np.log2(errors[0] / errors[2]) / 2 > 1.7  # measured 1.86


def test_kinetic_energy_is_second_order():
    """u = sin pi x cos pi y, v = -cos pi x sin pi y on graded meshes: rho / 4. Measured: 1.1e-4, 2.7e-5, 6.4e-6."""
    errors = []
    for n in (8, 16, 32):
        block = block_of((n, n, 3))
        u = at_faces(block, 0, lambda x, y, z: np.sin(np.pi * x) * np.cos(np.pi * y))
        v = at_faces(block, 1, lambda x, y, z: -np.cos(np.pi * x) * np.sin(np.pi * y))
        w = at_faces(block, 2, lambda x, y, z: 2.0 + 0 * x)
        errors.append(abs(totals(block, flow_of(block, u=u, v=v, w=w)).kinetic / (RHO * (0.25 + 2.0)) - 1))
    assert errors[0] < 2e-4 and np.log2(errors[0] / errors[2]) / 2 > 1.9  # one face of a cell alone: first order


def made(n=(9, 8, 7), boxes=(), seed=3, scale=1.0):
    """Random liquid around boxes."""
    block = block_of(n, hi=tuple(scale * np.ones(3)))
    random = np.random.default_rng(seed)
    shape = tuple(m + 2 * G for m in n)
    F = np.clip(random.normal(0.5, 0.6, shape), 0, 1)
    flow = flow_of(block, F, None, *(random.normal(size=shape) for _ in range(3)))
    return block, flow, openings_of(block, [np.array(b) * scale for b in boxes])[0] if boxes else NONE


BOX = [[0.21, 0.33, 0.0], [0.56, 0.71, 0.44]]


def test_one_and_two_threads_give_the_same_bits():
    block, flow, openings = made((30, 30, 30), [BOX])
    assert totals(block, flow, openings=openings) == totals(block, flow, openings=openings, threads=2)


@pytest.mark.parametrize("axis", [0, 1, 2])
def test_the_mirror_image_has_the_same_energies(axis):
    """On a uniform mesh: to round-off (measured 4e-16)."""
    block = block_of((9, 8, 7), ratio=1.0)
    _, flow, _ = made()
    openings = openings_of(block, [np.array(BOX)])[0]
    mirrored = [np.flip(a, axis).copy() for a in (flow.F, *flow.velocity, *openings)]
    for k in (1 + axis, 5 + axis):  # faces: the upper one of a cell is the lower one of its image
        mirrored[k] = np.roll(mirrored[k], -1, axis)
    here = totals(block, flow, (1.0, -2.0, 3.0), openings)
    gravity = np.array([1.0, -2.0, 3.0])
    gravity[axis] *= -1
    there = totals(block, flow_of(block, mirrored[0], None, *mirrored[1:4]), gravity, Open(*mirrored[4:]))
    assert np.allclose(here, there, rtol=2e-15)


def test_scaled_by_powers_of_two_gives_the_same_bits():
    block, flow, openings = made(boxes=[BOX])
    here = totals(block, flow, openings=openings)
    block, flow, openings = made(boxes=[BOX], scale=4.0)
    for a in flow.velocity:
        a *= 4.0
    there = totals(block, flow, 4.0 * DOWN, openings, rho=8.0 * RHO)
    assert np.array_equal(np.array(there) / [64.0, 64 * 8 * 16.0, 64 * 8 * 16.0, 1], here)


def test_solids_hold_no_liquid_and_a_solid_is_a_wall():
    """A box that fills x > 0.5 leaves what a mesh that ends there has; potential energy of level liquid."""
    half, whole = block_of((4, 5, 6), hi=(0.5, 1, 1), ratio=1.0), block_of((8, 5, 6), ratio=1.0)
    random = np.random.default_rng(5)
    shape = tuple(n + 2 * G for n in whole.shape)
    F, u, v, w = (random.random(shape) for _ in range(4))
    cut = (slice(0, 4 + 2 * G),)
    part = [a[cut].copy() for a in (F, u, v, w)]
    part[1][5] = 0.0  # the side
    part[0][6:] = part[0][5]  # ghosts of F: mirrored
    openings = openings_of(whole, [np.array([[0.5, -1, -1], [2, 2, 2]])])[0]
    here = totals(half, flow_of(half, part[0], None, *part[1:]))
    there = totals(whole, flow_of(whole, F, None, u, v, w), openings=openings)
    assert np.allclose(here[:2], there[:2], rtol=1e-14) and here.wet == there.wet
    level = below(whole, 0.63)
    here = totals(half, flow_of(half, level[cut].copy()))
    assert here.potential == pytest.approx(totals(whole, flow_of(whole, level), openings=openings).potential, rel=1e-14)


def test_absent_parts():
    """One cell in y, no surface, no solids: all of the domain is liquid."""
    block = block_of((4, 1, 5), hi=(2, 1, 3))
    found = totals(block, flow_of(block))
    assert found.volume == pytest.approx(6.0) and found.kinetic == 0.0 and found.wet == 20
    assert found.potential == pytest.approx(RHO * GRAVITY * 6.0 * 1.5)


@pytest.mark.parametrize(
    ("volume", "start", "passed", "error"),
    [
        (1.0, 1.0, [0] * 6, 0.0),
        (1.5, 1.0, [1, -0.5, 0, 0, 0, 0], 0.0),
        (1.53, 1.0, [1, -0.5, 0, 0, 0, 0], 0.02),
        (0.0, 0.0, [0] * 6, 0.0),
        (0.0, 1.0, [0, -1.0, 0, 0, 0, 0], 0.0),
    ],
)
def test_volume_error(volume, start, passed, error):
    assert volume_error(volume, start, np.array(passed, dtype=float)) == pytest.approx(error, abs=1e-15)


@pytest.mark.parametrize("dust", [1e-20, 1e-155, 1e-162, 5e-324])
def test_dust_beside_a_cell_tells_no_direction(dust):
    """The square of its change is below the smallest number: 0 / 0 made the potential energy nan."""
    block = block_of((5, 5, 5))
    F = np.zeros([n + 2 * G for n in block.shape])
    F[4, 4, 4], F[5, 4, 4] = 0.3, dust
    alone = F.copy()
    alone[5, 4, 4] = 0.0
    assert totals(block, flow_of(block, F)).potential == pytest.approx(totals(block, flow_of(block, alone)).potential)
