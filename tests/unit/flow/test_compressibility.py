"""Liquid that gives way (rcsql): beta dp/dt + div u = 0 with beta = 1 / (rho c2)."""

import numpy as np
import pytest
from flowgmo_pressure import RHO, block_of, projector
from flowgmo_wet import wet
from flowgmo_wet_runs import CLOSED, REAL, advance, start

from flowgmo.flow.fields import G, zeros

BETA = 1e-6
INTO = CLOSED.replace("(1)=2", "(1)=6") + "ubct(1,1)=.5, flhtbct(1,1)=2.,"
MESH = "px=0., 1., nxcelt=12, py=0., .3, nycelt=6, pz=0., .5, nzcelt=8,"


@pytest.mark.parametrize("itb", [0, 1])
def test_a_full_box_that_something_presses_into(itb):
    """The mean pressure is (volume that came in) / (beta volume), and F holds what came in: F - 1 = beta p.

    Measured: 4e-6 of it. Without gravity: liquid in tension opens. Without compressibility the run ends with an
    error.
    """
    xput = f"twfin=1., delt=.0005, itb={itb},"
    text = wet(xput, fl="flht=.5," if itb else "", mesh=MESH, bcdata=INTO, props=f"rhof=1000., rcsql={BETA},")
    liquid, flow, first = start(text)
    advance(liquid, flow, first, end=0.02)
    cells = np.einsum("i,j,k->ijk", *liquid.grid[:3])[REAL]
    mean = (flow.p[REAL] * cells).sum() / cells.sum()
    expected = 0.5 * 0.02 / 1.0 / BETA
    assert abs(mean / expected - 1.0) <= 2e-5
    if itb:
        held = (flow.F[REAL] * cells).sum() / cells.sum()
        assert abs(held - 1.0 - BETA * expected) <= 1e-10


def test_a_standing_wave_of_sound():
    """One implicit step of the first mode of a closed tube, u = sin(pi x / L): u falls to u / (1 + (omega dt)2), omega
    of the mesh, p / rho = -(c2 / omega) ... = dt c2 k u: closed form of the discrete equations, to the solution's
    tolerance."""
    n, dt = 16, 0.01
    block = block_of((n, 1, 1), graded=False)
    P = projector(block, gravity=(0.0, 0.0, 0.0))
    P.beta = BETA
    faces = np.arange(-1, n + 3) / n  # of upper faces with ghosts
    velocity = [zeros(block), None, None]
    velocity[0][:, :, :] = 1e-3 * np.sin(np.pi * faces)[:, None, None]
    P.sides.fill_velocity(velocity)
    before = velocity[0].copy()
    P.set_surface(None)
    p = zeros(block)
    assert P.project(velocity, p, None, dt, 1e-13, 60).converged
    omega = 2.0 * n * np.sin(0.5 * np.pi / n) / np.sqrt(RHO * BETA)
    left = 1.0 / (1.0 + (omega * dt) ** 2)
    line = (slice(G, -G - 1), G, G)
    assert 0.1 < left < 0.95
    assert np.abs(velocity[0][line] - left * before[line]).max() <= 1e-9 * np.abs(before).max()
    assert np.abs(np.diff(velocity[0][G - 1 : -G, G, G]) * n + BETA * p[G:-G, G, G] / dt).max() <= 1e-9 * 1e-3 * n


def test_what_does_not_give_way_is_the_limit():
    """beta -> 0: pressures in an open box differ by beta's share. 1e-16 of water's 4.5e-10 x 1e-6."""
    found = []
    for beta in ("0.", "1e-16"):
        text = wet("twfin=1., delt=.002, gz=-10., itb=1,", fl="nfls=1, fxh(1)=.4, fzh(1)=.4,", mesh=MESH,
                   bcdata=CLOSED, props=f"rhof=1000., rcsql={beta},")  # fmt: skip
        liquid, flow, first = start(text)
        advance(liquid, flow, first, most=10)
        found.append(flow.p.copy())
    assert np.abs(found[0] - found[1]).max() <= 1e-5 * np.abs(found[0]).max()
