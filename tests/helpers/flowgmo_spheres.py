"""Decks with spheres that the liquid moves, at random places, and how much work their steps are."""

import time

import numpy as np
from flowgmo_wet import wet
from flowgmo_wet_bodies import begin

from flowgmo.flow.immersed.immersed import Immersed
from flowgmo.pace import Pace

CLOSED = "ibct=2,2,2,2,2,2,"


def places(n, radius, low, high, gap, seed=0):
    """n centres (3,) in a box, spheres `gap` apart and from its sides."""
    rng, found = np.random.default_rng(seed), []
    for _ in range(100_000):
        x = rng.uniform(low + radius + gap, high - radius - gap)
        if all(np.linalg.norm(x - y) > 2.0 * radius + gap for y in found):
            found.append(x)
        if len(found) == n:
            return [x.tolist() for x in found]
    raise ValueError("no room for so many")


def spheres(n, ratio, *, full, cells=48, across=9, seed=0, xput="", **blocks):
    """n spheres `across` cells wide of density ratio times the liquid's in a unit cube of cells^3, let go at rest."""
    h = 1.0 / cells
    radius, top = 0.5 * across * h, 1.0 if full else 0.8
    rows = [f"nobs={n},"]
    for m, x in enumerate(places(n, radius, np.zeros(3), np.array([1.0, 1.0, top]), 1.5 * h, seed), 1):
        rows.append(
            f" obsid({m})='b{m}', imo({m})=4, iob({m})={m}, rhomvb({m})={1000.0 * ratio!r}, rsh({m})={radius!r}, "
            f"trnx({m})={x[0]!r}, trny({m})={x[1]!r}, trnz({m})={x[2]!r},"
        )
    return wet(
        f"twfin=1., delt=.002, itb={int(not full)}, ipdis=1, gz=-9.81, imobs=1, {xput}",
        props="rhof=1000.,", mesh=f"px=0.,1., py=0.,1., pz=0.,1., nxcelt={cells}, nycelt={cells}, nzcelt={cells},",
        **({"bcdata": CLOSED, "obs": "\n".join(rows), "fl": "" if full else f"flht={top - 0.5 * h!r},"} | blocks),
    )  # fmt: skip


class Counted:
    """A deck's scene; cycles: V-cycles of the last step, of all its solutions; changed: cells sorted anew in it."""

    def __init__(self, text, threads=1):
        self.world, self.state = begin(text, threads)
        self.pace = Pace(self.world.model, self.state)
        self.cycles, self.changed = 0, 0
        solver, immersed = self.world.liquid.projector.solver, self.world.liquid.immersed
        solve = solver.solve

        def counted(*arguments, **more):
            found = solve(*arguments, **more)
            self.cycles += found.iterations
            return found

        solver.solve = counted
        if isinstance(immersed, Immersed):
            renew = immersed.renew

            def noted(cells, meanwhile):
                self.changed = -1 if cells is None else len(cells)
                renew(cells, meanwhile)

            immersed.renew = noted

    def step(self):
        """One step; its CPU time [s]."""
        self.cycles = 0
        began = time.process_time()
        self.pace.advance(self.world)
        return time.process_time() - began

    def steps(self, n):
        """V-cycles of n steps."""
        found = []
        for _ in range(n):
            self.step()
            found.append(self.cycles)
        return found
