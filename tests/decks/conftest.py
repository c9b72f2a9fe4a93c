"""Runs of the decks in decks/, each made once, and what decks/measure.py reads from them."""

import importlib.util
from pathlib import Path

import pytest

DECKS = Path(__file__).parents[2] / "decks"


def _measure_module():
    spec = importlib.util.spec_from_file_location("decks_measure", DECKS / "measure.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


class Runs:
    """Results of decks by (case, deck), computed at the first use."""

    def __init__(self, folder):
        self.folder, self.measure = folder, _measure_module()
        self._done = {}

    def results(self, case, deck):
        """The results folder of decks/<case>/<deck>.nml."""
        if (case, deck) not in self._done:
            self._done[case, deck] = self.compute(DECKS / case / f"{deck}.nml", self.folder / case / f"{deck}.out")
        return self._done[case, deck]

    def compute(self, path, folder):
        """Run the deck at `path` into `folder`; returns the folder."""
        from flowgmo.building import build_model
        from flowgmo.deck import read_deck
        from flowgmo.results_folder import prepare_folder
        from flowgmo.run import DONE, run

        model = build_model(read_deck(path), folder)
        prepare_folder(folder, overwrite=False, restart=False)
        assert run(model, folder, None, "tests/decks") == DONE
        return folder

    def varied(self, case, deck, name, **values):
        """A run of the deck with other values in its &xput, which it must give: delt=0.1 replaces 'delt=...,'."""
        lines = (DECKS / case / f"{deck}.nml").read_text().replace(",", ",\n")
        for variable, value in values.items():
            start = lines.index(f"{variable}=")
            lines = lines[:start] + f"{variable}={value}" + lines[lines.index(",", start) :]
        path = self.folder / f"{name}.nml"
        path.write_text(lines.replace(",\n", ","))
        return self.compute(path, self.folder / f"{name}.out")

    def curves(self, case, deck):
        return self.measure.Curves(self.results(case, deck))

    def agree(self, case, deck, bounds):
        """Measured against reference.csv: |difference| <= bound for every quantity; `bounds` one number or by name."""
        found = self.measure.measure(self.results(case, deck), case, deck)
        expected = self.measure.reference(case, deck)
        assert set(found) == set(expected)
        for name, (value, unit) in expected.items():
            bound = bounds[name] if isinstance(bounds, dict) else bounds
            assert abs(found[name] - value) <= bound, f"{name}: {found[name]!r}, reference {value!r} {unit}"


@pytest.fixture(scope="session")
def runs(tmp_path_factory):
    return Runs(tmp_path_factory.mktemp("decks"))
