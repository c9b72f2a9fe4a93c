"""The forms in which decks are written."""

import subprocess
import sys
import time
from pathlib import Path

import pytest

from flowgmo.deck import DeckError, Where, read_deck


def test_both_kinds_of_blocks(read) -> None:
    """& and $ blocks, any case, closed by /, $end or &end, also on one line."""
    deck = read("a title\n $XPUT\n TWFIN=3.,\n $END\n&Mesh px=0.,2. &end\n  &limits eps=.1 /  &obs nobs=0 $end\n")
    assert (deck["twfin"], deck.at("Px", 2), deck["EPS"], deck.title) == (3.0, 2.0, 0.1, "a title")


def test_titles_and_free_text(read) -> None:
    """Lines between and after blocks are ignored, tables after the last block too."""
    deck = read(
        "Title\nThis is a sample input file\n&xput twfin=2. /\nbetween: a=b\n&mesh /\nfree text\n"
        "#start tables:\n#fluid1:\ntwfin=99.\n#mu1t\n1.0 2.0\n#end mu1t\n#end start tables\n"
    )
    assert deck["TWFIN"] == 2.0 and deck.notices == []


@pytest.mark.parametrize(
    ("written", "name", "index", "value"),
    [
        ("twfin=120,", "TWFIN", (), 120.0),
        ("twfin = 1d-3", "TWFIN", (), 0.001),
        ("twfin=.5e+1 gz=0", "TWFIN", (), 5.0),
        ("twfin=0.003, remark='Simulation Finish Time',", "TWFIN", (), 0.003),
        ("remark='!! gui ' twfin=2. ! remark='x", "TWFIN", (), 2.0),
        ("remark=no quotes at all, remark='a=1, b(2)=3 /', twfin=2.", "TWFIN", (), 2.0),
        ("twfin\n =\n 2.", "TWFIN", (), 2.0),
        ("tpltd=1.,2.,3.", "TPLTD", (3,), 3.0),
        ("tpltd( 2 )=1.,\n 2.", "TPLTD", (3,), 2.0),
        ("tpltd(2:3)=1., 2.", "TPLTD", (3,), 2.0),
        ("tpltd=3*2.0", "TPLTD", (3,), 2.0),
        ("tpltd=1.,,3.", "TPLTD", (3,), 3.0),
        ("tpltd=2*,3.", "TPLTD", (3,), 3.0),
    ],
)
def test_values(read, written: str, name: str, index: tuple, value: float) -> None:
    """Whole numbers for reals, remarks, lists, repeats, gaps, ranges, Fortran's exponents."""
    found = read(xput=written, obs="nobs=0").at(name, *index)
    assert found == value and type(found) is type(value)


def test_gaps_stay_unset(read) -> None:
    deck = read(add_xput="tpltd=1.,,3.")
    assert deck.indices("TPLTD") == [(1,), (3,)] and not deck.given("TPLTD", 2) and deck.at("TPLTD", 2) == 0.1


def test_index_order_is_the_decks(read) -> None:
    """a(1, 5) with a blank; lists run along the first index; a range of two indices likewise."""
    bcdata = "timbct=0.,1., ubct(1, 5)=0., ubct(2,5)=2., vbct(1,3)=3.,4., wbct(1:2,1:2)=1.,2.,3.,4."
    deck = read(bcdata=bcdata)
    assert [deck.at("UBCT", *i) for i in ((1, 5), (2, 5))] == [0.0, 2.0]
    assert [deck.at("VBCT", *i) for i in ((1, 3), (2, 3))] == [3.0, 4.0]
    assert [deck.at("WBCT", *i) for i in ((1, 1), (2, 1), (1, 2), (2, 2))] == [1.0, 2.0, 3.0, 4.0]


def test_texts_and_logicals(read) -> None:
    deck = read(more="obsid(1)='it.s',", props="fluid1=\"it's\", fluid2='don''t'", flowgmo="sleep=f, impact='EXACT'")
    assert (deck["FLUID1"], deck["FLUID2"], deck.at("OBSID", 1)) == ("it's", "don't", "it.s")
    assert deck["SLEEP"] is False and deck["IMPACT"] == "exact" and deck["LUBRICATION"] is True


def test_effective_values_and_places(read) -> None:
    """Defaults that follow other variables; where a variable stands, where it would stand, nowhere."""
    deck = read()
    assert (deck["DELT"], deck["DTMIN"], deck.at("CRSTRNG", 1), deck.at("ICLIDOB", 1, 2)) == (1e-3, 1e-8, 1.0, 1)
    assert deck.at("RHOSUB", 1) == 1000.0 and deck.at("TJMVB", 1, 1, 2) == 0.0 and deck.at("TJMVB", 1, 1, 1) is None
    assert (deck.at("IVMCAL", 1), deck["IMPMOB"], deck["IFVOF"]) == (1, 1, 6)
    assert deck.given("IMO", 1) and deck.given("IMO") and not deck.given("IMO", 2) and not deck.given("GZ")
    assert deck.where("IMO", 1) == Where("deck.nml", 10, "OBS")
    assert deck.where("IMO", 2) == Where("deck.nml", 9, "OBS") and deck.where("RHOF") == Where(
        "deck.nml", None, "PROPS"
    )
    assert str(deck.problem("IMO", 1, wrong="so", write="Write thus")) == "deck.nml:10: &obs imo(1)=4: so. Write thus."
    with pytest.raises(KeyError):
        deck["NOTHING"]
    with pytest.raises(KeyError):
        deck.at("IMO", 1, 2)


