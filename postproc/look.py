"""What both ways of drawing share: the box that is seen, colours of the bodies, directions of view."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from postproc.palette import COLOURS
from postproc.scene import Scene

BACKGROUND, SOLID_COLOUR, CROWD_COLOUR = "#ffffff", "#d2d6dc", "#a9bccd"
MOST_NAMES = 8  # a longer legend covers the picture
VIEWS = ("iso", "x", "y", "z")


@dataclass(frozen=True)
class Frame:
    """The box (2, 3) that the picture shows."""

    bounds: np.ndarray

    @property
    def corners(self) -> np.ndarray:
        """(8, 3)"""
        return np.array([[x, y, z] for x in self.bounds[:, 0] for y in self.bounds[:, 1] for z in self.bounds[:, 2]])


def frame_of(scene: Scene) -> Frame:
    """All that is ever seen."""
    return Frame(scene.bounds)


def body_colours(moving: list[int], chosen: list[int]) -> dict[int, str]:
    """Number of a moving body -> its colour, in the order of the deck; a crowd is grey but for the chosen ones."""
    if len(moving) <= len(COLOURS) or not chosen:
        return {number: COLOURS[k % len(COLOURS)] for k, number in enumerate(sorted(moving))}
    coloured = dict(zip(sorted(chosen), COLOURS, strict=False))
    return {number: coloured.get(number, CROWD_COLOUR) for number in moving}


def camera(view: str) -> tuple[np.ndarray, tuple[float, float, float], bool]:
    """Direction from the picture's centre to the camera, what is up, whether the projection is parallel.

    x, y, z look along the axis: x from its far end, y from the front (x to the right, z up), z from above.
    """
    direction, up = {
        "iso": ((0.62, -1.0, 0.42), (0, 0, 1)),
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
    """Names and colours for a legend; none for one body, or for so many that they would cover the picture."""
    if not 1 < len(colours) <= MOST_NAMES:
        return []
    return [(scene.names.get(number, f"obs{number}"), colour) for number, colour in colours.items()]
