"""Arbitration: what all valid sources have in common, led by the best; nothing where they exclude each other."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations

import pytest
from pydantic import ValidationError

from safeloc.language.expr import TRUE
from safeloc.language.interpret import run
from safeloc.language.nodes import Value
from safeloc.language.system import lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.verdict import Proved
from safeloc.models import arbitration
from safeloc.models.arbitration import SOURCES, Arbitration, ArbitrationConfig
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import obligations
from safeloc.proof.provers.portfolio import prove
from safeloc.properties.arbitration import properties
from tests.models.everything_proved import shipped_runs
from tests.models.inductive import changed, inductive, without

SUBSETS = [chosen for size in range(1, len(SOURCES) + 1) for chosen in combinations(SOURCES, size)]
FEW = [("satellite",), ("odometry", "balise"), ("reflector", "fibre"), SOURCES]


@dataclass(frozen=True)
class Says:
    """What a source states in a cycle, in mm."""

    position: int
    below: int
    above: int
    reference: bool = False


def machine(*sources: str) -> Arbitration:
    """Arbitration between some sources."""
    return arbitration.build(arbitration.parts(ArbitrationConfig(sources=sources or SOURCES)))


def step(distance: int | None = None, **stated: Says) -> dict[str, Value | None]:
    """One cycle: the measured distance, and what each source states; a source that is left out states nothing."""
    inputs: dict[str, Value | None] = {"distance_mm": distance}
    for name in SOURCES:
        says = stated.get(name, Says(0, 0, 0))
        inputs |= {
            f"{name}_valid": name in stated,
            f"{name}_position_mm": says.position,
            f"{name}_margin_below_mm": says.below,
            f"{name}_margin_above_mm": says.above,
            f"{name}_reference": says.reference,
            f"{name}_reason": "NONE" if name in stated else "TOLERANCE",
        }
    return inputs


def ran(*steps: Mapping[str, Value | None]) -> Trace:
    """The machine with all sources, without its environment, over these cycles."""
    return run(without_ghosts(lower(machine().machine)), steps)


def interval(trace: Trace) -> tuple[object, ...]:
    """What is given out after the last cycle: lower end, estimate, upper end; nothing: empty."""
    last = trace.steps[-1].outputs
    if not last["valid"]:
        return ()
    position = last["position_mm"]
    return position - last["margin_below_mm"], position, position + last["margin_above_mm"]


def lead(trace: Trace) -> object:
    """The leading source after the last cycle, as a member's number: 0 for none."""
    return trace.steps[-1].outputs["lead"]


REFERRED = Says(10_000, 500, 800, reference=True)


def test_the_common_part_counts_and_the_smallest_margin_leads() -> None:
    """Odometry 8000..13000, balise 9500..10800: what both have in common, with the balise's estimate."""
    trace = ran(step(odometry=Says(11_000, 3_000, 2_000), balise=REFERRED))
    assert interval(trace) == (9_500, 10_000, 10_800)
    assert lead(trace) == 1 + SOURCES.index("balise")


def test_the_leaders_estimate_is_brought_into_what_all_have_in_common() -> None:
    """The balise leads with 10000, but odometry begins at 10100."""
    trace = ran(step(odometry=Says(12_000, 1_900, 2_000), balise=REFERRED))
    assert interval(trace) == (10_100, 10_100, 10_800)


def test_two_that_exclude_each_other_are_named_and_nothing_is_given_out() -> None:
    """Balise 9500..10800 and satellite 11000..13000: withheld in the same step, both named."""
    trace = ran(step(balise=REFERRED), step(100, balise=Says(10_100, 500, 800), satellite=Says(12_000, 1_000, 1_000)))
    assert interval(trace) == ()
    said = trace.steps[-1].outputs
    assert {said["contradicting_first"], said["contradicting_second"]} == {
        1 + SOURCES.index("balise"),
        1 + SOURCES.index("satellite"),
    }


def test_after_a_contradiction_agreement_alone_is_not_enough() -> None:
    """Without an absolute reference in the cycle nothing is given out again; with one it is."""
    clash = step(100, balise=Says(10_100, 500, 800), satellite=Says(12_000, 1_000, 1_000))
    agreed = step(100, balise=Says(10_200, 500, 800), satellite=Says(10_300, 1_000, 1_000))
    assert interval(ran(step(balise=REFERRED), clash, agreed)) == ()
    assert interval(ran(step(balise=REFERRED), clash, step(balise=REFERRED))) == (9_500, 10_000, 10_800)


def test_a_reference_does_not_help_while_sources_contradict() -> None:
    """The one that is wrong may be the one with the reference."""
    assert interval(ran(step(balise=REFERRED, satellite=Says(20_000, 100, 100)))) == ()


def test_another_stands_in_for_a_leader_that_withdraws() -> None:
    """In the cycle in which the balise states nothing any more, odometry leads with its wider interval."""
    both = step(odometry=Says(11_000, 3_000, 2_000), balise=REFERRED)
    trace = ran(both, step(100, odometry=Says(11_100, 3_050, 2_050)))
    assert interval(trace) == (8_050, 11_100, 13_150)
    assert trace.steps[-1].fired == {"fired": "odometry stands in"}


