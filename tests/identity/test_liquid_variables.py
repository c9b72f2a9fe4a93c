"""Every variable of the registry that acts on the liquid does: another value gives another run.

One scene for each, stepped four times: values of all gauges, and the fields, are compared bit for bit. A variable that
reaches the plan and is used by nobody, or a table that is read at t = 0 only, is found here.
"""

import pickle
import re
from pathlib import Path

import numpy as np
import pytest

from flowgmo.building import build_model
from flowgmo.deck import parse_deck
from flowgmo.errors import StepTooLong
from flowgmo.state import initial_state
from flowgmo.step import liquid_values, prepare, start_liquid, step

BASE = {
    "xput": "twfin=2., itb=1, gz=-9.81, gx=1., delt=.002",
    "limits": "",
    "props": "rhof=1000.",
    "bcdata": "",
    "mesh": "px=0., 2., nxcelt=14, py=0., 1., nycelt=7, pz=0., 1.5, nzcelt=10",
    "obs": "",
    "fl": "nfls=1, fxh(1)=.83, fyh(1)=.77, fzh(1)=1.03",
    "grafic": "xloc(1)=.3, yloc(1)=.5, zloc(1)=.2",
    "flowgmo": "",
}
VISCOUS = {"xput": BASE["xput"] + ", ifvisc=1", "props": "rhof=1000., mu1=20.", "bcdata": "ibct=2,2,2,2,2,2"}
INFLOW = {"bcdata": "ibct=6,5,1,1,1,1, ubct(1,1)=1."}
PRESSED = {"bcdata": "ibct=5,1,1,1,1,1, pbct(1,1)=3000., flhtbct(1,1)=.7, ihpbct(1)=0"}
LID = {**VISCOUS, "bcdata": "ibct=2,2,2,2,2,2, timbct(2)=1., ubct(1,5)=0., ubct(2,5)=.5"}
BOX = {"obs": "nobs=1, iob(1)=1, xl(1)=.61, xh(1)=1.07, yl(1)=.21, yh(1)=.71, zl(1)=-1., zh(1)=.43, ifrco(1)=1"}
BALL = {"obs": "nobs=1, iob(1)=1, rsh(1)=.4, trnx(1)=.9, trny(1)=.5, trnz(1)=.33"}
POOL = {"fl": BASE["fl"] + ", flht=.6"}
QUADRIC = {"fl": "nfls=1, fcc(1)=-1., fcx(1)=1., fcz(1)=1., fcx2(1)=.1"}
TURNED = {"fl": BASE["fl"] + ", frotx(1)=20., froty(1)=20., frotz(1)=30."}
PLANE = {"flowgmo": "planex(1)=.5"}

