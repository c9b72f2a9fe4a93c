"""One figure that shows a run: pictures at a few times, how the bodies moved, energy and impacts, the liquid."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.gridspec import SubplotSpec
from matplotlib.ticker import MaxNLocator

from postproc import style
from postproc.body_panels import NOTE, body_panels
from postproc.errors import WrongRequest
from postproc.impacts import Hits, hits
from postproc.liquid_panels import liquid_panels
from postproc.marks import mark_impacts
from postproc.palette import INK
from postproc.panels import Panel, panels
from postproc.results import Results
from postproc.strip import draw_strip, place_strip
from postproc.tables import draw_table

ALL_BODIES, SOME_BODIES = 6, 4  # curves that an eye can follow; of a crowd, those that are picked
WIDTH = 13.0  # inches, of the page
PLOTS = {0: 0.1, 1: 3.6, 2: 6.4, 3: 8.1}  # inches: height of so many plots above each other
GAUGE = 2.3  # inches: height of a plot of the liquid
SMALLS, SMALL = 3, 1.8  # small plots beside each other; inches: height of one
LEFT, RIGHT = 1.5, 1.0  # widths of the plots and of the table
BESIDE = 0.9  # inches beside the axes of a plot, for its numbers
NUMBERS = 0.6  # inches beside a plot without a name of its values
LONGEST = 24  # letters of a name in a legend


def report(results: Results, path: Path, notice: Callable[[str], None] = lambda text: None) -> Path:
    """Draw the report and return the file written."""
    if len(results.t) < 2:
        raise WrongRequest(f"{results.path} holds {len(results.t)} rows; a report needs two")
    names = _interesting(results)
    if len(names) < len(results.bodies):
        notice(f"curves of {len(names)} of {len(results.bodies)} bodies: {', '.join(names)}")
    shown, liquid = panels(results, names), liquid_panels(results)
    loads = body_panels(results, names, shown)
    strip = draw_strip(results, names, WIDTH, notice)
    tall = strip.height(WIDTH)
    found = hits(results)
    plots = PLOTS[2 if len(found) else len(shown)]
    small = max(SMALL * -(-len(loads) // SMALLS), PLOTS[0])
    heights = [tall, plots, small, max(GAUGE * len(liquid), PLOTS[0])]
    figure = plt.figure(figsize=(WIDTH, 1.1 + sum(heights)), layout="constrained")
    figure.get_layout_engine().set(w_pad=0.08, h_pad=0.08, hspace=0.02, wspace=0.02)
    style.headline(figure, results.title, 16)
    notes = [strip.caption(_length_unit(results)), *(panel.note for panel in (*shown, *liquid)), NOTE * bool(loads)]
    style.footnote(figure, "\n".join(note for note in notes if note))
    grid = figure.add_gridspec(4, 1, height_ratios=heights)
    place_strip(figure, grid[0], strip, results)
    looks = _looks([*shown, *loads], results.t)
    if len(found):
        _beside_table(figure, grid[1], results, shown, looks, found)
    else:
        _stacked(figure, grid[1], results, shown, looks)
    _side_by_side(figure, grid[2], results, loads, looks[len(shown) :])
    _stacked(figure, grid[3], results, liquid, _looks(liquid, results.t))
    return style.save(figure, path)


def _length_unit(results: Results) -> str:
    named = (results.curve(f"bodies/{name}/position").unit for name in results.bodies)
    return results.length_unit or next(named, "")


def _looks(shown: list[Panel], t: np.ndarray) -> list[dict[str, dict]]:
    """Strokes of the curves of each panel; one body has one stroke in all panels of the motion."""
    curves = [{line.text: np.interp(t, line.t, line.y) for line in panel.lines} for panel in shown]
    together = style.strokes(*(c for c, panel in zip(curves, shown, strict=True) if panel.motion))
    return [together if panel.motion else style.strokes(c) for c, panel in zip(curves, shown, strict=True)]


def _stacked(figure: plt.Figure, place: SubplotSpec, results: Results, shown: list[Panel], looks: list) -> None:
    """Panels above each other over one time axis."""
    rows = place.subgridspec(max(1, len(shown)), 1)
    axes: list[plt.Axes] = []
    for k, panel in enumerate(shown):
        axes.append(figure.add_subplot(rows[k], sharex=axes[0] if axes else None))
        _draw_panel(axes[k], panel, looks[k])
        if _needs_legend(shown, k, 0):
            style.legend_above(axes[k], WIDTH - BESIDE)
        axes[k].tick_params(labelbottom=k == len(shown) - 1)
    if axes:
        style.fit_time(axes[-1], results.t[0], results.t[-1], results.time_unit)


def _side_by_side(figure: plt.Figure, place: SubplotSpec, results: Results, shown: list[Panel], looks: list) -> None:
    """Small panels in rows; bodies look as in the panels above, other curves have a legend."""
    columns, told = max(1, min(SMALLS, len(shown))), []
    cells = place.subgridspec(max(1, -(-len(shown) // columns)), columns)
    for k, panel in enumerate(shown):
        axes = figure.add_subplot(cells[k // columns, k % columns])
        _draw_panel(axes, panel, looks[k])
        axes.set_title(style.label(panel.title, panel.unit))
        axes.set_ylabel("")
        texts = [line.text for line in panel.lines]
        if texts not in told and not set(texts) <= set(results.bodies):
            style.legend_above(axes, WIDTH / columns - NUMBERS)
        told.append(texts)
        axes.xaxis.set_major_locator(MaxNLocator(6, steps=[1, 2, 5, 10]))
        last = k + columns >= len(shown)
        style.fit_time(axes, results.t[0], results.t[-1], results.time_unit if last else None)
        axes.tick_params(labelbottom=last)


def _beside_table(
    figure: plt.Figure, place: SubplotSpec, results: Results, shown: list[Panel], looks: list, found: Hits
) -> None:
    """The motion on the left, on the right the table and what else there is."""
    sides = place.subgridspec(1, 2, width_ratios=[LEFT, RIGHT])
    left, right = (sides[k].subgridspec(2, 1) for k in (0, 1))
    motion = [k for k, panel in enumerate(shown) if panel.motion]
    others = [k for k, panel in enumerate(shown) if not panel.motion]
    width = WIDTH * LEFT / (LEFT + RIGHT)
    first = None
    for row, k in enumerate(motion):
        axes = figure.add_subplot(left[row], sharex=first)
        first = first or axes
        _draw_panel(axes, shown[k], looks[k])
        style.fit_time(axes, results.t[0], results.t[-1], results.time_unit if row else None)
        mark_impacts(axes, found, results.t[0], results.t[-1], results.time_unit)
        if row == 0 or _needs_legend(shown, k, 0):
            style.legend_above(axes, width - BESIDE)
        axes.tick_params(labelbottom=row > 0)
    draw_table(figure.add_subplot(right[0] if others else right[:]), results, WIDTH - width - 1.2 * BESIDE)
    for k in others:
        axes = figure.add_subplot(right[1])
        _draw_panel(axes, shown[k], looks[k])
        style.legend_above(axes, WIDTH - width - BESIDE)
        axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
        style.fit_time(axes, results.t[0], results.t[-1], results.time_unit)


def _needs_legend(shown: list[Panel], k: int, marks: int) -> bool:
    """A legend is there for energies and for more than one entry, unless the first panel's says the same."""
    texts = [[line.text for line in panel.lines] for panel in shown]
    several = len(texts[k]) + (marks if k == 0 else 0) > 1 and (k == 0 or texts[k] != texts[0])
    return several or shown[k].quantity == "energy"


