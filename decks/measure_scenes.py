"""What the report's scenes with many bodies in a stream measure (stones, logs), for measure.py, READMEs and tests.

Overlaps are found anew here, not by the program's own contact search: points of one surface inside another body. A
ball is its centre with a radius, a box has points on its edges, a log on its rims and along its sides.
"""

from __future__ import annotations

from collections.abc import Iterable
from itertools import product
from pathlib import Path

import f90nml
import h5py
import numpy as np

Array = np.ndarray
FAR = 1e3  # m: for limits that a deck leaves open
ON_EDGE = np.linspace(-1.0, 1.0, 7)  # of a box: every sixth of an edge
SIDES = ("yl", "yh", "zl")  # where streams go along x under the open air
AROUND = 24  # points on a log's rim, .13 m apart


def turn(degrees: Array) -> Array:
    """Rz Ry Rx of rotx, roty, rotz."""
    out = np.eye(3)
    for axis, angle in enumerate(np.radians(degrees)):
        e, f, R = (axis + 1) % 3, (axis + 2) % 3, np.eye(3)
        R[e, e] = R[f, f] = np.cos(angle)
        R[f, e], R[e, f] = np.sin(angle), -np.sin(angle)
        out = R @ out
    return out


def rotations(q: Array) -> Array:
    """(n, 3, 3) of quaternions (n, 4), w x y z."""
    w, x, y, z = q.T
    return np.array([
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]).transpose(2, 0, 1)  # fmt: skip


class Solid:
    """A ball (radius), a log along its own z (radius, half its length) or a box (half its sides), about the middle."""

    def __init__(self, kind: str, sizes: Array, R0: Array) -> None:
        self.kind, self.sizes, self.R0 = kind, np.atleast_1d(sizes), R0
        self.radius = float(sizes[0]) if kind == "ball" else 0.0
        if kind == "ball":
            self.points = np.zeros((1, 3))
        elif kind == "log":
            angle = 2.0 * np.pi * np.arange(AROUND) / AROUND
            ring = sizes[0] * np.column_stack([np.cos(angle), np.sin(angle)])
            self.points = np.array([(*p, z * sizes[1]) for z in ON_EDGE for p in ring])
        else:
            edges = {
                tuple(np.roll((s, a, b), axis))
                for axis in range(3)
                for s in ON_EDGE
                for a, b in product((-1, 1), repeat=2)
            }
            self.points = np.array(sorted(edges)) * sizes
        self.points = self.points @ R0.T

    def distance(self, x: Array) -> Array:
        """(...,) from the surface of places x (..., 3) in body axes as they were at t = 0; negative inside."""
        x = x @ self.R0
        if self.kind == "ball":
            return np.linalg.norm(x, axis=-1) - self.sizes[0]
        if self.kind == "log":
            beyond = np.stack([np.hypot(x[..., 0], x[..., 1]) - self.sizes[0], np.abs(x[..., 2]) - self.sizes[1]], -1)
        else:
            beyond = np.abs(x) - self.sizes
        return np.linalg.norm(np.maximum(beyond, 0.0), axis=-1) + np.minimum(beyond.max(axis=-1), 0.0)


