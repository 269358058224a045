"""What earlier runs found, on the command line: an unchanged run is put back, `--fresh` ignores it, `cache` says and cleans."""

from __future__ import annotations

import json
import os
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest

from safeloc.cli import verify as module
from safeloc.proof.cache.store import Store
from safeloc.report import folder as folder_module
from tests.cli.calling import Call, started

QUICK = ["--depth", "6", "--examples", "3", "--steps", "10"]


def files(folder: Path) -> dict[str, bytes]:
    """All files of a folder by name."""
    return {
        path.relative_to(folder).as_posix(): path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()
    }


def test_an_unchanged_run_is_put_back(call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """File by file the report of then, into another folder too; nothing is loaded for it."""
    first, other, cache = tmp_path / "first", tmp_path / "other", tmp_path / "cache"
    arguments = ["verify", "delocalized", *QUICK, "--cache", str(cache)]
    once = call(*arguments, "--out", str(first))
    assert (0, True) == (once.code, "computed now" not in once.err)
    made = files(first)
    with monkeypatch.context() as patch:
        patch.setattr(module, "load_target", lambda *_: pytest.fail("a target was loaded"))
        (first / "traces" / "old.js").write_bytes(b"of another report")
        for folder in (first, other):
            again = call(*arguments, "--out", str(folder))
            assert (0, once.out) == (again.code, again.out)
            assert "nothing has changed since" in again.err
            assert made == files(folder)
        with pytest.raises(pytest.fail.Exception, match="a target was loaded"):
            call("verify", "delocalized", *QUICK, "--seed", "1", "--cache", str(cache), "--out", str(first))


@pytest.mark.thorough
def test_fresh_ignores_what_was_found(call: Call, tmp_path: Path) -> None:
    """And leaves what it finds to the next one."""
    arguments = ["verify", "emitter", *QUICK, "--out", str(tmp_path / "report"), "--cache", str(tmp_path / "cache")]
    call(*arguments)
    fresh = call(*arguments, "--fresh")
    assert "nothing has changed" not in fresh.err
    assert "emitter: 2" in fresh.err or "held" in fresh.err
    assert "nothing has changed" in call(*arguments).err


@pytest.mark.thorough
def test_a_report_says_what_was_kept(call: Call, tmp_path: Path) -> None:
    """By machine, with the time since when; in the data, on the page and on the screen."""
    folder, cache = tmp_path / "report", tmp_path / "cache"
    call("verify", "emitter", *QUICK, "--out", str(folder), "--cache", str(cache))
    both = call("verify", "emitter", "travel_direction", *QUICK, "--out", str(folder), "--cache", str(cache))
    assert "emitter: unchanged" in both.err
    assert "results computed now" in both.err
    data = json.loads((folder / "report.json").read_text())
    assert ["emitter"] == list(data["kept"])
    assert f"of {data['kept']['emitter']}" in (folder / "index.html").read_text()


@pytest.mark.thorough
def test_prove_looks_up_too(call: Call, tmp_path: Path) -> None:
    """All of a machine, and one property, are two questions."""
    arguments = ["prove", "emitter", "--depth", "6", "--cache", str(tmp_path)]
    first, again, fresh = call(*arguments), call(*arguments), call(*arguments, "--fresh")
    assert first.out == again.out == fresh.out
    assert [False, True, False] == ["from the cache, the oldest of" in one.err for one in (first, again, fresh)]


def test_what_is_violated_is_never_put_back_as_a_whole(call: Call, tmp_path: Path) -> None:
    """The report is made anew, since what is wrong has to be told with its run; the machine is looked up."""
    path = tmp_path / "own.py"
    path.write_text(
        "from safeloc.language.expr import number\n"
        "from safeloc.language.machine import Machine, Transition, modes\n"
        "from safeloc.language.spec import always\n"
        "from safeloc.language.units import COUNT\n"
        "A, B = modes('A', 'B')\n"
        "X, N = number('x', COUNT, 0, 9), number('n', COUNT, 0, 9)\n"
        "machine = Machine('own', (A, B), [X], {N: 0}, {'n': N}, [Transition('go', A, B, X > 5, {N: X})])\n"
        "properties = [always('small', N < 9)]\n"
    )
    arguments = [
        "verify",
        f"{path}:machine",
        *QUICK,
        "--out",
        str(tmp_path / "report"),
        "--cache",
        str(tmp_path / "cache"),
    ]
    first, again = call(*arguments), call(*arguments)
    assert (1, 1) == (first.code, again.code)
    assert first.out == again.out
    assert "own: unchanged" in again.err
    path.write_text(path.read_text().replace("N < 9", "N <= 9"))
    mended = call(*arguments)
    assert (0, False) == (mended.code, "unchanged" in mended.err)


@pytest.mark.thorough
def test_recheck_follows_where_it_is_asked_for(call: Call, tmp_path: Path) -> None:
    """Of a report that was put back as well."""
    arguments = [
        "verify",
        "emitter",
        *QUICK,
        "--out",
        str(tmp_path / "report"),
        "--cache",
        str(tmp_path / "cache"),
        "--recheck",
    ]
    assert "confirmed" in call(*arguments).out
    again = call(*arguments)
    assert "confirmed" in again.out
    assert "nothing has changed" in again.err


def test_cache_says_how_much_is_kept_and_cleans(call: Call, tmp_path: Path) -> None:
    """In the folder that is named; empty where nothing is."""
    Store(tmp_path).put("answers", "ab" * 32, b"proved")
    assert f"{tmp_path}: 1 files, 0.0 MB\n" == call("cache", "--cache", str(tmp_path)).out
    assert "the cache is empty now" in call("cache", "--clean", "--cache", str(tmp_path)).out
    assert "0 files" in call("cache", "--size", "--cache", str(tmp_path)).out


@pytest.mark.thorough
def test_what_is_done_when_interrupted_is_kept(call: Call, tmp_path: Path) -> None:
    """A machine that was done is not verified again; of the one that was not, there is no report."""
    arguments = ["verify", "travel_direction", "fibre_area", *QUICK, "--out", str(tmp_path / "report")]
    command = [sys.executable, "-m", "safeloc", *arguments, "--cache", str(tmp_path / "cache"), "--jobs", "2"]
    with started(command, stderr=subprocess.PIPE) as process:
        assert process.stderr is not None
        assert any(line.startswith("travel_direction: ") for line in process.stderr)
        os.killpg(process.pid, signal.SIGINT)
        assert "completed machines are in the cache" in process.stderr.read()
    assert (130, False) == (process.returncode, (tmp_path / "report" / "report.json").exists())
    again = call(
        "verify", "travel_direction", *QUICK, "--out", str(tmp_path / "report"), "--cache", str(tmp_path / "cache")
    )
    assert "travel_direction: unchanged" in again.err


@pytest.mark.thorough
def test_what_another_run_writes_into_the_folder_is_not_kept(
    call: Call, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A report is kept before any other run may write where it stands."""
    order: list[str] = []
    alone, keeps = folder_module.locked, module.keep_report

    @contextmanager
    def told(folder: Path) -> Iterator[None]:
        with alone(folder):
            yield
        order.append("others may write")

    def kept(*arguments: Any) -> None:
        order.append("kept")
        keeps(*arguments)

    monkeypatch.setattr(folder_module, "locked", told)
    monkeypatch.setattr(module, "keep_report", kept)
    call("verify", "emitter", *QUICK, "--out", str(tmp_path / "report"), "--cache", str(tmp_path / "cache"))
    assert ["kept", "others may write"] == order
