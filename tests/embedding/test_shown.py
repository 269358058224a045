"""The examples that docs/embedding.md points to run, and show what they say."""

from __future__ import annotations

import asyncio
import importlib.util
import re
import sys
from pathlib import Path
from types import ModuleType

import pytest

from safeloc.streams.record_files import write_records
from tests.embedding.driving import drive

DOCS = Path(__file__).parents[2] / "docs"


def example(name: str) -> ModuleType:
    """A file of docs/examples."""
    found = importlib.util.spec_from_file_location(name, DOCS / "examples" / f"{name}.py")
    assert found is not None
    assert found.loader is not None
    module = importlib.util.module_from_spec(found)
    sys.modules[name] = module
    found.loader.exec_module(module)
    return module


def test_an_asyncio_host(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """The interlock opens with the place and closes with its loss."""
    path = tmp_path / "records.jsonl"
    silent = [*range(10, 25)]
    write_records(path, [record for n, records in enumerate(drive(40)) if n not in silent for record in records])
    asyncio.run(example("asyncio_controller").main(path))
    first, second, last = capsys.readouterr().out.splitlines()
    assert first.startswith("200 ms: released, 244.794 m to 255.970 m")
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


def test_the_first_lines_of_the_page(capsys: pytest.CaptureFixture[str]) -> None:
    """docs/embedding.md's own example prints what its comment says."""
    text = (DOCS / "embedding.md").read_text(encoding="utf-8")
    (code,) = re.findall(r"```python\n(.*?)```", text, re.DOTALL)
    exec(compile(code, "embedding.md", "exec"), {})
    (said,) = re.findall(r"# (cycle 1 .*)\n", code)
    assert capsys.readouterr().out.strip() == said
