"""Decks with bodies that move in liquid, and steps of them."""

import re
from pathlib import Path

from flowgmo_wet import wet
from flowgmo_wet_runs import CLOSED

from flowgmo.building import build_model
from flowgmo.deck import parse_deck
from flowgmo.flow import build
from flowgmo.pace import Pace
from flowgmo.state import initial_state
from flowgmo.step import prepare, start_liquid

BOX = (1.0, 0.75, 0.75)  # of the tank, on 16 x 12 x 12 cells


def tank(size=1.0, time=1.0, mass=1.0, mirrored=False, xput="", output="", bodies="both", full=False, **blocks):
    """A tank in which a ball is pushed along x and a box floats and is let go aslant; mirrored in x.

    size, time, mass: units, in powers of two.
    """
    s, sign, lx = size, -1.0 if mirrored else 1.0, BOX[0]

    def x(value):
        return repr((lx - value if mirrored else value) * s)

    speed, g = size / time, size / time**2
    ball = (
        f"obsid({{m}})='ball', imo({{m}})=3, iob({{m}})=1, rsh({{m}})={0.125 * s!r}, trnx({{m}})={x(0.25)}, "
        f"trny({{m}})={0.375 * s!r}, trnz({{m}})={0.3125 * s!r}, utobs(1,{{m}})={sign * 0.75 * speed!r},"
    ).replace("iob({m})=1", "iob({m})={m}")
    box = (
        f"obsid({{m}})='box', imo({{m}})=4, rhomvb({{m}})={500.0 * mass / s**3!r}, iob({{m}})={{m}}, "
        f"xl({{m}})={-0.125 * s!r}, xh({{m}})={0.125 * s!r}, yl({{m}})={-0.1 * s!r}, yh({{m}})={0.1 * s!r}, "
        f"zl({{m}})={-0.09375 * s!r}, zh({{m}})={0.09375 * s!r}, roty({{m}})={sign * 10.0!r}, "
        f"trnx({{m}})={x(0.703125)}, trny({{m}})={0.375 * s!r}, trnz({{m}})={0.5 * s!r},"
    )
    parts = {"both": (ball, box), "ball": (ball,), "box": (box,)}[bodies]
    obs = f"nobs={len(parts)},\n" + "\n".join(part.format(m=m) for m, part in enumerate(parts, start=1))
    mesh = "".join(
        f"p{a}=0., {n * s!r}, n{a}celt={c}, " for a, n, c in zip("xyz", BOX, (16, 12, 12), strict=True)
    )  # fmt: skip
    start = {"fl": ""} if full else {"fl": f"flht={0.484375 * s!r},"}
    return wet(
        f"twfin={2.0 * time!r}, delt={0.00390625 * time!r}, itb={int(not full)}, ipdis=1, imobs=1, "
        f"gz={-8.0 * g!r}, {xput}\n{output}",
        props=f"rhof={1000.0 * mass / s**3!r},", mesh=mesh, **({"bcdata": CLOSED} | start | {"obs": obs} | blocks),
    )  # fmt: skip


def model_of(text):
    return build_model(parse_deck(text, Path("t.nml")))


def begin(text, threads=1):
    """(world, state) of a deck's text at t = 0."""
    model = model_of(text)
    threads_before, build.default_threads = build.default_threads, lambda: threads
    try:
        world, state = prepare(model), initial_state(model)
    finally:
        build.default_threads = threads_before
    start_liquid(world, state)
    return world, state


def hair(text, draw):
    """The deck with gravity changed by so many 1e-8: another draw of what is chaotic."""
    g = re.search(r"gz=(-?[0-9.]+)", text)
    return text.replace(g.group(0), f"gz={float(g.group(1)) * (1.0 + draw * 1e-8)!r}")


def play(text, steps, threads=1, each=None):
    """(world, state) after so many steps, or at the end; each(world, state, report) after every one."""
    world, state = begin(text, threads)
    pace = Pace(world.model, state)
    for _ in range(steps):
        if state.t >= world.model.clock.end:
            break
        report, _ = pace.advance(world)
        if each is not None:
            each(world, state, report)
    return world, state
