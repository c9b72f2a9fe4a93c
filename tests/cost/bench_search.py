"""Contacts found on the surfaces or on the mesh: python tests/cost/bench_search.py. No test; machines differ.

A box 0.4 x 0.3 x 0.2 m with a spin, e 0.5, mu 0.3: dropped on the floor of the domain, and thrown at a free box. The
surfaces find the impact when a corner touches; the mesh sees it when a node lies in both bodies, at the next look.
"""

import time

from tables import row, title

from flowgmo_scenes import Scene, at, deck, number, start  # isort: skip (tables adds its folder)

G, DT, END = 9.81, 1e-3, 0.6
HALF = (0.2, 0.15, 0.1)
MASS = 8.0 * HALF[0] * HALF[1] * HALF[2] * 1000.0
SPIN = (1.0, 2.0, 0.5)
SEARCHES = {"surface": (1, "")} | {
    f"grid, {n}³ cells" + (", constraint" if resting == "constraint" else ""): (n, f"search='grid' resting='{resting}'")
    for n, resting in ((20, "micro"), (40, "micro"), (80, "micro"), (40, "constraint"))
}


def box(x, v=(0, 0, 0), w=(0, 0, 0)):
    limits = " ".join(f"{a}l(#)={number(-h)}, {a}h(#)={number(h)}," for a, h in zip("xyz", HALF, strict=True))
    return f"imo(#)=4, rhomvb(#)=1000.0, iob(#)=#, {limits} {at(x)} {start(v, w)}"


def on_floor(cells, knobs):
    """The domain is 2 m wide. Returns the deck, the gravity and the vertical velocity at the start."""
    sides = (3, 3, 3, 3, 2, 3)
    here = {"lo": (-1, -1, 0), "hi": (1, 1, 2), "sides": sides, "g": (0, 0, -G), "e": 0.5, "mu": 0.3}
    return deck(box((0, 0, 0.6), w=SPIN), cells=cells, knobs=knobs, **here), G, 0.0


def on_box(cells, knobs):
    here = {"lo": (-1, -1, -1), "hi": (1, 1, 1), "e": 0.5, "mu": 0.3}
    thrown = box((0.05, 0.03, 0.5), v=(0, 0, -2.0), w=SPIN)
    return deck(thrown, box((0, 0, 0)), cells=cells, knobs=knobs, **here), 0.0, -2.0


def measure(scene, search):
    """Time of the first impact, the box's vertical velocity after it, ms a step before it and over the whole run."""
    text, g, v0 = scene(*search)
    warm = Scene(text)
    warm.to(END, DT)  # compiles, or loads
    s = Scene(text)
    began = time.perf_counter()
    while not len(s.impacts) and s.state.t < END:
        s.to(s.state.t + DT)
    flying = 1e3 * (time.perf_counter() - began) / (s.state.t / DT)
    s.to(END, DT)
    whole = 1e3 * (time.perf_counter() - began) / (END / DT)
    first = s.impacts[0]
    t, jump = float(first["time"]), float(first["impulse"][2]) / MASS
    return t, v0 - g * t + (jump if first["a"] == 1 else -jump), flying, whole, len(s.impacts)


if __name__ == "__main__":
    for name, scene in (("the floor", on_floor), ("a free box", on_box)):
        title(f"search: a box on {name}, dt = {DT} s, {END} s in all")
        row("", "t first [s]", "error [s]", "v [m/s]", "error", "ms flying", "ms a step", "impacts", width=28)
        exact = None
        for label, search in SEARCHES.items():
            t, v, flying, whole, count = measure(scene, search)
            exact = exact or (t, v)
            cells = (
                f"{t:.6f}",
                f"{t - exact[0]:.1e}",
                f"{v:.4f}",
                f"{v - exact[1]:.1e}",
                f"{flying:.3f}",
                f"{whole:.3f}",
            )
            row(label, *cells, count, width=28)
    print("errors against 'surface'; v: vertical velocity of the box's centre after its first impact")
