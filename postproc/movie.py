"""A movie of the bodies: a GIF, or numbered pictures in a folder for a program that makes movies."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from postproc.errors import PostprocError, WrongRequest
from postproc.pictures import draw
from postproc.results import Results
from postproc.scene import Scene

if TYPE_CHECKING:
    from PIL import Image

LAST = 1000  # ms; the end is shown longer before the movie begins again
WHITE = 255  # number of this colour in the palette
SAMPLES, COARSE = 12, 4  # frames that the colours are taken from; steps between two shades


def movie(
    results: Results,
    path: Path,
    frames: int,
    rate: float,
    view: str,
    size: tuple[int, int],
    notice: Callable[[str], None] = lambda text: None,
) -> Path:
    """Draw `frames` pictures evenly over the run, shown at `rate` [1/s]; a path that ends in .gif becomes one file."""
    if path.suffix not in (".gif", ""):
        raise WrongRequest(f"cannot write {path}: a movie is a .gif file, or a folder of pictures (no ending)")
    scene = Scene(results)
    times = np.linspace(scene.times[0], scene.end, frames)
    if path.suffix == "":
        draw(results, [(t, path / f"frame_{k:05d}.png") for k, t in enumerate(times)], view, size, notice=notice)
        return path
    with tempfile.TemporaryDirectory() as folder:
        files = [Path(folder) / f"{k}.png" for k in range(frames)]
        draw(results, list(zip(times, files, strict=True)), view, size, notice=notice)
        _join(files, path, rate)
    return path


def _join(files: list[Path], path: Path, rate: float) -> None:
    from PIL import Image

    images = [Image.open(file).convert("RGB") for file in files]
    palette = _palette(images)
    images = [_painted(image, palette) for image in images]
    shown = [round(1000 / rate)] * (len(images) - 1) + [LAST]
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        images[0].save(path, save_all=True, append_images=images[1:], duration=shown, loop=0)
    except OSError as error:
        raise PostprocError(f"cannot write {path}: {error}") from error


def _palette(images: list[Image.Image]) -> Image.Image:
    """256 colours for all frames, so that they do not flicker; each shade that occurs counts once, however few pixels.

    By the number of pixels a large floor would get all colours, and a small ball none of its own.
    """
    from PIL import Image

    some = np.concatenate([np.asarray(image).reshape(-1, 3) for image in images[:: max(1, len(images) // SAMPLES)]])
    shades = np.unique(some // COARSE, axis=0) * COARSE + COARSE // 2
    found = Image.fromarray(shades.astype(np.uint8)[None]).quantize(WHITE, method=Image.Quantize.MEDIANCUT)
    colours = np.full((WHITE + 1, 3), 255)
    some = np.array(found.getpalette()).reshape(-1, 3)[:WHITE]
    colours[: len(some)] = some
    found.putpalette(colours.ravel().tolist())
    return found


def _painted(image: Image.Image, palette: Image.Image) -> Image.Image:
    """A frame in the colours of the palette. Pillow finds the nearest ones roughly; white has to stay white."""
    from PIL import Image

    indices = np.array(image.quantize(palette=palette, dither=Image.Dither.NONE))
    indices[(np.asarray(image) == 255).all(axis=2)] = WHITE
    painted = Image.fromarray(indices)
    painted.putpalette(palette.getpalette())
    return painted
