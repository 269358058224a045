"""A channel of a counting head that comes free late: what is counted without a fault is counted where the wheel is, or a little farther on."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import pytest
from pydantic import ValidationError

from safeloc.language.expr import FALSE, Bool
from safeloc.language.verdict import word
from safeloc.models.axle_counter import AxleCounterConfig
from safeloc.models.counting_head import CountingHeadConfig, cycle
from safeloc.models.counting_head.late_wheels import late_um
from safeloc.models.counting_head.variables import Parts
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from tests.models.inductive import inductive_in
from tests.theorems.fibre.late_channel import claims, compose_late

LATE_MM = AxleCounterConfig().late_mm
FIGURE = "and no farther on"
RIGHT = cycle.counted_late


def kept(late_mm: int = LATE_MM) -> bool:
    """Whether the claim on the distance beyond the head follows in one step, of the device as it stands."""
    whole = compose_late()
    (prop,) = [one for one in claims(whole, late_mm) if one.name == FIGURE]
    return inductive_in(whole.composition.system, prop, FIGURE)


def test_a_wheel_is_counted_no_farther_on_than_the_counter_allows() -> None:
    """Whatever channel comes free late, and whenever: one wheel, its direction, and at most `late_mm` beyond the head; or a fault."""
    assert late_um(CountingHeadConfig()) < LATE_MM * 1_000
    whole = compose_late()
    findings = prove(whole.composition.system, claims(whole, LATE_MM), Limits(seconds=60))
    words = {one.id.rpartition("/")[2]: word(one.result) for one in findings}
    assert {"proved"} == {words[one.name] for one in claims(whole, LATE_MM)}
    assert {"proved"} == {words[name] for name in whole.composition.system.lemmas}


def _no_comparison(_: Parts) -> Bool:
    return FALSE


def _no_slow_wheel(own: Parts) -> Bool:
    return RIGHT(own) & (own.first_alone < own.config.wheel.slow_samples)


@pytest.mark.parametrize("wrong", [_no_comparison, _no_slow_wheel])
def test_a_head_that_compares_less_is_noticed(wrong: Callable[[Parts], Bool], monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the comparison, or with one for fast wheels alone, a wheel may be counted anywhere."""
    monkeypatch.setattr(cycle, "counted_late", wrong)
    assert not kept()


def test_the_figure_is_needed() -> None:
    """A third of it is not enough: a wheel at the highest speed may be counted farther on."""
    assert kept()
    assert not kept(LATE_MM // 3)


@pytest.mark.parametrize(
    "figures", [{"wheel": {"times_as_long": 6}}, {"counter": {"late_mm": 0}}, {"counter": {"late_mm": 608}}]
)
def test_a_counter_without_the_room_is_refused(figures: dict[str, Any]) -> None:
    """A rest twice as long, or a smaller figure of the counter: a wheel may be counted farther on than the record has room for."""
    with pytest.raises(
        (ValidationError, ValueError), match=r"beyond the head without a fault, but the counter leaves room for"
    ):
        CountingHeadConfig.model_validate(figures)