CASES = [
    ("xput", "autot=0.", {"fl": "flht=.5"}), ("xput", "con=.2", {"fl": BASE["fl"] + ", ureg(1)=9."}),
    ("xput", "confs=.3", {"xput": "twfin=2., itb=1, gz=-9.81, delt=.05"}), ("xput", "itb=0", {}),
    ("xput", "ifvisc=0", VISCOUS), ("xput", "iwsh=0", VISCOUS), ("xput", "impvis=1", VISCOUS), ("xput", "ipdis=1", {}),
    ("xput", "iorder=1", {}), ("xput", "ifvof=4", {}), ("xput", "epsadj=1e-3", {}), ("xput", "igmres=0", {}),
    ("limits", "eps=.3", BALL), ("limits", "itmax=1", {}),
    ("props", "rhof=900.", {}), ("props", "mu1=50.", VISCOUS), ("props", "rcsql=1e-5", {}),
    ("props", "ipgauge=0", {"props": "rhof=1000., p_reference=1e5"}),
    ("props", "p_reference=9e4", {"props": "rhof=1000., p_reference=1e5, ipgauge=0"}),
    ("bcdata", "timbct(2)=.01, ubct(2,1)=2.", INFLOW), ("bcdata", "ubct(1,1)=2.", INFLOW),
    ("bcdata", "ubct(2,5)=1.", LID),
    ("bcdata", "vbct(1,1)=1.", INFLOW), ("bcdata", "wbct(1,1)=1.", INFLOW), ("bcdata", "fbct(1,1)=.5", INFLOW),
    ("bcdata", "pbct(1,1)=4000.", PRESSED), ("bcdata", "ihpbct(1)=1", PRESSED), ("bcdata", "ipbctp(1)=0", PRESSED),
    ("bcdata", "flhtbct(1,1)=.4", {"bcdata": PRESSED["bcdata"].replace("ihpbct(1)=0", "ihpbct(1)=1")}),
    ("obs", "ifrco(1)=0", BOX), ("obs", "ifwetar(1)=1", BOX), ("obs", "iavrck=1", BALL),
    ("obs", "avrck=1.2", {"obs": BALL["obs"] + ", iavrck=1"}), *(("obs", f"{a}frco(1)=.5", BOX) for a in "xyz"),
    ("fl", "iflinittyp=0", POOL), ("fl", "flht=.3", POOL), ("fl", "vlin=.5", {}), ("fl", "pvoid=100.", {}),
    ("fl", "presi=500.", {}), ("fl", "nfls=2, frsh(2)=.9", {}), ("fl", "fioh(1)=0", POOL),
    ("fl", "if_flreg_enabled(1)=0", POOL),
    *(("fl", f"{a}i=.5", {}) for a in "uvw"), *(("fl", f"{a}reg(1)=.5", {}) for a in "uvw"),
    *(("fl", f"f{a}{end}(1)=.33", {}) for a in ("x", "y", "z", "ra") for end in "lh"),
    ("fl", "frsl(1)=.33", {}), ("fl", "frsh(1)=.7", {}), ("fl", "fangll(1)=20.", {}), ("fl", "fanglh(1)=50.", {}),
    ("fl", "fconel(1)=20.", {}), ("fl", "fconeh(1)=50.", {}), ("fl", "freg(1)=.7", {}), ("fl", "preg(1)=700.", {}),
    ("fl", "fcc(1)=-.7", QUADRIC),
    *(("fl", f"fc{c}(1)=.6", QUADRIC) for c in ("x", "y", "z", "xy", "xz", "yz", "x2", "y2", "z2", "rxy")),
    *(("fl", f"frot{a}(1)=20.", {}) for a in "xyz"), *(("fl", f"ftrn{a}(1)=.2", {}) for a in "xyz"),
    *(("fl", f"fmagn{a}(1)=1.3", {}) for a in ("", "x", "y", "z")), *(("fl", f"f{a}trfc(1)=.3", TURNED) for a in "xyz"),
    *(("grafic", f"{a}loc(1)=.41", {}) for a in "xyz"), ("grafic", "if_probe_enabled(1)=0", {}),
    *(("flowgmo", f"plane{a}(2)=.5", {}) for a in "xyz"),
    *(("flowgmo", f"plane{a}{end}(1)=.3", PLANE) for a in "yz" for end in "lh"),
    *(("flowgmo", f"planex{end}(1)=.3", {"flowgmo": "planez(1)=.5"}) for end in "lh"),
]  # fmt: skip
#: of bodies that move in the liquid, or with one value only, or (VFCLEAN) in tests/unit/flow/test_clean_up.py,
#: (FFSTL) tests/unit/building/test_liquid_of_files.py; MUI: MU1
ELSEWHERE = {
    "impmob", "wetimpact", "lubrication", "filmrough", "ibuoyo", "ipref", "prefmbw", "ifdis", "npmov",
    "ifpk", "vfclean", "mui", "ffstl",
}  # fmt: skip
done: dict[str, bytes] = {}


def deck(changed, block="", lines=""):
    """The base scene with blocks changed, then lines of one block, which take the place of those given before."""
    blocks = {**BASE, **changed}
    if block:
        for name in re.findall(r"([a-z_0-9]+(?:\([0-9,]+\))?)=", lines):
            blocks[block] = re.sub(rf"(^|,\s*){re.escape(name)}=[^,]+(?=,|$)", "", blocks[block])
        blocks[block] = ", ".join(text for text in (blocks[block].strip(" ,"), lines) if text)
    return "t\n" + "".join(f"&{name}\n{text}\n/\n" for name, text in blocks.items())


def run(text):
    """Everything that is known of the liquid at the start and after four steps, as bytes."""
    if text not in done:
        model = build_model(parse_deck(text, Path("t.nml")))
        world, state = prepare(model), initial_state(model)
        start_liquid(world, state)
        out = [liquid_values(world, state), state.fluid.p.copy()]
        for _ in range(4):
            dt = min(world.liquid.longest_step(state.fluid, model.clock.dt), model.clock.dt_max.spacing[0])
            for _ in range(20):
                try:
                    step(world, state, state.t + dt, np.zeros(0), landing=False)
                    break
                except StepTooLong:
                    dt *= 0.5
        fluid = state.fluid
        done[text] = pickle.dumps([*out, state.t, *fluid.velocity, fluid.p, fluid.F, liquid_values(world, state)])
    return done[text]


@pytest.mark.parametrize("block, lines, changed", CASES, ids=[lines for _, lines, _ in CASES])
def test_another_value_gives_another_run(block, lines, changed):
    assert run(deck(changed, block, lines)) != run(deck(changed))


def test_every_variable_is_tried():
    """Those that the reference calls computed for liquid."""
    page = Path(__file__).parents[2] / "docs" / "deck-reference.md"
    rows = re.findall(r"^\| `(\w+)(?:\([^`]*\))?` .*computed, for liquid", page.read_text(), re.MULTILINE)
    tried = {name for _, lines, _ in CASES for name in re.findall(r"([a-z_]\w*)(?:\([0-9,]+\))?=", lines)}
    assert set(rows) - tried == ELSEWHERE
