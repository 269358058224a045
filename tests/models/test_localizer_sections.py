"""One located train on board and in virtual sections: one truth, and no section that it is in is ever clear."""

from __future__ import annotations

import gzip
from collections.abc import Mapping
from functools import cache
from pathlib import Path

import pytest
from pydantic import ValidationError

from safeloc.language.expr import TRUE, Expr, Var
from safeloc.language.interpret import run
from safeloc.language.machine import Machine
from safeloc.language.nodes import Value
from safeloc.language.system import TransitionSystem, lower, without_ghosts
from safeloc.language.trace import Step
from safeloc.language.units import NM_PER_MM
from safeloc.language.verdict import Proved, word
from safeloc.models import localizer_sections
from safeloc.models.area import AreaConfig, moves_clause, reports_clause
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.localizer_sections import LocalizerSections, LocalizerSectionsConfig, compose_machines, train_ends
from safeloc.models.localizer_sections.simulate import ENDS, FOLDER, SCENES, SECTION, first_state, simulate, write
from safeloc.models.sections import SectionsConfig
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import obligations
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.provers.proved_base import base
from safeloc.proof.testing import run_tests
from safeloc.properties.localizer_sections import properties
from tests.models.everything_proved import shipped_runs
from tests.models.inductive import changed
from tests.proof.provers.small import told

CONFIG = LocalizerSectionsConfig()
SMALL = LocalizerSectionsConfig(localizer=LocalizerConfig(sources=("fibre",)))
FULL = LocalizerSectionsConfig(
    localizer=LocalizerConfig(),
    sections=SectionsConfig(sections=2, area=AreaConfig(trains=2, period_ms=100, limit_mm=1_000_000_000)),
)
CONTRACTS = [f"contract of {name} holds" for name in ("ends", "far_uplink", "trackside", "area")]


@cache
def small() -> LocalizerSections:
    """One source on board: what is behind the localizer is the same."""
    return compose_machines(SMALL)


def not_proved(config: LocalizerSectionsConfig) -> list[str]:
    """What is not proved of lemmas, contracts and properties; recordings show most of the properties' cases."""
    whole = compose_machines(config)
    shown = shipped_runs("localizer_sections")
    findings = prove(whole.composition.system, properties(whole), Limits(seconds=120), **shown)
    return [one.id for one in findings if not isinstance(one.result, Proved)]


# ------------------------------------------------------------------ contracts


def test_what_is_told_of_the_train_is_owed_not_assumed() -> None:
    """From the interval on board to the area: each machine's contract is proved."""
    known = base(small().composition.system)
    assert set(CONTRACTS) <= told(known.kept)
    assert {
        "area: train 1 within",
        "trackside: a complete train's far end is inside",
        "ends: the far end is inside",
    } <= told(known.facts)
    assert not known.refuted


def test_only_the_areas_own_environment_is_assumed() -> None:
    """Movement and reports of this train are clauses of the area that the whole does not assume."""
    area = small().area
    train = area.own.slots[0]
    assert {moves_clause(train), reports_clause(train)} <= set(area.machine.world.clauses)
    assert "train 1 is counted" in area.machine.world.clauses


