"""What is delivered: the wheel holds the tree and nothing else, and works on a machine that has no checkout."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
import tomllib
import venv
import zipfile
from collections.abc import Iterator
from importlib.util import module_from_spec, spec_from_file_location
from pathlib import Path
from typing import Any

import pytest

from tests.rooms import imported

ROOT = Path(__file__).parents[1]
TREES = {"safeloc": "safeloc", "models": "safeloc/models", "properties": "safeloc/properties"}
DOCS = {"docs": "safeloc/docs"}
LINKS = ("models", "properties")
LEFT_OUT = shutil.ignore_patterns(".*", "__pycache__", "*.egg-info", "build", "dist", "safeloc-*")
LEFT_OUT_AT_THE_TOP = ("tests", "benchmarks")  # a template of a project has tests of its own


def project() -> dict[str, Any]:
    """pyproject.toml."""
    return tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))


def setup_py() -> Any:
    """setup.py as a module; it sets up nothing when it is imported."""
    spec = spec_from_file_location("setup_py", ROOT / "setup.py")
    assert spec is not None
    assert spec.loader is not None
    module = module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def delivered() -> Iterator[tuple[Path, str]]:
    """Every file of the three trees of packages and of the documentation, with its name in the wheel."""
    yield from files_of(TREES | DOCS)


def files_of(trees: dict[str, str]) -> Iterator[tuple[Path, str]]:
    """Every file of these trees with its name in the wheel."""
    for tree, name in trees.items():
        for folder, folders, files in os.walk(ROOT / tree):
            folders[:] = [one for one in folders if one != "__pycache__" and not (Path(folder) / one).is_symlink()]
            for file in files:
                path = Path(folder) / file
                yield path, f"{name}/{path.relative_to(ROOT / tree).as_posix()}"


def left_out(folder: str, names: list[str]) -> set[str]:
    """What a copy of the repository for the build does without."""
    return LEFT_OUT(folder, names) | (set(LEFT_OUT_AT_THE_TOP) if Path(folder) == ROOT else set())


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The wheel, built from the source distribution, which is built from a copy of the tree."""
    copy, out = tmp_path_factory.mktemp("copy") / "source", tmp_path_factory.mktemp("dist")
    shutil.copytree(ROOT, copy, symlinks=True, ignore=left_out)
    command = [sys.executable, "-m", "build", "--no-isolation", "--outdir", str(out), str(copy)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=out)
    assert done.returncode == 0, done.stdout + done.stderr
    (found,) = out.glob("*.whl")
    assert len(list(out.glob("*.tar.gz"))) == 1
    return found


def names(wheel: Path) -> list[str]:
    """Files of the wheel, without its metadata."""
    with zipfile.ZipFile(wheel) as archive:
        return sorted(name for name in archive.namelist() if not name.split("/")[0].endswith(".dist-info"))


@pytest.mark.thorough
def test_the_wheel_holds_the_tree(wheel: Path) -> None:
    """Every file of safeloc, models and properties is in the wheel, and no other."""
    expected = sorted(name for _, name in delivered())
    kinds = {Path(name).suffix for name in expected}
    assert {".py", ".toml", ".json", ".jinja", ".gz"} <= kinds
    assert "safeloc/py.typed" in expected
    assert names(wheel) == expected


def test_the_wheel_holds_what_the_tree_holds(wheel: Path) -> None:
    """Every file of the wheel is byte for byte the one in the tree."""
    with zipfile.ZipFile(wheel) as archive:
        differing = [name for path, name in delivered() if archive.read(name) != path.read_bytes()]
    assert differing == []


def test_one_top_level_name(wheel: Path) -> None:
    """Installed, the package takes the name safeloc and no other: models and properties lie within it."""
    with zipfile.ZipFile(wheel) as archive:
        tops = {name.split("/")[0] for name in archive.namelist()}
    assert {top for top in tops if not top.endswith(".dist-info")} == {"safeloc"}
    assert len(tops) == 2


@pytest.mark.thorough
def test_packages_are_the_trees() -> None:
    """The packages that setup.py finds are the folders with Python files, each of which has an __init__.py."""
    modules = [name for _, name in files_of(TREES) if name.endswith(".py")]
    expected = {name.rpartition("/")[0].replace("/", ".") for name in modules}
    assert sorted(setup_py().packages()) == sorted(expected)
    assert not {"packages", "package-data", "package-dir"} & set(project()["tool"].get("setuptools", {}))
    missing = [name for name in modules if not _has_init(name)]
    assert missing == []


def _has_init(name: str) -> bool:
    return f"{name.rpartition('/')[0]}/__init__.py" in {other for _, other in delivered()}


@pytest.mark.parametrize("name", LINKS)
def test_links(name: str) -> None:
    """safeloc/models and safeloc/properties are relative links, so a checkout works wherever it stands."""
    link = ROOT / "safeloc" / name
    assert link.is_symlink()
    assert os.readlink(link) == f"../{name}"


