"""Every claim of a shipped machine is proved in each of its declared configurations, not only in the defaults."""

from __future__ import annotations

from typing import Any

import pytest

from safeloc.catalogue import ENTRIES
from safeloc.language.spec import always
from safeloc.language.system import lower
from safeloc.language.verdict import word
from safeloc.models import odometry
from safeloc.models.odometry.marker_reading import OUT_OF_WINDOW
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
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
VACUOUS = {
    ("odometry", "one device, the first marker is believed"): WINDOWS,
    ("odometry", "satellites, units that drift, one device, the first reference is believed"): WINDOWS,
    ("reflector", "ultrasound in place of the radar"): WAITS,
}
"""Claims whose case does not occur in a configuration. Odometry: there no reading at all is refused as out of its window, as the test below proves.
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


@pytest.mark.slow
@pytest.mark.parametrize("name", [name for machine, name in VACUOUS if machine == "odometry"])
def test_no_reading_is_out_of_its_window_where_the_claim_on_it_is_vacuous(name: str) -> None:
    """Whether or not a unit slips in the cycle; so the vacuous claims lose nothing."""
    config = ENTRIES["odometry"].configurations.named[name]
    assert isinstance(config, OdometryConfig)
    model = odometry.build(odometry.parts(config, with_fault=config.single_fault_safe))
    never = [always(f"{one.name} reading fits", one.verdict.ne(OUT_OF_WINDOW)) for one in model.own.readers]
    found = prove(lower(model.machine), never, Limits(), jobs=2)
    assert {"proved"} == {word(one.result) for one in found}
    assert {f"odometry/property/{one.name}" for one in never} <= {one.id for one in found}
