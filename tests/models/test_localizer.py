"""The localizer's composition: what one machine tells another is proved true, and a wrong wire is not."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from itertools import combinations
from typing import get_args

import pytest
from pydantic import ValidationError

from safeloc.language.composition import Clause, compose
from safeloc.language.expr import TRUE, Expr, Lit, Num, minimum
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import MM
from safeloc.language.verdict import Proved
from safeloc.models.arbitration import ArbitrationConfig
from safeloc.models.localizer import Localizer, LocalizerConfig, SourceName, compose_machines
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.models.reflector.world import PRESCRIBED, READING
from safeloc.models.satellite.variables import SatelliteConfig
from safeloc.models.satellite.world import SELECTED
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.provers.proved_base import base
from safeloc.properties import arbitration
from safeloc.properties.localizer import properties
from tests.models.everything_proved import shipped_runs
from tests.proof.provers.small import told as names

SOURCES: tuple[SourceName, ...] = get_args(SourceName)
CHOICES = [chosen for size in range(1, len(SOURCES) + 1) for chosen in combinations(SOURCES, size)]
CONTRACT = "contract of position holds"
INSIDE = "position: the truth is inside"


def referring(first: SourceName = "balise") -> Localizer:
    """A localizer whose satellite position hears references of another source."""
    return compose_machines(LocalizerConfig(sources=(first, "satellite")))


def up_to_the_position(whole: Localizer, changed: Mapping[str, Expr]) -> TransitionSystem:
    """Only the machines up to the satellites' position, with wires to it changed, by the input's name."""
    first, position = whole.pieces.values()
    wires = {**first.wires, **position.wires}
    for name, term in changed.items():
        [heard] = [var for var in wires if var.name == name]
        wires[heard] = term
    machines = (whole.motion.machine, *first.machines, *position.machines)
    return compose(
        "part", machines, wires, shared=whole.motion.shared, discharge=[*first.discharged, *position.discharged]
    ).system


def told(whole: Localizer) -> Num:
    """What the satellites' position hears as reference, whether it is trusted or not."""
    [first, _] = whole.pieces.values()
    return first.stated.position


@pytest.mark.slow
def test_a_reference_is_owed_not_assumed() -> None:
    """What a balise tells the satellites' position is proved to be true, and then the truth is inside."""
    known = base(up_to_the_position(referring(), {}))
    assert CONTRACT in names(known.kept)
    assert INSIDE in names(known.facts)
    assert not known.refuted


def test_without_an_earlier_source_it_is_assumed() -> None:
    """Satellites alone: references come from the environment; only what the selection keeps is discharged."""
    whole = compose_machines(LocalizerConfig(sources=("satellite",)))
    assert [SELECTED] == [one.name for one in whole.pieces["satellite"].discharged if isinstance(one, Clause)]
    assert "position.reference_mm.present" in {var.name for var in whole.composition.system.inputs}


def _no_error(_: Localizer) -> Mapping[str, Expr]:
    return {"reference_accuracy_mm": Lit(0, MM)}


def _untrusted(whole: Localizer) -> Mapping[str, Expr]:
    return {"reference_mm.present": TRUE, "reference_mm": told(whole)}


def _half(whole: Localizer) -> Mapping[str, Expr]:
    [first, _] = whole.pieces.values()
    return {"reference_accuracy_mm": minimum(first.stated.below, whole.config.satellite.tolerance_mm)}


@pytest.mark.thorough
@pytest.mark.parametrize(
    "wrong", [_untrusted, *(pytest.param(one, marks=pytest.mark.slow) for one in (_no_error, _half))]
)
def test_a_wrong_wire_is_not_proved(wrong: Callable[[Localizer], Mapping[str, Expr]]) -> None:
    """No accuracy, a reference that is not trusted, the margin of one side alone: to be discharged, and not kept."""
    whole = referring()
    known = base(up_to_the_position(whole, wrong(whole)))
    assert CONTRACT in names(known.refuted)
    assert INSIDE not in names(known.facts)


