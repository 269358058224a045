"""Everything of a shipped machine is proved in each of its declared configurations, not only in the defaults."""

from __future__ import annotations

from typing import Any

import pytest

from safeloc.catalogue import ENTRIES
from safeloc.language.verdict import word
from safeloc.proof.provers.limits import Limits
from safeloc.proof.results import Finding
from safeloc.proof.verification.one import Work
from safeloc.target import Entry

CASES = [(machine, name) for machine, entry in ENTRIES.items() for name in entry.configurations.named]
QUICK = ("emitter", "one pattern is enough")
VACUOUS: dict[tuple[str, str], frozenset[str]] = {}
"""Claims whose case does not occur in a configuration, and must not."""


def open_in(entry: Entry[Any], name: str) -> dict[str, str]:
    """The findings that are not proved, by id, with their verdicts."""
    findings: list[Finding] = []
    target = entry.make(entry.configurations.named[name])
    Work(target, 2, lambda *_: None, findings.append).proved_and_obliged(Limits())
    return {one.id: word(one.result) for one in findings if word(one.result) != "proved"}


def _marked(case: tuple[str, str]) -> Any:
    return pytest.param(*case, marks=() if case == QUICK else pytest.mark.slow, id=": ".join(case))


@pytest.mark.parametrize(("machine", "name"), [_marked(case) for case in CASES])
def test_every_configuration_is_proved(machine: str, name: str) -> None:
    """Claims and obligations, with the runs that ship with the machine."""
    vacuous = VACUOUS.get((machine, name), frozenset())
    assert dict.fromkeys(vacuous, "vacuous") == open_in(ENTRIES[machine], name)
