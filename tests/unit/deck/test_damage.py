"""What is wrong with a single line: every trap of plain namelist readers, and every misspelling, is named."""

import pytest


def lines(error) -> list[tuple[int | None, str, str]]:
    return [(problem.line, problem.block, problem.variable) for problem in error.problems]


def test_title_with_digits_and_minus(read) -> None:
    """f90nml drops the first group when the title holds a token like 6-DOF."""
    deck = read("Coupled 6-DOF box, 2-way & $more\n&xput twfin=7. /\n&mesh /\n")
    assert deck["TWFIN"] == 7.0


def test_group_that_is_not_closed(error) -> None:
    """f90nml swallows the next group."""
    found = error("t\n&xput\n twfin=2.\n&mesh\n px=0.,1.\n/\n")
    assert lines(found) == [(2, "XPUT", "")] and "Write / before line 4" in str(found)
    assert lines(error("t\n&xput /\n&mesh\n px=0.,1.\n")) == [(3, "MESH", "")]


def test_group_that_lost_its_mark(error) -> None:
    """f90nml drops it."""
    found = error("t\n&xput /\n&mesh /\nobs\n nobs=1, imo(1)=4\n/\n")
    assert lines(found) == [(4, "OBS", "")] and "Write &obs" in str(found)
    assert lines(error("t\nxput twfin=1. /\n&mesh /\n")) == [(2, "XPUT", "")]


def test_lines_outside_blocks(error) -> None:
    """A / too early leaves assignments outside."""
    assert lines(error("t\n&xput\n twfin=2. /\n gz=-9.81,\n/\n&mesh /\n")) == [(4, "", "gz")]
    assert lines(error("t\n&xput twfin=2. / gz=-9.81,\n&mesh /\n")) == [(2, "", "gz")]
    assert lines(error("t\n&xput /\n&mesh /\n imo(1)=4, imo(2)=3\n")) == [(4, "", "imo")]


def test_element_set_twice(error) -> None:
    """f90nml keeps the last one; also as a list, in another block, and under an old name."""
    found = error(more="rhomvb(1)=2.,\n")
    assert lines(found) == [(11, "OBS", "rhomvb(1)")] and "in line 10 and in line 11" in str(found)
    listed = error(add_xput="tpltd=1,5,3.\n tpltd(2)=1.")
    assert lines(listed) == [(4, "XPUT", "tpltd(2)")]
    assert "in line 3 by tpltd=1,5,3. and in line 4" in str(listed)  # 1,5 may have been meant as 1.5
    assert lines(error(bcdata="wl=2, ibct(1)=2")) == [(6, "BCDATA", "ibct(1)")]


def test_group_that_stands_twice(error) -> None:
    """f90nml returns a cogroup."""
    found = error("t\n&xput /\n&mesh /\n&xput gz=1. /\n")
    assert lines(found) == [(4, "XPUT", "")] and "line 2" in str(found)


def test_indices_are_absolute(read) -> None:
    """f90nml returns x(2)=3 as a list that starts anywhere, and index order reversed."""
    deck = read(add_xput="tpltd(2)=3.,", bcdata="pbct(1,6)=5.")
    assert deck.at("TPLTD", 2) == 3.0 and deck.at("TPLTD", 1) == 0.1
    assert deck.at("PBCT", 1, 6) == 5.0 and deck.at("PBCT", 1, 5) == 0.0