@pytest.mark.thorough
def test_arbitration_is_the_one_that_is_proved_by_itself() -> None:
    """With the figures of the shipped target `arbitration`; of a vehicle with a smaller tolerance it is proved as well."""
    assert LocalizerConfig().arbitration == ArbitrationConfig()
    whole = compose_machines(LocalizerConfig(sources=("odometry", "balise"), tolerance_mm=12_000))
    findings = prove(lower(whole.arbitration.machine), arbitration.properties(whole.arbitration), Limits())
    assert [one.id for one in findings if not isinstance(one.result, Proved)] == []


def test_groups_anchor_the_reflectors() -> None:
    """With balises a reading is owed, with its distance, and none of it is an input."""
    system = compose_machines().composition.system
    owed = {part.name: part.guaranteed for part in system.parts if part.guaranteed}
    assert {READING, PRESCRIBED} <= set(owed["reflector"])
    inputs = {var.name for var in system.inputs}
    assert not {name for name in inputs if name.startswith(("reflector.balise", "line.switch"))}
    assert not inputs & {"reflector.route_contradicted", "reflector.next_position_mm", "reflector.next_reference_mm"}
    assert {"balise.telegram_reflector_mm", "line.next_position_mm", "line.next_reference_mm"} <= inputs


def test_without_balises_readings_are_assumed() -> None:
    """Nothing in such a vehicle judges them."""
    whole = compose_machines(LocalizerConfig(sources=("odometry", "reflector")))
    system = whole.composition.system
    [reflectors] = [part for part in system.parts if part.name == "reflector"]
    assert READING not in reflectors.guaranteed and PRESCRIBED not in reflectors.guaranteed
    assert {"reflector.balise_position_mm", "reflector.next_position_mm", "reflector.route_contradicted"} <= {
        var.name for var in system.inputs
    }
    assert "line" not in {machine.name for machine in whole.machines}


def test_an_accepted_group_can_be_handed_over() -> None:
    """Figures with which it could not are refused, where a vehicle has balises and reflectors."""
    few = LocalizerConfig().reflector.model_copy(update={"last_balise_identity": 1_000_000})
    with pytest.raises(
        ValidationError, match=r"reflector\.last_balise_identity 1000000 is below balise\.last_group_identity 16777216"
    ):
        LocalizerConfig(reflector=few)
    assert LocalizerConfig(sources=("odometry", "reflector"), reflector=few).reflector == few


def test_what_is_said_of_one_vehicle_is_said_once() -> None:
    """A way of locating that is told another greatest acceleration would exclude what the others allow."""
    slower = SatelliteConfig(period_ms=100, coast_limit_cycles=20, max_acceleration_mm_s2=1_500)
    with pytest.raises(ValidationError, match=r"odometry\.satellite_markers must be false: nothing here checks"):
        LocalizerConfig(odometry=OdometryConfig(satellite_markers=True))
    with pytest.raises(ValidationError, match=r"satellite\.max_acceleration_mm_s2 is 1500, but the vehicle's is 2500"):
        LocalizerConfig(satellite=slower)


def test_only_what_a_vehicle_has_must_fit() -> None:
    """A small tolerance is refused because of the fibre's wide link, but not where there is no fibre."""
    with pytest.raises(
        ValidationError, match=r"downlink\.margin_limit_mm 300000 is beyond ten times tolerance_mm 12000"
    ):
        LocalizerConfig(sources=("odometry", "fibre"), tolerance_mm=12_000)
    assert LocalizerConfig(sources=("odometry",), tolerance_mm=12_000).tolerance_mm == 12_000


@pytest.mark.slow
@pytest.mark.parametrize("sources", CHOICES, ids="+".join)
def test_every_choice_of_sources_is_proved(sources: tuple[SourceName, ...]) -> None:
    """Every property, lemma and contract of the whole, whichever of the 31 choices of sources a vehicle has.

    Recordings of a vehicle with all sources show the cases of properties, which a search would take minutes to find.
    """
    whole = compose_machines(LocalizerConfig(sources=sources))
    findings = prove(whole.composition.system, properties(whole), Limits(seconds=120), **shipped_runs("localizer"))
    assert [one.id for one in findings if not isinstance(one.result, Proved)] == []
