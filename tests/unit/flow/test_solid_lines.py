"""What is not read changes no bit: open fractions of lines that no solid comes near, and ghosts far from the liquid."""

import numpy as np
from flowgmo_wet_runs import REAL, advance, start

from flowgmo.flow.columns import all_columns
from flowgmo.flow.fields import Open
from flowgmo.flow.ghost_layers import GhostLayers
from flowgmo.flow.observe.measures import total
from flowgmo.flow.solid_lines import SolidLines

DAM = """Water runs against a block that does not fit the mesh, is thrown up and falls back
 &xput
  remark='SI units', twfin=1.0, delt=0.002, itb=1, ifvisc={viscous}, gz=-9.81,
 /
 &limits
 /
 &props
  units='si', rhof=1000.0, mu1={mu},
 /
 &bcdata
  ibct(1)=2, ibct(2)=2, ibct(3)=2, ibct(4)=2, ibct(5)=2, ibct(6)=2,
 /
 &mesh
  px(1)=0.0, px(2)=1.2, nxcelt=24, py(1)=0.0, py(2)=0.5, nycelt=10, pz(1)=0.0, pz(2)=0.8, nzcelt=16,
 /
 &obs
  nobs=1, obsid(1)='block', iob(1)=1, xl(1)=0.62, xh(1)=0.77, yl(1)=0.13, yh(1)=0.38, zl(1)=0.0, zh(1)=0.17,
 /
 &fl
  nfls=1, fxh(1)=0.42, fzh(1)=0.31,
 /
"""
STEPS = 70


def run(mu=0.0):
    """Time, totals, fields of the real cells after each step; sides that were ever far from the liquid; lines."""
    liquid, flow, first = start(DAM.format(viscous=int(mu > 0.0), mu=mu))
    columns, seen, far = all_columns(liquid.shape), [], np.zeros(6, bool)

    def note(t, flow):
        scene = liquid.grid, liquid.openings, flow, 1000.0, liquid.gravity, 1e-6
        whole = total(liquid.team, columns, *scene, planes=liquid.planes, solid_lines=liquid.solid_lines)
        far[:] |= liquid.sides.ghosts.far
        seen.append((t, whole, [a[REAL].copy() for a in (*flow.velocity, flow.p, flow.F)]))

    advance(liquid, flow, first, most=STEPS, each=note)
    return seen, far, liquid.lines


def assert_same(one, two):
    assert len(one) == len(two) == STEPS
    for (t0, whole, fields), (t1, other, others) in zip(one, two, strict=True):
        assert t0 == t1 and all(np.array_equal(a, b) for a, b in zip(fields, others, strict=True))
        assert np.allclose(whole, other, rtol=1e-13, atol=0.0)  # a b + c may be one operation in one of both sums


def test_lines_without_solids_change_no_bit(monkeypatch):
    for mu in (0.0, 2.0):
        seen, _, lines = run(mu)
        assert 0 < lines.sum() < 0.5 * lines.size
        assert max(fields[2][:, :, 5].max() for _, _, fields in seen) > 0.0  # water has met the block
        with monkeypatch.context() as patch:
            patch.setattr(SolidLines, "of", lambda self, opened: np.ones(opened.V.shape[:2], np.int8))
            anew, _, every = run(mu)
        assert every.all()
        assert_same(seen, anew)


def test_sides_far_from_the_liquid_change_no_bit(monkeypatch):
    seen, far, _ = run()
    assert far[1] and far[5] and not far[0] and not far[4]  # Xmax at first, Zmax; water stands at Xmin and on Zmin
    monkeypatch.setattr(GhostLayers, "stay_near", lambda self, columns: None)
    anew, none, _ = run()
    assert not none.any()
    assert_same(seen, anew)


def test_a_line_counts_where_a_fraction_beside_it_is_below_one():
    random = np.random.default_rng(5)
    shape = (9, 8, 7)
    for n in range(4):  # a single V, or a single face, is enough
        fractions = [np.ones(shape) for _ in range(4)]
        i, j, k = (int(random.integers(0, m)) for m in shape)
        fractions[n][i, j, k] = 0.9
        found = SolidLines(watched=True).of(Open(*fractions))
        for a in range(shape[0]):
            for b in range(shape[1]):
                assert found[a, b] == (abs(a - i) <= 1 and abs(b - j) <= 1)
        assert SolidLines().of(Open(*fractions)).all()  # nobody says what is written
    assert SolidLines(watched=True).of(Open(None, None, None, None)) is None


def test_lines_are_marked_at_once_and_taken_back_when_all_is_open():
    opened, lines = Open(*(np.ones((12, 11, 7)) for _ in range(4))), SolidLines(watched=True)
    assert not lines.of(opened).any()
    lines.mark(np.array([[5, 5, 3]], np.int32))
    expected = np.zeros((12, 11), bool)
    expected[4:7, 4:7] = True
    assert np.array_equal(lines.of(opened) != 0, expected)
    lines.renew(opened, np.array([[7, 5, 3]], np.int32))  # where it was, nothing is closed
    assert np.array_equal(lines.of(opened) != 0, np.roll(expected, 2, axis=0))
    opened.V[5, 5, 3] = 0.5
    lines.mark(np.array([[5, 5, 3]], np.int32))
    lines.renew(opened, np.zeros((0, 3), np.int32))
    assert np.array_equal(lines.of(opened) != 0, expected)
    lines.mark(np.array([[3, 5, 3]], np.int32))  # its image lies in a ghost, mirrored or on the other side
    assert lines.of(opened)[0, 5] and lines.of(opened)[-1, 5]