@pytest.mark.parametrize(
    ("written", "variable", "hint"),
    [
        ("gz=abc", "gz", "is not a number"),
        ("gz='9.81'", "gz", "is not a number"),
        ("gz=nan", "gz", "finite"),
        ("gz=-Infinity", "gz", "finite"),
        ("gz=1e999", "gz", "too large"),
        ("gz=9,81", "gz", "here are 2: 9,81. Write gz=9.81, decimals behind a point"),
        ("gz=-9.81 # gravity", "gz", "here are 3: -9.81,#,gravity. Write gz= with one value"),
        ("gz=", "gz", "no value"),
        ("gz=1/2", "", "1/2 is no number; the / ends the block. Write the number itself"),
        ("resfile=‘abc’", "resfile", "Write resfile='abc'"),
        ("resfile='abc\n", "", "a quote is opened and not closed"),
        ("gz=1.0.0", "gz", "is not a number"),
        ("imobs2=1", "imobs2", "Did you mean imobs?"),
        ("imobs=1.5", "imobs", "Write imobs=2"),
        ("imobs=.true.", "imobs", "whole number"),
        ("imobs=99999999999", "imobs", "too large"),
        ("imobs(1)=1", "imobs(1)", "has no index"),
        ("iclid=2", "iclid=2", "must be one of 0, 1"),
        ("strngmob=1.1", "strngmob=1.1", "must be in 0 .. 1"),
        ("frcmob=-.1", "frcmob=-.1", "must be >= 0"),
        ("delt=0.", "delt=0.", "must be > 0"),
        ("resfile=abc", "resfile", "Write resfile='abc'"),
        ("imo(1)=4", "imo", "Move it to &obs"),
        ("mu1=1.", "mu1", "Move it to &props"),
        ("tpltd(0)=1.", "tpltd(0)", "is not in 1 .. 500"),
        ("tpltd(501)=1.", "tpltd(501)", "is not in 1 .. 500"),
        ("tpltd(499)=1.,1.,1.", "tpltd(499)", "index 501"),
        ("tpltd(1,2)=1.", "tpltd(1,2)", "one index is needed"),
        ("tpltd(x)=1.", "tpltd(x)", "is not an index"),
        ("tpltd(3:1)=1.", "tpltd(3:1)", "smaller one first"),
        ("tpltd(1:3)=1.", "tpltd(1:3)", "3*value"),
        ("tpltd=999999999*1.", "tpltd", "more values than"),
        ("gz(1=2", "", "cannot read gz(1=2"),
        ("remark='not closed\n", "", "quote"),
    ],
)
def test_one_wrong_line(error, written: str, variable: str, hint: str) -> None:
    """Each is one problem, in its line, and says what to write."""
    found = error(f"t\n&xput\n twfin=1.,\n {written}\n/\n&mesh /\n")
    assert [(problem.line, problem.variable) for problem in found.problems] == [(4, variable)]
    assert hint in str(found)


@pytest.mark.parametrize(
    ("obs", "variable", "hint"),
    [
        ("imo(1)=7", "imo(1)=7", "must be one of 0, 2, 3, 4"),
        ("iclidob(1)=1", "iclidob(1)", "2 indices are needed, not 1"),
        ("iclidob=1", "iclidob", "the index is missing"),
        ("obsid(1)=box", "obsid(1)", "Write obsid(1)='box'"),
        ("tjmvb(1,1,4)=1.", "tjmvb(1,1,4)", "is not in 1 .. 3"),
        ("rhomv(1)=1.", "rhomv", "Did you mean rhomvb?"),
        ("imo(2)=4", "imo(2)=4", "there is no component 2, nobs=1"),
    ],
)
def test_one_wrong_line_of_obs(error, obs: str, variable: str, hint: str) -> None:
    """The same in &obs, where a broken value must not bring further problems with it."""
    found = error(obs=f"nobs=1, iob(1)=1, xl(1)=0., xh(1)=1., {obs}")
    assert [problem.variable for problem in found.problems] == [variable]
    assert hint in str(found)


def test_blocks_that_are_missing_or_misspelt(error) -> None:
    """A near miss of a block's name is an error; only &xput and &mesh must be there."""
    assert [str(p) for p in error("t\n&limits /\n").problems] == [
        "deck.nml: there is no block &mesh. Add &mesh px(1)=0., px(2)=1., and so on /.",
        "deck.nml: there is no block &xput. Add &xput twfin=1.0 /.",
    ]
    (problem,) = error("t\n&xputt /\n&mesh /\n").problems
    assert "Write &xput" in str(problem)
    (problem,) = error("t\n&xput /\n&mesh /\n&obz nobs=1 /\n").problems
    assert "Write &obs" in str(problem)


def test_title_is_missing(error) -> None:
    """The first line is always the title: a block in it would be lost."""
    (problem,) = error("&xput twfin=2. /\n&mesh /\n").problems
    assert problem.line == 1 and "title" in problem.wrong


def test_all_problems_together(error) -> None:
    """In the order of their lines, reader and rules alike."""
    found = error("t\n&xput\n gz=abc,\n iclid=1,\n/\n&mesh\n px=0.,0.\n/\n&obs\n imoo=3\n/\n")
    assert [problem.line for problem in found.problems] == [3, 4, 7, 10]
