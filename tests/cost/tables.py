"""Tables that the benches print, and the best of several calls."""

import sys
import time
from pathlib import Path

HELPERS = Path(__file__).parents[1] / "helpers"
sys.path.insert(0, str(HELPERS))


def title(text):
    print(f"\n{text}\n{'-' * max(len(line) for line in text.splitlines())}", flush=True)


def row(first, *cells, width=26):
    """One line: the first column to the left, the others to the right in 12 characters."""
    print(f"{first:<{width}}" + "".join(f"{cell:>12}" for cell in cells), flush=True)


def best_of(times, call, *arguments):
    """Seconds of the fastest of several calls: what others do on the machine makes the rest slower."""
    least = float("inf")
    for _ in range(times):
        began = time.perf_counter()
        call(*arguments)
        least = min(least, time.perf_counter() - began)
    return least


def timed(call, *arguments):
    """Seconds of one call."""
    return best_of(1, call, *arguments)