def test_dependencies_are_declared() -> None:
    """Every package that is imported is declared, by the core or by an extra for users; jinja2 brings markupsafe, pydantic pydantic_core."""
    distributions = {"z3": "z3-solver", "tomli_w": "tomli-w", "vcd": "pyvcd", "paho": "paho-mqtt"}
    distributions |= {"prometheus_client": "prometheus-client"}
    extras = project()["project"]["optional-dependencies"]
    users = [one for name, every in extras.items() if name not in ("bench", "dev") for one in every]
    named = [*project()["project"]["dependencies"], *users]
    declared = {re.split(r"[<>=~!]", one)[0] for one in named} | {"markupsafe", "pydantic_core"}
    files = [path for path, _ in delivered() if path.suffix == ".py"]
    tops = {name.split(".")[0] for path in files for name in imported(path.read_text(encoding="utf-8"))}
    outside = tops - set(sys.stdlib_module_names) - {"safeloc"}
    assert {distributions.get(name, name) for name in outside} <= declared
    assert {"z3", "cvc5", "hypothesis"} <= outside


# ------------------------------------------------------------------ the description of the package


def metadata(wheel: Path) -> tuple[str, str]:
    """The fields of the wheel's METADATA, and the description below them."""
    with zipfile.ZipFile(wheel) as archive:
        (name,) = [name for name in archive.namelist() if name.endswith(".dist-info/METADATA")]
        fields, _, text = archive.read(name).decode().partition("\n\n")
    return fields, text


def outside_of_code(text: str) -> str:
    """A page without its blocks of code."""
    return re.sub(r"^```.*?^```$", "", text, flags=re.DOTALL | re.MULTILINE)


def links(text: str) -> list[str]:
    """Where a page leads, in Markdown and HTML, pictures included."""
    inline = re.findall(r"\]\(\s*<?([^)>\s]*)", text)
    by_reference = re.findall(r"^\s*\[[^\]]+\]:\s*(\S+)", text, re.MULTILINE)
    return [*inline, *by_reference, *re.findall(r"""(?:href|src|srcset)=["']([^"']*)""", text)]


def test_no_link_of_the_description_is_dead(wheel: Path) -> None:
    """Outside of a checkout a relative link or picture leads nowhere; each command that stands in its place names a page."""
    fields, text = metadata(wheel)
    assert "Description-Content-Type: text/markdown" in fields
    assert text.startswith("# safeloc")
    assert [one for one in links(outside_of_code(text)) if not one.startswith(("https://", "http://"))] == []
    named = set(re.findall(r"`safeloc docs ([\w./-]+)`", text))
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    pages = {one.partition("#")[0] for one in links(outside_of_code(readme)) if one.startswith("docs/")}
    assert len(pages) > 10
    assert len(named) == len(pages)
    with zipfile.ZipFile(wheel) as archive:
        inside = set(archive.namelist())
    for name in named:
        assert inside & {f"safeloc/docs/{name}{end}" for end in ("", ".md", "/README.md")}, name


def test_code_of_the_description_is_that_of_the_readme(wheel: Path) -> None:
    """What a user copies from the package's page runs as in the README."""
    text, readme = metadata(wheel)[1], (ROOT / "README.md").read_text(encoding="utf-8")
    blocks = re.findall(r"^```.*?^```$", readme, re.DOTALL | re.MULTILINE)
    assert blocks
    assert re.findall(r"^```.*?^```$", text, re.DOTALL | re.MULTILINE) == blocks


@pytest.mark.parametrize(
    ("written", "described"),
    [
        ("see [docs/a.md](docs/a.md#b).", "see `safeloc docs a`."),
        ("the [way in](docs/a.md) is", "the way in (`safeloc docs a`) is"),
        ("[docs/decisions/](docs/decisions/README.md)", "`safeloc docs decisions`"),
        ("[changes](CONTRIBUTING.md), [above](#start)", "changes, above"),
        ("![modes](docs/odometry.svg)", "modes (picture: `safeloc docs odometry.svg`)"),
        ('<img alt="a train" width="9" src="docs/train.svg">', "a train (picture: `safeloc docs train.svg`)"),
        ("[z3](https://z3.example/a(b)", "[z3](https://z3.example/a(b)"),
        ("```\nrows[0](docs/a.md)\n```", "```\nrows[0](docs/a.md)\n```"),
    ],
)
def test_links_in_words(written: str, described: str) -> None:
    """A link to a page is the command that finds it; other files are not installed; addresses and code stay."""
    assert setup_py().description(written) == described


# ------------------------------------------------------------------ as a user installs it