def test_old_names(read) -> None:
    """WL .. WT, PLTDT .. and MUI, each with a notice."""
    deck = read(bcdata="wl=2, wt=3,", add_xput="pltdt=.3, sprtdt=.1,", props="mui=1.,")
    assert [deck.at("IBCT", side) for side in (1, 2, 6)] == [2, 1, 3]
    assert (deck.at("TPLTD", 1), deck.at("TSPRTD", 1), deck["MU1"]) == (0.3, 0.1, 1.0)
    assert [notice.variable for notice in deck.notices] == ["pltdt", "sprtdt", "wl", "wt", "mui=1.0"]


def test_unset_density_is_dry(read) -> None:
    """RHOF=-1 is the format's way to say that it is not given."""
    assert not read(props="rhof=-1.0").given("RHOF")


def test_unknown_blocks(read) -> None:
    """Blocks of other programs and versions are skipped with a notice."""
    deck = read("t\n&xput /\n&details f3d_version_number='12', /\n&whatever x=1 /\n&mesh /\n")
    assert [notice.line for notice in deck.notices] == [3, 4]


def test_mesh_blocks(read, error) -> None:
    """One block that is switched on is taken with its own boundaries; two are not computed."""
    two = "t\n&xput /\n&bcdata ibct=6*2 /\n&mesh px=0.,1. {} /\n&bcdata ibct=6*3 /\n&mesh px=0.,2. /\n"
    deck = read(two.format("if_mesh_enabled=0"))
    assert (deck.at("PX", 2), deck.at("IBCT", 1)) == (2.0, 3)
    (problem,) = error(two.format("")).problems
    assert problem.line == 6 and "known but not computed: 2 mesh blocks" in problem.wrong
    (problem,) = error("t\n&xput /\n&mesh if_mesh_enabled=0 /\n").problems
    assert "switched on" in problem.wrong


def test_files(tmp_path: Path) -> None:
    """Files that are no deck: one problem each, and no other exception."""
    empty, binary, folder = tmp_path / "empty", tmp_path / "binary", tmp_path / "folder"
    empty.write_text(" \n\n")
    binary.write_bytes(b"a title\n&xput \x00 /\n&mesh /")
    folder.mkdir()
    huge = tmp_path / "huge"
    with huge.open("wb") as file:
        file.truncate(10**10)
    prose = tmp_path / "prose"
    prose.write_text("Once upon a time there was a deck.\n")
    odd = tmp_path / "odd"
    odd.write_bytes(bytes([0x81, 0x8D]) * 9)
    (tmp_path / "real.nml").write_text("t\n&xput /\n&mesh /\n")
    for path in (empty, binary, folder, huge, prose, odd, tmp_path / "absent", tmp_path / "a\0b", "/dev/zero"):
        with pytest.raises(DeckError) as caught:
            read_deck(path)
        assert len(caught.value.problems) == 1, path
        assert str(caught.value)
    with pytest.raises(DeckError, match="real.nml"):
        read_deck(tmp_path / "absent")


def test_no_permission(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(_path: Path) -> bytes:
        raise PermissionError

    monkeypatch.setattr(Path, "read_bytes", refuse)
    path = tmp_path / "deck.nml"
    path.write_text("x")
    with pytest.raises(DeckError, match="permission"):
        read_deck(path)


def test_encodings_and_line_ends(tmp_path: Path) -> None:
    """UTF-8 with mark, Windows and old Mac line ends, Windows-1252 with a notice."""
    body = "a title\n&xput twfin=2. ! °C\n/\n&mesh /\n"
    path = tmp_path / "deck.nml"
    for raw in (
        body.encode("utf-8-sig"),
        body.replace("\n", "\r\n").encode() + b"\x1a",
        body.replace("\n", "\r").encode(),
        body.encode("cp1252"),
    ):
        path.write_bytes(raw)
        deck = read_deck(path)
        assert deck["TWFIN"] == 2.0 and deck.title == "a title"
    assert "Windows-1252" in str(deck.notices[0])


def test_time_and_imports(tmp_path: Path) -> None:
    """200 bodies in less than 0.5 s (0.07 s when written); nothing heavy is imported for it."""
    path = tmp_path / "deck.nml"
    body = " imo({m})=4, rhomvb({m})=1., iob({m})={m}, xl({m})=0., xh({m})=1., zl({m})={m}., zh({m})={m}.5,\n"
    path.write_text(
        "t\n&xput imobs=1 /\n&mesh /\n&obs nobs=200\n" + "".join(body.format(m=m) for m in range(1, 201)) + "/\n"
    )
    start = time.perf_counter()
    read_deck(path)
    assert time.perf_counter() - start < 0.5
    code = "import sys, flowgmo.deck; print(sorted({'numba', 'scipy', 'h5py', 'pyvista'} & set(sys.modules)))"
    assert subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout == "[]\n"
