"""The pytest plugin, as a user's project has it: items for each claim, runs in failures, mistakes refused."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

import pytest

from tests.started_pytest import run_pytest

LAMP = """
from pathlib import Path

from safeloc.language.expr import boolean, number
from safeloc.language.machine import Machine, Transition, modes
from safeloc.language.spec import never
from safeloc.language.units import COUNT

OFF, ON = modes("OFF", "ON")
go, uses = boolean("go"), number("uses", COUNT, 0, 9)
machine = Machine(
    name="lamp", modes=(OFF, ON), inputs=[go], state={uses: 0}, outputs={},
    transitions=[
        Transition("on", OFF, ON, go & (uses < 9), {uses: uses + 1}),
        Transition("off", ON, OFF, ~go),
    ],
    lemmas={"few uses": uses <= 9},
)
properties = [never("more than nine", uses > 9), never("worn", uses > 1)]
recordings = [Path(__file__).with_name("lamp-once.jsonl")]
"""
RECORDING = '{"go": true}\n{"go": false}\n'


@pytest.fixture
def project(tmp_path: Path) -> Path:
    """A project with a machine in `src`."""
    (tmp_path / "src").mkdir()
    (tmp_path / "src" / "lamp.py").write_text(LAMP, encoding="utf-8")
    (tmp_path / "src" / "lamp-once.jsonl").write_text(RECORDING, encoding="utf-8")
    listed(tmp_path, '["src/lamp.py:machine"]')
    return tmp_path


def listed(project: Path, machines: str, more: str = "") -> None:
    """Write the project's list of machines."""
    text = f"[tool.pytest.ini_options]\nsafeloc_machine = {machines}\n{more}"
    (project / "pyproject.toml").write_text(text, encoding="utf-8")


def ran(project: Path, *arguments: str, anew: bool = False) -> tuple[int, str]:
    """Exit code and output of pytest in the project."""
    loaded = ("-p", "safeloc.pytest_plugin")  # whether or not it is installed
    plain = "--assert=plain"  # else every module of safeloc is compiled anew, with its assertions rewritten
    environment = {**os.environ, "SAFELOC_CACHE": str(project / "kept"), "PYTHONDONTWRITEBYTECODE": "1"}
    environment["PYTHONPATH"] = str(Path(__file__).parents[1])
    run = run_pytest(*loaded, plain, *arguments, folder=project, environment=environment, anew=anew)
    return run.returncode, run.stdout + run.stderr


def test_each_claim_is_an_item(project: Path) -> None:
    """What does not hold fails with its run; all else passes."""
    code, text = ran(project, "-v", anew=True)
    assert code == 1
    name = "src/lamp.py::machine::"
    for item, outcome in (
        ("lemma: few uses", "PASSED"),
        ("proof: more than nine", "PASSED"),
        ("proof: worn", "FAILED"),
        ("obligations", "PASSED"),
        ("test: more than nine", "PASSED"),
        ("test: worn", "FAILED"),
        ("recording: lamp-once.jsonl", "PASSED"),
    ):
        assert f"{name}{item} {outcome}" in text
    assert "2 failed, 5 passed" in text
    assert "violated: worn\n   0  start  mode=OFF uses=0\n" in text
    assert "Traceback" not in text
    assert "pytest_plugin.py" not in text


@pytest.mark.thorough
def test_items_are_chosen_as_usual(project: Path) -> None:
    """By a word of their names, and by the file."""
    assert ran(project, "-k", "proof and nine")[0] == 0
    code, text = ran(project, "src/lamp.py", "-q", "-k", "recording", "--durations=1")
    assert code == 0
    assert "1 passed, 6 deselected" in text


def test_a_proof_under_laws_that_exclude_each_other_fails(project: Path) -> None:
    """Also where it is asked alone: of such laws everything follows."""
    text = LAMP.replace("import COUNT", "import COUNT\nfrom safeloc.language.world import World")
    laws = 'outputs={}, world=World(clauses={"go": go, "stay": ~go}),'
    (project / "src" / "lamp.py").write_text(text.replace("outputs={},", laws), encoding="utf-8")
    code, told = ran(project, "-v", "-k", "proof and worn")
    assert code == 1
    assert "proof: worn FAILED" in told
    why = "no run satisfies the assumption: every proof under it would be empty"
    assert f"{why}. These clauses exclude each other in the first step: 'lamp: go', 'lamp: stay'" in told


def test_a_recording_that_breaks_a_claim_fails(project: Path) -> None:
    """Its message names the claim."""
    (project / "src" / "lamp-once.jsonl").write_text(RECORDING * 2, encoding="utf-8")
    code, text = ran(project, "-k", "recording")
    assert code == 1
    assert "violated: worn" in text


@pytest.mark.parametrize(
    ("machines", "message"),
    [
        ('["src/lump.py:machine"]', "safeloc_machine: 'src/lump.py:machine': no such file or module"),
        ('["src/lamp.py"]', "safeloc_machine: 'src/lamp.py': no such file or module; write file.py:name"),
        ('["no.such.module:machine"]', "'no.such.module:machine': no such file or module"),
        ('["src/lamp.py:lamp"]', "lamp.py"),
    ],
)
def test_a_wrong_address_is_refused(project: Path, machines: str, message: str) -> None:
    """Nothing passes without it."""
    listed(project, machines)
    code, text = ran(project)
    assert code != 0
    assert message in text
    assert "passed" not in text


def test_a_machine_where_nobody_looks_is_refused(project: Path) -> None:
    """It would never be verified; a command that names what to run may leave it out."""
    (project / "tests").mkdir()
    (project / "tests" / "test_none.py").write_text("def test_none() -> None: ...\n", encoding="utf-8")
    listed(project, '["src/lamp.py:machine"]', 'testpaths = ["tests"]\n')
    code, text = ran(project)
    assert code == 4
    assert "src/lamp.py:machine is in no folder that pytest looks in; add the folder of its file to `testpaths`" in text
    assert ran(project, "tests")[0] == 0


def test_a_composition_has_its_contracts(project: Path) -> None:
    """What its machines owe each other is an item, and so is each lemma of a machine."""
    template = Path(__file__).parents[1] / "safeloc" / "templates" / "composition"
    shutil.copy(template / "supervised.py", project / "src")
    shutil.copytree(template / "recordings", project / "src" / "recordings")
    listed(project, '["src/supervised.py:whole"]')
    code, text = ran(project, "-v", "-k", "contracts or lemma")
    assert code == 0
    assert "src/supervised.py::whole::contracts PASSED" in text


def test_a_machine_that_cannot_be_loaded_says_why(project: Path) -> None:
    """Once, with the reason, and not also that nobody looked for it."""
    (project / "src" / "lamp-once.jsonl").unlink()
    code, text = ran(project)
    assert code == 2
    assert "lamp-once.jsonl: no such file" in text
    assert "testpaths" not in text


def test_without_the_list_nothing_is_collected(project: Path) -> None:
    """The plugin is installed with safeloc, also for projects that do not use it."""
    (project / "pyproject.toml").write_text("", encoding="utf-8")
    assert ran(project)[0] == 5
