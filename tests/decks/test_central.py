"""decks/central: report 4.1, Table 1."""

import pytest


@pytest.mark.parametrize("deck", ["elastic", "plastic", "partial"])
def test_table_1(deck, runs):
    # Measured: 0, bit for bit. 1e-12 would reveal an impact that is stepped through instead of solved.
    runs.agree("central", deck, 1e-12)


@pytest.mark.parametrize("deck", ["elastic", "plastic", "partial"])
def test_one_impact_at_its_time(deck, runs):
    # Measured: 3e-17 s. The impact lies on the end of step 40 of 0.001 s: a search step by step would find it twice or
    # late.
    curves = runs.curves("central", deck)
    assert len(curves.impacts["time"]) == 1
    assert abs(curves.impacts["time"][0] - 0.04) <= 1e-12


def test_plastic_spheres_stay_together(runs):
    # Measured: 1e-17 m. A gap would reveal a rebound, an overlap a missed contact (1e-12 of 4 cm).
    curves = runs.curves("central", "plastic")
    gap = curves.at("right", "position")[0] - curves.at("left", "position")[0] - 0.08
    assert abs(gap) <= 4e-14
