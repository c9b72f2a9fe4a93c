"""How far and fast moving bodies go in a step: no point of them crosses more than TRAVEL of a cell of the domain."""

from __future__ import annotations

import numpy as np

from flowgmo.errors import StepTooLong
from flowgmo.model import Model
from flowgmo.wet_shapes import reach_of

TRAVEL = 0.5  # of a cell: no point of a body crosses more in a step (DESIGN 3)


class Ways:
    """movers (m,): the bodies that move; reach (m,) [length] of the farthest point of each from B, inf without an end;
    cell [length]: the least width of the mesh, directions of one cell apart."""

    def __init__(self, model: Model, arrays: np.ndarray, movers: np.ndarray) -> None:
        block = model.mesh.blocks[0]
        widths = [float(np.diff(x).min()) for x, n in zip(block.planes, block.shape, strict=True) if n > 1]
        self.movers, self.cell, self.bounds = movers, min(widths), model.mesh.bounds
        self.reach = np.array([reach_of(model.bodies[b].shape, arrays[b]["origin"]) for b in movers])

    def longest_step(self, v: np.ndarray, w: np.ndarray, p: np.ndarray) -> float:
        """[time] in which no point of a moving body crosses more than TRAVEL cells of the domain. v, w, p (n, 3) of all
        bodies, p of B."""
        ways, speeds = TRAVEL * self.cell + self.apart(p), self.speeds(v, w)
        return float(np.min(ways[speeds > 0.0] / speeds[speeds > 0.0], initial=np.inf))

    def apart(self, p: np.ndarray) -> np.ndarray:
        """(m,) [length]: how far each body is from the domain at least, 0 inside. p (n, 3) of B of all bodies."""
        low, high = self.bounds
        off = np.maximum(np.maximum(low - p[self.movers], p[self.movers] - high), 0.0)
        return np.maximum(np.linalg.norm(off, axis=1) - self.reach, 0.0)

    def speeds(self, v: np.ndarray, w: np.ndarray) -> np.ndarray:
        """(m,) [length/time] that no point of a moving body exceeds. v, w (n, 3) of all bodies."""
        reach = np.where(np.isfinite(self.reach), self.reach, 0.0)
        return np.linalg.norm(v[self.movers], axis=1) + reach * np.linalg.norm(w[self.movers], axis=1)

    def check(self, now: np.ndarray, then: np.ndarray, dt: float) -> float:
        """Largest speed (float) of motion `then` (n,) POSE, dt after `now`. Raises StepTooLong where a body crosses
        twice as much as it may."""
        m, speeds = self.movers, self.speeds(then["v"], then["w"])
        ways = np.linalg.norm(then["p"][m] - now["p"][m], axis=1)  # a jump within the step may be over at its end
        way = float((np.maximum(ways, speeds * dt) - self.apart(now["p"])).max(initial=0.0))
        if way > 2.0 * TRAVEL * self.cell:
            raise StepTooLong(f"a body crosses {way / self.cell:.3g} of a cell in a step")
        return float(speeds.max(initial=0.0))
