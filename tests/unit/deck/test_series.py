"""Tables of time, in the deck and in files."""

from pathlib import Path

import numpy as np
import pytest

from flowgmo.deck import DeckError, parse_deck

TIMES = "tobs=0.,1.,2.,"


def test_table_in_the_deck(read) -> None:
    """Velocities by component, boundary values by side, point loads by component and point."""
    deck = read(
        more=TIMES + "utobs(1,1)=0.,2.,1., igf(1)=2, fxtobsm(1,1,3)=5.,6.,7.,",
        bcdata="timbct(2)=4., pbct(1,6)=1.,3.",
    )
    t, y = deck.series("UTOBS", 1)
    assert t.tolist() == [0.0, 1.0, 2.0] and y.tolist() == [0.0, 2.0, 1.0]
    assert deck.series("fxtobsm", 1, 3).y.tolist() == [5.0, 6.0, 7.0]
    assert deck.series("PBCT", 6).t.tolist() == [0.0, 4.0] and deck.series("PBCT", 6).y.tolist() == [1.0, 3.0]
    assert all(column.dtype == np.float64 for column in deck.series("PBCT", 6))


def test_one_value_is_constant(read) -> None:
    """Also none, and one beside the longer table of another body."""
    deck = read(more=TIMES + "utobs(1,1)=0.,2.,1., vtobs(1,1)=3.")
    for series, value in (
        (deck.series("VTOBS", 1), 3.0),
        (deck.series("WTOBS", 1), 0.0),
        (deck.series("FBCT", 3), 1.0),
    ):
        assert series.t.tolist() == [0.0] and series.y.tolist() == [value]


@pytest.mark.parametrize(
    ("tables", "variable", "part"),
    [
        (TIMES + "utobs(1,1)=1.,2.", "utobs(3,1)", "the value at time 3"),
        (TIMES + "utobs(1,1)=1., utobs(3,1)=2.", "utobs(2,1)", "the value at time 2"),
        (TIMES + "utobs(2,1)=1.,2.", "utobs(1,1)", "the value at time 1"),
        (TIMES + "utobs(1,1)=1.,2.,3.,4.", "utobs(4,1)=4.0", "4 values and 3 times"),
        ("utobs(1,1)=1.,2.", "utobs(2,1)=2.0", "2 values and 1 times"),
        ("futobs(1)='gone.csv', iutobsc(1)=2", "futobs(1)='gone.csv'", "no such file"),
        ("futobs(1)='good.csv'", "futobs(1)='good.csv'", "Write iutobsc(1)=2"),
        ("futobs(1)='good.csv', iutobsc(1)=4", "iutobsc(1)=4", "has 3 columns"),
        ("futobs(1)='good.csv', iutobsc(1)=2, utobs(1,1)=1.", "futobs(1)='good.csv'", "Keep one"),
        ("futobs(1)='.', iutobsc(1)=2", "futobs(1)='.'", "not a plain file"),
        ("futobs(1)='/dev/zero', iutobsc(1)=2", "futobs(1)='/dev/zero'", "not a plain file"),
        ("futobs(1)='word.csv', iutobsc(1)=2", "futobs(1)='word.csv'", "word.csv:2: fast is not a finite number"),
        (
            "futobs(1)='back.csv', iutobsc(1)=2",
            "futobs(1)='back.csv'",
            "csv:3: the time 0.5 does not come after 1",
        ),
        ("futobs(1)='rag.csv', iutobsc(1)=2", "futobs(1)='rag.csv'", "rag.csv:2: 1 columns"),
        ("futobs(1)='nan.csv', iutobsc(1)=2", "futobs(1)='nan.csv'", "nan.csv:1: nan is not a finite"),
        ("futobs(1)='none.csv', iutobsc(1)=2", "futobs(1)='none.csv'", "no numbers"),
        ("futobs(1)='open.csv', iutobsc(1)=2", "futobs(1)='open.csv'", "not closed"),
        ("futobs(1)='bytes.csv', iutobsc(1)=2", "futobs(1)='bytes.csv'", "cannot be read"),
    ],
)
def test_wrong_tables(text, tmp_path: Path, tables: str, variable: str, part: str) -> None:
    """Each is one problem that names the element or the file and its line."""
    files = {
        "good": "0 1 2\n1 2 3\n",
        "word": "0 1\n1 fast\n",
        "back": "0 1\n1 2\n.5 3\n",
        "rag": "0 1\n1\n",
        "nan": "0 nan\n",
        "none": "# nothing\n",
        "open": "/* header\n0 1\n",
    }
    for name, content in files.items():
        (tmp_path / f"{name}.csv").write_text(content)
    (tmp_path / "bytes.csv").write_bytes(b"\xff\xfe0 1")
    with pytest.raises(DeckError) as caught:
        parse_deck(text(more=tables), tmp_path / "deck.nml")
    (problem,) = caught.value.problems
    assert problem.variable == variable and part in str(problem)


@pytest.mark.parametrize(
    "content",
    [
        "0 5 1\n2 6 3\n",
        "0,5,1\n2,6,3",
        "0;5;1\r\n2;6;3\r\n",
        "0\t5\t1\n\n2\t6\t3\n",
        "/* time, a, b\n more */\n0., 5., 1.d0 # here\n# and here\n+2.0e0 ,6, 3\n",
        "\ufeff 0 5 1,\n 2 6 3,\n",
    ],
)
def test_files(text, tmp_path: Path, content: str) -> None:
    """All separators and headers, beside the deck."""
    (tmp_path / "f.csv").write_text(content, encoding="utf-8")
    deck = parse_deck(text(more="futobs(1)='f.csv', iutobsc(1)=3, fomxtobs(1)='f.csv', iomxtobsc(1)=2"), tmp_path / "d")
    t, y = deck.series("UTOBS", 1)
    assert t.tolist() == [0.0, 2.0] and y.tolist() == [1.0, 3.0]
    assert deck.series("OMXTOBS", 1).y.tolist() == [5.0, 6.0]


def test_not_a_table(read) -> None:
    deck = read()
    for name, index in (("UTOBS", ()), ("UTOBS", (1, 2)), ("IMO", (1,))):
        with pytest.raises(KeyError):
            deck.series(name, *index)
