"""The runs that ship with the unlinked group: what is told of each comes true, and the truth lies in every interval."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest

from safeloc.catalogue import load_target
from safeloc.language.interpret import run
from safeloc.language.monitor import check_all
from safeloc.language.system import lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.units import NM_PER_MM
from safeloc.language.verdict import word
from safeloc.models import balise
from safeloc.models.balise.groups import telegram
from safeloc.models.unlinked_group.simulate import RUNS, beside, mixed_line
from safeloc.models.unlinked_group.variables import UnlinkedGroupConfig
from safeloc.proof.provers.replayed_evidence import admissible_run
from safeloc.proof.verification.replay import replay_stream
from safeloc.runtime.streams.gzipped import name_of
from safeloc.runtime.streams.steps import Cell, read_steps
from safeloc.target import Target
from tests.models.unlinked_runs import label
from tests.shipped_recordings import shipped

CONFIG = UnlinkedGroupConfig()


@cache
def target() -> Target:
    """The shipped machine; this process makes it once."""
    return load_target("unlinked_group")


@cache
def lawful(stem: str) -> Trace:
    """A shipped recording with its truth; refused if it breaks what is assumed."""
    recorded = read_steps(shipped(stem))
    return admissible_run(target().system, dict(recorded.first), recorded.steps)


def slacks(stem: str) -> list[tuple[int, int]]:
    """How far the true distance is from the lower and the upper end of each reported interval, nm."""
    found = []
    for one in lawful(stem).steps:
        if one.outputs["valid"]:
            distance, truth = int(one.outputs["distance_mm"]), int(one.state["true_distance_nm"])
            below, above = int(one.outputs["margin_below_mm"]), int(one.outputs["margin_above_mm"])
            found.append((truth - (distance - below) * NM_PER_MM, (distance + above) * NM_PER_MM - truth))
    return found


def course(stem: str) -> list[tuple[str, int]]:
    """Reason and reference, each pair as often as it was come to."""
    trace = lawful(stem)
    found = [(label(trace, "reason", at), int(one.outputs["group"])) for at, one in enumerate(trace.steps)]
    return [one for number, one in enumerate(found) if number == 0 or found[number - 1] != one]


def judged(stem: str) -> list[str]:
    """The verdicts on all readings."""
    trace = lawful(stem)
    told = [label(trace, "telegram", at) for at in range(len(trace.steps))]
    return [one for one in told if one != "NONE"]


@pytest.mark.parametrize("stem", RUNS)
def test_a_recording_is_its_run(stem: str) -> None:
    """The file that ships is what the simulation makes, step by step, and ships with its machine."""
    assert list(read_steps(shipped(stem)).steps) == RUNS[stem].steps(CONFIG)
    assert stem in map(name_of, target().streams)
    assert RUNS[stem].outcome.endswith(".")


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("stem", RUNS)
def test_every_claim_holds_on_a_recording(stem: str) -> None:
    """With its truth it keeps what is assumed, and every property holds on it; `verify` finds the same."""
    assert {"held"} == {word(one) for one in check_all(lawful(stem), target().properties)}
    _, findings = replay_stream(target(), shipped(stem))
    assert {"held"} == {word(one.result) for one in findings}


@pytest.mark.parametrize("stem", RUNS)
def test_the_true_distance_is_in_every_interval(stem: str) -> None:
    """Asked of the recording itself, to the nanometre."""
    slack = slacks(stem)
    assert len(slack) > 70
    assert min(map(min, slack)) >= 0


def test_at_the_limits_the_truth_is_at_the_ends() -> None:
    """With a counter no margin is a nanometre wider than it has to be: 18 readings at each end, less one on the way between them."""
    below, above = zip(*slacks("unlinked_group-at-the-limits"), strict=True)
    assert (18, 17) == (above.count(0), below.count(0))
    assert ["TAKEN"] * 72 == judged("unlinked_group-at-the-limits")


@pytest.mark.thorough
def test_a_simulation_is_lawful() -> None:
    """Whatever the seed: the truth beside the steps keeps the assumption; another seed is another run."""
    simulate = target().simulate
    assert simulate is not None
    for seed in range(3):
        assert admissible_run(target().system, {}, simulate(seed)).steps
    assert simulate(0) != simulate(1)
    assert simulate(0) == simulate(0)


def test_a_service() -> None:
    """Two unlinked groups, each the reference from its reading on; linked ones change nothing."""
    assert [("NO_GROUP", 0), ("NONE", 2), ("NONE", 5)] == course("unlinked_group-service")
    assert ["LINKED", "TAKEN", "LINKED", "LINKED", "TAKEN", "LINKED"] == judged("unlinked_group-service")


def test_faulty_groups() -> None:
    """The good one stays the reference until the next good one."""
    stem = "unlinked_group-faulty-groups"
    assert [("NO_GROUP", 0), ("NONE", 1), ("NONE", 7)] == course(stem)
    assert ["TAKEN", "CORRUPTED", "INCOMPLETE", "STALE", "MALFORMED", "TAKEN", "LINKED"] == judged(stem)


def test_a_vehicle_that_rolled_back() -> None:
    """The reference ends with the turn, and a new one comes after it."""
    assert [("NO_GROUP", 0), ("NONE", 1), ("NONE", 3), ("REVERSED", 0), ("NONE", 5)] == course(
        "unlinked_group-rolled-back"
    )


def test_a_silent_odometer() -> None:
    """The reference ends half a second after the odometer, and a new one comes with the next unlinked group."""
    stem = "unlinked_group-silent-odometer"
    assert [("NO_GROUP", 0), ("NONE", 1), ("SENSOR_FAILURE", 0), ("NONE", 4)] == course(stem)
    assert "SENSOR_FAILURE" == label(lawful(stem), "reason", 255)
    assert "NONE" == label(lawful(stem), "reason", 254)


def test_far_behind() -> None:
    """The reference ends with its tolerance."""
    assert [("NO_GROUP", 0), ("NONE", 1), ("TOLERANCE", 0)] == course("unlinked_group-far-behind")


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("stem", RUNS)
def test_the_balise_machine_beside_it_is_not_moved(stem: str) -> None:
    """Located, it has the same interval in every cycle with and without the telegrams of unlinked groups, and refuses each of these."""
    vehicle = beside(CONFIG).model_copy(update={"tolerance_mm": 400_000, "trust_first_group": True})
    board = without_ghosts(lower(balise.machine(vehicle)))
    names = {var.name for var in board.inputs}
    first = telegram(replace(mixed_line()[0], identity=1_000), since_mm=0)
    start: list[dict[str, Cell]] = [{"odometer_mm": 0}, {"odometer_mm": 0, **first}]
    recorded = read_steps(shipped(stem)).steps
    steps = [{name: value for name, value in one.items() if name in names} for one in recorded]
    without = [
        {name: value for name, value in one.items() if one.get("telegram_link") != "UNLINKED" or "telegram" not in name}
        for one in steps
    ]
    taken, left = (run(board, [*start, *given]) for given in (steps, without))
    told = (
        "valid",
        "position_mm",
        "margin_above_mm",
        "margin_below_mm",
        "direction",
        "distance_run_mm",
        "expected",
        "reason",
    )
    for one, other in zip(taken.steps, left.steps, strict=True):
        assert [one.outputs[name] for name in told] == [other.outputs[name] for name in told]
    located = [at for at, one in enumerate(taken.steps) if one.outputs["valid"]]
    assert "UNLINKED" in {label(taken, "telegram", at) for at in located}
