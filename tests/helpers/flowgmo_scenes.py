"""Small dry decks as text, and a scene that is stepped without a results folder.

A body's text is written with '#' for its number; `deck` puts the numbers in. Tests import this module through the
conftest.py of their folder.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from flowgmo.building import build_model
from flowgmo.deck import parse_deck
from flowgmo.rows import rows_of_state
from flowgmo.state import initial_state
from flowgmo.step import prepare, step

NONE = np.zeros(0)
OPEN, MIRRORS, WALLS = (3,) * 6, (1,) * 6, (2,) * 6


def number(x):
    """A float as a deck text that reads back to the same bits."""
    return repr(float(x))


def three(names, x):
    """'a=1.0, b=2.0, c=3.0,' of three names and values; zeros are left out."""
    return " ".join(f"{name}={number(value)}," for name, value in zip(names, x, strict=True) if value != 0.0)


def start(v=(0, 0, 0), w=(0, 0, 0)):
    """First table elements: initial velocities of a coupled body, constant ones of a prescribed body."""
    return three((f"{n}tobs(1,#)" for n in ("u", "v", "w")), v) + three((f"om{n}tobs(1,#)" for n in ("x", "y", "z")), w)


def at(x):
    """Translation of the subcomponent."""
    return three(("trnx(#)", "trny(#)", "trnz(#)"), x)


def ball(x, r=0.1, v=(0, 0, 0), w=(0, 0, 0), rho=1000.0, mass=None, e=None, mu=None, more=""):
    """A coupled solid sphere; `mass` in place of the density."""
    rho = rho if mass is None else mass / (4.0 / 3.0 * np.pi * r**3)
    text = f"imo(#)=4, rhomvb(#)={number(rho)}, iob(#)=#, rsh(#)={number(r)}, {at(x)} {start(v, w)}"
    text += f" crstrng(#)={number(e)}," if e is not None else ""
    text += f" cfrc(#)={number(mu)}," if mu is not None else ""
    return f"{text} {more}"


def driven(x, r=0.1, v=(0, 0, 0), w=(0, 0, 0), more=""):
    """A prescribed sphere without mass."""
    return f"imo(#)=3, iob(#)=#, rsh(#)={number(r)}, {at(x)} {start(v, w)} {more}"


def solid(lo, hi, more=""):
    """A stationary box; None leaves a side at infinity."""
    limits = [(f"{axis}{end}(#)", value) for end, values in (("l", lo), ("h", hi))
              for axis, value in zip("xyz", values, strict=True)]  # fmt: skip
    return "imo(#)=0, iob(#)=#, " + " ".join(f"{n}={number(v)}," for n, v in limits if v is not None) + more


def rigid(inertia, mass=1.0, centre=(0, 0, 0), v=(0, 0, 0), w=(0, 0, 0), kind=4, more="", r=0.1):
    """A body with given mass data (a sphere to look at); inertia (3, 3)."""
    inertia = np.add(inertia, np.transpose(inertia)) / 2  # the same to the last bit on both sides
    tensor = " ".join(
        f"tjmvb(#,{i + 1},{j + 1})={number(inertia[i][j])}," for i in range(3) for j in range(3) if inertia[i][j] != 0.0
    )
    place = " ".join(f"{a}mcmvb0(#)={number(c)}," for a, c in zip("xyz", centre, strict=True))
    return (
        f"imo(#)={kind}, iprpmvb(#)=1, massmvb(#)={number(mass)}, {place} {tensor} iob(#)=#, rsh(#)={number(r)}, "
        f"{at(centre)} {start(v, w)} {more}"
    )


def on_axis(moment, axis, mass=1.0, centre=(0, 0, 0), point=(0, 0, 0), rate=0.0, more="", kind=4, r=0.1):
    """A body on a fixed axis of any direction, with its moment about it."""
    place = " ".join(f"{a}mcmvb0(#)={number(c)}," for a, c in zip("xyz", centre, strict=True))
    return (
        f"imo(#)={kind}, imoaxs(#)=1, iprpmvb(#)=1, massmvb(#)={number(mass)}, tjaxs(#)={number(moment)}, {place}"
        f"{three(('xaxs0(#)', 'yaxs0(#)', 'zaxs0(#)'), point)} iob(#)=#, rsh(#)={number(r)}, {at(centre)}"
        f"omxtobs(1,#)={number(rate)}, {more}",
        three(("axisx(#)", "axisy(#)", "axisz(#)"), axis),
    )


def table(name, y, index="#"):
    """A time table of component '#': values y at the deck's TOBS times."""
    return " ".join(f"{name}({k + 1},{index})={number(v)}," for k, v in enumerate(y))


