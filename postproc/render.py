"""Draw scenes with VTK, without a screen. Runs as a program of its own: `python -m postproc.render JOB.json`.

A missing graphics library can end the whole process (no exception to catch), and VTK prints what it tries. So the
pictures are drawn in a child process that `pictures.py` starts, quietly, once per kind of render window.

The job: results (folder), frames (list of {"time", "path"}), view, size [pixels], colour_by ("name" | "speed"),
label (whether to write the time into the picture), chosen (numbers of the bodies that a crowd's colours are for).
"""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pyvista as pv

from postproc.look import (
    BACKGROUND,
    EDGE_COLOUR,
    FLOOR_COLOUR,
    SOLID_COLOUR,
    body_colours,
    body_names,
    camera,
    clock,
)
from postproc.palette import INK, WATER
from postproc.results import Results
from postproc.scene import Scene, Surface
from postproc.sight import Frame, frame_of

SHARP = 35.0  # degrees; edges sharper than this stay sharp in the shading and get a line
LENS = 20.0  # degrees; a long lens, little distortion
MARGIN = 1.14  # of the box, for the label and the axes
BAR = 0.14  # of the width, kept free for the scale of the speeds
MOST_RAYS = 200


def render(job: dict) -> None:
    """Write one picture per frame. Raises RuntimeError when the render window gives nothing."""
    scene = Scene(Results(Path(job["results"])))
    frame = frame_of(scene)
    colours = body_colours(scene.moving, job["chosen"])
    hiding = _hiding(scene, frame, job["view"])
    fastest = _fastest(scene) if job["colour_by"] == "speed" else 0.0
    for wanted in job["frames"]:
        plotter = pv.Plotter(off_screen=True, window_size=job["size"], lighting="none")
        _light(plotter)
        plotter.set_background(BACKGROUND)
        t = scene.shown_time(wanted["time"])
        for surface in scene.at(t):
            _add(plotter, surface, surface.number in hiding, colours, fastest, scene.speed_label)
        _add_liquid(plotter, scene.liquid(t))
        _outline(plotter, frame)
        _place_camera(plotter, frame, job, BAR if fastest > 0 else 0.0)
        if job["label"]:
            _label(plotter, clock(t, scene.end, scene.time_unit), job["size"])
            if fastest == 0:
                _legend(plotter, body_names(scene, colours), job["size"])
        plotter.enable_anti_aliasing("ssaa")
        image = plotter.screenshot(wanted["path"], return_img=True)
        plotter.close()
        if image is None or image.std() == 0:
            raise RuntimeError("the render window gave an empty picture")


def _light(plotter: pv.Plotter) -> None:
    """A bright light from above and left of the camera, a weak one from the other side, a little from everywhere."""
    for place, strength in (((-0.6, 1.0, 0.8), 0.75), ((0.9, 0.3, 0.6), 0.30), ((0.0, 0.0, 1.0), 0.15)):
        light = pv.Light(position=place, intensity=strength, light_type="camera light")
        light.positional = False
        plotter.add_light(light)


def _mesh(surface: Surface) -> pv.PolyData:
    faces = np.column_stack([np.full(len(surface.faces), 3), surface.faces])
    return pv.PolyData(surface.points, faces)


def _hiding(scene: Scene, frame: Frame, view: str) -> set[int]:
    """Numbers of the stationary solids that stand between the camera and a body at some time; drawn translucent."""
    towards = camera(view, frame)[0] * np.linalg.norm(np.ptp(frame.bounds, axis=0))
    times = np.linspace(scene.times[0], scene.end, 7)
    eyes = [s.points.mean(axis=0) for t in times for s in scene.at(t) if not s.stationary][:MOST_RAYS]
    solids = {s.number: _mesh(s) for s in scene.at(scene.times[0]) if s.stationary}
    return {k for k, mesh in solids.items() if any(len(mesh.ray_trace(eye, eye + towards)[0]) for eye in eyes)}


def _add(
    plotter: pv.Plotter, surface: Surface, hides: bool, colours: dict[int, str], fastest: float, speed: str
) -> None:
    mesh = _mesh(surface)
    look = {"smooth_shading": True, "split_sharp_edges": True, "feature_angle": SHARP, "ambient": 0.34}
    if surface.stationary:
        look |= {"color": SOLID_COLOUR, "opacity": 0.3 if hides else 1.0, "diffuse": 0.7}
    else:
        look |= {"color": colours[surface.number], "diffuse": 0.8, "specular": 0.25, "specular_power": 25}
    if fastest > 0 and not surface.stationary:
        mesh["speed"] = np.full(mesh.n_points, surface.speed)
        bar = {"title": f"{speed}\n", "vertical": True, "color": INK, "n_labels": 4, "fmt": "%.3g"}
        bar |= {"height": 0.5, "position_y": 0.25, "position_x": 0.88, "title_font_size": 20, "label_font_size": 18}
        look |= {"scalars": "speed", "cmap": "viridis", "clim": (0.0, fastest), "scalar_bar_args": bar, "color": None}
    plotter.add_mesh(mesh, **look)
    edges = mesh.extract_feature_edges(SHARP, boundary_edges=False, non_manifold_edges=False, manifold_edges=False)
    if edges.n_cells:
        plotter.add_mesh(edges, color="#3c424b", line_width=1.5, opacity=0.45 if surface.stationary else 0.8)


