"""A position on its way: its age widens it, a newer report replaces it, silence and revocation take it away."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safeloc.language.expr import TRUE
from safeloc.language.interpret import run
from safeloc.language.system import lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved
from safeloc.models import transmission
from safeloc.models.transmission import Transmission, TransmissionConfig
from safeloc.models.vocabulary.absent import NO_POSITION_MM
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import obligations
from safeloc.proof.provers.portfolio import prove
from safeloc.properties.transmission import properties
from tests.models.everything_proved import shipped_runs
from tests.models.inductive import changed, inductive

CONFIG = TransmissionConfig(max_speed_mm_s=10_000, age_limit_ms=500)
RUN_MM = 1_000
"""The farthest in a cycle of 100 ms at 10 m/s."""


def link(config: TransmissionConfig = CONFIG) -> Transmission:
    """The machine of one link."""
    return transmission.build(transmission.parts(config))


def step(sent: int | None = None, *, arrived: bool = False, revokes: bool = False) -> dict[str, int | bool]:
    """One cycle: a position in mm that is sent, within 50 mm behind and 70 mm ahead; or a report that revokes."""
    told = {"sent_valid": sent is not None, "sent_position_mm": sent or 0}
    return {
        "sent": sent is not None or revokes, "arrived": arrived, **told, "sent_margin_below_mm": 50 if sent else 0,
        "sent_margin_above_mm": 70 if sent else 0,
    }  # fmt: skip


def ran(*steps: dict[str, int | bool]) -> Trace:
    """The link without its environment, over these cycles."""
    return run(without_ghosts(lower(link().machine)), steps)


def told(trace: Trace) -> list[tuple[object, ...]]:
    """Per cycle: valid, position, under, over, age."""
    names = ("valid", "position_mm", "margin_below_mm", "margin_above_mm", "age_ms")
    return [tuple(one.outputs[name] for name in names) for one in trace.steps]


def test_age_adds_error_on_both_sides() -> None:
    """Sent in cycle 1, it arrives in cycle 3, two cycles old, and grows older by one cycle's run on either side."""
    trace = ran(step(5_000), step(), step(arrived=True), step())
    assert told(trace)[2:] == [
        (True, 5_000, 50 + 2 * RUN_MM, 70 + 2 * RUN_MM, 200),
        (True, 5_000, 50 + 3 * RUN_MM, 70 + 3 * RUN_MM, 300),
    ]


def test_silence_withdraws_it() -> None:
    """After the age limit nothing is given out any more, and nothing comes back by itself."""
    trace = ran(step(5_000), step(arrived=True), *(step() for _ in range(6)))
    assert [one[0] for one in told(trace)] == [False, *[True] * 5, False, False]
    assert trace.steps[6].fired == {"fired": "report has become too old"}


def test_a_report_lost_on_its_way_never_arrives() -> None:
    """What is on its way for longer than the age limit is gone."""
    trace = ran(step(5_000), *(step() for _ in range(6)), step(arrived=True))
    assert not told(trace)[-1][0]


def test_a_newer_report_takes_the_place_of_an_older_one() -> None:
    """One is on its way at a time; what arrives is the newest that was sent before."""
    trace = ran(step(5_000), step(6_000), step(arrived=True))
    assert told(trace)[-1] == (True, 6_000, 50 + RUN_MM, 70 + RUN_MM, 100)


def test_a_report_that_is_sent_while_another_arrives_follows_it() -> None:
    """Arriving comes first: the one sent in that cycle is on its way."""
    trace = ran(step(5_000), step(6_000, arrived=True), step(arrived=True))
    assert [one[1] for one in told(trace)] == [NO_POSITION_MM, 5_000, 6_000]


def test_revocation_takes_the_position_away() -> None:
    """A report without a position withdraws the one that is held, in the cycle in which it arrives."""
    trace = ran(step(5_000), step(arrived=True), step(revokes=True), step(arrived=True))
    assert [one[0] for one in told(trace)] == [False, True, True, False]
    assert trace.steps[-1].fired == {"fired": "report revokes"}


def test_what_has_become_too_wide_is_withdrawn() -> None:
    """The limit of the margin counts with the age added."""
    config = TransmissionConfig(max_speed_mm_s=10_000, age_limit_ms=5_000, margin_limit_mm=2_000)
    system = without_ghosts(lower(link(config).machine))
    trace = run(system, [step(5_000), step(arrived=True), step()])
    assert [one.outputs["valid"] for one in trace.steps] == [False, True, False]
    assert trace.steps[-1].fired == {"fired": "report has become too wide"}


@pytest.mark.thorough
def test_everything_is_proved() -> None:
    """Every property and lemma, and every obligation: all transitions fire in some run."""
    model = link()
    findings = prove(lower(model.machine), properties(model), Limits(), **shipped_runs("transmission"))
    findings += obligations(lower(model.machine), Limits())
    assert [one.id for one in findings if not isinstance(one.result, Proved)] == []


def test_a_link_without_a_limit_of_width_is_noticed() -> None:
    """Without the transition that looks at the width, the limit is not kept."""
    model = link()
    wrong = changed(model.machine, "report has become too wide", when=~TRUE)
    prop = next(one for one in properties(model) if one.name == "tolerance")
    assert inductive(model.machine, prop)
    assert not inductive(wrong, prop)


@pytest.mark.parametrize("property_", ["containment", "age widens a stored report"])
def test_a_link_that_forgets_to_age_is_noticed(property_: str) -> None:
    """A held report that stays as it is neither keeps the truth nor adds the error of its age."""
    model = link()
    wrong = replace(model, machine=changed(model.machine, "report grows older", set={}))
    right_one, wrong_one = (next(one for one in properties(each) if one.name == property_) for each in (model, wrong))
    assert inductive(model.machine, right_one)
    assert not inductive(wrong.machine, wrong_one)
