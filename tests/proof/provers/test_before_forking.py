"""What every process of a prover needs is made before processes are forked."""

from __future__ import annotations

import subprocess
from typing import Any

import pytest
import z3

from safeloc import yices
from safeloc.proof.provers.before_forking import prepare
from safeloc.proof.provers.workers import Task, in_processes


def test_a_forked_process_makes_no_context_and_does_not_look_for_yices(monkeypatch: pytest.MonkeyPatch) -> None:
    """A forked process has the context of its parent, and starts no process to learn the version of yices."""
    prepare()
    known = (id(z3.main_ctx()), yices.version())

    def refused(*_: Any, **__: Any) -> None:
        raise AssertionError("yices was looked for again")

    monkeypatch.setattr(subprocess, "run", refused)
    task = Task("asks", lambda: (id(z3.main_ctx()), yices.version()), 60.0)
    assert [data for _, data, _ in in_processes([task], 1)] == [known]
