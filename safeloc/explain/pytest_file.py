"""A run that violates a property as a test file: it fails until the machine is mended, and then guards against a relapse."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from pathlib import Path

from safeloc.explain.mattering_inputs import open_first
from safeloc.language.nodes import Value
from safeloc.language.spec import Property
from safeloc.language.trace import Trace
from safeloc.target import Target


def pytest_file(target: Target, prop: Property, trace: Trace, config: Path | None) -> str:
    """Return the text of a test file with one test, which runs the machine on the inputs of the run.

    config  file of the configuration in which the property fails; None for the defaults
    """
    loaded = f"load_target({_quoted(target.spec or target.name)}{'' if config is None else f', Path({_quoted(str(config))})'})"
    statement = prop.statement.rstrip(".")
    return f'''"""A run that violated {_plain(prop.name)} of {_plain(target.name)}."""
{"" if config is None else "from pathlib import Path" + chr(10)}
from safeloc.catalogue import load_target
from safeloc.language.interpret import run
from safeloc.language.monitor import check
from safeloc.language.verdict import Violated

FIRST = {_literal(open_first(trace))}
STEPS = [
{"".join(f"    {_literal(step)},{chr(10)}" for step in trace.stream())}]


def {name_of_test(prop.name)}() -> None:
    """It must hold: {_plain(statement)}."""
    target = {loaded}
    [claim] = [one for one in target.properties if one.name == {_quoted(prop.name)}]
    verdict = check(run(target.system, STEPS, first=FIRST), claim)
    assert not isinstance(verdict, Violated), verdict.trace and verdict.trace.table()
'''


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
