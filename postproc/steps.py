"""Curves that jump at impacts, drawn with the jump at its time and not as a slope from row to row.

A row of the history is before an impact, the next one after it. With the slopes of the intervals before and after, both
free of impacts, the values at the impact's two sides follow to second order of the interval, exactly in free flight:

    y(τ-) = y_k + (τ - t_k) s_(k-1),    y(τ+) = y_(k+1) - (t_(k+1) - τ) s_(k+1)
"""

from __future__ import annotations

import numpy as np

SHARP = 1e-9  # of an interval; an impact that is so little after a row is in the row already
BEYOND = 0.25  # of the change between the rows; sides that lie farther outside are not believed


def stepped(t: np.ndarray, y: np.ndarray, impacts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Rows t, y (n,) with two points more at each impact that is alone in its interval.

    Left as they are: intervals with several impacts, or with none beside them that is free of impacts, and those where
    the sides would lie far outside of the rows.
    """
    if len(t) < 3 or len(impacts) == 0:
        return t, y
    impacts = np.sort(impacts)
    dt = np.diff(t)
    home = np.searchsorted(t, impacts - SHARP * dt.min(), side="left") - 1  # t_k < τ <= t_(k+1)
    home, impacts = home[(home >= 0) & (home < len(dt))], impacts[(home >= 0) & (home < len(dt))]
    busy = np.bincount(home, minlength=len(dt))
    slope = np.where(busy == 0, np.diff(y) / dt, np.nan)
    before = np.concatenate([[np.nan], slope[:-1]])
    after = np.concatenate([slope[1:], [np.nan]])
    before, after = np.where(np.isnan(before), after, before), np.where(np.isnan(after), before, after)
    alone = busy[home] == 1
    k, at = home[alone], impacts[alone].clip(t[home[alone]], t[home[alone] + 1])
    sides = np.column_stack([y[k] + (at - t[k]) * before[k], y[k + 1] - (t[k + 1] - at) * after[k]])
    low, high = np.minimum(y[k], y[k + 1]), np.maximum(y[k], y[k + 1])
    air = BEYOND * (high - low)
    believed = ((sides >= (low - air)[:, None]) & (sides <= (high + air)[:, None])).all(axis=1)  # nan is not
    places = np.repeat(k[believed] + 1, 2)
    return np.insert(t, places, np.repeat(at[believed], 2)), np.insert(y, places, sides[believed].ravel())
