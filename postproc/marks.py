"""The impacts on a time axis: a mark for each while marks can be told apart, else how many there are in each span."""

from __future__ import annotations

import numpy as np
from matplotlib import pyplot as plt

from postproc.impacts import Hits
from postproc.palette import FAINT, INK

MANY = 60  # hits; from here on marks run into each other
SPANS = 100  # of the time axis, each about as wide as a mark
HIGHEST = 0.18  # of the axes, the bar of the fullest span


def mark_impacts(axes: plt.Axes, hits: Hits, t0: float, t1: float, unit: str) -> None:
    """Draw the hits on the lower edge of axes whose time runs from t0 to t1; the legend says what is drawn."""
    across = axes.get_xaxis_transform()
    if len(hits) < MANY:
        look = {"ls": "", "marker": "^", "ms": 5, "alpha": 0.6, "color": INK, "zorder": 9, "clip_on": False}
        axes.plot(hits.time, np.zeros(len(hits)), transform=across, label="impact", **look)
        return
    counts, edges = counts_of(hits, t0, t1)
    most, width = counts.max(), edges[1] - edges[0]
    span = f"{width:.2g} {unit}".rstrip()
    axes.bar(
        edges[:-1],
        HIGHEST * counts / most,
        width,
        align="edge",
        transform=across,
        color=FAINT,
        zorder=1,
        label=f"impacts, up to {most} in {span}",
    )


def counts_of(hits: Hits, t0: float, t1: float) -> tuple[np.ndarray, np.ndarray]:
    """How many hits (n,) are in spans between edges (n + 1,); spans of 1, 2 or 5 times a power of ten."""
    wished = (t1 - t0) / SPANS
    power = 10.0 ** np.floor(np.log10(wished))
    width = power * next(k for k in (1, 2, 5, 10) if k * power >= wished * (1 - 1e-9))  # 1e-9: rounding of a power
    n = max(1, int(np.ceil((t1 - t0) / width * (1 - 1e-12))))  # 1e-12: no span for the rounding of t1
    edges = t0 + width * np.arange(n + 1)
    edges[-1] = max(edges[-1], t1)
    return np.histogram(hits.time, edges)[0], edges
