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
from postproc.bounces import bouncing_body, rebounds, vertical_axis
from postproc.errors import PostprocError, WrongRequest
from postproc.look import body_colours
from postproc.palette import FAINT, INK
from postproc.pictures import draw
from postproc.results import Results

PICTURES = 4
MOST_BODIES = 4  # curves that an eye can follow
FIRST = ("energy/kinetic", "energy/potential")
MOST_ROWS = 10  # of the table
PIXELS = (760, 760)
WIDTH, PLOTS, TALLEST = 13.0, 7.2, 4.6  # inches: of the page, height of the plots, largest of the pictures
MANY_IMPACTS = 60  # from here on marks become strokes
SIDEWAYS = 0.05  # bodies that rise less than this part of their largest travel are shown along that travel instead


def report(results: Results, path: Path, notice: Callable[[str], None] = lambda text: None) -> Path:
    """Draw the report and return the file written."""
    if len(results.t) < 2:
        raise WrongRequest(f"{results.path} holds {len(results.t)} rows; a report needs two")
    names = _interesting(results)
    if len(names) < len(results.bodies):
        notice(f"curves of {len(names)} of {len(results.bodies)} bodies: {', '.join(names)}")
    times = _picture_times(results, names)
    images = _pictures(results, times, names, notice)
    tall = WIDTH * images[0].shape[0] / images[0].shape[1] / PICTURES if images else 0.3
    tall = min(tall, TALLEST)
    figure = plt.figure(figsize=(WIDTH, 0.9 + tall + PLOTS), layout="constrained")
    figure.get_layout_engine().set(w_pad=0.08, h_pad=0.08, hspace=0.02, wspace=0.02)
    figure.suptitle(results.title, fontsize=16, fontweight="bold", x=0.012, ha="left")
    grid = figure.add_gridspec(2, 1, height_ratios=[tall, PLOTS])
    _place(figure, grid[0], images, times, results.time_unit)
    below = grid[1].subgridspec(2, 2, width_ratios=[1.75, 1])
    axis, up = _axis(results, names)
    height = figure.add_subplot(below[0, 0])
    speed = figure.add_subplot(below[1, 0], sharex=height)
    colours = _colours(results, names)
    for k, name in enumerate(names):
        for axes, quantity in ((height, "position"), (speed, "velocity")):
            curve = results.curve(f"bodies/{name}/{quantity}")
            axes.plot(curve.t, curve.y[:, axis], color=colours[k], label=name, zorder=3 + k)
    _dress(results, height, speed, axis, up, names)
    has_impacts = len(results.impacts.get("time", ())) > 0
    _energy(figure.add_subplot(below[1, 1] if has_impacts else below[:, 1]), results)
    if has_impacts:
        _table(figure.add_subplot(below[0, 1]), results)
    return style.save(figure, path)


def _colours(results: Results, names: list[str]) -> list[str]:
    """As in the pictures."""
    numbers = [results.bodies[name] for name in names]
    colours = body_colours(list(results.bodies.values()), numbers)
    return [colours[number] for number in numbers]


def _interesting(results: Results) -> list[str]:
    """Up to four moving bodies, those that travel farthest; in the order of the deck."""
    travel = {
        name: np.ptp(results.curve(f"bodies/{name}/position").y, axis=0).max(initial=0.0) for name in results.bodies
    }
    chosen = sorted(travel, key=travel.get, reverse=True)[:MOST_BODIES]
    return [name for name in results.bodies if name in chosen]


def _axis(results: Results, names: list[str]) -> tuple[int, float]:
    """The direction to show: up, or where the bodies go if they hardly rise or fall."""
    axis, up = vertical_axis(results)
    if not names:
        return axis, up
    travel = np.max([np.ptp(results.curve(f"bodies/{n}/position").y, axis=0) for n in names], axis=0)
    return (axis, up) if travel[axis] >= SIDEWAYS * travel.max() else (int(travel.argmax()), 1.0)


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


def _place(figure: plt.Figure, place: SubplotSpec, images: list[np.ndarray], times: np.ndarray, unit: str) -> None:
    row = place.subgridspec(1, PICTURES, wspace=0.02)
    for k, image in enumerate(images):
        axes = figure.add_subplot(row[k])
        axes.imshow(image)
        axes.set_axis_off()
        axes.set_title(f"t = {times[k]:.3g} {style.unit_text(unit)}", fontweight="normal", loc="center")


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