class Solids:
    """What a deck has of them: bodies {name: Solid} that move, blocks [(low, high)] that do not, the domain."""

    def __init__(self, deck: f90nml.Namelist, moving: list[str]) -> None:
        obs, self.low, self.high = deck["obs"], *_domain(deck["mesh"])
        ids = obs["obsid"] if isinstance(obs["obsid"], list) else [obs["obsid"]]
        self.bodies, self.blocks = {}, []
        for n, component in enumerate(obs["iob"] if isinstance(obs["iob"], list) else [obs["iob"]]):
            limits = [[_entry(obs, f"{a}{end}", n, sign * FAR) for a in "xyz"] for end, sign in (("l", -1), ("h", 1))]
            low, high = np.array(limits)
            name = ids[int(component) - 1]
            if name not in moving:
                self.blocks.append((low, high))
                continue
            R0 = turn(np.array([_entry(obs, f"rot{a}", n, 0.0) for a in "xyz"]))
            ball, log = _entry(obs, "rsh", n, FAR), _entry(obs, "rah", n, FAR)
            kind, sizes = ("ball", np.array([ball])) if ball < FAR else ("box", 0.5 * (high - low))
            self.bodies[name] = Solid("log", np.array([log, sizes[2]]), R0) if log < FAR else Solid(kind, sizes, R0)

    def deepest(
        self,
        poses: dict[str, tuple[Array, Array]],
        sides: Iterable[str] = SIDES,
        through: Iterable[str] = (),
    ) -> float:
        """Largest depth [length] of a body in another one, in a solid, or beyond one of those sides of the domain,
        where bodies `through` may go. poses {name: (places (n, 3), quaternions (n, 4))}. Below 0: the least distance,
        as far as points tell."""
        poses = {name: (p, rotations(q)) for name, (p, q) in poses.items()}
        worst = -np.inf
        for name, solid in self.bodies.items():
            p, R = poses[name]
            x = p[:, None] + np.einsum("nij,kj->nki", R, solid.points)
            for side in sides if name not in through else ():
                axis = "xyz".index(side[0])
                beyond = self.low[axis] - x[..., axis] if side[1] == "l" else x[..., axis] - self.high[axis]
                worst = max(worst, float(beyond.max()) + solid.radius)
            for low, high in self.blocks:
                block = Solid("box", 0.5 * (high - low), np.eye(3))
                worst = max(worst, solid.radius - float(block.distance(x - 0.5 * (low + high)).min()))
            for other, (p1, R1) in poses.items():
                if other != name:
                    there = np.einsum("nji,nkj->nki", R1, x - p1[:, None])
                    worst = max(worst, solid.radius - float(self.bodies[other].distance(there).min()))
        return worst


class Scene:
    """Of a run: time (n,), what was recorded of each body {name: {quantity: (n, ...)}}, impacts, Solids."""

    def __init__(self, results: Path) -> None:
        with h5py.File(results / "history.h5") as file:
            self.time, self.volume_error = file["time"][:], file["fluid/volume_error"][:]
            self.states = {name: {key: table[:] for key, table in one.items()} for name, one in file["bodies"].items()}
            hits = file["collisions"]
            self.hits = {key: hits[key][:] for key in ("time", "a", "b")}
        self.solids = Solids(f90nml.read(results / "deck.resolved.nml"), list(self.states))

    def deepest(self, rows: slice = slice(None)) -> float:
        """As Solids.deepest, in these rows; 0 where nothing overlaps."""
        poses = {name: (one["position"][rows], one["orientation"][rows]) for name, one in self.states.items()}
        return max(self.solids.deepest(poses), 0.0)


def _domain(mesh: f90nml.Namelist) -> tuple[Array, Array]:
    ends = [(mesh[f"p{a}"][0], mesh[f"p{a}"][-1]) for a in "xyz"]
    return np.array([e[0] for e in ends]), np.array([e[1] for e in ends])


def _entry(obs: f90nml.Namelist, name: str, n: int, default: float) -> float:
    """Value of subcomponent n (from 0), as far as the deck gives one."""
    if name not in obs:
        return default
    values = obs[name] if isinstance(obs[name], list) else [obs[name]]
    n -= obs.start_index.get(name, [1])[0] - 1
    found = values[n] if 0 <= n < len(values) else None
    return default if found is None or abs(found) >= FAR else float(found)


def stones(results: Path, deck: str) -> dict[str, float]:
    """The stones: at rest until the water comes, how far they are at the end, and what must hold all the time."""
    scene = Scene(results)
    dry = scene.time <= 0.15  # s: the water, .45 m on, has no stone yet
    x = np.array([one["position"][-1, 0] for one in scene.states.values()])
    way = [np.linalg.norm(one["position"] - one["position"][0], axis=1) for one in scene.states.values()]
    return {
        "way before the water comes": max(w[dry].max() for w in way),
        "beyond the first step": (x > 4.2).sum(),  # m: its edge
        "beyond the second step": (x > 6.6).sum(),
        "largest speed": max(np.linalg.norm(one["velocity"], axis=1).max() for one in scene.states.values()),
        "deepest overlap": scene.deepest(),
        "volume error": np.abs(scene.volume_error).max(),
    }


def logs(results: Path, deck: str) -> dict[str, float]:
    """The logs: how many have passed the gate, and what must hold all the time."""
    scene = Scene(results)
    x = np.array([one["position"][-1, 0] for one in scene.states.values()])
    return {
        "through the gate": (x > 15.75).sum(),  # m: the wall's far side
        "largest speed": max(np.linalg.norm(one["velocity"], axis=1).max() for one in scene.states.values()),
        "deepest overlap": scene.deepest(),
        "volume error": np.abs(scene.volume_error).max(),
    }
