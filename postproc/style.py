"""How figures look: one set of colours for curves and bodies, sober axes, readable letters."""

from __future__ import annotations

import textwrap
from pathlib import Path
from typing import TYPE_CHECKING

import matplotlib
import numpy as np

matplotlib.use("Agg")

from matplotlib import pyplot as plt
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import text_to_path

from postproc.errors import PostprocError
from postproc.palette import COLOURS, FAINT, INK

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

EDGE = 0.012  # of a figure's width, beside its title
SMALL, HANDLE = 9.5, 0.42  # of a legend above a plot: font size; width of an entry beside its text [inches]
GAP = 0.15  # inches between the title and the legend
LINES = ("-", "--", ":", "-.")
SAME, HALF = 0.005, 0.5  # curves closer than this part of the panel, at more than half of the rows, hide each other
LEVEL = 1e-6  # of its value; a smaller change is not drawn

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


def plain(text: str) -> str:
    """Text of the user's, in which a dollar is a dollar and not the start of a formula."""
    return text.replace("$", r"\$")


def short(name: str, most: int) -> str:
    """A name of at most so many letters; the beginning and the end stay, for names often differ at the end only."""
    return name if len(name) <= most else f"{name[: most // 2]}…{name[len(name) - (most - 1 - most // 2) :]}"


def text_width(text: str, size: float, bold: bool = False) -> float:
    """Width of a line of text [inches]."""
    font = FontProperties(family="DejaVu Sans", size=size, weight="bold" if bold else "normal")
    return text_to_path.get_text_width_height_descent(text, font, False)[0] / 72


def headline(figure: Figure, text: str, size: float) -> None:
    """The title of a figure, on as many lines as its width asks for, three at most."""
    room = (1 - 2 * EDGE) * figure.get_figwidth()
    letters = max(1, len(text))
    while True:
        lines = textwrap.wrap(text, letters, max_lines=3, placeholder=" …") if letters > 4 else [text[:4]]
        if letters <= 4 or max((text_width(line, size, True) for line in lines), default=0.0) <= room:
            break
        letters -= 1
    figure.suptitle(plain("\n".join(lines)), fontsize=size, fontweight="bold", x=EDGE, ha="left")


def strokes(curves: list[np.ndarray]) -> list[dict]:
    """Strokes and order for the curves of a panel: one that runs on top of another, which varies more, is broken."""
    everything = np.concatenate([*curves, np.zeros(0)])
    span = float(np.ptp(everything)) if everything.size else 0.0
    order = sorted(range(len(curves)), key=lambda k: -float(np.ptp(curves[k])) if len(curves[k]) else 0.0)
    looks: list[dict] = [{}] * len(curves)
    for place, k in enumerate(order):
        on_top = sum(_same(curves[k], curves[other], span) for other in order[:place])
        looks[k] = {"ls": LINES[on_top % len(LINES)], "zorder": 3 + place}
    return looks


def _same(a: np.ndarray, b: np.ndarray, span: float) -> bool:
    return len(a) == len(b) > 0 and float(np.mean(np.abs(a - b) <= SAME * span)) > HALF


def fit_values(axes: Axes) -> None:
    """A quantity that does not change is a level line, not the rounding of it."""
    low, high = axes.dataLim.intervaly
    size = max(abs(low), abs(high))
    if np.isfinite(size) and 0 < high - low < LEVEL * size:
        axes.set_ylim((low + high) / 2 - size / 4, (low + high) / 2 + size / 4)


def legend_above(axes: Axes, width: float) -> None:
    """A legend beside the title, where it hides no curve; `width` of the axes [inches]."""
    handles, texts = axes.get_legend_handles_labels()
    if not texts:
        return
    room = width - text_width(axes.get_title(loc="left"), 11, True) - GAP
    entries = [HANDLE + text_width(text, SMALL) for text in texts]
    axes.legend(
        handles,
        texts,
        loc="lower right",
        bbox_to_anchor=(1.0, 1.0),
        borderaxespad=0.1,
        ncols=columns_that_fit(entries, room),
        fontsize=SMALL,
        handlelength=1.6,
        columnspacing=1.0,
        handletextpad=0.5,
    )


def columns_that_fit(entries: list[float], room: float) -> int:
    """The most columns of a legend, filled one after the other, in which entries of these widths are within `room`."""
    for columns in range(len(entries), 1, -1):
        parts = np.array_split(np.array(entries), columns)
        if sum(part.max() for part in parts) <= room:
            return columns
    return 1


def fit_time(axes: Axes, t0: float, t1: float, unit: str | None) -> None:
    """The time axis: from edge to edge; without its name where the unit is None."""
    if t1 > t0:
        axes.set_xlim(t0, t1)
    if unit is not None:
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