def _dress(results: Results, height: plt.Axes, speed: plt.Axes, axis: int, up: float, names: list[str]) -> None:
    """Labels, legend, and the impacts as marks on the time axis."""
    position, velocity = (
        results.curve(f"bodies/{names[0]}/{q}").unit if names else "" for q in ("position", "velocity")
    )
    upright = (axis, up) == vertical_axis(results) and up > 0
    letter = "xyz"[axis]
    height.set_ylabel(style.label(f"height {letter}" if upright else f"position {letter}", position))
    speed.set_ylabel(style.label(f"vertical velocity ({letter})" if upright else f"velocity {letter}", velocity))
    height.set_title("Height against time" if upright else f"Position {letter} against time")
    speed.set_title("Vertical velocity against time" if upright else f"Velocity {letter} against time")
    style.fit_time(speed, results.t[0], results.t[-1], results.time_unit)
    plt.setp(height.get_xticklabels(), visible=False)
    times = results.impacts.get("time", np.zeros(0))
    for axes in (height, speed):
        if len(times):
            across = axes.get_xaxis_transform()
            mark = (
                {"marker": "^", "ms": 5, "alpha": 0.6} if len(times) < MANY_IMPACTS else {"marker": "|", "alpha": 0.3}
            )
            mark |= {"label": "impact"} if axes is height else {}
            axes.plot(times, np.zeros(len(times)), ls="", color=INK, transform=across, clip_on=False, zorder=9, **mark)
    if len(names) + bool(len(times)) > 1:
        height.legend(loc="upper right", ncols=min(3, len(names) + 1))


def _energy(axes: plt.Axes, results: Results) -> None:
    """All books of energy that are not zero throughout, what moves first."""
    axes.set_title("Energy")
    names = [name for name in results.quantities if name.startswith("energy/")]
    curves = [results.curve(name) for name in sorted(names, key=lambda name: (name not in FIRST, name))]
    largest = max((np.abs(curve.y).max(initial=0.0) for curve in curves), default=0.0)
    for k, curve in enumerate(c for c in curves if np.abs(c.y).max(initial=0.0) > 1e-6 * largest):  # 1e-6: not visible
        axes.plot(curve.t, curve.y[:, 0], color=style.colour(k), label=_energy_name(curve.name))
    if curves:
        axes.set_ylabel(style.label("energy", curves[0].unit))
        # above the curves, in a row: inside there is no corner that stays free
        low, high = axes.get_ylim()
        axes.set_ylim(low, high + 0.18 * (high - low))
        axes.legend(loc="upper left", ncols=3, fontsize=9, columnspacing=1.0, handlelength=1.2)
    axes.xaxis.set_major_locator(MaxNLocator(5))
    style.fit_time(axes, results.t[0], results.t[-1], results.time_unit)


def _energy_name(name: str) -> str:
    name = name.split("/")[1].replace("_", " ")
    return {"impacts": "lost in impacts", "dissipated": "lost in friction"}.get(name, name)


def _table(axes: plt.Axes, results: Results) -> None:
    """The first rebounds of a bouncing body, else the first impacts."""
    axes.set_axis_off()
    body = bouncing_body(results)
    if body is not None:
        title, heads, rows = _rebound_rows(results, body)
    else:
        title, heads, rows = _impact_rows(results)
    axes.set_title(title)
    drawn = axes.table(
        cellText=rows,
        colLabels=heads,
        loc="upper center",
        cellLoc="right",
        colLoc="right",
        edges="horizontal",
        colWidths=[0.1, 0.3, 0.3, 0.3] if body is not None else [0.2, 0.23, 0.23, 0.34],
    )
    drawn.auto_set_font_size(False)
    drawn.set_fontsize(10.5)
    drawn.scale(1, min(1.5, 16.0 / (len(rows) + 1)))
    for (row, _), cell in drawn.get_celld().items():
        cell.set_edgecolor(INK if row == 0 else FAINT)
        cell.set_text_props(fontweight="bold" if row == 0 else "normal")


def _rebound_rows(results: Results, body: str) -> tuple[str, list[str], list[list[str]]]:
    length = style.unit_text(results.curve(f"bodies/{body}/position").unit)
    time = style.unit_text(results.time_unit)
    found = rebounds(results, body)
    more = f" (first {MOST_ROWS} of {len(found)})" if len(found) > MOST_ROWS else ""
    rows = [
        [str(k), *("–" if np.isnan(x) else f"{x:.5f}" for x in (bounce.impact, bounce.top, bounce.height))]
        for k, bounce in enumerate(found[:MOST_ROWS], start=1)
    ]
    return (
        f"Rebounds of {body}{more}",
        ["i", f"impact [{time}]", f"top [{time}]", f"height [{length}]"],
        rows,
    )


def _impact_rows(results: Results) -> tuple[str, list[str], list[list[str]]]:
    impacts, names = results.impacts, results.parties
    order = np.argsort(impacts["time"], kind="stable")[:MOST_ROWS]
    impulse = np.linalg.norm(impacts["impulse"], axis=1)
    rows = [
        [
            f"{impacts['time'][k]:.5g}",
            *(names.get(int(impacts[party][k]), str(impacts[party][k]))[:14] for party in "ab"),
            f"{impulse[k]:.4g}",
        ]
        for k in order
    ]
    count = len(impulse)
    unit = results.file["collisions/impulse"].attrs.get("unit", "")
    title = f"Impacts (first {MOST_ROWS} of {count})" if count > MOST_ROWS else "Impacts"
    heads = [style.label("time", results.time_unit), "a", "b", style.label("impulse", str(unit))]
    return title, heads, rows
