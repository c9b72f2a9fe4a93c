"""One figure that shows a run: the bodies at a few times, how they moved, the energy, the impacts."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.gridspec import SubplotSpec
from matplotlib.ticker import MaxNLocator

from postproc import style
from postproc.errors import PostprocError, WrongRequest
from postproc.look import clock
from postproc.palette import INK
from postproc.panels import Panel, panels
from postproc.pictures import draw
from postproc.results import Results
from postproc.tables import draw_table

PICTURES = 4
MOST_BODIES = 4  # curves that an eye can follow
PIXELS = (760, 760)
WIDTH, TALLEST = 13.0, 4.6  # inches: of the page, largest height of the pictures
PLOTS = {0: 0.1, 1: 3.6, 2: 6.4, 3: 8.1}  # inches: height of so many plots above each other
LEFT, RIGHT = 1.5, 1.0  # widths of the plots and of the table
BESIDE = 0.9  # inches beside the axes of a plot, for its numbers
MANY_IMPACTS = 60  # from here on marks become strokes
LONGEST = 24  # letters of a name in a legend


def report(results: Results, path: Path, notice: Callable[[str], None] = lambda text: None) -> Path:
    """Draw the report and return the file written."""
    if len(results.t) < 2:
        raise WrongRequest(f"{results.path} holds {len(results.t)} rows; a report needs two")
    names = _interesting(results)
    if len(names) < len(results.bodies):
        notice(f"curves of {len(names)} of {len(results.bodies)} bodies: {', '.join(names)}")
    shown = panels(results, names)
    times = _picture_times(results, names)
    images = _pictures(results, times, names, notice)
    tall = WIDTH * images[0].shape[0] / images[0].shape[1] / PICTURES if images else 0.3
    tall = min(tall, TALLEST)
    has_table = len(results.impacts.get("time", ())) > 0
    plots = PLOTS[2 if has_table else len(shown)]
    figure = plt.figure(figsize=(WIDTH, 0.9 + tall + plots), layout="constrained")
    figure.get_layout_engine().set(w_pad=0.08, h_pad=0.08, hspace=0.02, wspace=0.02)
    style.headline(figure, results.title, 16)
    grid = figure.add_gridspec(2, 1, height_ratios=[tall, plots])
    _place(figure, grid[0], images, times, results)
    (_beside_table if has_table else _stacked)(figure, grid[1], results, shown)
    return style.save(figure, path)


def _stacked(figure: plt.Figure, place: SubplotSpec, results: Results, shown: list[Panel]) -> None:
    """Panels above each other over one time axis."""
    rows = place.subgridspec(max(1, len(shown)), 1)
    axes: list[plt.Axes] = []
    for k, panel in enumerate(shown):
        axes.append(figure.add_subplot(rows[k], sharex=axes[0] if axes else None))
        _draw_panel(axes[k], panel)
        if _needs_legend(shown, k, 0):
            style.legend_above(axes[k], WIDTH - BESIDE)
        axes[k].tick_params(labelbottom=k == len(shown) - 1)
    if axes:
        style.fit_time(axes[-1], results.t[0], results.t[-1], results.time_unit)


def _beside_table(figure: plt.Figure, place: SubplotSpec, results: Results, shown: list[Panel]) -> None:
    """The motion on the left, on the right the table and what else there is."""
    below = place.subgridspec(2, 2, width_ratios=[LEFT, RIGHT])
    motion = [panel for panel in shown if panel.motion]
    others = [panel for panel in shown if not panel.motion]
    width = WIDTH * LEFT / (LEFT + RIGHT)
    first = None
    for k, panel in enumerate(motion):
        axes = figure.add_subplot(below[k, 0], sharex=first)
        first = first or axes
        _draw_panel(axes, panel)
        _mark_impacts(axes, results, "impact" if k == 0 else None)
        if _needs_legend(motion, k, 1):
            style.legend_above(axes, width - BESIDE)
        axes.tick_params(labelbottom=k > 0)
        style.fit_time(axes, results.t[0], results.t[-1], results.time_unit if k else None)
    draw_table(figure.add_subplot(below[0, 1] if others else below[:, 1]), results)
    for panel in others:
        axes = figure.add_subplot(below[1, 1])
        _draw_panel(axes, panel)
        style.legend_above(axes, WIDTH - width - BESIDE)
        axes.xaxis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))
        style.fit_time(axes, results.t[0], results.t[-1], results.time_unit)


def _needs_legend(shown: list[Panel], k: int, marks: int) -> bool:
    """A legend is there for energies and for more than one entry, unless the first panel's says the same."""
    texts = [[line.text for line in panel.lines] for panel in shown]
    several = len(texts[k]) + (marks if k == 0 else 0) > 1 and (k == 0 or texts[k] != texts[0])
    return several or shown[k].quantity == "energy"


