"""What the rules on markers are for, proved for all lengths by z3 and again by cvc5; a looser rule does not suffice."""

from __future__ import annotations

from collections.abc import Callable

import pytest

from safeloc.language.expr import BoolVar, Lit, Var, as_num, between, exact_to, number, with_unit
from safeloc.language.interpret import evaluate
from safeloc.language.nodes import Value
from safeloc.language.terms import variables
from safeloc.language.units import MM, NM, NM_PER_MM, PPM, PPM_PER_ONE
from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.layout_rules import markers as rules
from safeloc.models.layout_rules.marker_readers import MarkerReaders
from safeloc.models.odometry import build
from safeloc.models.odometry.variables import OdometryConfig, parts
from tests.models.sufficient_rules import Claim, require_loose, require_sufficient

LAYOUTS = {
    "default": LayoutConfig(markers=MarkerReaders()),
    "fine": LayoutConfig(
        tolerance_mm=10_000, odometry_constant_mm=1_000, odometry_rate_ppm=20_000,
        markers=MarkerReaders(vehicle_length_mm=120_000, max_speed_mm_s=22_223, reader_latency_ms=5),
    ),
}  # fmt: skip
REACH = 10**9
DISTANCE, APART, OFF = (number(name, MM, low, REACH) for name, low in (("distance", 0), ("apart", 0), ("off", -REACH)))
BEFORE, LAST, FIRST_OFF = (
    number(name, MM, low, REACH) for name, low in (("before", 0), ("last", 0), ("first_off", -REACH))
)
FIX = number("fix", NM, 0, REACH * NM_PER_MM)
ALL = [between(0, one, REACH) for one in (DISTANCE, APART, BEFORE, LAST)] + [between(0, FIX, REACH * NM_PER_MM)]


def kept(layout: LayoutConfig) -> Claim:
    """However the run to the next marker is measured, the error is within the tolerance at the end of the cycle in which it is read."""
    readers, rate = layout.readers, layout.odometry_rate_ppm
    true = exact_to(DISTANCE + OFF + layout.odometry_constant_mm, NM) + readers.unsteady_nm
    law = with_unit(BEFORE * (PPM_PER_ONE - rate), NM) <= true
    last = LAST <= readers.measured_in_a_cycle_mm
    error = FIX + exact_to(as_num(layout.odometry_constant_mm, MM), NM) + (BEFORE + LAST) * Lit(rate, PPM)
    back, none = as_num(readers.measured_in_a_cycle_mm, MM), as_num(0, MM)
    rule, loose = (rules.marker_is_near(DISTANCE, FIX, APART, held, layout) for held in (back, none))
    goal = error <= exact_to(as_num(layout.tolerance_mm, MM), NM)
    return Claim([law, last, between(-APART, OFF, APART)], rule, loose, goal)


def in_order(layout: LayoutConfig) -> Claim:
    """Wherever two markers lie, the second is passed later than the first, and in another cycle, by either reader."""
    rule = rules.markers_read_one_by_one(DISTANCE, APART, layout)
    spread = [between(-APART, OFF - FIRST_OFF, APART)]
    return Claim(spread, rule, DISTANCE > APART, DISTANCE + OFF - FIRST_OFF > layout.readers.cycle_run_mm)


CLAIMS: dict[str, Callable[[LayoutConfig], Claim]] = {claim.__name__: claim for claim in (kept, in_order)}


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("name", CLAIMS)
def test_the_rule_suffices(name: str, layout: str) -> None:
    """For every length: proved by z3, confirmed by cvc5; the rule itself can be kept."""
    claim = CLAIMS[name](LAYOUTS[layout])
    require_sufficient(name, ALL, claim)


@pytest.mark.parametrize("layout", LAYOUTS)
@pytest.mark.parametrize("name", CLAIMS)
def test_a_looser_rule_does_not_suffice(name: str, layout: str) -> None:
    """Without the cycle in which the next marker is read there is a counterexample."""
    claim = CLAIMS[name](LAYOUTS[layout])
    require_loose(name, ALL, claim)


def test_the_closed_form_of_the_marked_line() -> None:
    """With nothing but 5 m + 5 % the position is kept for 470 m of true run, as docs/examples/marked_line.py has it."""
    exact = LayoutConfig(markers=MarkerReaders(reader_latency_ms=0, vehicle_length_tolerance_mm=0))
    longest = rules.longest_run_mm(as_num(0, NM), as_num(0, MM), exact)
    assert [470_000] == evaluate([longest], {})


def test_the_figures_are_those_of_the_machine() -> None:
    """Names, ranges and defaults of the readers' figures are those of the odometry machine, so that both mean the same."""
    for name, field in MarkerReaders.model_fields.items():
        if name != "groups_are_markers":
            own = OdometryConfig.model_fields[name]
            assert (own.default, own.metadata) == (field.default, field.metadata)


def test_the_error_of_a_reading_is_the_machines() -> None:
    """At the highest measured speed, a reading with its distance leaves the margin that the audit reckons, to the nanometre."""
    config = OdometryConfig(second_unit=OdometryConfig().first_unit.model_copy(update={"kind": "radar"}))
    model = build(parts(config))
    own, step = model.own, config.limits.max_cycle_distance_mm
    reader, device = own.readers[1], own.devices[1]
    given: dict[Var, Value] = {
        var: False if isinstance(var, BoolVar) else 0 for var in variables([model.judgement.readings[1].fix.above])
    }
    for unit in device.units:
        given |= {unit.measured.present: True, unit.measured.value: step, unit.last: step}
    given |= {reader.since.present: True, reader.accuracy.present: True, reader.accuracy.value: 300}
    assert [MarkerReaders().fix_error_nm(300, 50_000)] == evaluate([model.judgement.readings[1].fix.above], given)
