"""What is off compiles nothing: kernels of viscosity in scenes with and without it."""

import subprocess
import sys
from pathlib import Path

import pytest

HELPERS = Path(__file__).parents[2] / "helpers"
SCRIPT = """
import importlib, pkgutil, sys
sys.path.insert(0, sys.argv[1])
from flowgmo_wet import wet
from flowgmo_wet_runs import advance, start
import flowgmo.flow.momentum as momentum

solid = "nobs=1, iob(1)=1, rsh(1)=.4, trnx(1)=1.3, trny(1)=.5,"
dam = "nfls=1, fxh(1)=.8, fzh(1)=1.,"
deck = wet("twfin=1., itb=1, gz=-9.81, delt=.005," + sys.argv[2], props="rhof=1000., mu1=5.,", fl=dam, obs=solid)
advance(*start(deck), most=2)
for name in ("viscosity", "implicit_viscosity", "cut_viscosity", "viscous_work", "wall_shear"):
    module = importlib.import_module(f"flowgmo.flow.momentum.{name}")
    own = [a for a in vars(module).values() if getattr(a, "__module__", "") == module.__name__]
    print(name, sum(len(getattr(kernel, "signatures", ())) for kernel in own))
"""


def signatures(xput):
    """Signatures for which the kernels of each module of viscosity are compiled, or loaded, after two steps."""
    command = [sys.executable, "-c", SCRIPT, str(HELPERS), xput]
    said = subprocess.run(command, capture_output=True, text=True, check=True).stdout
    return {name: int(count) for name, count in map(str.split, said.splitlines())}


@pytest.mark.parametrize(("xput", "acting"), [
    ("ifvisc=0,", set()),
    ("ifvisc=1,", {"viscosity", "cut_viscosity", "viscous_work", "wall_shear"}),
    ("ifvisc=1, impvis=1,", {"viscosity", "implicit_viscosity", "cut_viscosity", "viscous_work", "wall_shear"}),
])  # fmt: skip
def test_kernels_of_viscosity(xput, acting):
    """mu1 is given in all three. A signature without IFVISC would be code in the step of a scene that did not ask."""
    found = signatures(xput)
    assert len(found) == 5
    assert {name for name, count in found.items() if count} == acting
