"""`safeloc export --to c` and `--to fmu`: what lands on disk works, and wrong usage is told."""

from __future__ import annotations

import json
import subprocess
import zipfile
from pathlib import Path

import pytest

from tests.cli.calling import DOOR, Call
from tests.codegen.c_folder import make, needs_compiler
from tests.codegen.in_node import needs_node


@needs_compiler
def test_a_folder_of_c_checks_itself(call: Call, tmp_path: Path) -> None:
    """Exported, compiled and checked; a file of the user's in the folder stays."""
    folder = tmp_path / "made" / "door"
    folder.mkdir(parents=True)
    (folder / "own.txt").write_text("mine", encoding="utf-8")
    called = call("export", DOOR, "--to", "c", "--out", str(folder))
    assert called.code == 0, called.err
    assert f"7 files in {folder}" in called.err
    assert called.out == ""
    code, printed = make(folder, "check", "sanitize")
    assert code == 0, printed
    assert (folder / "own.txt").read_text(encoding="utf-8") == "mine"
    readme = (folder / "README.md").read_text(encoding="utf-8")
    assert "make check" in readme
    assert "no step ever leaves the ranges" in readme


@needs_compiler
def test_the_readme_of_the_folder_compiles(call: Call, tmp_path: Path) -> None:
    """The example in the exported README is C that an integrator can begin with, also where first values are open."""
    for target in (DOOR, "sections"):
        assert call("export", target, "--to", "c", "--out", str(tmp_path)).code == 0
        text = (tmp_path / "README.md").read_text(encoding="utf-8")
        include, body = text.split("```c\n")[1].split("```")[0].split("\n", 1)
        (tmp_path / "own.c").write_text(f"{include}\nint main(void)\n{{\n{body}return 0;\n}}\n", encoding="utf-8")
        name = include.split('"')[1].removesuffix(".h")
        command = ["cc", "-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-o", "own", "own.c", f"{name}.c"]
        done = subprocess.run(command, cwd=tmp_path, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert subprocess.run([str(tmp_path / "own")], check=False).returncode == 0


@pytest.mark.thorough
@needs_compiler
def test_the_configuration_reaches_the_code(call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Figures of the configuration stand in the C and in the unit: tolerance and period. Where nothing is proved, that is
    told."""
    monkeypatch.setattr("safeloc.proof.exported.lasting", lambda _system: None)
    config = tmp_path / "odometry.json"
    config.write_text(json.dumps({"tolerance_mm": 31_234, "period_ms": 200}), encoding="utf-8")
    called = call("export", "odometry", "--config", str(config), "--to", "c", "--out", str(tmp_path))
    assert called.code == 0
    assert "not every range is proved: check_state checks ranges only" in " ".join(called.err.split())
    assert "31234000000" in (tmp_path / "odometry.c").read_text(encoding="utf-8")
    unit = tmp_path / "odometry.fmu"
    assert call("export", "odometry", "--config", str(config), "--to", "fmu", "--out", str(unit)).code == 0
    with zipfile.ZipFile(unit) as archive:
        assert 'stepSize="0.2"' in archive.read("modelDescription.xml").decode()


@needs_node
def test_the_script_of_the_page_runs(call: Call, tmp_path: Path) -> None:
    """docs/export.md's example of a script, as it stands there: what refuses each transition, and one step."""
    page = (Path(__file__).parents[2] / "docs" / "export.md").read_text(encoding="utf-8")
    assert call("export", "odometry", "--to", "javascript", "--out", str(tmp_path / "odometry.js")).code == 0
    (tmp_path / "run.js").write_text(page.split("```js\n")[1].split("```")[0], encoding="utf-8")
    done = subprocess.run(["node", "run.js"], cwd=tmp_path, capture_output=True, text=True, check=False)
    assert done.stderr == ""
    assert done.stdout.splitlines() == [
        "candidate marker at front: front reading is a candidate is false",
        "candidate marker at rear: rear reader leads is false",
        "wait for a marker 0",
    ]


def test_a_script_goes_to_standard_output(call: Call) -> None:
    """As every form that is one text; a machine of the user's own too."""
    called = call("export", DOOR, "--to", "javascript")
    assert called.code == 0
    assert called.out.startswith('(()=>{"use strict";')
    assert 'safelocMachine("door",' in called.out


@pytest.mark.parametrize(("form", "said"), [("c", "several files; name a folder"), ("fmu", "a binary file; name it")])
def test_forms_that_are_no_text_need_a_place(call: Call, monkeypatch: pytest.MonkeyPatch, form: str, said: str) -> None:
    """They are not written to standard output."""
    monkeypatch.setenv("COLUMNS", "300")
    called = call("export", DOOR, "--to", form)
    assert called.code == 2
    assert f"--to {form} writes {said} with --out." in called.err
    assert called.out == ""


@pytest.mark.parametrize(
    ("form", "place", "why"),
    [
        ("c", "file", "file is no folder. Name a folder with --out."),
        ("c", "file/folder", "file is no folder. Name a folder with --out."),
        ("fmu", ".", "it is a folder. Name a file with --out."),
        ("svg", "none/door.svg", "there is no folder"),
    ],
)
def test_a_place_that_cannot_be_written_is_told_first(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, form: str, place: str, why: str
) -> None:
    """One sentence, exit code 2, before the machine is even loaded."""
    monkeypatch.setenv("COLUMNS", "300")
    monkeypatch.setattr("safeloc.cli.export.load_target", lambda *_: pytest.fail("loaded"))
    (tmp_path / "file").write_text("kept", encoding="utf-8")
    called = call("export", DOOR, "--to", form, "--out", str(tmp_path / place))
    assert called.code == 2
    assert "cannot be written" in called.err
    assert why in called.err
    assert (tmp_path / "file").read_text(encoding="utf-8") == "kept"


def test_a_unit_needs_a_compiler_before_anything_is_proved(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A named compiler that does not exist is not replaced by another one."""
    monkeypatch.setenv("CC", "/nonexistent/cc")
    monkeypatch.setattr("safeloc.cli.export.load_target", lambda *_: pytest.fail("loaded"))
    called = call("export", DOOR, "--to", "fmu", "--out", str(tmp_path / "door.fmu"))
    assert called.code == 2
    assert "CC names '/nonexistent/cc'" in called.err
    assert not (tmp_path / "door.fmu").exists()


def test_what_was_proved_before_is_not_proved_again(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """`prove` and `export` ask the same questions of a machine, and the second finds the answers in the cache."""
    store = ["--cache", str(tmp_path / "cache")]
    assert call("prove", DOOR, *store, "--jobs", "1").code == 0
    monkeypatch.setattr("safeloc.proof.provers.implication.ask", lambda *_: pytest.fail("asked z3 again"))
    called = call("export", DOOR, "--to", "c", "--out", str(tmp_path / "door"), *store)
    assert called.code == 0, called.err
    assert "door: proving the invariants that every state is checked by" in called.err
