"""Every claim of a shipped machine is proved in each of its declared configurations, not only in the defaults."""

from __future__ import annotations

from typing import Any

import pytest

from safeloc.catalogue import ENTRIES
from safeloc.language.spec import always
from safeloc.language.system import lower
from safeloc.language.verdict import Proved, word
from safeloc.models import odometry
from safeloc.models.odometry.marker_reading import OUT_OF_WINDOW
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.provers.reachability import reached
from safeloc.proof.results import Finding
from safeloc.proof.verification.one import Work
from safeloc.proof.verification.witness_files import read_witnesses
from safeloc.target import Entry

CASES = [(machine, name) for machine, entry in ENTRIES.items() for name in entry.configurations.named]
QUICK = ("emitter", "one pattern is enough")
TRUSTING = tuple(
    name
    for name, config in ENTRIES["odometry"].configurations.named.items()
    if isinstance(config, OdometryConfig) and config.trust_first_marker
)
"""Configurations of odometry in which the first reference is trusted."""
WAITS = frozenset({
    "reflector/property/the test begins with the prescribed distance",
    "reflector/property/the test goes on with the distance run",
    "reflector/property/the reference reflector is found in time",
})  # fmt: skip
VACUOUS = {("reflector", "ultrasound in place of the radar"): WAITS}
"""Claims whose case does not occur in a configuration.
Reflector: the wheel's constant of 5 m, on both sides, is more than 6 m of tolerance, so a self-test is made at the balise and never waits."""


def open_in(entry: Entry[Any], name: str) -> dict[str, str]:
    """The claims and lemmas that are not proved, by id, with their verdicts."""
    findings: list[Finding] = []
    target = entry.make(entry.configurations.named[name])
    Work(target, 2, lambda *_: None, findings.append).proved(target.properties, Limits())
    return {one.id: word(one.result) for one in findings if word(one.result) != "proved"}


def _marked(case: tuple[str, str]) -> Any:
    return pytest.param(*case, marks=() if case == QUICK else pytest.mark.slow, id=": ".join(case))


@pytest.mark.thorough
@pytest.mark.parametrize(("machine", "name"), [_marked(case) for case in CASES])
def test_every_configuration_is_proved(machine: str, name: str) -> None:
    """With the runs that ship with the machine, which show most cases."""
    expected = dict.fromkeys(VACUOUS.get((machine, name), ()), "vacuous")
    assert expected == open_in(ENTRIES[machine], name)


def _trusting(name: str) -> OdometryConfig:
    config = ENTRIES["odometry"].configurations.named[name]
    assert isinstance(config, OdometryConfig)
    return config


@pytest.mark.parametrize("name", TRUSTING)
def test_nothing_waits_as_a_candidate_where_the_first_reference_is_trusted(name: str) -> None:
    """Such a machine has no mode, no transition and no state of a candidate, which no run would reach."""
    config = _trusting(name)
    for one in (config, config.model_copy(update={"devices": 2})):
        made = odometry.machine(one)
        assert ("DELOCALIZED", "FRONT", "REAR")[: 1 + one.devices] == tuple(mode.label for mode in made.modes)
        rows = {row.name for row in made.transitions}
        assert {row for row in rows if "candidate" in row or "confirm" in row} == set()
        assert {f"trusted marker at {end}" for end in ("front", "rear")} <= rows
        assert "candidate_of_satellites" not in {var.name for var in made.state}


@pytest.mark.thorough
@pytest.mark.slow
@pytest.mark.parametrize("name", TRUSTING)
def test_every_mode_and_transition_occurs_where_the_first_reference_is_trusted(name: str) -> None:
    """Shown by a run of each; a row that no run reaches was declared here once."""
    target = ENTRIES["odometry"].make(_trusting(name))
    shown = reached(target.system, Limits(), witnesses=read_witnesses(target.witnesses))
    assert [] == [one.name for one in shown if not isinstance(one.verdict, Proved)]


@pytest.mark.slow
@pytest.mark.parametrize("name", TRUSTING)
def test_no_reading_is_out_of_its_window_with_one_device_and_no_stray_reading(name: str) -> None:
    """Whether or not a unit slips in the cycle, which is more than the claim says."""
    config = _trusting(name)
    model = odometry.build(odometry.parts(config, with_fault=config.single_fault_safe))
    never = [always(f"{one.name} reading fits", one.verdict.ne(OUT_OF_WINDOW)) for one in model.own.readers]
    found = prove(lower(model.machine), never, Limits(), jobs=2)
    assert {"proved"} == {word(one.result) for one in found}
    assert {f"odometry/property/{one.name}" for one in never} <= {one.id for one in found}