@pytest.mark.slow
@pytest.mark.parametrize("wrong", ["integer", "place"])
def test_a_wrong_wire_to_the_area_is_not_proved(wrong: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """A train that is told to be whole though it is not; a report whose place is that of the estimate."""
    behind = localizer_sections._Behind
    right = behind._into_area

    def into_area(self: localizer_sections._Behind) -> Mapping[Var, Expr]:
        spoilt: dict[str, Mapping[Var, Expr]] = {
            "integer": {self.train.integer: TRUE},
            "place": {self.train.front.value: self.trackside.own.low},
        }
        return {**right(self), **spoilt[wrong]}

    monkeypatch.setattr(behind, "_into_area", into_area)
    known = base(compose_machines(SMALL).composition.system)
    assert "contract of area holds" in told(known.refuted)
    assert "area: train 1 within" not in told(known.facts)


# ------------------------------------------------------------------ the machines between


def refuted(machine: Machine) -> set[str]:
    """Lemmas that a machine by itself does not keep."""
    return told(base(lower(machine)).refuted)


def test_the_machines_between_keep_their_lemmas() -> None:
    """As they are, both do."""
    assert refuted(small().ends.machine) == set()
    assert refuted(small().trackside.machine) == set()


def test_a_train_that_is_not_confirmed_has_no_far_end() -> None:
    """Without the guard that asks for integrity, the far end told may be that of the front part."""
    ends = small().ends
    assert "the far end is inside" in refuted(changed(ends.machine, "both ends known", when=ends.own.valid))


def test_the_length_is_used_with_its_tolerance() -> None:
    """The far end told with the front end's own margin may not hold it."""
    ends = small().ends
    [row] = [t for t in ends.machine.transitions if t.name == "both ends known"]
    wrong = changed(ends.machine, "both ends known", set={**row.set, ends.own.far_margin_below: ends.own.below})
    assert "the far end is inside" in refuted(wrong)


def test_a_whole_train_is_told_to_its_far_end() -> None:
    """Bounds of the front end alone do not hold a whole train."""
    seen = small().trackside
    [row] = [t for t in seen.machine.transitions if t.name == "new report of both ends"]
    wrong = changed(seen.machine, "new report of both ends", set={**row.set, seen.own.low: seen.own.front.low})
    assert "a complete train's far end is inside" in refuted(wrong)


@pytest.mark.slow
@pytest.mark.parametrize("config", [SMALL, CONFIG], ids=["one", "shipped"])
def test_everything_is_proved(config: LocalizerSectionsConfig) -> None:
    """Every property, lemma and contract, with one source and as it ships."""
    assert not_proved(config) == []


@pytest.mark.slow
def test_everything_is_proved_with_all_sources_and_two_trains() -> None:
    """All five sources on board, another train in the area, two sections."""
    assert not_proved(FULL) == []


@pytest.mark.slow
def test_every_transition_fires() -> None:
    """All obligations, as it ships."""
    system = compose_machines(CONFIG).composition.system
    assert [one.id for one in obligations(system, Limits()) if not isinstance(one.result, Proved)] == []


NEVER_MET = {
    "tolerance",
    "no resurrection",
    "trackside containment",
    "trackside forgets",
    "train 1 report is widened by its age",
    "train 1 that may be split is believed at its leading end only",
    "section_1 names the rule",
    "section_1 is trusted as far as its reports are fresh",
    "section_1 obeys its timers",
    "both views agree",
    "the far end is inside its interval",
    "the trackside's view is never the narrower one",
    "a report counts once",
    "the host gets its source's interval",
    "the host is told its source's reason",
    "section_1 is never clear with this train in it",
}
"""What six runs from nowhere do not come to: a train that is located and tells the trackside of it."""


@pytest.mark.slow
def test_random_runs_hold() -> None:
    """Along plausible and faulty streams every property holds."""
    found = run_tests(small().composition.system, properties(small()), examples=6, steps=20, seed=5)
    vacuous = {one.id.rpartition("/")[2] for one in found if word(one.result) == "vacuous"}
    assert vacuous <= NEVER_MET
    assert {word(one.result) for one in found if one.id.rpartition("/")[2] not in NEVER_MET} == {"held"}


# ------------------------------------------------------------------ runs


@cache
def steps(name: str) -> tuple[Step, ...]:
    """A shipped scene with its environment; the interpreter refuses inputs that are out of range."""
    system = compose_machines(CONFIG).composition.system
    told = [
        {key: cell for key, cell in step.items() if key != "truth_mm"}
        for step in simulate(CONFIG, SCENES[name], seed=3)
    ]
    return run(system, told, first=first_state(CONFIG, SCENES[name])).steps


def free(step: Step) -> bool:
    """The section is reported clear."""
    return bool(step.outputs["section_1.clear"])


def inside(step: Step) -> bool:
    """Some part of the train is truly in the section."""
    rear, front = (int(step.state[f"train_1_true_{end}_um"]) for end in ("rear", "front"))
    return rear <= SECTION[1] * 1_000 and front >= SECTION[0] * 1_000


def test_a_train_runs_through_its_section() -> None:
    """FREE before it comes, not FREE while it is inside, FREE again behind it, with both ends told."""
    told = [free(step) for step in steps("through")]
    assert told[100] and told[-1]
    assert any(inside(step) for step in steps("through"))
    assert {step.fired["trackside.fired"] for step in steps("through")} == {"no new report", "new report of both ends"}


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", SCENES)
def test_no_section_is_clear_with_the_train_in_it(name: str) -> None:
    """In every cycle of every recording, against the truth."""
    assert [cycle for cycle, step in enumerate(steps(name)) if free(step) and inside(step)] == []


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", ["parted", "silent-uplink"])
def test_neither_a_lost_part_nor_silence_clears_it(name: str) -> None:
    """The front end has long left, on board it is located to the end; the section is not FREE any more."""
    last = steps(name)[-1]
    assert not last.outputs["delocalized.restrictive"]
    assert int(last.state["truth_nm"]) > (SECTION[1] + 200_000) * NM_PER_MM
    assert not any(free(step) for step in steps(name)[300:])


def test_recordings_come_out_the_same(tmp_path: Path) -> None:
    """What ships is what the module writes."""
    for path in write(tmp_path):
        assert gzip.decompress((FOLDER / path.name).read_bytes()) == gzip.decompress(path.read_bytes())


def test_on_board_and_trackside_run_without_their_environment() -> None:
    """No output depends on a ghost."""
    board = without_ghosts(compose_machines(CONFIG).composition.system)
    names = {var.name for var in board.inputs}
    scene = SCENES["through"]
    told = [{key: cell for key, cell in step.items() if key in names} for step in simulate(CONFIG, scene, seed=3)]
    first: dict[str, Value] = {key: value for key, value in first_state(CONFIG, scene).items() if key in _names(board)}
    assert [step.outputs for step in run(board, told, first=first).steps] == [step.outputs for step in steps("through")]


def _names(system: TransitionSystem) -> set[str]:
    return {var.name for var in system.state}


# ------------------------------------------------------------------ configuration


def test_vehicle_and_area_have_one_cycle_and_one_line() -> None:
    """Another period, or an area that is shorter than the line, is refused."""
    with pytest.raises(ValidationError, match="make them the same"):
        LocalizerSectionsConfig(sections=SectionsConfig(area=AreaConfig(trains=1, limit_mm=1_000_000_000)))
    with pytest.raises(ValidationError, match="the vehicle can be where the area has no places"):
        LocalizerSectionsConfig(sections=SectionsConfig(area=AreaConfig(trains=1, period_ms=100)))


def test_detection_inside_the_area_is_refused() -> None:
    """The claims of this machine do not tell the parts of a train apart."""
    area = AreaConfig(trains=1, period_ms=100, limit_mm=1_000_000_000, inner_detection=1)
    with pytest.raises(ValidationError, match=r"sections\.area\.inner_detection is 1, but this machine's claims take"):
        LocalizerSectionsConfig(sections=SectionsConfig(area=area))


def test_the_area_begins_where_the_train_is_counted_in() -> None:
    """The scenes' axle counter stands before the section, and the fibre begins there."""
    assert ENDS[0] < SECTION[0] < SECTION[1] < ENDS[1]
    assert all(scene.journey.fibre is not None and scene.journey.fibre.begin_mm == ENDS[0] for scene in SCENES.values())


def test_the_far_end_owes_its_place_to_the_front_end() -> None:
    """The clause is named, so that the composition can name it."""
    clauses = small().ends.machine.world.clauses
    assert train_ends.SENT in clauses
    assert len(clauses) == 4
