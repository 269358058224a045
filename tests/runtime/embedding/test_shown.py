"""The examples that docs/embedding.md points to run, and show what they say."""

from __future__ import annotations

import asyncio
import importlib.util
import re
import shlex
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

from tests.runtime.service.processes import ROOT, read

DOCS = Path(__file__).parents[3] / "docs"


def example(name: str) -> ModuleType:
    """A file of docs/examples."""
    found = importlib.util.spec_from_file_location(name, DOCS / "examples" / f"{name}.py")
    assert found is not None
    assert found.loader is not None
    module = importlib.util.module_from_spec(found)
    sys.modules[name] = module
    found.loader.exec_module(module)
    return module


def test_an_asyncio_host(capsys: pytest.CaptureFixture[str]) -> None:
    """The interlock opens with the place and closes with its loss."""
    asyncio.run(example("asyncio_controller").main(DOCS / "examples" / "records.jsonl"))
    first, second, last = capsys.readouterr().out.splitlines()
    assert first.startswith("200 ms: released, 244.793 m to 255.979 m")
    assert re.fullmatch(r"1\d00 ms: restricted, SENSOR_FAILURE", second)
    assert last.startswith("cycle 40 at 4000 ms: DELOCALIZED; nothing reported")


def test_a_guarded_filter() -> None:
    """The filter follows a wrong position; of what it says, only what lies within the proven interval is passed on."""
    pytest.importorskip("filterpy")
    run = list(example("guarded_filter").journey(600))
    passed = [one for one in run if one.passed_mm is not None]
    assert all(one.interval.holds(one.truth_mm) for one in run if one.interval is not None)
    assert all(one.interval.low_mm <= round(one.passed_mm) <= one.interval.high_mm for one in passed)
    assert len(passed) > 200
    assert max(abs(one.filter_mm - one.truth_mm) for one in run) > 40_000
    assert max(abs(one.passed_mm - one.truth_mm) for one in passed) < 30_000
    assert run[-1].passed_mm is None


@pytest.mark.parametrize("number", [0, 1])
def test_the_snippets_of_the_page(number: int, capsys: pytest.CaptureFixture[str]) -> None:
    """docs/embedding.md's own examples, of a controller and of the localizer, print what their comments say."""
    text = (DOCS / "embedding.md").read_text(encoding="utf-8")
    codes = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    assert len(codes) == 3
    exec(compile(codes[number], "embedding.md", "exec"), {})
    (said,) = re.findall(r"# (cycle 1 .*)\n", codes[number])
    assert capsys.readouterr().out.strip() == said


def test_the_library_calls_of_the_page(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """docs/embedding.md's example of proof, replay and report from Python does what its comments say."""
    text = (DOCS / "embedding.md").read_text(encoding="utf-8")
    code = re.findall(r"```python\n(.*?)```", text, re.DOTALL)[2]
    monkeypatch.chdir(tmp_path)
    exec(compile(code, "embedding.md", "exec"), {})
    (said,) = re.findall(r"# (\d+ steps .*)\n", code)
    assert capsys.readouterr().out.strip() == said
    assert {"index.html", "report.json"} <= {path.name for path in (tmp_path / "safeloc-report").iterdir()}


def test_the_functions_of_the_page_exist() -> None:
    """Each function that the table of commands names stands in the file that it names."""
    text = (DOCS / "embedding.md").read_text(encoding="utf-8")
    table = text[text.index("| command | function |") :].split("\n\n")[0]
    found = re.findall(r"`(\w+)\([^`]*\)`[^`|]* in `((?:safeloc|models)/\S+\.py)`", table)
    assert len(found) >= 7
    for name, file in found:
        assert re.search(rf"^(def|class) {name}\b", (ROOT / file).read_text(encoding="utf-8"), re.MULTILINE), name


def test_the_first_command_of_the_page() -> None:
    """As it stands there, it locates the vehicle of the records that are shipped, loses it in their silence, and says so."""
    text = (DOCS / "embedding.md").read_text(encoding="utf-8")
    (command,) = re.findall(r"^safeloc run (odometry --config \S+) < (\S+)$", text, re.MULTILINE)
    arguments = [sys.executable, "-c", "from safeloc.cli import main; main()", "run", *shlex.split(command[0])]
    with (ROOT / command[1]).open("rb") as records:
        done = subprocess.run(arguments, stdin=records, capture_output=True, cwd=ROOT, check=True, timeout=60)
    said = read(done.stdout)
    printed = iter(done.stdout.decode().splitlines())
    shown = text[text.index("The first command prints") :].split("```\n")[1]
    for line in shown.splitlines():
        assert any(one.startswith(line.removesuffix("...").rstrip()) for one in printed), line
    modes = [one["mode"]["odometry"] for one in said if "mode" in one]
    assert all("accepted as soon as lines of 2 cycles agree" in one["reason"] for one in said if "mode" not in one)
    assert (len(modes), len(said)) == (40, 48)
    assert set(modes) == {"DELOCALIZED", "FRONT"}
    assert modes[-1] == "DELOCALIZED"
