"""Lines in the cells across an axis along which the liquid is the same: exact for lines, better at what reaches in."""

import numpy as np
import pytest

from flowgmo.flow.surface import line_fit, plic
from flowgmo.kernel import kernel


@kernel
def line(a, b, rows, wide, tall):
    return line_fit.line_vector(a, b, rows, wide, tall)


@kernel
def misfit(rows, wide, tall, a, b):
    return line_fit.missed_by(rows, wide, tall, a, b)


@kernel
def both(a, b, F):
    """alpha; area under it; volume under the plane (a, 0, b) with it."""
    alpha = line_fit.line_offset(a, b, F)
    return alpha, line_fit.area_under(a, b, alpha), plic.volume_under((a, 0.0, b), alpha)


@kernel
def share(a, b, alpha):
    return line_fit.area_under(a, b, alpha)


EVEN = (1.0, 1.0)


def block(lines, wide=EVEN, tall=EVEN):
    """F (3 rows of 3) of what lies under all lines (a, b, alpha); of two lines that do not cross within a cell."""
    rows = []
    for z, h in ((-tall[0], tall[0]), (0.0, 1.0), (1.0, tall[1])):
        row = []
        for x, w in ((-wide[0], wide[0]), (0.0, 1.0), (1.0, wide[1])):
            shares = [share(a * w, b * h, alpha - a * x - b * z) for a, b, alpha in lines]
            row.append(sum(shares) - (len(shares) - 1))
        rows.append(tuple(row))
    return tuple(rows)


def angle_between(m, n):
    return abs(np.arctan2(m[0] * n[1] - m[1] * n[0], m[0] * n[0] + m[1] * n[1]))


def test_offset_is_the_inverse_of_the_area_and_the_plane_is_the_same():
    """To 1e-14 (4e-16 measured), small F and lines along an axis too."""
    rng = np.random.default_rng(2)
    for _ in range(500):
        a, b = rng.uniform(-1, 1, 2) * 10.0 ** rng.uniform(-6, 0, 2)
        F = rng.choice([rng.uniform(), 1e-9, 1.0 - 1e-9, 0.5])
        _, area, volume = both(a, b, F)
        assert area == pytest.approx(F, abs=1e-14)
        assert volume == pytest.approx(F, abs=1e-14)
    assert both(0.0, -2.0, 0.25) == (-1.5, 0.25, 0.25)


def test_a_line_is_found_from_a_wrong_start():
    """To 1e-12 rad on even cells (Pilliod and Puckett's proof), .03 on graded ones, where no slope need be exact."""
    rng = np.random.default_rng(3)
    for wide, tall, most in ((EVEN, EVEN, 1e-12), ((0.95, 1.05), (1.04, 0.96), 0.03)):
        for _ in range(300):
            way = rng.uniform(-np.pi, np.pi)
            m = (np.cos(way), np.sin(way))
            alpha = line_fit_offset(m, rng.uniform(0.02, 0.98))
            rows = block([(*m, alpha)], wide, tall)
            wrong = (np.cos(way + 0.7), np.sin(way + 0.7))
            assert misfit(rows, wide, tall, *wrong) > line_fit.MISSED
            assert angle_between(line(*wrong, rows, wide, tall), m) <= most


def line_fit_offset(m, F):
    return both(*m, F)[0]


def test_what_misses_little_is_kept():
    """The line of the heights, .05 rad off: it belongs to an arc, and the least misfit to that is not its tangent."""
    m = (0.3, 1.0)
    rows = block([(*m, line_fit_offset(m, 0.4))])
    near = (0.35, 1.0)
    assert misfit(rows, EVEN, EVEN, *near) <= line_fit.MISSED
    assert line(*near, rows, EVEN, EVEN) == near


def test_of_the_lines_along_both_axes_the_better_one_is_taken():
    """In random cells, unlike any surface, none that was found misses more than both centred slopes do."""
    rng = np.random.default_rng(4)
    for _ in range(300):
        F = np.clip(rng.uniform(-0.5, 1.5, (3, 3)), 0.0, 1.0)
        rows = tuple(tuple(float(f) for f in row) for row in F)
        weights = np.array([1.0, 2.0, 1.0])
        up, right = np.sign((F[2] - F[0]) @ weights), np.sign((F[:, 2] - F[:, 0]) @ weights)
        heights, widths = F.sum(0), F.sum(1)
        centred = (0.5 * (heights[0] - heights[2]), -up), (-right, 0.5 * (widths[0] - widths[2]))
        wrong = (float(right), float(up))  # into the liquid
        found = misfit(rows, EVEN, EVEN, *line(*wrong, rows, EVEN, EVEN))
        least = min(misfit(rows, EVEN, EVEN, *m) for m in centred)
        assert found <= max(least, line_fit.MISSED) + 1e-12


def test_a_mirrored_surface_gives_the_mirrored_line():
    """1e-12 (2e-15 measured); the tip of a finger, the same to both sides, points straight ahead."""
    rng = np.random.default_rng(5)
    for _ in range(300):
        F = np.clip(rng.uniform(-0.5, 1.5, (3, 3)), 0.0, 1.0)
        rows = tuple(tuple(float(f) for f in row) for row in F)
        flipped = tuple(row[::-1] for row in rows)
        a, b = line(0.4, 1.0, rows, EVEN, EVEN)
        c, d = line(-0.4, 1.0, flipped, EVEN, EVEN)
        assert (a + c, b - d) == pytest.approx((0.0, 0.0), abs=1e-12)
    tip = ((0.1, 0.9, 0.1), (0.0, 0.4, 0.0), (0.0, 0.0, 0.0))
    assert line(1.0, 1.0, tip, EVEN, EVEN) == (0.0, 1.0)


def test_a_second_surface_in_the_corner_turns_no_line():
    """Another body of liquid reaches into the three cells on the right: centred differences turn by .4 rad and more,
    a sided one does not know of it; the last step gives way by .06 (measured)."""
    m = (0.2, 1.0)
    rows = [list(row) for row in block([(*m, line_fit_offset(m, 0.5))])]
    rows[2][2] = 0.9
    rows = tuple(tuple(row) for row in rows)
    centred = 0.5 * (sum(row[0] for row in rows) - sum(row[2] for row in rows))
    assert angle_between((centred, 1.0), m) > 0.35
    assert angle_between(line(centred, 1.0, rows, EVEN, EVEN), m) <= 0.08
