"""A plain picture with matplotlib, where VTK cannot draw. Painter's order, so it may err behind corners."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib import colors
from matplotlib import pyplot as plt
from mpl_toolkits.mplot3d.art3d import Line3DCollection, Poly3DCollection

from postproc import style
from postproc.look import EDGE_COLOUR, FLOOR_COLOUR, SOLID_COLOUR, body_colours, body_names, camera, clock
from postproc.palette import WATER
from postproc.results import Results
from postproc.scene import Scene
from postproc.sight import frame_of

SUN = np.array([-0.4, -0.5, 0.77])
DOTS = 100  # per inch
LETTERS = 1.8  # points for each inch of the picture's height


def draw_simply(results: Results, job: dict) -> None:
    """Write one picture per frame of the job (render.py)."""
    scene = Scene(results)
    frame, colours = frame_of(scene), body_colours(scene.moving, job["chosen"])
    direction, _, parallel = camera(job["view"], frame)
    width, height = (pixels / DOTS for pixels in job["size"])
    for wanted in job["frames"]:
        figure = plt.figure(figsize=(width, height), dpi=DOTS)
        axes = figure.add_axes((0, 0, 1, 1), projection="3d", proj_type="ortho" if parallel else "persp")
        axes.view_init(np.degrees(np.arcsin(direction[2])), np.degrees(np.arctan2(direction[1], direction[0])))
        t = scene.shown_time(wanted["time"])
        for surface in scene.at(t):
            alpha = 0.35 if surface.stationary else 1.0
            axes.add_collection3d(
                _painted(surface.points[surface.faces], colours.get(surface.number, SOLID_COLOUR), alpha)
            )
        if (liquid := scene.liquid(t)) is not None:
            axes.add_collection3d(_painted(liquid[0][liquid[1]], WATER, 0.55))
        if frame.floor is not None:
            axes.add_collection3d(
                _Floor([frame.floor], facecolors=FLOOR_COLOUR, edgecolors=EDGE_COLOUR, linewidths=0.8)
            )
        axes.add_collection3d(Line3DCollection(_edges(frame.corners), colors=EDGE_COLOUR, linewidths=0.8))
        axes.set(**{f"{name}lim": frame.bounds[:, k] for k, name in enumerate("xyz")})
        axes.set_box_aspect(np.ptp(frame.bounds, axis=0), zoom=0.98)
        axes.set_axis_off()
        for artist in axes.collections:  # the axes are square, the picture is not
            artist.set_clip_on(False)
        if job["label"]:
            figure.text(0.03, 0.94, clock(t, scene.end, scene.time_unit), fontsize=LETTERS * height)
            for k, (name, colour) in enumerate(body_names(scene, colours)):
                place = (0.97, 0.94 - 0.04 * k)
                figure.text(*place, style.plain(name), color=colour, ha="right", fontsize=0.9 * LETTERS * height)
        style.save(figure, Path(wanted["path"]), dots=DOTS)


class _Floor(Poly3DCollection):
    """Painted before all else."""

    def do_3d_projection(self) -> float:
        super().do_3d_projection()
        return np.inf


def _painted(corners: np.ndarray, colour: str, alpha: float) -> Poly3DCollection:
    """Triangles (n, 3, 3) lit from above."""
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normals, axis=1, keepdims=True)
    light = 0.62 + 0.38 * (normals / np.where(length > 0, length, 1.0)) @ SUN
    shade = np.array(colors.to_rgb(colour)) * light[:, None]
    painted = np.column_stack([shade.clip(0, 1), np.full(len(shade), alpha)])
    return Poly3DCollection(corners, facecolors=painted, edgecolors="none", antialiased=False)


def _edges(corners: np.ndarray) -> list[np.ndarray]:
    """The 12 edges of a box: pairs of corners (8, 3) whose numbers differ in one bit."""
    return [corners[[a, b]] for a in range(8) for bit in (1, 2, 4) if (b := a | bit) != a]
