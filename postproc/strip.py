"""The pictures of a report: the bodies at a few times, beside each other, or in rows where the scene is a long one."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib import pyplot as plt
from matplotlib.gridspec import SubplotSpec

from postproc import style
from postproc.errors import PostprocError
from postproc.look import clock, silhouette
from postproc.palette import COLOURS
from postproc.pictures import draw
from postproc.results import Results
from postproc.scene import Scene
from postproc.sight import Frame, frame_of

PICTURES = 4
TITLE = 0.32  # inches: of the time above a picture
#: Pictures beside each other, while the scene is at most so many times as wide as high.
BESIDE = ((4, 1.9), (2, 4.5), (1, np.inf))
DOTS = 130  # per inch, as the figure is saved
LEAST = 400  # pixels; less is too coarse for edges
TALLEST = 4.6  # inches: of a row of pictures
AIR = 1.3  # height of what is drawn over that of the scene, for the perspective; the margin is cut off


@dataclass(frozen=True)
class Strip:
    """Pictures (none where nothing can be drawn), their times, how many are beside each other, the box that they show.

    grey: how many bodies of a crowd are grey.
    """

    images: list[np.ndarray]
    times: np.ndarray
    columns: int
    frame: Frame | None
    grey: int

    def height(self, width: float) -> float:
        """Inches, on a page of this width."""
        if not self.images:
            return 0.3
        high, wide = self.images[0].shape[:2]
        rows = -(-len(self.images) // self.columns)
        return rows * (TITLE + min(TALLEST, width / self.columns * high / wide))

    def caption(self, unit: str) -> str:
        """What the pictures do not say themselves."""
        if not self.images:
            return ""
        size = " × ".join(f"{side:.3g}" for side in np.ptp(self.frame.bounds, axis=0))
        grey = f"; grey: the {self.grey} bodies without curves" if self.grey else ""
        what = "the domain" if self.frame.whole else "a part of the domain"
        return f"The outlined box is {what}: {size} {style.unit_text(unit)}".rstrip() + grey


def draw_strip(results: Results, names: list[str], width: float, notice: Callable[[str], None]) -> Strip:
    """The bodies at a few times, `names` in their colours, for a page of this width [inches]."""
    try:
        scene = Scene(results)
        times = np.unique([scene.shown_time(t) for t in _picture_times(results, names)])
        if not (results.bodies or scene.has_liquid):  # all pictures would be the same
            times = times[:1]
        frame = frame_of(scene)
        wide, high = silhouette("iso", frame)
        columns = min(next(n for n, most in BESIDE if wide <= most * high), len(times))
        across = max(LEAST, round(DOTS * width / columns))
        size = (across, max(LEAST, min(across, round(AIR * across * high / wide))))
        images = _images(results, times, names, size, notice)
    except PostprocError as error:
        notice(f"no pictures: {error}")
        return Strip([], np.zeros(0), PICTURES, None, 0)
    crowd = len(results.bodies) > len(COLOURS)
    return Strip(images, times, columns, frame, crowd * (len(results.bodies) - len(names)))


def _images(
    results: Results, times: np.ndarray, names: list[str], size: tuple[int, int], notice: Callable[[str], None]
) -> list[np.ndarray]:
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / f"{k}.png" for k in range(len(times))]
        chosen = tuple(results.bodies[name] for name in names)
        draw(results, list(zip(times, files, strict=True)), size=size, label=False, chosen=chosen, notice=notice)
        return _cropped([plt.imread(file) for file in files])


def place_strip(figure: plt.Figure, place: SubplotSpec, strip: Strip, results: Results) -> None:
    """Put the pictures into the figure, each under its time."""
    rows = -(-len(strip.images) // strip.columns) or 1
    cells = place.subgridspec(rows, strip.columns, wspace=0.02)
    for k, image in enumerate(strip.images):
        axes = figure.add_subplot(cells[k // strip.columns, k % strip.columns])
        axes.imshow(image)
        axes.set_axis_off()
        axes.set_title(clock(strip.times[k], results.t[-1], results.time_unit), fontweight="normal", loc="center")


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
