"""Runs as test files.

A run that violates a property: the test fails until the machine is mended, and then guards against a relapse. A run that was made
by hand: no property is violated in it, and the machine moves as it did.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable, Mapping
from pathlib import Path

from safeloc.explain.mattering_inputs import open_first
from safeloc.language.nodes import Value
from safeloc.language.spec import Property
from safeloc.language.trace import Trace
from safeloc.target import Target

_PATH = "from pathlib import Path\n"


def pytest_file(target: Target, prop: Property, trace: Trace, config: Path | None) -> str:
    """Return the text of a test file with one test, which runs the machine on the inputs of the run.

    config  file of the configuration in which the property fails; None for the defaults
    """
    loaded = _loading(target, config)
    on_board = trace.system is not target.system
    system = "without_ghosts(target.system)" if on_board else "target.system"
    imported = "from safeloc.language.system import without_ghosts\n" if on_board else ""
    statement = prop.statement.rstrip(".")
    return f'''"""A run that violated {_plain(prop.name)} of {_plain(target.name)}."""
{"" if config is None else "from pathlib import Path" + chr(10)}
from safeloc.catalogue import load_target
from safeloc.language.interpret import run
from safeloc.language.monitor import check
{imported}from safeloc.language.verdict import Violated

FIRST = {_literal(open_first(trace))}
STEPS = [
{"".join(f"    {_literal(step)},{chr(10)}" for step in trace.stream())}]


def {name_of_test(prop.name)}() -> None:
    """It must hold: {_plain(statement)}."""
    target = {loaded}
    [claim] = [one for one in target.properties if one.name == {_quoted(prop.name)}]
    verdict = check(run({system}, STEPS, first=FIRST), claim)
    assert not isinstance(verdict, Violated), verdict.trace and verdict.trace.table()
'''


def run_file(target: Target, trace: Trace, config: Path | None) -> str:
    """Return the text of a test file for a run that was made by hand. `config` as in `pytest_file`."""
    head, before_steps, before_fired, tail = run_file_pieces(target, config)
    steps = _listed(_literal(step) for step in trace.stream())
    fired = _listed(json.dumps(list(step.fired.values())) for step in trace.steps)
    return f"{head}{_literal(open_first(trace))}{before_steps}{steps}{before_fired}{fired}{tail}"


def run_file_pieces(target: Target, config: Path | None) -> tuple[str, str, str, str]:
    """Return what stands in such a file before the first values, the steps and the fired transitions, and after them."""
    config = config or target.config_file
    loader = "configured" if config is None and target.configuration else "load_target"
    head = f'''"""A run of {_plain(target.name)} that was made by hand."""
{"" if config is None else _PATH}
from safeloc.catalogue import {loader}
from safeloc.language.interpret import run
from safeloc.language.monitor import check_all
from safeloc.language.verdict import Violated

TARGET = {_loading(target, config)}
FIRST = '''
    tail = ''']


def test_no_property_is_violated() -> None:
    """In no step of this run."""
    claims = [one for one in TARGET.properties if one.kind != "reachable"]
    verdicts = check_all(run(TARGET.system, STEPS, first=FIRST), claims)
    for claim, verdict in zip(claims, verdicts, strict=True):
        assert not isinstance(verdict, Violated), f"{claim.name}: {verdict.trace and verdict.trace.table()}"


def test_the_machine_moves_as_it_did() -> None:
    """In every step the same transitions fire. Delete this test if the run was saved of a machine that had to be mended."""
    assert [list(step.fired.values()) for step in run(TARGET.system, STEPS, first=FIRST).steps] == FIRED
'''
    return head, "\nSTEPS = [\n", "]\nFIRED = [\n", tail


def _listed(lines: Iterable[str]) -> str:
    return "".join(f"    {line},\n" for line in lines)


def _loading(target: Target, config: Path | None) -> str:
    """Return the call that loads the target, in its named configuration if it has one."""
    if config is None and target.configuration:
        return f"next(configured({_quoted(target.spec)}, [{_quoted(target.configuration)}]))[1]"
    path = "" if config is None else f", Path({_quoted(str(config.resolve()))})"
    return f"load_target({_quoted(_anywhere(target.spec or target.name))}{path})"


def _anywhere(spec: str) -> str:
    """Return the address of a target so that it leads to the same file from every folder."""
    file, colon, name = spec.rpartition(":")
    return f"{Path(file).resolve()}{colon}{name}" if file.endswith(".py") else spec


def name_of_test(name: str) -> str:
    """Return the name of the test for a property: its letters and digits, with underscores between."""
    return f"test_{'_'.join(re.findall('[a-z0-9]+', name.lower())) or 'property'}"


def _literal(values: Mapping[str, Value]) -> str:
    return "{" + ", ".join(f"{json.dumps(name)}: {value!r}" for name, value in values.items()) + "}"


def _quoted(text: str) -> str:
    return json.dumps(text)


def _plain(text: str) -> str:
    """Return a text that may stand in a docstring."""
    return " ".join(text.replace("\\", "/").replace('"', "'").split())
