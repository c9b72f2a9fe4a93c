"""Pictures of the bodies: with VTK in a child process, else with matplotlib.

Without a screen VTK can draw through EGL (a driver or Mesa) or OSMesa. Which of them works is found out by trying;
one that does not work may crash, and says so at length, which is why it happens in a child.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable
from pathlib import Path

from postproc.errors import PostprocError
from postproc.results import Results

PATIENCE = 300  # s for all frames of a job; software rendering of 200 bodies takes about a second a frame


def windows() -> list[str | None]:
    """Kinds of render window to try, the likeliest first; None is VTK's own choice."""
    if not sys.platform.startswith("linux"):
        return [None]
    if wanted := os.environ.get("VTK_DEFAULT_OPENGL_WINDOW"):
        return [wanted]
    screen = [None] if os.environ.get("DISPLAY") else []  # without a screen, VTK's own choice asks the X server first
    return ["vtkEGLRenderWindow", "vtkOSOpenGLRenderWindow", *screen]


def draw(
    results: Results,
    frames: list[tuple[float, Path]],
    view: str = "iso",
    size: tuple[int, int] = (1200, 900),
    colour_by: str = "name",
    label: bool = True,
    chosen: tuple[int, ...] = (),
    notice: Callable[[str], None] = lambda text: None,
) -> None:
    """Write a picture of the bodies at each time of `frames`."""
    for _, path in frames:
        if path.suffix.lower() not in (".png", ".jpg", ".jpeg", ".tif", ".tiff", ".bmp"):
            raise PostprocError(f"cannot write {path}: a picture's name ends in .png, .jpg, .tif or .bmp")
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
        except OSError as error:
            raise PostprocError(f"cannot write {path}: {error.strerror}") from error
    job = {
        "results": str(results.folder.resolve()),
        "frames": [{"time": t, "path": str(path.resolve())} for t, path in frames],
        "view": view,
        "size": list(size),
        "colour_by": colour_by,
        "label": label,
        "chosen": list(chosen),
    }
    if not any(_try_window(job, window) for window in windows()):
        notice("VTK cannot draw on this machine; the picture is drawn with matplotlib instead")
        from postproc.simple_picture import draw_simply

        draw_simply(results, job)


def _try_window(job: dict, window: str | None) -> bool:
    """Whether a child process with this kind of window has written all pictures."""
    environment = dict(os.environ)
    if window is not None:
        environment["VTK_DEFAULT_OPENGL_WINDOW"] = window
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "job.json"
        file.write_text(json.dumps(job))
        try:
            child = subprocess.run(
                [sys.executable, "-m", "postproc.render", str(file)],
                env=environment,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                timeout=PATIENCE,
            )
        except (OSError, subprocess.TimeoutExpired):
            return False
    return child.returncode == 0
