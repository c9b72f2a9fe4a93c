"""How figures look: one set of colours for curves and bodies, sober axes, readable letters."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib

matplotlib.use("Agg")

from matplotlib import pyplot as plt

from postproc.errors import PostprocError
from postproc.palette import COLOURS, FAINT, INK

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

plt.rcParams.update(
    {
        "font.family": "DejaVu Sans",
        "font.size": 11,
        "text.color": INK,
        "axes.edgecolor": INK,
        "axes.labelcolor": INK,
        "axes.linewidth": 0.8,
        "axes.grid": True,
        "axes.spines.top": False,
        "axes.spines.right": False,
        "axes.titlesize": 11,
        "axes.titleweight": "bold",
        "axes.titlelocation": "left",
        "axes.formatter.limits": (-4, 5),
        "axes.formatter.use_mathtext": True,
        "axes.prop_cycle": matplotlib.cycler(color=COLOURS),
        "grid.color": FAINT,
        "grid.linewidth": 0.6,
        "grid.alpha": 0.8,
        "lines.linewidth": 1.6,
        "lines.solid_capstyle": "round",
        "xtick.color": INK,
        "ytick.color": INK,
        "legend.frameon": False,
        "figure.dpi": 130,
        "savefig.dpi": 130,
        "savefig.facecolor": "white",
    }
)


def colour(k: int) -> str:
    """Colour of the k-th body or curve; they repeat."""
    return COLOURS[k % len(COLOURS)]


def unit_text(unit: str) -> str:
    """A unit as matplotlib text: m/s^2 -> m/s²; "1" is nothing."""
    return "" if unit in ("", "1") else unit.replace("^2", "²").replace("^3", "³")


def label(name: str, unit: str) -> str:
    """`angular_velocity`, `rad/s` -> "Angular velocity [rad/s]"."""
    words = name.replace("_", " ")
    words = words[:1].upper() + words[1:]
    unit = unit_text(unit)
    return f"{words} [{unit}]" if unit else words


def fit_time(axes: Axes, t0: float, t1: float, unit: str) -> None:
    """The time axis: from edge to edge."""
    if t1 > t0:
        axes.set_xlim(t0, t1)
    axes.set_xlabel(label("time", unit))


def save(figure: Figure, path: Path, dots: float | None = None) -> Path:
    """Write a figure (`dots` per inch) and close it."""
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        figure.savefig(path, **({} if dots is None else {"dpi": dots}))
    except (OSError, ValueError) as error:  # ValueError: a file ending that matplotlib does not know
        raise PostprocError(f"cannot write {path}: {error}") from error
    finally:
        plt.close(figure)
    return path
