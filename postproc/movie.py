"""A movie of the bodies: a GIF, or numbered pictures in a folder for a program that makes movies."""

from __future__ import annotations

import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np

from postproc.errors import PostprocError, WrongRequest
from postproc.pictures import draw
from postproc.results import Results
from postproc.scene import Scene


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

    images = [Image.open(file).convert("RGB").quantize(128, dither=Image.Dither.NONE) for file in files]
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        images[0].save(path, save_all=True, append_images=images[1:], duration=1000 / rate, loop=0)
    except OSError as error:
        raise PostprocError(f"cannot write {path}: {error}") from error
