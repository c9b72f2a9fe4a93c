"""Linear systems with a band matrix, LU with row exchanges (Golub & Van Loan 2013, section 4.3.5).

A matrix (n, n) with entries where |i - j| <= reach lies by rows in a (n, 3 reach + 1), entry (i, j) at
a[i, j - i + reach].
Row exchanges let U reach twice as far as the matrix: the last third of a is zero before.
Most rows end before their band does: ends[i] is the last column of row i that may hold anything, and nothing is done
beyond it (as the column `ju` of LAPACK's dgbtf2). A row that a pivot row is taken from ends where the longer one does.
Work: at most 2 n reach² multiplications to factor, 3 n reach to substitute; a chain without exchanges takes a third.
"""

from __future__ import annotations

from flowgmo.kernel import inner

LONG = 16  # entries from which views of two rows, whose loop runs on several entries at once, cost less than they save


@inner
def factor(a, n, reach, rows, ends):
    """Factors in place of the matrix; rows[i] (n,): the row that row i was exchanged with; ends (n,): see above."""
    flat, w = a.reshape(a.size), 3 * reach  # entry (i, j) is flat[i w + reach + j]
    for i in range(n):
        last = min(n, i + reach + 1)
        best = i
        most = abs(a[i, reach])
        for r in range(i + 1, last):
            x = abs(flat[r * w + reach + i])
            if x > most:
                best, most = r, x
        rows[i] = best
        if best != i:
            exchange(a, i, best, reach, ends)
        pivot = a[i, reach]
        size = ends[i] - i
        if pivot != 0.0:
            start = i * w + reach + i
            for r in range(i + 1, last):
                at = r * w + reach + i
                x = flat[at]
                if x != 0.0:
                    x /= pivot
                    flat[at] = x
                    ends[r] = max(ends[r], ends[i])
                    if size < LONG:
                        for j in range(1, size + 1):
                            flat[at + j] -= x * flat[start + j]
                    else:
                        upper, row = flat[start + 1 : start + 1 + size], flat[at + 1 : at + 1 + size]
                        for j in range(size):
                            row[j] -= x * upper[j]


@inner
def exchange(a, i, best, reach, ends):
    """Rows i and best change places, from column i on."""
    at = i - best + reach
    for j in range(max(ends[i], ends[best]) + 1 - i):
        x = a[i, reach + j]
        a[i, reach + j] = a[best, at + j]
        a[best, at + j] = x
    end = ends[i]
    ends[i] = ends[best]
    ends[best] = end


@inner
def substitute(a, n, reach, rows, ends, x):
    """x (n,) becomes the solution for the right-hand side x; zero where the matrix is singular."""
    for i in range(n):
        r = rows[i]
        y = x[r]
        x[r] = x[i]
        x[i] = y
        if y != 0.0:
            for r in range(i + 1, min(n, i + reach + 1)):
                x[r] -= a[r, i - r + reach] * y
    for k in range(n):
        i = n - 1 - k
        y = x[i]
        for j in range(1, ends[i] - i + 1):
            y -= a[i, reach + j] * x[i + j]
        x[i] = y / a[i, reach] if a[i, reach] != 0.0 else 0.0
