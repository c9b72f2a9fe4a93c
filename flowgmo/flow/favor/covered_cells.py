"""Which cells several bodies touch, and what they leave open of them together.

    open      A = still - sum of s_b       s_b what body b covers by itself, still what the stationary solids leave
    shares    S_b = (1 - A) s_b / (sum of s_b + 1 - still)     s_b itself where nothing overlaps

so that A + sum of S_b + the stationary solids' own share is 1 on every face, also where a sum that is more than there
is was replaced by the exact union (overlaps.py) or where a face was closed because its cell is full.
"""

from __future__ import annotations

import numpy as np

from flowgmo.kernel import kernel

TOUCH = 1e-13  # of a cell or face: what round-off says that a body covers; a cell open by less than 1 has a wall
ROUND = 1e-10  # what is open by less is rounding of cuts (1e-15) or poses (1e-12): no liquid finds its way through
OVERLAP = 1e-9  # of a cell or face: bodies that rest on each other overlap by rounding only


@kernel
def subtract_runs(a, b, out):
    """Numbers in runs a (m, 2) but not in b (n, 2), both ascending, into out (k,) as far as it reaches; their count."""
    count = np.int64(0)
    first = np.int64(0)
    for m in range(len(a)):
        at = a[m, 0]
        while first < len(b) and b[first, 1] <= at:
            first += 1
        n = first
        while at < a[m, 1]:
            end = a[m, 1]
            if n < len(b):
                if b[n, 0] <= at:
                    at = max(at, b[n, 1])
                    n += 1
                    continue
                end = min(end, b[n, 0])
            for number in range(at, end):
                if count < len(out):
                    out[count] = number
                count += 1
            at = end
    return count


def runs_apart(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Numbers (n,) that are in the runs a or in b, but not in both."""
    if a is b:
        return np.zeros(0, np.int64)
    none = np.zeros(0, np.int64)
    found = []
    for one, other in ((a, b), (b, a)):
        count = subtract_runs(one, other, none)
        out = np.empty(count, np.int64)
        if count:
            subtract_runs(one, other, out)
        found.append(out)
    return np.concatenate(found)


def united(lists: list[np.ndarray]) -> np.ndarray:
    """Numbers (n,) that are in any of the lists, ascending."""
    every = np.sort(np.concatenate(lists))
    return every[np.append(True, every[1:] != every[:-1])[: len(every)]]


@kernel
def cells_of(numbers, shape, cells):
    """Cells (n, 3) [with ghosts] of numbers (n,)."""
    for c in range(len(numbers)):
        k = numbers[c] % shape[2]
        rest = numbers[c] // shape[2]
        cells[c, 0] = rest // shape[1]
        cells[c, 1] = rest % shape[1]
        cells[c, 2] = k


@kernel
def rows_of_body(union, numbers, shares, runs, at, out):
    """Which of the union's cells (n,) a body touches, and what it covers: at (r,) ascending, out (r, 7); their count.

    numbers, shares, runs: of its BodyCover.
    """
    count = np.int64(0)
    s = np.int64(0)
    m = np.int64(0)
    for c in range(len(union)):
        while s < len(numbers) and numbers[s] < union[c]:
            s += 1
        while m < len(runs) and runs[m, 1] <= union[c]:
            m += 1
        if s < len(numbers) and numbers[s] == union[c]:
            at[count] = c
            for part in range(7):
                out[count, part] = shares[s, part]
            count += 1
        elif m < len(runs) and runs[m, 0] <= union[c]:
            at[count] = c
            for part in range(7):
                out[count, part] = 1.0
            count += 1
    return count


@kernel
def read_open(cells, V, Ax, Ay, Az, out):
    """Open fractions (n, 7) of cells (n, 3) [with ghosts]: six faces, then volume; V None: all is open."""
    for c in range(len(cells)):
        if V is None:
            for part in range(7):
                out[c, part] = 1.0
        else:
            i = cells[c, 0]
            j = cells[c, 1]
            k = cells[c, 2]
            out[c, 0] = Ax[i - 1, j, k]
            out[c, 1] = Ax[i, j, k]
            out[c, 2] = Ay[i, j - 1, k]
            out[c, 3] = Ay[i, j, k]
            out[c, 4] = Az[i, j, k - 1]
            out[c, 5] = Az[i, j, k]
            out[c, 6] = V[i, j, k]


@kernel
def add_rows(at, shares, total, most):
    """Add shares (r, 7) to total (n, 7), and keep the largest in most (n, 7)."""
    for r in range(len(at)):
        for part in range(7):
            total[at[r], part] += shares[r, part]
            most[at[r], part] = max(most[at[r], part], shares[r, part])


@kernel
def leave_open(still, total, most, opened, overlapping):
    """opened (n, 7), what is left, and overlapping (n,) uint8: cells that need the exact union."""
    for c in range(len(still)):
        overlapping[c] = 0
        for part in range(7):
            left = still[c, part] - (total[c, part] if total[c, part] > TOUCH else 0.0)
            opened[c, part] = left if left > ROUND or total[c, part] == 0.0 else 0.0
            if left < -OVERLAP and still[c, part] > 0.0 and most[c, part] < 1.0:
                overlapping[c] = 1


@kernel
def keep_volume(still, total, opened):
    """A cell next to a face that no body covers keeps a trace of volume: closing it would close that face, whose other
    cell no body touches."""
    for c in range(len(still)):
        if opened[c, 6] == 0.0 and still[c, 6] > 0.0:
            for part in range(6):
                if still[c, part] > 0.0 and total[c, part] == 0.0:
                    opened[c, 6] = ROUND


@kernel
def mean_open(now, then, mean, wanted):
    """mean (n, 7) of what is open now and then, and the cells (n,) bool that have volume or, in the mean, a face."""
    for c in range(len(now)):
        some = now[c, 6] > 0.0 or then[c, 6] > 0.0
        for part in range(7):
            mean[c, part] = 0.5 * (now[c, part] + then[c, part])
            some |= part < 6 and mean[c, part] > 0.0
        wanted[c] = some


@kernel
def add_shares(at, shares, still, total, opened, weight, cells, faces, covered):
    """Add weight times a body's shares of the faces that are open by opened (n, 7) to faces (m, 6).

    at (r,) ascending, shares (r, 7): what it covers by itself; cells (m,), ascending: of faces, all of `at` among them;
    covered (m,) becomes its share of the volume, None: is not wanted.
    """
    m = np.int64(0)
    for r in range(len(at)):
        c = at[r]
        while cells[m] < c:
            m += 1
        for part in range(7):
            covers = total[c, part] + (1.0 - still[c, part])
            share = (1.0 - opened[c, part]) * (shares[r, part] / covers) if shares[r, part] > 0.0 else 0.0
            if part < 6:
                faces[m, part] += weight * share
            elif covered is not None:
                covered[m] = share