def _draw_panel(axes: plt.Axes, panel: Panel) -> None:
    for line, look in zip(panel.lines, style.strokes([line.y for line in panel.lines]), strict=True):
        axes.plot(line.t, line.y, color=line.colour, label=style.plain(style.short(line.text, LONGEST)), **look)
    axes.set_title(panel.title)
    axes.set_ylabel(style.label(panel.quantity, panel.unit))
    if panel.quantity == "energy":  # zero is part of the picture
        low, high = min(axes.dataLim.y0, 0.0), max(axes.dataLim.y1, 0.0)
        axes.set_ylim(low - 0.06 * (high - low), high + 0.06 * (high - low))
    else:
        style.fit_values(axes)
    if panel.quantity == "angle":
        axes.yaxis.set_major_locator(MaxNLocator(6, steps=[1, 1.5, 3, 4.5, 6, 9, 10]))  # 30, 45, 60, 90 degrees


def _mark_impacts(axes: plt.Axes, results: Results, text: str | None) -> None:
    """The impacts as marks on the time axis."""
    times = results.impacts["time"]
    mark = {"marker": "^", "ms": 5, "alpha": 0.6} if len(times) < MANY_IMPACTS else {"marker": "|", "alpha": 0.3}
    across = axes.get_xaxis_transform()
    zeros = np.zeros(len(times))
    axes.plot(times, zeros, ls="", color=INK, transform=across, clip_on=False, zorder=9, label=text, **mark)


def _interesting(results: Results) -> list[str]:
    """Up to four moving bodies, those that travel farthest; in the order of the deck."""
    travel = {
        name: np.ptp(results.curve(f"bodies/{name}/position").y, axis=0).max(initial=0.0) for name in results.bodies
    }
    chosen = sorted(travel, key=travel.get, reverse=True)[:MOST_BODIES]
    return [name for name in results.bodies if name in chosen]


def _pictures(results: Results, times: np.ndarray, names: list[str], notice: Callable[[str], None]) -> list[np.ndarray]:
    """The bodies at these times, without the white margin; none, with a notice, where nothing can be drawn."""
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / f"{k}.png" for k in range(len(times))]
        try:
            chosen = tuple(results.bodies[name] for name in names)
            draw(results, list(zip(times, files, strict=True)), size=PIXELS, label=False, chosen=chosen, notice=notice)
            return _cropped([plt.imread(file) for file in files])
        except PostprocError as error:
            notice(f"no pictures: {error}")
            return []


def _place(
    figure: plt.Figure, place: SubplotSpec, images: list[np.ndarray], times: np.ndarray, results: Results
) -> None:
    row = place.subgridspec(1, PICTURES, wspace=0.02)
    for k, image in enumerate(images):
        axes = figure.add_subplot(row[k])
        axes.imshow(image)
        axes.set_axis_off()
        axes.set_title(clock(times[k], results.t[-1], results.time_unit), fontweight="normal", loc="center")


def _cropped(images: list[np.ndarray]) -> list[np.ndarray]:
    """Without the white margin that all of them share."""
    inked = np.min([image[..., :3].min(axis=2) for image in images], axis=0) < 0.98
    rows, columns = np.flatnonzero(inked.any(axis=1)), np.flatnonzero(inked.any(axis=0))
    if not len(rows):
        return images
    return [image[rows[0] : rows[-1] + 1, columns[0] : columns[-1] + 1] for image in images]


def _picture_times(results: Results, names: list[str]) -> np.ndarray:
    """Times that share the path of the bodies evenly, so that a body at rest does not fill the report."""
    t = results.t
    path = np.zeros(len(t) - 1)
    for name in names:
        path += np.linalg.norm(np.diff(results.curve(f"bodies/{name}/position").y, axis=0), axis=1)
    if path.sum() == 0:
        return np.linspace(t[0], t[-1], PICTURES)
    way = np.concatenate([[0.0], np.cumsum(path / path.sum() + np.diff(t) / (t[-1] - t[0]))])
    return np.interp(np.linspace(0, way[-1], PICTURES), way, t)
