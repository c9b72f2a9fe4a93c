"""The package's shape (DESIGN 2, 3, 8): imports point one way, `check` loads no kernels, deck names stay in the deck,
a dry scene makes no array of mesh size."""

import ast
import subprocess
import sys
import tomllib
import tracemalloc
from pathlib import Path

import pytest

import flowgmo

PACKAGE = Path(flowgmo.__file__).parent
ROOT = PACKAGE.parent

#: What each part may import from the package. `deck` and `geometry` know nobody; the physics does not know the deck.
BASE = {"errors", "kernel", "compiler", "vectors", "records"}
MODEL = {"bodies.body", "flow_plan", "mesh", "model"}
MAY = {
    "deck": {"errors"},
    "geometry": {"errors"},
    "bodies": BASE | {"bodies", "geometry", "mesh", "model", "state"},
    "collision": BASE | {"collision", "bodies", "geometry", "mesh", "model", "state", "world"},
    "output": BASE
    | {"output", "bodies.body", "bodies.energy", "flow.fields", "geometry", "mesh", "model", "state", ""},
    "building": {"building", "deck", "flow_plan", "geometry", "mesh", "model", "bodies.body", "errors"},
    "flow_plan": {"geometry", "mesh"},
    "model": MODEL | {"geometry"},
    "state": {"flow.fields", "model"},
    "flow": BASE | {"flow", "flow_plan", "mesh", "model", "state"},
    "records": set(),
    "mesh": set(),
    "vectors": {"kernel"},
    "kernel": {"", "compiler"},
    "compiler": {""},
    "errors": set(),
}


def modules():
    return {".".join(p.relative_to(PACKAGE).with_suffix("").parts): p for p in PACKAGE.rglob("*.py")}


def absolute(name, node):
    """Names inside the package that an import statement of module `name` loads."""
    if isinstance(node, ast.Import):
        return [a.name.removeprefix("flowgmo").lstrip(".") for a in node.names if a.name.split(".")[0] == "flowgmo"]
    if node.level:
        parts = name.split(".")[: -node.level] if node.level else []
        return [".".join([*parts, *([node.module] if node.module else [])])]
    if (node.module or "").split(".")[0] != "flowgmo":
        return []
    inside = node.module.removeprefix("flowgmo").lstrip(".")
    return (
        [inside]
        if inside
        else [a.name if a.name in modules() or (PACKAGE / a.name).is_dir() else "" for a in node.names]
    )


def imports(name, path):
    """Imports of a module, but those for type checkers only."""
    tree = ast.parse(path.read_text())
    hidden = {
        id(inner)
        for node in ast.walk(tree)
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING"
        for inner in ast.walk(node)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.Import | ast.ImportFrom) and id(node) not in hidden:
            yield from absolute(name, node)


@pytest.mark.parametrize("part", MAY)
def test_imports_point_one_way(part):
    """A part loads only what lies below it."""
    wrong = []
    for name, path in modules().items():
        if name.split(".")[0] != part:
            continue
        for target in imports(name, path):
            allowed = MAY[part] | {part}
            if not any(target == a or (a and target.startswith(a + ".")) for a in allowed):
                wrong.append(f"{name} imports flowgmo.{target}")
    assert not wrong


def test_nobody_imports_what_lies_above():
    """step and run, the command line and the loop, are loaded by each other only."""
    users = {
        "step": {"run", "pace", "run_summary"},
        "run": {"cli", "study", "batch"},
        "cli": set(),
        "building": {"cli", "study", "batch"},
    }
    wrong = []
    for name, path in modules().items():
        for target in imports(name, path):
            top = target.split(".")[0]
            if top in users and name.split(".")[0] not in users[top] | {top}:
                wrong.append(f"{name} imports flowgmo.{target}")
    assert not wrong


def test_postproc_never_imports_the_solver():
    wrong = []
    for path in (ROOT / "postproc").rglob("*.py"):
        for node in ast.walk(ast.parse(path.read_text())):
            names = [a.name for a in node.names] if isinstance(node, ast.Import) else []
            names += [node.module or ""] if isinstance(node, ast.ImportFrom) and not node.level else []
            wrong += [f"{path.name}: {n}" for n in names if n.split(".")[0] == "flowgmo"]
    assert not wrong


DECK = """a ball
&xput
 twfin=1.0, gz=-9.81, imobs=1, iclid=1,
/
&bcdata
 ibct=2, 2, 2, 2, 2, 2,
/
&mesh
 px=-1., 1., py=-1., 1., pz=0., 2., nxcelt={n}, nycelt={n}, nzcelt={n},
/
&obs
 nobs=1, imo(1)=4, rhomvb(1)=1000., iob(1)=1, rsh(1)=.1, trnz(1)=1.,
/
"""


def test_check_loads_no_kernel_and_no_picture_library(tmp_path):
    """`flowgmo check` answers at once (DESIGN 8): neither numba nor scipy, pyvista, vtk, matplotlib are loaded."""
    deck = tmp_path / "ball.nml"
    deck.write_text(DECK.format(n=10))
    code = (
        "import sys; sys.argv = ['flowgmo', 'check', sys.argv[1]]\n"
        "from flowgmo.cli import main\n"
        "try:\n main()\nexcept SystemExit as end:\n assert not end.code, end.code\n"
        "heavy = {'numba', 'llvmlite', 'scipy', 'pyvista', 'vtk', 'vtkmodules', 'matplotlib', 'meshio'}\n"
        "print('loaded:', sorted(heavy & set(sys.modules)))"
    )
    out = subprocess.run([sys.executable, "-c", code, str(deck)], capture_output=True, text=True, timeout=60)
    assert out.returncode == 0, out.stderr
    assert out.stdout.splitlines()[-1] == "loaded: []"


def test_deck_names_stay_in_the_deck():
    """No registry name in capitals as a string outside deck/ and building/, but in texts for the user."""
    from flowgmo.deck.variables import REGISTRY

    known = {name for name in REGISTRY if len(name) > 1}
    wrong = []
    for name, path in modules().items():
        if name.split(".")[0] in ("deck", "building"):
            continue
        for node in ast.walk(ast.parse(path.read_text())):
            if isinstance(node, ast.Constant) and isinstance(node.value, str) and node.value in known:
                wrong.append(f"{name}:{node.lineno} {node.value}")
    assert not wrong


def test_a_dry_scene_has_no_array_of_mesh_size(tmp_path):
    """10^8 cells: one array of bytes would be 100 MB. Measured: 0.3 MB through reading, building, and 20 steps."""
    from flowgmo.building import build_model
    from flowgmo.deck import read_deck
    from flowgmo.state import initial_state
    from flowgmo.step import prepare, step

    def scene(n):
        deck = tmp_path / f"{n}.nml"
        deck.write_text(DECK.format(n=n))
        model = build_model(read_deck(deck))
        world, state = prepare(model), initial_state(model)
        for k in range(20):
            step(world, state, 0.05 * (k + 1), state.p_WB[0, :0], False)
        return model

    scene(2)  # kernels are compiled here
    tracemalloc.start()
    model = scene(465)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert model.mesh.cells > 1e8 and model.fluid is None
    assert peak < 5e6


def test_the_version_is_written_once():
    """pyproject.toml or the package takes it from the other, and the command prints the same."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    if "version" in project:
        assert project["version"] == flowgmo.__version__
        written = [p for p in PACKAGE.rglob("*.py") if f'"{flowgmo.__version__}"' in p.read_text()]
        assert not written, "the version stands in pyproject.toml and in the package"
    else:
        assert "version" in project["dynamic"]
