"""How large the liquid's force on each moving body was over a run: usually, in all but 1 % of the time, at most.

Each step has one force, the mean over it (body_loads.py), and counts by its length: a blow cuts steps short, and how
often it does must not change what is usual. Time in which the liquid does not touch a body does not count.

    weight of step = dt        bins of |F| in steps of 2 %, so that a quantile is known to 1 %
"""

from __future__ import annotations

import numpy as np

BIN = np.log(1.02)  # of |F|, natural logarithm: to 1 %, what one digit more of a table would need


class Spikes:
    """Of one run, without what it continues. shares [{bin: time}], largest, when (k,) of k bodies."""

    def __init__(self, count: int) -> None:
        self.shares: list[dict[int, float]] = [{} for _ in range(count)]
        self.largest, self.when = np.zeros(count), np.zeros(count)

    def note(self, forces: np.ndarray, t: float, dt: float) -> None:
        """One step that was made, of length dt until t: forces (k, 3) of the liquid in it."""
        sizes = np.linalg.norm(forces, axis=1)
        more = sizes > self.largest
        self.largest[more], self.when[more] = sizes[more], t
        wet = np.flatnonzero((sizes > 0.0) & np.isfinite(sizes))
        bins = np.floor(np.log(sizes[wet]) / BIN).astype(np.int64)
        for k, n in zip(wet.tolist(), bins.tolist(), strict=True):
            self.shares[k][n] = self.shares[k].get(n, 0.0) + dt

    def below(self, k: int, share: float) -> float:
        """|F| of body k that is exceeded in no more than 1 - share of the time; it has been touched."""
        bins = np.array(sorted(self.shares[k]))
        time = np.cumsum([self.shares[k][n] for n in bins.tolist()])
        at = int(np.searchsorted(time, share * time[-1]))
        return min(float(np.exp((bins[min(at, len(bins) - 1)] + 0.5) * BIN)), float(self.largest[k]))

    def summary(self, names: list[str]) -> dict[str, dict[str, float]]:
        """For run.json and the final table, by the bodies' names; those that the liquid never touched are left out."""
        return {
            name: {
                "median": self.below(k, 0.5),
                "quantile_99": self.below(k, 0.99),
                "largest": float(self.largest[k]),
                "time": float(self.when[k]),
            }
            for k, name in enumerate(names)
            if self.shares[k]
        }
