"""Linear systems with a band matrix, LU with row exchanges (Golub & Van Loan 2013, section 4.3.5).

A matrix (n, n) with entries where |i - j| <= reach lies by rows in a (n, 3 reach + 1), entry (i, j) at
a[i, j - i + reach].
Row exchanges let U reach twice as far as the matrix: the last third of a is zero before.
Work: about 2 n reach² multiplications to factor, 3 n reach to substitute.
"""

from __future__ import annotations

from flowgmo.kernel import inner


@inner
def factor(a, n, reach, rows):
    """Factors in place of the matrix; rows[i] (n,): the row that row i was exchanged with."""
    for i in range(n):
        last = min(n, i + reach + 1)
        best = i
        for r in range(i + 1, last):
            if abs(a[r, i - r + reach]) > abs(a[best, i - best + reach]):
                best = r
        rows[i] = best
        width = min(n - i, 2 * reach + 1)
        if best != i:
            at = i - best + reach
            for j in range(width):
                x = a[i, reach + j]
                a[i, reach + j] = a[best, at + j]
                a[best, at + j] = x
        pivot = a[i, reach]
        if pivot != 0.0:
            for r in range(i + 1, last):
                at = i - r + reach
                x = a[r, at]
                if x != 0.0:
                    x /= pivot
                    a[r, at] = x
                    for j in range(1, width):
                        a[r, at + j] -= x * a[i, reach + j]


@inner
def substitute(a, n, reach, rows, x):
    """x (n,) becomes the solution for the right-hand side x; zero where the matrix is singular."""
    for i in range(n):
        r = rows[i]
        y = x[r]
        x[r] = x[i]
        x[i] = y
        for r in range(i + 1, min(n, i + reach + 1)):
            x[r] -= a[r, i - r + reach] * y
    for k in range(n):
        i = n - 1 - k
        y = x[i]
        for j in range(1, min(n - i, 2 * reach + 1)):
            y -= a[i, reach + j] * x[i + j]
        x[i] = y / a[i, reach] if a[i, reach] != 0.0 else 0.0