def _draw_panel(axes: plt.Axes, panel: Panel, looks: dict[str, dict]) -> None:
    for line in panel.lines:
        look = looks[line.text] | style.rows_as_dots(line.t) | ({"lw": 1.0} if line.colour == INK else {})
        axes.plot(line.t, line.y, color=line.colour, label=style.plain(style.short(line.text, LONGEST)), **look)
    nothing = not any(line.y.any() for line in panel.lines)
    axes.set_title(f"{panel.title}: zero throughout" if nothing else panel.title)
    axes.set_ylabel(style.label(panel.quantity, panel.unit))
    if panel.quantity in ("energy", "volume"):  # zero is part of the picture
        low, high = min(axes.dataLim.y0, 0.0), max(axes.dataLim.y1, 0.0)
        axes.set_ylim(low - 0.06 * (high - low), high + 0.06 * (high - low))
    else:
        style.fit_values(axes)
    if panel.quantity == "angle":
        axes.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 1.5, 3, 4.5, 6, 9, 10]))  # 30, 45, 60, 90 degrees


def _interesting(results: Results) -> list[str]:
    """All bodies that move, in the order of the deck; of a crowd four: one is the fastest at the start.

    The others travel farthest, least, and between these: what a crowd does is seen in what differs.
    """
    if len(results.bodies) <= ALL_BODIES:
        return list(results.bodies)
    moves = {name: results.curve(f"bodies/{name}/position").y for name in results.bodies}
    travel = {name: np.ptp(p, axis=0).max(initial=0.0) for name, p in moves.items()}
    speed = {name: np.linalg.norm(results.curve(f"bodies/{name}/velocity").y[0]) for name in results.bodies}
    ranked = sorted(travel, key=travel.get, reverse=True)
    fastest = max(speed, key=speed.get)
    if sum(v >= speed[fastest] for v in speed.values()) == 1:  # one that sets the others going
        ranked.remove(fastest)
        places = np.linspace(0, len(ranked) - 1, SOME_BODIES - 1).round().astype(int)
        chosen = [fastest, *(ranked[k] for k in places)]
    else:
        chosen = [ranked[k] for k in np.linspace(0, len(ranked) - 1, SOME_BODIES).round().astype(int)]
    return [name for name in results.bodies if name in chosen]
