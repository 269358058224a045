"""What an error law shares with its machine: an added error that is left out weakens both, and only a property in figures sees it."""

from __future__ import annotations

import pytest

from safeloc.language.expr import Lit, Num, abs_, as_num, exact_to, ite
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.language.system import TransitionSystem, lower
from safeloc.language.units import MM, NM, PPM
from safeloc.models import fibre, guard, sections
from safeloc.models.area import AreaConfig
from safeloc.models.area.slot import Reach, Slot
from safeloc.models.fibre.cycle import Cycle
from safeloc.models.guard import box
from safeloc.models.guard.variables import GuardConfig
from safeloc.models.guard.variables import Parts as GuardParts
from safeloc.models.guard.variables import parts as guard_parts
from safeloc.properties.fibre import properties as fibre_properties
from safeloc.properties.guard import properties as guard_properties
from safeloc.properties.sections import properties as section_properties
from tests.models.inductive import inductive_in

Found = tuple[TransitionSystem, dict[str, Property]]
CHARGES = {
    "fibre": ("every run adds its error", "an edge adds the run of its cycle to the error"),
    "guard": (
        "an interval begun by a fix covers the fix's whole error",
        "a fix narrows no further than to its own error",
    ),
    "sections": (
        "train 1 report is widened by its age",
        "train 1 that may be split is believed at its leading end only",
    ),
}


def _fibre() -> Found:
    model = fibre.build(fibre.parts(fibre.FibreConfig()))
    return _single(model.machine, fibre_properties(model))


def _guard() -> Found:
    config = GuardConfig(confirmations=3, speed_window_ms=400, window_limit_mm=40_000)
    model = guard.build(guard_parts(config))
    return _single(model.machine, guard_properties(model))


def _sections() -> Found:
    model = sections.compose_machines(sections.SectionsConfig(area=AreaConfig(trains=1)))
    return model.composition.system, {one.name: one for one in section_properties(model)}


def _single(machine: Machine, found: list[Property]) -> Found:
    return lower(machine), {one.name: one for one in found}


BUILT = {"fibre": _fibre, "guard": _guard, "sections": _sections}


def _lost(name: str) -> list[str]:
    """Properties about added errors that the machine, as it is built now, does not keep."""
    system, found = BUILT[name]()
    return [one for one in CHARGES[name] if not inductive_in(system, found[one])]


@pytest.mark.parametrize("name", BUILT)
def test_every_error_is_added(name: str) -> None:
    """Each machine adds what its figures say."""
    assert _lost(name) == []


def _rate_only(cycle: Cycle) -> Num:
    rate = abs_(cycle.own.run.value) * Lit(cycle.own.config.rate_ppm, PPM)
    return ite(cycle.own.run.present, rate, Lit(cycle.own.config.max_cycle_distance_mm * 1_000_000, NM))


def test_a_run_without_its_floor_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """A run in a fibre to which only its rate is added."""
    monkeypatch.setattr(Cycle, "added_error", property(_rate_only))
    assert "every run adds its error" in _lost("fibre")


def test_an_edge_without_its_run_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """An edge in a fibre that is taken to have been passed at the end of its cycle."""
    monkeypatch.setattr(Cycle, "fresh", property(lambda cycle: as_num(0, NM) + cycle.added_error))
    assert _lost("fibre") == ["an edge adds the run of its cycle to the error"]


def test_a_fix_without_its_age_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """A receiver's fix to which only its error is added, neither its age nor its distance off the track."""

    def error_only(own: GuardParts) -> Num:
        return exact_to(as_num(own.config.fix_error_mm, MM), NM)

    monkeypatch.setattr(box, "half_nm", error_only)
    assert _lost("guard") == list(CHARGES["guard"])


def test_a_report_without_its_age_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """A train's report that is taken for one of now."""
    monkeypatch.setattr(Reach, "added_error_mm", lambda reach, age_ms: as_num(0, MM))
    assert _lost("sections") == ["train 1 report is widened by its age"]


def test_a_split_train_that_is_believed_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """A train's rear end that is taken from a report although the train may have lost a part."""
    monkeypatch.setattr(Slot, "holds_low", property(lambda slot: slot.trusted))
    assert _lost("sections") == ["train 1 that may be split is believed at its leading end only"]
