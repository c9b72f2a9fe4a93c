"""Taylor-Green vortices that a stream carries along: what the whole step of the liquid is worth, in space and time.

    python decks/taylor_green/taylor_green.py

    u = U - cos(x - U t) sin(z - W t) e^(-2 nu t)
    w = W + sin(x - U t) cos(z - W t) e^(-2 nu t)            p from it

solves the equations of Navier and Stokes in a periodic box of 2 pi (Taylor & Green 1937). No deck can give such a
velocity to start from: the box is built from a deck's text, the velocity set, and the stages of a step called in turn.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flowgmo.building import build_model
from flowgmo.deck import parse_deck
from flowgmo.flow import stages
from flowgmo.flow.build import build_liquid, initial_flow

NU, STREAM, END = 0.05, (0.7, -0.4), 1.0
BOX = """Periodic box
 &xput itb=0, ifvisc=1, impvis={implicit}, delt=1.0, epsadj=0.001, /
 &limits /
 &props rhof=1.0, mu1=0.05, /
 &bcdata ibct=4,4,1,1,4,4, /
 &mesh px=0.0,6.283185307179586, py=0.0,1.0, pz=0.0,6.283185307179586, nxcelt={n}, nycelt=1, nzcelt={n}, /
 &obs /
 &fl /
"""
REAL = (slice(2, -2), 2, slice(2, -2))


def exact(n: int, t: float) -> tuple[np.ndarray, np.ndarray]:
    """u and w (n, n) on upper faces of the cells at time t."""
    h = 2.0 * np.pi / n
    face, centre = (np.arange(n) + 1.0) * h, (np.arange(n) + 0.5) * h
    decay = np.exp(-2.0 * NU * t)
    (a, b), (x, z) = STREAM, np.ix_(face, centre)
    u = a - np.cos(x - a * t) * np.sin(z - b * t) * decay
    x, z = np.ix_(centre, face)
    return u, b + np.sin(x - a * t) * np.cos(z - b * t) * decay


def run(n: int, finer: int = 1, implicit: bool = False) -> tuple[np.ndarray, np.ndarray]:
    """u and w (n, n) at END on n x n cells; Courant sum 1/4 / finer."""
    model = build_model(parse_deck(BOX.format(n=n, implicit=3 * implicit), Path("box.nml")))
    liquid = build_liquid(model, 1)
    flow = initial_flow(liquid, model)
    flow.u[REAL], flow.w[REAL] = exact(n, 0.0)
    liquid.sides.fill_velocity(flow.velocity)
    steps = finer * int(np.ceil(END * 4.0 * (sum(map(abs, STREAM)) + 2.0) * n / (2.0 * np.pi)))
    dt = END / steps
    stages.predict(liquid, flow, 0.0, dt)  # for the pressure at the start; the velocity is not taken over
    stages.project(liquid, flow, dt)
    flow.p[...] = liquid.p
    for k in range(steps):
        stages.predict(liquid, flow, (k + 1) * dt, dt)
        stages.project(liquid, flow, dt)
        liquid.store(flow, dt)
    return flow.u[REAL].copy(), flow.w[REAL].copy()


def mean_error(n: int, implicit: bool = False) -> float:
    """Mean of |u - exact| and |w - exact|; the vortices' velocity is 1 at the start."""
    found, there = run(n, implicit=implicit), exact(n, END)
    return 0.5 * sum(float(np.abs(a - b).mean()) for a, b in zip(found, there, strict=True))


def decay_rate(n: int) -> float:
    """- d ln(amplitude) / dt / nu, exactly 2: from the part of u and w that is like the solution."""
    found, there, mean = run(n), exact(n, END), STREAM
    shape = [(b - m) * np.exp(2.0 * NU * END) for b, m in zip(there, mean, strict=True)]
    part = sum(float(((a - m) * s).sum()) for a, m, s in zip(found, mean, shape, strict=True))
    return -np.log(part / sum(float((s * s).sum()) for s in shape)) / (NU * END)


def order_in_time(n: int = 32, implicit: bool = False) -> float:
    """From three runs on one mesh, each with steps half as long as the one before."""
    results = [run(n, finer, implicit)[0] for finer in (1, 2, 4)]
    coarse, fine = (np.abs(b - a).mean() for a, b in zip(results[:-1], results[1:], strict=True))
    return float(np.log2(coarse / fine))


def main() -> None:
    """Print errors, orders, decay."""
    before = None
    for n in (16, 32, 64, 128):
        error = mean_error(n)
        order = "" if before is None else f"   order {np.log2(before / error):.2f}"
        print(f"{n:4} cells   mean error {error:.2e}{order}   decay rate over nu {decay_rate(n):.5f}")
        before = error
    print(f"order in time, explicit viscosity {order_in_time():.2f}, implicit {order_in_time(implicit=True):.2f}")


if __name__ == "__main__":
    main()
