"""The three rules of the house, and a few that keep it liveable."""

import ast
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parent.parent
PACKAGES = ("app", "widgets", "processing", "resources")


def modules():
    return [path for package in PACKAGES for path in sorted((ROOT / package).glob("**/*.py"))]


def test_imports_go_one_way():
    script = "from importlinter.cli import lint_imports_command; lint_imports_command()"
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stdout + done.stderr


def test_processing_imports_without_qt():
    names = [".".join(p.relative_to(ROOT).with_suffix("").parts) for p in modules() if p.parts[-2] != "app"]
    names = [n.removesuffix(".__init__") for n in names if n.startswith("processing")]
    script = (
        f"import importlib, sys\nfor name in {names!r}: importlib.import_module(name)\n"
        "bad = {m.split('.')[0] for m in sys.modules}&{'PySide6', 'pyqtgraph', 'sounddevice', 'app', 'widgets'}\n"
        "assert not bad, bad"
    )
    done = subprocess.run(
        [sys.executable, "-c", script], cwd=ROOT, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr


def test_packaging_can_never_be_imported_in_place_of_the_library():
    assert not (ROOT / "packaging" / "__init__.py").exists()


@pytest.mark.parametrize("path", modules(), ids=lambda p: str(p.relative_to(ROOT)))
def test_a_module_is_short_enough_to_read_in_one_sitting(path):
    text = path.read_text(encoding="utf-8")
    if len(text.splitlines()) > 400:
        docstring = ast.get_docstring(ast.parse(text)) or ""
        assert "Longer than 400 lines because" in docstring, "over 400 lines without its reason on top"


@pytest.mark.parametrize("path", modules(), ids=lambda p: str(p.relative_to(ROOT)))
def test_nothing_unpickles_or_evaluates(path):
    """Files from outside are untrusted."""
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import | ast.ImportFrom):
            names = [alias.name for alias in node.names] + [getattr(node, "module", "") or ""]
            assert not {"pickle", "shelve", "marshal"} & {n.split(".")[0] for n in names}
        if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
            assert node.func.id not in {"eval", "exec"}
        if isinstance(node, ast.keyword) and node.arg == "allow_pickle":
            assert isinstance(node.value, ast.Constant)
            assert node.value.value is False


def test_translation_is_asked_for_only_where_there_is_a_window_and_never_of_an_f_string():
    for path in modules():
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "tr":
                assert path.relative_to(ROOT).parts[0] in {"app", "widgets"}, path
                assert not any(isinstance(argument, ast.JoinedStr) for argument in node.args), f"{path}:{node.lineno}"


def test_the_lock_files_hold_hashes_and_no_address():
    for name in ("requirements.txt", "requirements-dev.txt"):
        text = (ROOT / "packaging" / name).read_text(encoding="utf-8")
        assert "://" not in text
        assert text.count("--hash=sha256:") > text.count("==")


def test_the_lock_files_hold_every_dependency():
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))
    locked = (ROOT / "packaging" / "requirements.txt").read_text(encoding="utf-8").lower()
    for requirement in project["project"]["dependencies"]:
        name = requirement.split(">")[0].split("<")[0].split("=")[0].strip().lower()
        assert f"{name}==" in locked, name