@pytest.fixture(scope="module")
def installed(wheel: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The command of a fresh environment with nothing but the wheel and what it asks for."""
    home = tmp_path_factory.mktemp("fresh") / "environment"
    venv.create(home, with_pip=True)
    command = [str(home / "bin" / "python"), "-m", "pip", "install", "--quiet", str(wheel)]
    done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=home)
    assert done.returncode == 0, done.stderr
    return home / "bin" / "safeloc"


def readme_door() -> str:
    """The machine of one's own that README.md shows."""
    blocks = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text(encoding="utf-8"), re.DOTALL)
    (door,) = [block for block in blocks if 'name="door"' in block]
    return str(door)


def called(command: Path, folder: Path, *arguments: str) -> tuple[int, str]:
    """Exit code and everything printed, from a folder outside the repository and without its variables."""
    clean = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "VIRTUAL_ENV", "PYTEST"))}
    done = subprocess.run(
        [str(command), *arguments], capture_output=True, text=True, check=False, cwd=folder, env=clean
    )
    return done.returncode, done.stdout + done.stderr


@pytest.mark.slow
def test_installed_package_is_the_wheel(installed: Path, tmp_path: Path) -> None:
    """The command imports the installed files, models and properties included, not the checkout."""
    code = "import safeloc.models.odometry as m, safeloc.properties.odometry as p; print(m.__file__, p.__file__)"
    status, printed = called(installed.with_name("python"), tmp_path, "-c", code)
    assert status == 0, printed
    files = printed.split()
    assert len(files) == 2
    assert all(file.startswith(str(installed.parents[1])) for file in files)


@pytest.mark.slow
def test_own_machine_is_verified(installed: Path, tmp_path: Path) -> None:
    """The door of README.md as door.py, by module name: exit code 0 and a report."""
    (tmp_path / "door.py").write_text(readme_door(), encoding="utf-8")
    code, printed = called(installed, tmp_path, "verify", "door:machine", "--out", "report")
    assert code == 0, printed
    assert "violated" not in printed
    assert (tmp_path / "report" / "index.html").is_file()


@pytest.mark.slow
def test_a_source_of_ones_own_is_verified(installed: Path, tmp_path: Path) -> None:
    """The beacons of docs/localizer.md outside of the repository: their contract, the localizer with them alone, and beside its own sources."""
    shutil.copy(ROOT / "docs" / "examples" / "beacons.py", tmp_path)
    beside = ["verify", "localizer", "--source", "beacons.py:source", "--out", "report"]
    for asked in (["prove", "contract+beacons.py:source"], ["prove", "alone+beacons.py:source"], beside):
        code, printed = called(installed, tmp_path, *asked)
        assert code == 0, printed
        assert "all holds" in printed


@pytest.mark.slow
def test_wrong_guard_is_shown(installed: Path, tmp_path: Path) -> None:
    """The door released at any speed: exit code 1, and the run that shows it."""
    wrong = readme_door().replace("wanted & speed.eq(0)", "wanted")
    assert wrong != readme_door()
    (tmp_path / "door.py").write_text(wrong, encoding="utf-8")
    code, printed = called(installed, tmp_path, "verify", "door:machine", "--out", "report")
    assert code == 1, printed
    assert "door/property/open while moving" in printed
    assert "   0  start  mode=CLOSED" in printed
    assert re.search(r"^   1  release  \[.*open_wanted=true.*\]  mode=OPEN", printed, re.MULTILINE)


@pytest.mark.slow
@pytest.mark.parametrize("template", ["machine", "composition", "source"])
def test_a_new_project_is_verified(installed: Path, tmp_path: Path, template: str) -> None:
    """`safeloc init` of the installed wheel: `make verify` finds that all holds, `make quick` says what was not asked."""
    code, printed = called(installed, tmp_path, "init", "my-train", "--template", template)
    assert code == 0, printed
    for rule, says in (("verify", "all holds: "), ("quick", "quick: ")):
        command = ["make", rule, f"SAFELOC={installed}", f"PYTHON={installed.with_name('python')}"]
        done = subprocess.run(command, cwd=tmp_path / "my-train", capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stdout + done.stderr
        assert says in done.stdout


@pytest.mark.slow
def test_the_tests_of_a_new_project(installed: Path, tmp_path: Path) -> None:
    """Without pytest `make test` says what to install; with it, taken from this environment, the tests hold."""
    called(installed, tmp_path, "init", "train")
    command = ["make", "test", f"PYTHON={installed.with_name('python')}"]
    bare = subprocess.run(command, cwd=tmp_path / "train", capture_output=True, text=True, check=False)
    assert bare.returncode == 2
    assert "make test needs safeloc and pytest: " in bare.stdout
    here = {**os.environ, "PYTHONPATH": str(ROOT)}
    done = subprocess.run(
        ["make", "test", f"PYTHON={sys.executable}"],
        cwd=tmp_path / "train",
        env=here,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, done.stdout + done.stderr