def _add_liquid(plotter: pv.Plotter, surface: tuple[np.ndarray, np.ndarray] | None) -> None:
    """The liquid's surface, through which one sees what is below."""
    if surface is None:
        return
    points, faces = surface
    mesh = pv.PolyData(points, np.column_stack([np.full(len(faces), 3), faces]))
    look = {"smooth_shading": True, "split_sharp_edges": False, "ambient": 0.3, "diffuse": 0.75, "specular": 0.35}
    plotter.add_mesh(mesh, color=WATER, opacity=0.55, specular_power=30, **look)
    rim = mesh.extract_feature_edges(SHARP, feature_edges=False, non_manifold_edges=False, manifold_edges=False)
    if rim.n_cells:
        plotter.add_mesh(rim, color=WATER, line_width=2.5)


def _outline(plotter: pv.Plotter, frame: Frame) -> None:
    """The edges of the box that is shown, and the domain's floor where that is a wall."""
    plotter.add_mesh(pv.Box(frame.bounds.T.ravel()).extract_all_edges(), color=EDGE_COLOUR, line_width=1.2)
    if frame.floor is not None:
        floor = pv.PolyData(frame.floor, np.array([4, 0, 1, 2, 3]))
        plotter.add_mesh(floor, color=FLOOR_COLOUR, lighting=False)
        plotter.add_mesh(floor.extract_all_edges(), color=EDGE_COLOUR, line_width=1.2)


def _label(plotter: pv.Plotter, text: str, size: list[int]) -> None:
    plotter.add_text(text, position=(0.03, 0.93), viewport=True, font_size=max(8, size[1] // 62), color=INK)
    plotter.add_axes(line_width=3, color=INK, viewport=(0, 0, 0.16, 0.16 * size[0] / size[1]))


def _legend(plotter: pv.Plotter, names: list[tuple[str, str]], size: list[int]) -> None:
    for k, (name, colour) in enumerate(names):
        place = (0.97, 0.94 - 0.036 * k)
        text = plotter.add_text(name, place, viewport=True, font_size=max(7, size[1] // 80), color=colour)
        text.GetTextProperty().SetJustificationToRight()


def _place_camera(plotter: pv.Plotter, frame: Frame, job: dict, bar: float) -> None:
    """Look at the box so that it just fills the picture but for the part `bar` of its width, on the right.

    A corner at (a, b, c) to the right, up, towards the camera is inside when |a| <= tan(angle/2) aspect (d - c) and
    |b| <= tan(angle/2) (d - c), d the camera's distance.
    """
    direction, up, parallel = camera(job["view"], frame)
    right = np.cross(up, direction)
    right /= np.linalg.norm(right)
    axes = np.array([right, np.cross(direction, right), direction])
    a, b, c = (seen := frame.corners @ axes.T).T
    middle = (seen.min(axis=0) + seen.max(axis=0)) / 2
    width, height = job["size"]
    a, b, c = np.abs(a - middle[0]), np.abs(b - middle[1]), c - middle[2]
    aspect = width / height * (1 - bar)
    half = np.tan(np.radians(LENS / 2))
    distance = MARGIN * max((c + b / half).max(), (c + a / (half * aspect)).max())
    plotter.camera.parallel_projection = parallel
    plotter.camera.parallel_scale = MARGIN * max(b.max(), a.max() / aspect)
    plotter.camera.SetWindowCenter(bar, 0.0)
    plotter.camera.view_angle = LENS
    plotter.camera.focal_point = middle @ axes
    plotter.camera.position = middle @ axes + distance * direction
    plotter.camera.up = up
    plotter.reset_camera_clipping_range()


def _fastest(scene: Scene) -> float:
    times = np.linspace(scene.times[0], scene.end, 64)
    return max((s.speed for t in times for s in scene.at(t) if not s.stationary), default=0.0)


def main() -> None:
    """Read the job's file and draw it."""
    try:
        import resource

        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))  # a crash in a graphics library is expected, no core file
    except (ImportError, ValueError):  # not on this system
        pass
    render(json.loads(Path(sys.argv[1]).read_text()))


if __name__ == "__main__":
    main()
