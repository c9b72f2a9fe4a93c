"""Run a deck of this folder with several pushes and print the front speeds, their mean and their spread.

    python decks/domino/pushes.py [elastic|plastic] [simultaneous|sequential]

The elastic front is chaotic from gap to gap, so that one run means little; the mean over the pushes is the answer. The
second word says how several contacts that are hit at once are resolved (`multiple` of `&flowgmo`).
"""

from __future__ import annotations

import re
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

HERE = Path(__file__).parent
sys.path.insert(0, str(HERE.parent))

from measure import measure  # noqa: E402

SPINS = (7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 13.0)  # [rad/s]; below 3.3 the first block does not go over its edge
PUSH = re.compile(r"(utobs\(1,1\)|wtobs\(1,1\)|omytobs\(1,1\))=([-+.\de]+)")
MULTIPLE = ("simultaneous", "sequential")


def pushed(deck: str, spin: float, multiple: str = MULTIPLE[0]) -> str:
    """The text of a deck with the first block turning at `spin` about its front lower edge (the deck has 10 rad/s)."""
    text = (HERE / f"{deck}.nml").read_text(encoding="utf-8")
    text = PUSH.sub(lambda found: f"{found[1]}={float(found[2]) * spin / 10.0!r}", text)
    return f"{text}\n &flowgmo\n    multiple='{multiple}',\n /\n"


def front_speed(deck: str, spin: float, multiple: str, folder: Path) -> float:
    """Run one push; returns the speed of its front [cm/s]."""
    path = folder / f"{deck}_{spin:g}.nml"
    path.write_text(pushed(deck, spin, multiple), encoding="utf-8")
    results = path.with_suffix(".out")
    command = [sys.executable, "-m", "flowgmo.cli", "run", str(path), "-o", str(results)]
    subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
    return measure(results, "domino", deck)["front speed"]


def main() -> None:
    """Print one line for each push, then mean and standard deviation."""
    words = sys.argv[1:]
    deck = words[0] if words else "elastic"
    multiple = words[1] if len(words) > 1 else MULTIPLE[0]
    if deck not in ("elastic", "plastic") or multiple not in MULTIPLE:
        sys.exit(__doc__)
    found = []
    with tempfile.TemporaryDirectory() as folder:
        for spin in SPINS:
            found.append(front_speed(deck, spin, multiple, Path(folder)))
            print(f"{spin:5.1f} rad/s  {found[-1]:7.2f} cm/s", flush=True)
    mean, spread = np.mean(found), np.std(found, ddof=1)
    print(f"{len(found)} pushes, {multiple}: mean {mean:.2f}, standard deviation {spread:.2f} cm/s")


if __name__ == "__main__":
    main()
