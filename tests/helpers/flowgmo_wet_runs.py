"""Wet decks stepped to an end, and what is left then."""

from pathlib import Path

import numpy as np
from flowgmo_wet import wet

from flowgmo.building import build_model
from flowgmo.deck import parse_deck
from flowgmo.errors import StepTooLong
from flowgmo.flow import stages
from flowgmo.flow.build import build_liquid, initial_flow

REAL = (slice(2, -2),) * 3
CLOSED = "ibct(1)=2, ibct(2)=2, ibct(3)=2, ibct(4)=2, ibct(5)=2, ibct(6)=2,"
HALVINGS = 30  # of a step before a test gives up


def start(text, threads=1):
    """(Liquid, Flow, first step) of a deck's text."""
    model = build_model(parse_deck(text, Path("t.nml")))
    liquid = build_liquid(model, threads)
    return liquid, initial_flow(liquid, model), model.clock.dt


def advance(liquid, flow, first, end=np.inf, most=10000, each=None):
    """Steps to `end` or `most` steps; returns (time, largest F - 1, error of the books in shares of the volume)."""
    t, over, n = 0.0, 0.0, 0
    while t < end and n < most:
        dt = min(liquid.longest_step(flow, first), end - t)
        for _ in range(HALVINGS):
            try:
                stages.predict(liquid, flow, t + dt, dt)
                stages.project(liquid, flow, dt)
                if flow.F is not None:
                    stages.move_liquid(liquid, flow, dt, n)
                break
            except StepTooLong:
                dt *= 0.5
        else:
            raise AssertionError(f"no step is short enough at t = {t}")
        liquid.store(flow, dt)
        t, n = t + dt, n + 1
        if flow.F is not None:
            over = max(over, flow.F[REAL].max() - 1.0)
        if each is not None:
            each(t, flow)
    return t, over, _books(liquid, flow)


def _books(liquid, flow):
    if flow.F is None:
        return 0.0
    cells = np.einsum("i,j,k->ijk", *liquid.grid[:3])
    held = flow.F * cells if liquid.openings.V is None else flow.F * cells * liquid.openings.V
    return abs(held[REAL].sum() - flow.start_volume - flow.passed.sum()) / max(flow.start_volume, *abs(flow.passed))


def fastest(flow):
    """Largest velocity of the liquid's cells on any of their upper faces."""
    wet = True if flow.F is None else flow.F[REAL] > 1e-9
    return max(float(np.abs(u[REAL] * wet).max()) for u in flow.velocity if u is not None)


def dam(size=1.0, time=1.0, rho=1000.0, axis="x", mirrored=False, solid=True, xput=""):
    """A dam break in a box 2 x .8 x 1.6 along axis, on 20 x 8 x 16 cells, with a block in the way, or from its end."""
    other = "y" if axis == "x" else "x"
    low, high, a, b = (1.2, 2.0, 0.53, 0.8) if mirrored else (0.0, 0.8, 1.2, 1.47)
    s = size
    mesh = f"p{axis}=0., {2 * s!r}, n{axis}celt=20, p{other}=0., {0.8 * s!r}, n{other}celt=8,"
    mesh += f"pz=0., {1.6 * s!r}, nzcelt=16,"
    block = (
        f"nobs=1, iob(1)=1, {axis}l(1)={a * s!r}, {axis}h(1)={b * s!r}, {other}l(1)={0.2 * s!r}, "
        f"{other}h(1)={0.63 * s!r}, zl(1)=0., zh(1)={0.33 * s!r},"
    )
    return wet(
        f"twfin={2 * time!r}, delt={0.005 * time!r}, itb=1, gz={-10.0 * s / time**2!r}, {xput}",
        props=f"rhof={rho!r},",
        fl=f"nfls=1, f{axis}l(1)={low * s!r}, f{axis}h(1)={high * s!r}, fzh(1)={0.8 * s!r},",
        mesh=mesh, bcdata=CLOSED, **({"obs": block} if solid else {}),
    )  # fmt: skip
