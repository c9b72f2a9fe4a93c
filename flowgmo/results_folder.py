"""The results folder: made, kept, or emptied of what an earlier run wrote."""

from __future__ import annotations

import shutil
from pathlib import Path

from flowgmo.errors import FlowgmoError

OURS = ("deck.resolved.nml", "run.log", "run.json", "history.h5", "fields.h5", "restart.h5", "vtk")


def prepare_folder(folder: Path, overwrite: bool, restart: bool) -> None:
    """Make the results folder. Raises FlowgmoError if it exists (without overwrite or restart), or cannot be made."""
    try:
        if folder.exists() and not folder.is_dir():
            raise FlowgmoError(f"{folder} is a file, not a folder. Name another results folder with -o")
        if folder.is_dir() and any(folder.iterdir()) and not (overwrite or restart):
            raise FlowgmoError(
                f"the results folder {folder} exists and is kept. Write --overwrite to replace it, --restart FILE to "
                "go on, or -o DIR for another one"
            )
        if overwrite and not restart and folder.is_dir():
            for name in OURS:  # only what a run writes; other files of the user stay
                target = folder / name
                if target.is_dir():
                    shutil.rmtree(target)
                elif target.exists():
                    target.unlink()
        folder.mkdir(parents=True, exist_ok=True)
        probe = folder / ".writable"
        probe.write_bytes(b"")
        probe.unlink()
    except OSError as error:
        raise FlowgmoError(f"the results folder {folder} cannot be written: {error.strerror or error}") from None
