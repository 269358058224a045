"""Machines as scripts, run in node as a page runs them, and what generated Python makes of the same steps."""

from __future__ import annotations

import json
import shutil
import subprocess
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from safeloc.codegen.compiled import Compiled, Row
from safeloc.codegen.javascript import javascript
from safeloc.language.absence import stand_ins, without_absent
from safeloc.language.nodes import Expr, Num, Value
from safeloc.language.system import TransitionSystem
from safeloc.language.units import Enumeration

needs_node = pytest.mark.skipif(shutil.which("node") is None, reason="needs node, which runs scripts outside a browser")
LARGEST = 2**53 - 1
"""The greatest number that JSON holds exactly for every reader."""


class NodeError(Exception):
    """What the script threw."""


class Node:
    """A process that runs scripts."""

    def __init__(self) -> None:
        driver = str(Path(__file__).with_name("node_driver.js"))
        self._process = subprocess.Popen(
            ["node", driver], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True, encoding="utf-8"
        )

    def load(self, text: str, key: str = "") -> None:
        """Run the text of a script; the machine that it hands over is chosen, and can be chosen again by the key."""
        self.ask("load", text, key)

    def choose(self, key: str) -> None:
        """Go on with a machine that was loaded before."""
        self.ask("choose", key)

    def ask(self, word: str, *given: object) -> Any:
        """What the driver tells; NodeError where it threw."""
        stdin, stdout = self._process.stdin, self._process.stdout
        assert stdin is not None and stdout is not None
        stdin.write(json.dumps([word, *given]) + "\n")
        stdin.flush()
        answer = json.loads(stdout.readline())
        if "error" in answer:
            raise NodeError(answer["error"])
        return answer.get("told")

    def close(self) -> None:
        """End the process."""
        assert self._process.stdin is not None and self._process.stdout is not None
        self._process.stdin.close()
        self._process.wait(timeout=60)
        self._process.stdout.close()


@pytest.fixture(scope="module")
def node() -> Iterator[Node]:
    """A process for the tests of a file."""
    started = Node()
    yield started
    started.close()


def loaded(node: Node, system: TransitionSystem, first: Mapping[str, Value] | None = None) -> None:
    """The machine in the process."""
    node.load(javascript(system, first=first))


def as_json(values: Mapping[str, object]) -> dict[str, object]:
    """Values by name as streams hold them; a number that JSON cannot hold for every reader is text."""
    return {
        name: str(one) if isinstance(one, int) and not isinstance(one, bool) and abs(one) > LARGEST else one
        for name, one in values.items()
    }


def told(term: Expr, value: Value | None) -> str | bool | None:
    """A value as the driver tells it: numbers as text, members by their labels."""
    if value is None or isinstance(value, bool):
        return value
    return term.unit.members[value] if isinstance(term, Num) and isinstance(term.unit, Enumeration) else str(value)


def expected(code: Compiled, state: Row, numbers: tuple[int, ...]) -> dict[str, Any]:
    """What the driver has to tell of a step, from what generated Python tells."""
    system = code.system
    outputs = without_absent(code.named_outputs(state), stand_ins(system))
    return {
        "state": state_told(system, state),
        "outputs": {name: told(system.outputs[name], value) for name, value in outputs.items()},
        "fired": list(code.fired(numbers).values()),
    }


def state_told(system: TransitionSystem, state: Row) -> dict[str, Any]:
    """A state as the driver tells it."""
    return {var.name: told(var, value) for var, value in zip(system.state, state, strict=True)}
