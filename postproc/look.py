"""What both ways of drawing share: colours and names of the bodies, directions of view, the clock."""

from __future__ import annotations

import numpy as np

from postproc.palette import COLOURS, INK, SCALE
from postproc.scene import Scene
from postproc.sight import Frame

BACKGROUND, SOLID_COLOUR, CROWD_COLOUR = "#ffffff", "#d2d6dc", "#a9bccd"
FLOOR_COLOUR, EDGE_COLOUR = "#edeff2", "#aab0b8"
MOST_NAMES, SOME_NAMES = 8, 6  # a longer legend covers the picture; names of a crowd's
LONG = 3.0  # a frame so many times as long as deep is a row
VIEWS = ("iso", "x", "y", "z")


def body_colours(moving: list[int], chosen: list[int]) -> dict[int, str]:
    """Number of a moving body -> its colour, in the order of the deck.

    A crowd is grey but for the chosen ones; without any, its colours run through a scale from the first to the last.
    """
    moving = sorted(moving)
    if len(moving) <= len(COLOURS):
        return {number: COLOURS[k] for k, number in enumerate(moving)}
    if not chosen:
        return {number: scale_colour(k / (len(moving) - 1)) for k, number in enumerate(moving)}
    coloured = dict(zip(sorted(chosen), COLOURS, strict=False))
    return {number: coloured.get(number, CROWD_COLOUR) for number in moving}


def scale_colour(share: float) -> str:
    """Colour "#rrggbb" on the scale, share from 0 to 1."""
    stops = np.array([[int(colour[k : k + 2], 16) for k in (1, 3, 5)] for colour in SCALE])
    rgb = [np.interp(share * (len(SCALE) - 1), np.arange(len(SCALE)), column) for column in stops.T]
    return "#" + "".join(f"{round(c):02x}" for c in rgb)


def camera(view: str, frame: Frame) -> tuple[np.ndarray, tuple[float, float, float], bool]:
    """Direction from the picture's centre to the camera, what is up, whether the projection is parallel.

    x, y, z look along the axis: x from its far end, y from the front (x to the right, z up), z from above. A long row
    is seen more from its side, so that it lies across the picture.
    """
    x, y, _ = np.ptp(frame.bounds, axis=0)
    iso = (0.3, -1.0, 0.42) if x > LONG * y else (1.0, -0.3, 0.42) if y > LONG * x else (0.62, -1.0, 0.42)
    direction, up = {
        "iso": (iso, (0, 0, 1)),
        "x": ((1, 0, 0), (0, 0, 1)),
        "y": ((0, -1, 0), (0, 0, 1)),
        "z": ((0, 0, 1), (0, 1, 0)),
    }[view]
    direction = np.array(direction, dtype=float)
    return direction / np.linalg.norm(direction), up, view != "iso"


def clock(t: float, end: float, unit: str) -> str:
    """ "t = 0.300 s": decimals as the end of the run asks for (0.300, 3.000, 117.3), so that a movie's do not dance."""
    decimals = (3 if end >= 1 else 2) - int(np.floor(np.log10(end))) if end > 0 else 0
    number = f"{t:.{max(0, decimals)}f}" if decimals <= 7 else f"{t:.4g}"  # 7: a run of 0.1 ms
    return f"t = {number} {unit}".rstrip()


def body_names(scene: Scene, colours: dict[int, str]) -> list[tuple[str, str]]:
    """Names and colours for a legend; none for one body, of a crowd some that lie evenly on the scale of colours."""
    numbers = list(colours)
    if len(numbers) < 2 or CROWD_COLOUR in colours.values():
        return []
    some = np.linspace(0, len(numbers) - 1, SOME_NAMES).round().astype(int)
    shown = numbers if len(numbers) <= MOST_NAMES else [numbers[k] for k in some]
    names = [(scene.names.get(number, f"obs{number}"), colours[number]) for number in shown]
    return names if len(numbers) <= MOST_NAMES else [(f"colours of {len(numbers)} bodies", INK), *names]


def silhouette(view: str, frame: Frame) -> tuple[float, float]:
    """Width and height of the frame as it is seen, without perspective."""
    direction, up, _ = camera(view, frame)
    right = np.cross(up, direction)
    right /= np.linalg.norm(right)
    width, height = (float(np.ptp(frame.corners @ axis)) for axis in (right, np.cross(direction, right)))
    return width, height
