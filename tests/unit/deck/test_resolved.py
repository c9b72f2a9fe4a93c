"""The resolved deck reads back to the same values, whatever the deck holds."""

import math
from pathlib import Path

from hypothesis import given, settings
from hypothesis import strategies as st

from flowgmo.deck import Deck, parse_deck
from flowgmo.deck.row import show
from flowgmo.deck.variables import REGISTRY

HERE = Path("deck.nml")
NUMBERS = st.floats(allow_nan=False, allow_infinity=False)
POSITIVE = st.floats(1e-300, 1e300)
PART = st.floats(0.0, 1.0)
TEXTS = st.text(st.characters(codec="utf-8", exclude_categories=("C", "Z")), max_size=30)
# Variables of a body that may take any value of their range without breaking a rule.
BODY = {
    **dict.fromkeys(("TRNX", "ROTY", "XTRFC", "CC", "CXY", "CZ2", "GROTZ", "GTRNX", "XAXS0", "XREF0"), NUMBERS),
    **dict.fromkeys(("MAGN", "MAGNX", "GMAGN", "RHOMVB", "CFRC", "DXMCMIN"), POSITIVE),
    **dict.fromkeys(("UAMP", "UFRE", "UPHS", "OMXAMP"), NUMBERS),
    **dict.fromkeys(("XL", "ZL", "RAL"), st.floats(-1e300, -1.0)),
    **dict.fromkeys(("XH", "ZH", "RAH"), st.floats(0.0, 1e300)),
    "CRSTRNG": PART,
    "MATERIAL": TEXTS,
    "IUPRE": st.integers(0, 1),
    "IGTRFMVB": st.integers(0, 1),
}
WHOLE = {
    **{"GX": NUMBERS, "GZ": NUMBERS, "STRNGMOB": PART, "FRCMOB": POSITIVE, "TWFIN": POSITIVE, "HERTZ": POSITIVE},
    **{"TOUCH": PART, "SLEEP": st.booleans(), "FLUID1": TEXTS, "ICLID": st.integers(0, 1), "LPR": st.integers(0, 9)},
    **{"ITB": st.integers(0, 1), "RESTART_DT": POSITIVE, "SIZE": st.floats(0.01, 10.0)},
}


@st.composite
def decks(draw: st.DrawFn) -> Deck:
    """A deck of up to three bodies with random values, tables, and pairs."""
    blocks: dict[str, list[str]] = {"xput": ["imobs=1"], "mesh": ["px=-1.,1."], "obs": []}
    nobs = draw(st.integers(1, 3))
    blocks["obs"].append(f"nobs={nobs}")
    for name in draw(st.sets(st.sampled_from(sorted(WHOLE)))):
        blocks.setdefault(REGISTRY[name].block.lower(), []).append(f"{name}={show(draw(WHOLE[name]))}")
    times = draw(st.lists(st.floats(1e-3, 1e3), min_size=1, max_size=4, unique=True).map(sorted))
    blocks["obs"] += [f"tobs(1)={', '.join(['0.', *map(repr, times)])}"]
    for m in range(1, nobs + 1):
        body = [f"imo({m})={draw(st.sampled_from((0, 3, 4)))}", f"iob({m})={m}", f"rhosub({m})=1.", f"iclidob({m},1)=1"]
        for name in draw(st.sets(st.sampled_from(sorted(BODY)), max_size=8)):
            body.append(f"{name}({m})={show(draw(BODY[name]))}")
        if draw(st.booleans()):
            values = draw(st.lists(NUMBERS, min_size=len(times) + 1, max_size=len(times) + 1))
            body.append(f"utobs(1,{m})={', '.join(map(repr, values))}")
        blocks["obs"] += body
    text = "".join(f"&{name}\n  " + "\n  ".join(lines) + "\n/\n" for name, lines in blocks.items())
    return parse_deck(f"a title\n{text}", HERE)


def values_of(deck: Deck) -> dict:
    """All effective values that a deck of up to three bodies has, by name and index."""
    found = {}
    for row in REGISTRY.values():
        if row.cls in ("computed", "accepted"):
            axes = {"t": range(1, 6), "side": range(1, 7), "i": (1, 2, 3), "j": (1, 2, 3), "mf": (1,)}
            indices = [()]
            for letter in row.shape:
                indices = [(*index, k) for index in indices for k in axes.get(letter, (1, 2, 3))]
            found |= {(row.name, *index): deck.at(row.name, *index) for index in indices}
    return found


def marked(text: str) -> dict[str, str]:
    """deck or default, by element."""
    lines = [line.strip() for line in text.split("\n") if "=" in line]
    return {line.partition("=")[0]: line.rpartition("! ")[2] for line in lines}


@settings(max_examples=60, deadline=None, derandomize=True)
@given(decks())
def test_round_trip(deck: Deck) -> None:
    """Every effective value, the tables, and the title; the second resolved deck only differs in its marks."""
    text = deck.resolved()
    again = parse_deck(text, HERE)
    before, after = values_of(deck), values_of(again)
    assert {key for key in before if before[key] != after[key]} == set()
    assert again.title == deck.title
    for m in range(1, deck["NOBS"] + 1):
        for one, other in zip(deck.series("UTOBS", m), again.series("UTOBS", m), strict=True):
            assert one.tolist() == other.tolist()
    once, twice = text.replace("! default", "! deck"), again.resolved().replace("! default", "! deck")
    assert once == twice


def test_marks(read) -> None:
    """Each line says where its value comes from; only what has a value is written, liquid only where it is."""
    deck = read(add_xput="gz=-9.81, ifsft=0,")
    marks = marked(deck.resolved())
    assert (
        marks["gz"] == "deck" and marks["gx"] == "default" and marks["ifsft"] == "deck" and marks["delt"] == "default"
    )
    assert marks["xl(1)"] == "deck" and "yl(1)" not in marks and "massmvb(1)" not in marks and "con" not in marks
    assert deck.resolved().index("&xput") < deck.resolved().index("&mesh") < deck.resolved().index("&obs")


def test_files_are_named_from_the_other_folder(text, tmp_path: Path) -> None:
    """Beside the results the names of tables and STL files still lead to the files."""
    (tmp_path / "f.csv").write_text("0 1\n1 2\n")
    (tmp_path / "s.stl").write_text("solid\nendsolid\n")
    more = "futobs(1)='f.csv', iutobsc(1)=2, igen(1)=3, fstl(1)='s.stl'"
    deck = parse_deck(text(more=more), tmp_path / "deck.nml")
    out = tmp_path / "deck.out"
    out.mkdir()
    again = parse_deck(deck.resolved(out), out / "deck.resolved.nml")
    assert again.series("UTOBS", 1).y.tolist() == [1.0, 2.0] and math.isinf(again.at("YL", 1))
    assert parse_deck(deck.resolved(), tmp_path / "x").at("FSTL", 1) == "s.stl"


def test_title_that_looks_like_a_block(read) -> None:
    """A deck without a title has a problem; a resolved deck always has one."""
    deck = read("\n&xput /\n&mesh /\n")
    assert parse_deck(deck.resolved(), HERE).title == "no title"
