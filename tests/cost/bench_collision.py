"""`make bench-collision`: what each part of the collision model costs and how exact it is. No test; machines differ.

    python tests/cost/bench_collision.py            all parts
    python tests/cost/bench_collision.py search     one of them, or several

Each part is a program of its own and runs in its own process.
"""

import subprocess
import sys
import time
from pathlib import Path

PARTS = {
    "impact": "one impact: exact against steps",
    "search": "contacts on the surfaces against the mesh",
    "clusters": "several contacts: together against in turn",
    "resting": "lasting contact: constraint against micro-collisions",
    "pour": "spheres poured into a box: cost against touching pairs",
    "convex": "the search between two pieces, all kinds",
    "persistent": "the solver of lasting contacts, compilation included",
}


def main(names):
    unknown = [name for name in names if name not in PARTS]
    if unknown:
        parts = "\n".join(f"  {name:12s}{what}" for name, what in PARTS.items())
        sys.exit(f"no part called {', '.join(unknown)}; there are\n{parts}")
    for name in names or PARTS:
        began = time.perf_counter()
        print(f"\n=== {name}: {PARTS[name]}", flush=True)
        subprocess.run([sys.executable, str(Path(__file__).with_name(f"bench_{name}.py"))], check=True)
        print(f"=== {name}: {time.perf_counter() - began:.0f} s", flush=True)


if __name__ == "__main__":
    main(sys.argv[1:])
