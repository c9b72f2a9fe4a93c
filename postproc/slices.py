"""A slice through the liquid: fraction, pressure and speed in the cells of one plane, from fields.h5.

No fraction where there is no surface. Cells are drawn as they are, without smoothing. Over them lie solids, grey, and
moving bodies, darker, as the plane cuts their surfaces at the time of the snapshot (outlines.py; without the files of
vtk/ as whole cells). Beside them, and in the cells that they cut, the lines of the mesh are drawn, so that one sees how
fine it is where it matters.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import h5py
import numpy as np
from matplotlib import pyplot as plt
from matplotlib.collections import LineCollection
from matplotlib.colors import LinearSegmentedColormap
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Curve

from postproc import style
from postproc.errors import PostprocError, WrongRequest
from postproc.look import clock
from postproc.outlines import curve_of, outlines
from postproc.palette import INK, WATER
from postproc.results import Results
from postproc.scene import Scene

SHOWN = 0.02  # of a cell; with less liquid it has no pressure and no speed to show
SOLID, BODY, LINE = "#c3c8cf", "#949ca8", "#5b636e"
WATERS = LinearSegmentedColormap.from_list("water", ("#ffffff", WATER))
WIDTH, TALLEST, BROAD = 9.0, 4.5, 3.6  # inches: of the figure; of one slice, its height, its width beside others
LONG = 1.8  # width over height from which on slices lie above each other
BESIDE = 1.7  # inches beside a slice, for numbers and the scale of colours
MOST, FAR = 1.0, 3.0  # per cent of the cells at each end, left out where all are spread so many times as far
SAME = 1e-4  # of the last snapshot's time; a user writes times to a few digits
LEAST = 1.1  # inches: a slice that would be flatter is drawn higher than it is, room for the words beside it


@dataclass(frozen=True)
class Slice:
    """Planes (n + 1,), (m + 1,) of the two directions and values (n, m) of the cells.

    F is None without a surface, V without solids. shapes: outline of each body, and whether it is stationary.
    """

    names: str
    planes: tuple[np.ndarray, np.ndarray]
    F: np.ndarray | None
    p: np.ndarray
    speed: np.ndarray
    V: np.ndarray | None
    shapes: tuple[tuple[Curve, bool], ...] = ()


class Fields:
    """The snapshots in fields.h5 of a results folder."""

    def __init__(self, folder: Path) -> None:
        path = Path(folder) / "fields.h5"
        if not path.is_file():
            raise WrongRequest(f"{folder} holds no fields.h5: the scene has no liquid, or it was not written yet")
        try:
            self.file = h5py.File(path, "r", locking=False)
            if self.file.attrs.get("format") != "flowgmo fields":
                raise PostprocError(f"{path} is not a file of flowgmo's fields")
            groups = [item for item in self.file.values() if isinstance(item, h5py.Group) and "time" in item.attrs]
        except (OSError, RuntimeError, KeyError) as error:
            raise PostprocError(f"{path} is damaged: {' '.join(str(error).split())}") from error
        self.groups = sorted(groups, key=lambda group: float(group.attrs["time"]))
        self.times = np.array([float(group.attrs["time"]) for group in self.groups])
        if not self.groups:
            raise WrongRequest(f"{path} holds no snapshot yet")

    @property
    def planes(self) -> list[np.ndarray]:
        return [self.file[name][()] for name in "xyz"]

    def cut(self, k: int, axis: int, position: float) -> Slice:
        """The cells of snapshot k that hold `position` along `axis`."""
        planes, group = self.planes, self.groups[k]
        n = int(np.clip(np.searchsorted(planes[axis], position, side="right") - 1, 0, len(planes[axis]) - 2))
        layer = (slice(None),) * axis + (n,)
        others = [d for d in range(3) if d != axis]
        p = group["p"][layer]
        F = group["F"][layer] if "F" in group else None
        of = group if "V" in group else self.file  # bodies that move open and close cells
        V = of["V"][layer] if "V" in of else None
        speed = np.linalg.norm(group["velocity"][layer], axis=-1)
        return Slice("".join("xyz"[d] for d in others), tuple(planes[d] for d in others), F, p, speed, V)


def draw_slice(
    folder: Path,
    path: Path,
    t: float | None,
    axis: int | None,
    position: float | None,
    notice: Callable[[str], None] = lambda text: None,
) -> Path:
    """Draw the slice nearest to time t [the end] across an axis [the shortest side] at a position [its middle]."""
    fields = Fields(folder)
    planes = fields.planes
    if axis is None:
        axis = min((1, 0, 2), key=lambda d: round(float(np.ptp(planes[d])), 12))
    low, high = planes[axis][[0, -1]]
    position = (low + high) / 2 if position is None else position
    if not low <= position <= high:
        raise WrongRequest(f"{'xyz'[axis]} = {position:g} is outside of the mesh, {low:g} … {high:g}")
    k = len(fields.times) - 1 if t is None else int(np.abs(fields.times - t).argmin())
    if t is not None and abs(fields.times[k] - t) > SAME * fields.times[-1]:
        others = f"{len(fields.times)} times, {fields.times[0]:g} to {fields.times[-1]:g} (TPLTD)"
        notice(f"fields were written at {others}; the nearest to {t:g} is {fields.times[k]:g}")
    cut, group, attrs = fields.cut(k, axis, position), fields.groups[k], fields.file.attrs
    cut = replace(cut, shapes=_shapes(folder, fields.times[k], axis, position))
    figure, axes = _figure(cut)
    length = str(fields.file["x"].attrs.get("unit", ""))
    when = clock(fields.times[k], fields.times[-1], str(attrs.get("time_unit", "")))
    where = f"{when}, {'xyz'[axis]} = {position:.4g} {length}".strip()
    style.headline(figure, str(attrs.get("title", "")), 12, where)
    _draw_panels(figure, axes, cut, group)
    stacked = axes[0].get_subplotspec().get_gridspec().nrows > 1
    for ax in axes[-1:] if stacked else axes:
        ax.set_xlabel(f"{cut.names[0]} [{length}]")
    for ax in axes if stacked else axes[:1]:
        ax.set_ylabel(f"{cut.names[1]} [{length}]")
    return style.save(figure, path)


def _shapes(folder: Path, t: float, axis: int, position: float) -> tuple[tuple[Curve, bool], ...]:
    """Outlines of the bodies that the plane cuts, moving ones last; () where the surfaces were not written."""
    try:
        surfaces = Scene(Results(folder)).snapshot(t)
    except PostprocError:
        return ()
    cuts = [(outlines(body, axis, position), body.stationary) for body in surfaces]
    cuts.sort(key=lambda cut: not cut[1])
    return tuple((curve_of(loops), stationary) for loops, stationary in cuts if loops)


def _draw_panels(figure: plt.Figure, axes: np.ndarray, cut: Slice, group: h5py.Group) -> None:
    """Fraction, pressure, and speed; the last two where there is liquid."""
    wet = np.ones(cut.p.shape, bool) if cut.F is None else cut.F > SHOWN
    if cut.V is not None:
        wet &= cut.V > 0
    p, speed = (np.where(wet, values, np.nan) for values in (cut.p, cut.speed))
    if cut.F is not None:
        _panel(figure, axes[0], cut, cut.F, "Liquid fraction", WATERS, (0.0, 1.0))
    _panel(figure, axes[-2], cut, p, _label(group, "p", "pressure"), "viridis", _limits(p))
    _panel(figure, axes[-1], cut, speed, _label(group, "velocity", "speed"), "viridis", (0.0, _limits(speed)[1]))


def _label(group: h5py.Group, name: str, word: str) -> str:
    return style.label(word, str(group[name].attrs.get("unit", "")))


def _figure(cut: Slice) -> tuple[plt.Figure, np.ndarray]:
    """Panels above each other where the slice is a long one, else beside each other."""
    wide, high = (float(np.ptp(p)) for p in cut.planes)
    n = 2 if cut.F is None else 3
    if wide > LONG * high:
        tall = max(min(TALLEST, _true_height(wide, high)), LEAST)
        size, shape = (WIDTH, 0.9 + n * (tall + 0.3)), (n, 1)
    else:
        tall = min(TALLEST, BROAD * high / wide)
        size, shape = (n * (tall * wide / high + BESIDE), tall + 1.1), (1, n)
    figure, axes = plt.subplots(*shape, figsize=size, layout="constrained", sharex=shape[1] == 1, sharey=shape[0] == 1)
    return figure, axes.ravel()


def _true_height(wide: float, high: float) -> float:
    """Inches, of a long slice as wide as the figure lets it be."""
    return (WIDTH - BESIDE) * high / wide


def _panel(
    figure: plt.Figure,
    axes: plt.Axes,
    cut: Slice,
    values: np.ndarray,
    name: str,
    colours: object,
    limits: tuple[float, float],
) -> None:
    image = axes.pcolormesh(*cut.planes, values.T, cmap=colours, vmin=limits[0], vmax=limits[1], rasterized=True)
    if cut.V is not None:
        solid = np.ma.masked_where(cut.V > 0, np.ones(cut.V.shape))
        axes.pcolormesh(*cut.planes, solid.T, cmap=LinearSegmentedColormap.from_list("solid", (SOLID, SOLID)))
        axes.add_collection(LineCollection(_lines(cut), colors=LINE, linewidths=0.3, alpha=0.6))
    for k, (curve, stationary) in enumerate(cut.shapes):  # the line first: between pieces of a body it is covered
        axes.add_patch(PathPatch(curve, fill=False, edgecolor=INK, linewidth=1.4, zorder=3 + k))
        axes.add_patch(PathPatch(curve, facecolor=SOLID if stationary else BODY, linewidth=0.0, zorder=3.5 + k))
    axes.set(**{f"{side}lim": planes[[0, -1]] for side, planes in zip("xy", cut.planes, strict=True)})
    beyond = _beyond(values, limits)
    figure.colorbar(image, ax=axes, label=name, pad=0.015, aspect=14, extend=beyond).ax.tick_params(labelsize=9)
    flat = _true_height(*(float(np.ptp(p)) for p in cut.planes)) < LEAST
    axes.set_aspect("auto" if flat else "equal")
    axes.grid(False)
    axes.tick_params(colors=INK, labelsize=9)


def _limits(values: np.ndarray) -> tuple[float, float]:
    """Ends of the scale: all that is there, and 0 unless it is far away; something where all is the same.

    Where a few cells lie far from all others, as beside an impact, the scale ends with the others.
    """
    known = values[np.isfinite(values)]
    if not len(known):
        return 0.0, 1.0
    low, high = float(known.min()), float(known.max())
    most = np.percentile(known, [MOST, 100 - MOST])
    if np.ptp(most) > 0 and high - low > FAR * np.ptp(most):
        low, high = (float(x) for x in most)
    low = low if low > 0.5 * high else min(low, 0.0)
    return (low, high) if high > low else (low, low + 1.0)


def _beyond(values: np.ndarray, limits: tuple[float, float]) -> str:
    """At which ends of the scale values lie beyond it, as matplotlib calls it."""
    below, above = (bool((sign * values > sign * end).any()) for sign, end in zip((-1, 1), limits, strict=True))
    return {(0, 0): "neither", (1, 0): "min", (0, 1): "max", (1, 1): "both"}[below, above]


def _lines(cut: Slice) -> list:
    """Edges of the cells that solids cut, and of open ones beside solids."""
    touched = cut.V < 1.0
    near = touched.copy()
    for axis in range(2):
        lower, upper = ((slice(None),) * axis + (s,) for s in (slice(None, -1), slice(1, None)))
        near[lower] |= touched[upper]
        near[upper] |= touched[lower]
    x, z = cut.planes
    lines = []
    for i, k in np.argwhere(near & (cut.V > 0)):
        (a, b), (c, d) = x[i : i + 2], z[k : k + 2]
        lines += [[(a, c), (b, c)], [(b, c), (b, d)], [(b, d), (a, d)], [(a, d), (a, c)]]
    return lines
