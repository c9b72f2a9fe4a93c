"""The kernel cache is named by a hash of KERNEL_SOURCES: kernels must be made of nothing else of this package.

If this fails, a change in the imported file would leave stale kernels in use. Either move what is imported, or add the
file to KERNEL_SOURCES.
"""

import ast
from pathlib import Path

import flowgmo

PACKAGE = Path(flowgmo.__file__).parent


def _covered(path: Path) -> bool:
    return any(path.is_relative_to(PACKAGE / place) for place in flowgmo.KERNEL_SOURCES)


def _imports(path: Path) -> list[str]:
    tree = ast.parse(path.read_text())
    modules = [node.module or "" for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)]
    return [name for name in modules if name.startswith("flowgmo.")]


def _file_of(module: str) -> Path:
    path = PACKAGE.joinpath(*module.split(".")[1:])
    return path.with_suffix(".py") if path.with_suffix(".py").exists() else path / "__init__.py"


def test_files_with_kernels_are_hashed_and_import_only_hashed_files():
    compiled = [p for p in PACKAGE.rglob("*.py") if "@kernel" in p.read_text() or "@inner" in p.read_text()]
    compiled = [p for p in compiled if p.name != "kernel.py"]
    assert len(compiled) > 10
    for path in compiled:
        assert _covered(path), path
        for module in _imports(path):
            assert _covered(_file_of(module)), f"{path.name} imports {module}"
