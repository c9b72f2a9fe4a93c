"""Move the bodies that nothing can hit, and note their states at the asked times on the way."""

from __future__ import annotations

import numpy as np

from flowgmo.bodies.forced import FAILED
from flowgmo.bodies.motion import fly
from flowgmo.kernel import kernel


@kernel
def move_alone(movers, A, laws, M, books, t0, t1, asked, rows, rows_books, hits, hit_body):
    """Move bodies `movers` (k,) from t0 to t1 [time].

    A (n,) BODY, M (n,) POSE (changed), books (4,). asked (r,) in (t0, t1]: states into rows (r, n) POSE, which hold the
    state at t0 on entry, and what the motion adds to the books into rows_books (r, 4). hits (h, 7), hit_body (h,):
    stops met, as motion.fly reports. Returns the number of hits and the body whose integration failed, or -1.
    """
    count = 0
    none = np.zeros((0, 7))
    for b in movers:
        for r in range(asked.size):
            if fly(A[b], rows[r, b], laws, rows_books[r], t0, asked[r], none) == FAILED:
                return count, b
        n = fly(A[b], M[b], laws, books, t0, t1, hits[count:])
        if n == FAILED:
            return count, b
        n = min(n, hits.shape[0] - count)
        for k in range(count, count + n):
            hit_body[k] = b
        count += n
    return count, -1