def deck(*bodies, lo=(-10, -10, -10), hi=(10, 10, 10), sides=OPEN, g=(0, 0, 0), end=1.0, dt=0.01, e=1.0, mu=0.0,
         collide=True, times=None, xput="", knobs="", cells=1):  # fmt: skip
    """The text of a deck. Bodies are texts, or pairs (text for &obs, text for &flowgmo)."""
    obs = [b if isinstance(b, str) else b[0] for b in bodies]
    own = [b[1] for b in bodies if not isinstance(b, str)] and [
        ("" if isinstance(b, str) else b[1]).replace("#", str(k + 1)) for k, b in enumerate(bodies)
    ]
    planes = " ".join(
        f"p{a}={number(x)}, {number(y)}, n{a}celt={cells}," for a, x, y in zip("xyz", lo, hi, strict=True)
    )
    return "\n".join(
        [
            "a scene",
            f"&xput\n twfin={number(end)}, delt={number(dt)}, imobs=1, iclid={int(collide)},",
            f" strngmob={number(e)}, frcmob={number(mu)}, {three(('gx', 'gy', 'gz'), g)} {xput}\n/",
            f"&bcdata\n {' '.join(f'ibct({k + 1})={kind},' for k, kind in enumerate(sides))}\n/",
            f"&mesh\n {planes}\n/",
            f"&obs\n nobs={len(bodies)},",
            "" if times is None else " " + " ".join(f"tobs({k + 1})={number(t)}," for k, t in enumerate(times)),
            *(" " + wrap(text.replace("#", str(k + 1))) for k, text in enumerate(obs)),
            "/",
            f"&flowgmo\n {' '.join(own)} {knobs}\n/",
        ]
    )


def wrap(text):
    """One assignment a line: no line is longer than a reader may take."""
    return text.replace(", ", ",\n ")


class Scene:
    """A deck's model, world and state, stepped to given times."""

    def __init__(self, text, name="t.nml"):
        self.model = build_model(parse_deck(text, Path(name)))
        self.world = prepare(self.model)
        self.state = initial_state(self.model)
        self.impacts = np.zeros(0)
        self.first_row = rows_of_state(self.world, self.state)
        self.rows = []

    def to(self, t, dt=None, asked=NONE):
        """Step to t in steps of dt (default: one step), and keep all impacts and rows. Returns self."""
        t0 = self.state.t
        n = 1 if dt is None else max(1, round((t - t0) / dt))
        asked = np.asarray(asked, dtype=float)
        every = [self.impacts] if len(self.impacts) else []
        for k in range(1, n + 1):
            t1 = t if k == n else t0 + (t - t0) * k / n
            mine = asked[(asked > self.state.t) & (asked <= t1)]
            report = step(self.world, self.state, t1, mine, False)
            if len(report.impacts):
                every.append(report.impacts)
            if report.rows is not None:
                self.rows.append(report.rows)
        if every:
            self.impacts = np.concatenate(every)
        return self

    def row(self, name):
        """A quantity of all rows so far, (k, ...)."""
        return np.concatenate([getattr(r, name) for r in self.rows])

    def energy(self, name):
        """A column of the energy history."""
        return np.concatenate([r.energy[name] for r in self.rows])

    @property
    def p(self):
        return self.state.p_WB

    @property
    def v(self):
        return self.state.v_WB

    @property
    def w(self):
        return self.state.w_WB

    @property
    def q(self):
        return self.state.q_WB

    @property
    def masses(self):
        return self.world.arrays["mass"]

    def kinetic(self):
        """½ m v² + ½ w·I w of all coupled bodies."""
        return float(rows_of_state(self.world, self.state).energy["kinetic"][0])

    def remainder(self):
        """What the energy books miss now."""
        return float(rows_of_state(self.world, self.state).energy["remainder"][0])


def matrix(q):
    """Rotation matrix of a quaternion w x y z."""
    w, x, y, z = q
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
            [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
            [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
        ]
    )
