"""Decks of impacts in liquid, of a valve, and of a hemisphere that heaves."""

import pytest


@pytest.mark.parametrize("deck", ["wet", "dry"])
def test_log_against_a_post(runs, deck):
    # VALIDATION E: -e within 2 % with a wet impact; with a dry one it goes on at (C_a - e r) / (r + C_a): .48 with the
    # 1.07 of C_a that the share of the impulse gives in this tank. Measured: -.6294 and .4807; share .6818. What the
    # liquid gets at the impact and what the next pressure takes back must agree, or the log would leave with another
    # speed than the law's.
    found = runs.measure.measure(runs.results("log", deck), "log", deck)
    assert found["energy lost over the law's"] == pytest.approx(1.0, abs=0.01)
    if deck == "wet":
        assert found["speed after over before"] == pytest.approx(-0.632, rel=0.02)
        assert found["liquid's share of the impulse"] == pytest.approx(2.0 / 3.0, rel=0.03)
    else:
        assert found["liquid's share of the impulse"] == 0.0
        share = runs.measure.measure(runs.results("log", "wet"), "log", "wet")["liquid's share of the impulse"]
        added = 0.5 * share / (1.0 - share)
        assert found["speed after over before"] == pytest.approx((added - 0.5 * 0.632) / (0.5 + added), rel=0.02)


def changed(runs, case, deck, name, *changes):
    """Results folder of a copy of the deck with pieces of its text exchanged: pairs (old, new)."""
    text = (runs.measure.DECKS / case / f"{deck}.nml").read_text()
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    path = runs.folder / f"{case}_{deck}_{name}.nml"
    path.write_text(text)
    return runs.compute(path, path.with_suffix(".out"))


def closes(found, leak, void):
    """It meets the seat, bounces, and stays; then hardly anything leaks and no void is left beneath or above it.

    The bounce: .3 of .52 m/s, against 3.4 N (weight less buoyancy, 1000 Pa on the hole) on ball and water of .52 kg
    would take 48 ms; seen 37, since water is drawn through the gap. The film between ball and seat takes 3 % of that.
    Counted once for each place that the contact engine sees it took all, and the ball rested at .092 s.
    """
    assert found["time of closing"] == pytest.approx(0.086, rel=0.03)
    assert found["time of rest"] == pytest.approx(0.137, rel=0.06)  # .1305 to .1400, .1320 now
    assert found["leak over largest flow"] <= leak
    # 2.9 N of the 1000 Pa press on the circle where it touches, buoyancy is 2.6 N: a third of the difference leaks away
    assert abs(found["load on the closed ball"] + 0.2735) <= 0.15 * 2.9
    assert found["most void"] <= void
    assert found["void of the closed valve"] <= void
    assert found["volume error"] <= 1e-10


def test_valve_closes_on_a_coarse_mesh(runs):
    # 11 cells across the ball. Measured: .0856 and .132 s, leak 5.8 %, -.44 N, voids 3e-7 of the ball (.0028 to .0046
    # where the ball goes by the mean of its velocities). A seat that the mesh does not close would leak a third, a ball
    # that bounces on would not rest.
    cells = [("nxcelt=24, nycelt=24, nzcelt=48", "nxcelt=16, nycelt=16, nzcelt=32")]
    found = runs.measure.measure(changed(runs, "valve", "valve", "coarse", *cells), "valve", "valve")
    closes(found, 0.08, 3e-5)


@pytest.mark.slow
def test_valve_closes(runs):
    # 16 cells across. Measured: .0855 and .1309 s (without film .1362), leak 3.3 %, -.45 N, voids 3e-7 of the ball.
    closes(runs.measure.measure(runs.results("valve", "valve"), "valve", "valve"), 0.045, 3e-5)


def lag(dt, added):
    """What a load that lags by half a step takes from the damping: (3/2 - a) omega dt / 2, 3/2 of still water."""
    return 0.5 * (1.5 - added) * 9.81**0.5 * dt


def test_hulme_on_a_coarse_mesh(runs):
    # 5 cells a radius, steps of .014 s. Measured: .4186 and .2263 (-2.3, -9 %); damping .250 without the lag of half a
    # step (+.6 %). Waves that come back, or a level that follows the body, would shift both by 5 %.
    coarse = [
        ("tdtmax(1)=0.005", "tdtmax(1)=0.014"),
        *[(f"n{a}cell=16,26, size{a}=.1,.1,1.2", f"n{a}cell=8,17, size{a}=.2,.2,1.6") for a in "xy"],
        ("nzcell=9,16, sizez=.6,.1,.1", "nzcell=7,8, sizez=.7,.2,.2"),
    ]  # fmt: skip
    found = runs.measure.measure(changed(runs, "hulme", "hulme", "coarse", *coarse), "hulme", "hulme")
    assert found["added mass"] == pytest.approx(0.4284, rel=0.04)
    assert found["damping"] + lag(0.014, found["added mass"]) == pytest.approx(0.2484, rel=0.04)
    assert found["volume error"] <= 1e-10


@pytest.mark.slow
def test_hulme(runs):
    # VALIDATION E: 5 %. Measured: .4255 and .2431 (-.7, -2.1 %), the lag of half a step among it (.0084).
    found = runs.measure.measure(runs.results("hulme", "hulme"), "hulme", "hulme")
    assert found["added mass"] == pytest.approx(0.4284, rel=0.05)
    assert found["damping"] == pytest.approx(0.2484, rel=0.05)
    assert found["volume error"] <= 1e-10
