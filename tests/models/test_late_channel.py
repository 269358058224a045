"""A channel of a counting head that comes free late: what is counted without a fault is counted where the wheel is, or a little farther on."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safeloc.language.expr import FALSE, Bool
from safeloc.language.verdict import word
from safeloc.models.axle_counter import AxleCounterConfig
from safeloc.models.counting_head import CountingHeadConfig, cycle
from safeloc.models.counting_head.configuration import WheelTimes
from safeloc.models.counting_head.variables import Parts
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from tests.theorems.fibre.late_channel import claims, compose_late, late_um

LATE_MM = AxleCounterConfig().late_mm
RIGHT = cycle.counted_late


def not_proved(late_mm: int = LATE_MM) -> set[str]:
    """The claims of the theorem that are not proved of the device as it stands."""
    whole = compose_late()
    properties = claims(whole, late_mm)
    findings = [
        one for one in prove(whole.composition.system, properties, Limits(seconds=60)) if one.kind == "property"
    ]
    assert len(findings) == len(properties)
    return {one.id.rpartition("/")[2] for one in findings if word(one.result) != "proved"}


def test_a_wheel_is_counted_no_farther_on_than_the_counter_allows() -> None:
    """Whatever channel comes free late, and whenever: one wheel, its direction, and at most `late_mm` beyond the head; or a fault."""
    assert late_um(CountingHeadConfig()) < LATE_MM * 1_000
    assert set() == not_proved()


def _no_comparison(_: Parts) -> Bool:
    return FALSE


def _no_slow_wheel(own: Parts) -> Bool:
    return RIGHT(own) & (own.first_alone < own.config.wheel.slow_samples)


@pytest.mark.parametrize("wrong", [_no_comparison, _no_slow_wheel])
def test_a_head_that_compares_less_is_noticed(wrong: Callable[[Parts], Bool], monkeypatch: pytest.MonkeyPatch) -> None:
    """Without the comparison, or with one for fast wheels alone, a wheel may be counted anywhere."""
    monkeypatch.setattr(cycle, "counted_late", wrong)
    assert "and no farther on" in not_proved()


def test_the_figure_is_needed() -> None:
    """A third of it is not enough: a wheel at the highest speed may be counted farther on."""
    assert {"and no farther on"} == not_proved(LATE_MM // 3)


def test_a_longer_rest_is_farther_on() -> None:
    """The figure follows from the comparison: twice as long a rest, and the counter's figure is too small."""
    longer = replace_wheel(times_as_long=6)
    assert late_um(longer) > LATE_MM * 1_000


def replace_wheel(**figures: int) -> CountingHeadConfig:
    """The shipped figures, with other times of a wheel."""
    return CountingHeadConfig(wheel=WheelTimes(**figures))