def test_a_leader_is_not_changed_for_an_equal_one() -> None:
    """Equal margins change nothing; a smaller one does."""
    first = step(balise=Says(10_000, 500, 500, reference=True))
    equal = step(100, odometry=Says(10_100, 500, 500), balise=Says(10_100, 500, 500))
    smaller = step(100, odometry=Says(10_100, 400, 400), balise=Says(10_100, 500, 500))
    assert ran(first, equal).steps[-1].fired == {"fired": "balise goes on leading"}
    assert ran(first, smaller).steps[-1].fired == {"fired": "odometry takes over"}


def test_min_safe_front_end_lags_behind_a_sudden_narrowing() -> None:
    """A better source lifts the lower end from 7000 to 9900 in a cycle of 100 mm: the front end told goes to 7100."""
    wide, narrow = Says(10_000, 3_000, 3_000, reference=True), Says(10_100, 200, 200)
    trace = ran(step(odometry=wide), step(100, odometry=Says(10_100, 3_000, 3_000), satellite=narrow))
    assert interval(trace) == (9_900, 10_100, 10_300)
    assert trace.steps[-1].outputs["min_safe_front_mm"] == 7_100


def test_without_a_measured_distance_the_estimate_tells_it() -> None:
    """From 10000 to 10080 estimated: the front end told advances by 80 at most."""
    wide = Says(10_000, 3_000, 3_000, reference=True)
    trace = ran(step(odometry=wide), step(None, satellite=Says(10_080, 200, 200)))
    assert trace.steps[-1].outputs["min_safe_front_mm"] == 7_080


def test_wider_than_tolerable_is_withheld() -> None:
    """One source with 40 m on one side gives no position within 30 m."""
    trace = ran(step(balise=REFERRED), step(100, fibre=Says(10_000, 40_000, 1_000)))
    assert interval(trace) == ()
    assert trace.steps[-1].fired == {"fired": "tolerance exceeded"}


def test_the_reason_is_that_of_the_source_that_led() -> None:
    """When the last source withdraws, its own reason is told: TOLERANCE, the third of the enumeration."""
    trace = ran(step(balise=REFERRED), step())
    assert trace.steps[-1].fired == {"fired": "no source is left"}
    assert trace.steps[-1].outputs["reason"] == 2


def test_unknown_sources_are_refused() -> None:
    """Sources are named, each once."""
    with pytest.raises(ValidationError, match="each at most once"):
        ArbitrationConfig(sources=("odometry", "odometry"))
    with pytest.raises(ValidationError, match="must be some of"):
        ArbitrationConfig(sources=("compass",))


@pytest.mark.thorough
@pytest.mark.parametrize("sources", FEW, ids="+".join)
def test_everything_is_proved(sources: tuple[str, ...]) -> None:
    """Every property and lemma, whatever the sources are; a single source takes over from none, and nothing is claimed of it."""
    model = machine(*sources)
    findings = prove(lower(model.machine), properties(model), Limits(), **shipped_runs("arbitration"))
    taken_over = {one.id for one in findings if one.id.endswith("takes over for a reason")}
    wanted = sources if len(sources) > 1 else ()
    assert taken_over == {f"arbitration/property/{source} takes over for a reason" for source in wanted}
    assert [one.id for one in findings if not isinstance(one.result, Proved)] == []


@pytest.mark.slow
@pytest.mark.parametrize("sources", [chosen for chosen in SUBSETS if chosen not in FEW], ids="+".join)
def test_every_choice_of_sources_is_proved(sources: tuple[str, ...]) -> None:
    """All 31 choices of sources."""
    test_everything_is_proved(sources)


@pytest.mark.thorough
def test_every_transition_fires_in_some_run() -> None:
    """All obligations, with three sources."""
    system = lower(machine("odometry", "balise", "satellite").machine)
    assert [one.id for one in obligations(system, Limits()) if not isinstance(one.result, Proved)] == []


@pytest.mark.parametrize(
    ("transition", "property_"),
    [
        ("sources contradict each other", "odometry against balise"),
        ("tolerance exceeded", "tolerance"),
    ],
)
def test_a_missing_guard_is_noticed(transition: str, property_: str) -> None:
    """Without the transition the property that speaks of it is not kept any more."""
    model = machine("odometry", "balise")
    prop = next(one for one in properties(model) if one.name == property_)
    assert inductive(model.machine, prop)
    assert not inductive(without(model.machine, transition), prop)


def test_leading_without_a_reference_is_noticed() -> None:
    """A machine that gives out a position again by agreement alone breaks `no resurrection`."""
    model = machine("odometry", "balise")
    prop = next(one for one in properties(model) if one.name == "no resurrection")
    wrong = changed(
        model.machine, "balise leads first", when=model.cycle.usable & model.cycle.leads(model.own.sources[1])
    )
    assert inductive(model.machine, prop)
    assert not inductive(wrong, prop)


def test_a_front_end_that_does_not_lag_is_noticed() -> None:
    """Telling the interval's own lower end breaks the limit on the front end's advance."""
    model = machine("odometry", "balise")
    prop = next(one for one in properties(model) if one.name == "min safe front end advances with the distance")
    row = next(t for t in model.machine.transitions if t.name == "balise takes over")
    wrong = changed(model.machine, "balise takes over", set={**row.set, model.own.lag: 0}, when=row.when & TRUE)
    assert not inductive(wrong, prop)
