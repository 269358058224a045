"""Every claim of a shipped machine is proved in each of its declared configurations, not only in the defaults."""

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
WINDOWS = frozenset(f"odometry/property/{end} reader over its marker is inside the window" for end in ("front", "rear"))
WAITS = frozenset({
    "reflector/property/the test begins with the prescribed distance",
    "reflector/property/the test goes on with the distance run",
    "reflector/property/the reference reflector is found in time",
})  # fmt: skip
BELIEVED = "satellites, units that drift, one device, the first reference is believed"
VACUOUS = {
    ("odometry", "one device, the first marker is believed"): WINDOWS,
    ("odometry", BELIEVED): WINDOWS,
    ("reflector", "ultrasound in place of the radar"): WAITS,
}
"""Claims whose case does not occur in a configuration. Odometry: there no reading is refused as out of its window (tests/models/test_variants.py).
Reflector: the wheel's constant of 5 m, on both sides, is more than 6 m of tolerance, so a self-test is made at the balise and never waits."""


UNDECIDED = {
    ("odometry", BELIEVED): frozenset({"odometry/property/a position of satellites that is outside sets nothing"})
}
"""Claims that are neither proved nor refuted in a configuration. Of units that drift no lemma says yet that their margins hold what silent
cycles add, so induction begins in states that no run reaches; bounded search finds no run that breaks the claim."""


def open_in(entry: Entry[Any], name: str) -> dict[str, str]:
    """The claims and lemmas that are not proved, by id, with their verdicts."""
    findings: list[Finding] = []
    target = entry.make(entry.configurations.named[name])
    Work(target, 2, lambda *_: None, findings.append).proved(target.properties, Limits())
    return {one.id: word(one.result) for one in findings if word(one.result) != "proved"}


def _marked(case: tuple[str, str]) -> Any:
    return pytest.param(*case, marks=() if case == QUICK else pytest.mark.slow, id=": ".join(case))


@pytest.mark.parametrize(("machine", "name"), [_marked(case) for case in CASES])
def test_every_configuration_is_proved(machine: str, name: str) -> None:
    """With the runs that ship with the machine, which show most cases."""
    vacuous, open_ = (some.get((machine, name), frozenset[str]()) for some in (VACUOUS, UNDECIDED))
    expected = {**dict.fromkeys(vacuous, "vacuous"), **dict.fromkeys(open_, "unknown")}
    assert expected == open_in(ENTRIES[machine], name)
