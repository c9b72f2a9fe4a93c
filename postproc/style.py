"""How figures look: one set of colours for curves and bodies, sober axes, readable letters."""

from __future__ import annotations

import textwrap
from collections.abc import Hashable
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
ON_PIXELS = 1.03  # letters are set on whole pixels, which widens a line (measured: by 2.6 % at size 12, .8 % at 16)
SMALL, HANDLE = 9.5, 0.42  # of a legend above a plot: font size; width of an entry beside its text [inches]
GAP = 0.15  # inches between the title and the legend
LINES = ("-", "--", ":", "-.")
SAME, HALF = 0.005, 0.5  # curves closer than this part of the panel, at more than half of the rows, hide each other
FEW_ROWS = 40  # up to here each row gets a dot
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


def headline(figure: Figure, text: str, size: float, below: str = "") -> None:
    """The title of a figure, on as many lines as its width asks for, three at most, and a line of its own below it."""
    room = (1 - 2 * EDGE) * figure.get_figwidth() / ON_PIXELS
    letters = max(1, len(text))
    while True:
        lines = textwrap.wrap(text, letters, max_lines=3, placeholder=" …") if letters > 4 else [text[:4]]
        if letters <= 4 or max((text_width(line, size, True) for line in lines), default=0.0) <= room:
            break
        letters -= 1
    lines = [line for line in (*lines, below) if line]
    figure.suptitle(plain("\n".join(lines)), fontsize=size, fontweight="bold", x=EDGE, ha="left")


def footnote(figure: Figure, text: str) -> None:
    """Small lines at the foot of a figure."""
    if text:
        figure.supxlabel(plain(text), fontsize=SMALL, x=EDGE, ha="left")


def strokes(*panels: dict[Hashable, np.ndarray]) -> dict[Hashable, dict]:
    """Stroke and order of what the panels {key: curve} show, one for each key in all of them.

    Where two curves run on top of each other, in any of the panels, the one that varies less is broken and above.
    """
    spans = [float(np.ptp(np.concatenate([*panel.values(), np.zeros(0)]))) if panel else 0.0 for panel in panels]
    some_vary = any(spans)  # then a panel of nothing but zeros breaks no curve of the others
    varies: dict[Hashable, float] = {}
    for panel, span in zip(panels, spans, strict=True):
        for key, curve in panel.items():
            share = float(np.ptp(curve)) / span if len(curve) and span > 0 else 0.0
            varies[key] = varies.get(key, 0.0) + share
    order = sorted(varies, key=lambda key: -varies[key])
    number: dict[Hashable, int] = {}
    for place, key in enumerate(order):
        taken = {
            number[other]
            for other in order[:place]
            for panel, span in zip(panels, spans, strict=True)
            if (span > 0 or not some_vary) and key in panel and other in panel and _same(panel[key], panel[other], span)
        }
        number[key] = next(k for k in range(len(order)) if k not in taken)
    return {key: {"ls": LINES[number[key] % len(LINES)], "zorder": 3 + place} for place, key in enumerate(order)}


def _same(a: np.ndarray, b: np.ndarray, span: float) -> bool:
    return len(a) == len(b) > 0 and float(np.mean(np.abs(a - b) <= SAME * span)) > HALF


def rows_as_dots(t: np.ndarray) -> dict:
    """Look of a curve with few rows: each is a dot, so that a line between two is not taken for what was computed."""
    return {"marker": "o", "ms": 3.5} if len(t) <= FEW_ROWS else {}


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
            return -(-len(entries) // -(-len(entries) // columns))  # as many as these rows need
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
