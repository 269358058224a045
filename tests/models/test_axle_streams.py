"""The named runs of axle counters, the emitter and the order of trains: what is told of each comes true."""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from functools import cache
from types import ModuleType

import pytest

from safeloc.catalogue import load_target
from safeloc.language.interpret import run
from safeloc.language.monitor import check_all
from safeloc.language.system import without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.verdict import word
from safeloc.models.axle_counter import simulate as axle_counter_streams
from safeloc.models.axle_head import simulate as axle_head_streams
from safeloc.models.axle_section import simulate as axle_section_streams
from safeloc.models.emitter import EmitterConfig
from safeloc.models.emitter import simulate as emitter_streams
from safeloc.models.train_order import simulate as train_order_streams
from safeloc.proof.provers.replayed_evidence import admissible_run
from safeloc.proof.verification.replay import replay_stream
from safeloc.runtime.streams.gzipped import name_of
from safeloc.runtime.streams.steps import Cell, read_steps
from safeloc.target import Target
from tests.models.fibre_family import labels, mode_labels
from tests.shipped_recordings import shipped

STREAMS_OF: Mapping[str, ModuleType] = {
    "axle_head": axle_head_streams,
    "axle_counter": axle_counter_streams,
    "axle_section": axle_section_streams,
    "emitter": emitter_streams,
    "train_order": train_order_streams,
}
RUNS = [(machine, stem) for machine, module in STREAMS_OF.items() for stem in module.RUNS]
NAMED = {
    stem: run
    for module in STREAMS_OF.values()
    for stem, run in (*module.RUNS.items(), *vars(module).get("ON_DEMAND", {}).items())
}
"""All named runs, also those that do not ship."""
UNLAWFUL = {
    "axle_head-direction-unknown",
    "axle_head-no-overlap",
    "axle_counter-power-up",
    "axle_counter-miscount",
    "axle_section-miscount",
}


@cache
def target(machine: str) -> Target:
    """A shipped machine; this process makes it once."""
    return load_target(machine)


def machine_of(stem: str) -> Target:
    """The machine of a named run."""
    return target(stem.partition("-")[0])


def steps_of(stem: str) -> Sequence[Mapping[str, Cell]]:
    """The steps of a named run; those of a recording are compared with it."""
    return list(NAMED[stem].steps(machine_of(stem).config))


@cache
def recorded(stem: str) -> Trace:
    """A named run, as it runs on board."""
    system = without_ghosts(machine_of(stem).system)
    inputs = {var.name for var in system.inputs}
    return run(system, [{name: value for name, value in step.items() if name in inputs} for step in steps_of(stem)])


def courses(stem: str) -> list[str]:
    """The modes, each as often as it was come to."""
    found = mode_labels(machine_of(stem).machines[0], recorded(stem))
    return [mode for number, mode in enumerate(found) if number == 0 or found[number - 1] != mode]


def told(stem: str, output: str) -> Counter[str]:
    """How often each member of an output was told."""
    return Counter(labels(recorded(stem), output))


@pytest.mark.parametrize(("machine", "stem"), RUNS, ids=[stem for _, stem in RUNS])
def test_a_recording_is_its_run(machine: str, stem: str) -> None:
    """The file that ships is what the model of it makes, step by step, and ships with its machine."""
    config = target(machine).config
    assert list(read_steps(shipped(stem)).steps) == STREAMS_OF[machine].RUNS[stem].steps(config)
    assert stem in map(name_of, target(machine).streams)
    assert STREAMS_OF[machine].RUNS[stem].outcome.endswith(".")


@pytest.mark.thorough(ordinary=4)
@pytest.mark.parametrize("stem", [one for one in NAMED if one not in UNLAWFUL])
def test_a_run_is_lawful(stem: str) -> None:
    """With its truth, it keeps what is assumed, and every property holds on it or is not about it."""
    trace = admissible_run(machine_of(stem).system, {}, steps_of(stem))
    assert {"held", "unknown"} >= {word(one) for one in check_all(trace, machine_of(stem).properties)}


@pytest.mark.parametrize("stem", sorted(UNLAWFUL))
def test_a_run_outside_the_assumption_claims_no_truth(stem: str) -> None:
    """What breaks the assumption comes without the truth that would break it."""
    ghosts = {var.name for var in machine_of(stem).system.ghosts}
    assert all(ghosts.isdisjoint(step) for step in steps_of(stem))


@pytest.mark.thorough(ordinary=8)
@pytest.mark.parametrize(("machine", "stem"), RUNS, ids=[stem for _, stem in RUNS])
def test_a_recording_verifies(machine: str, stem: str) -> None:
    """Replayed as `verify` does: whatever can be judged on it holds."""
    _, findings = replay_stream(target(machine), shipped(stem))
    assert {"held"} == {word(one.result) for one in findings}


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize("machine", STREAMS_OF)
def test_a_simulation_is_lawful(machine: str) -> None:
    """Whatever the seed: the truth beside the steps keeps the assumption; another seed is another run."""
    simulate = target(machine).simulate
    assert simulate is not None
    for seed in range(2):
        assert admissible_run(target(machine).system, {}, simulate(seed)).steps
    assert simulate(0) != simulate(1)
    assert simulate(0) == simulate(0)


# ------------------------------------------------------------------ heads


def test_axles_both_ways() -> None:
    """Two up, two down, never disturbed."""
    assert (2, 2) == (told("axle_head-both-ways", "counted")["UP"], told("axle_head-both-ways", "counted")["DOWN"])
    assert "DISTURBED" not in courses("axle_head-both-ways")


def test_a_wheel_that_turns_back_counts_nothing() -> None:
    """Only the wheel after it is counted."""
    assert {"UP": 1} == dict(told("axle_head-turned-back", "counted") - Counter(NONE=10**6))
    assert courses("axle_head-turned-back")[:5] == ["FREE", "A_FIRST", "BOTH_UP", "A_FIRST", "FREE"]


@pytest.mark.parametrize(("stem", "axles"), [("axle_head-direction-unknown", 2), ("axle_head-no-overlap", 1)])
def test_an_unknown_direction_disturbs(stem: str, axles: int) -> None:
    """Disturbed until free, and nothing counted by it."""
    found = courses(stem)
    assert found[found.index("DISTURBED") + 1] == "FREE"
    assert {"UP": axles} == dict(told(stem, "counted") - Counter(NONE=10**6))


def test_a_cut_cable_disturbs() -> None:
    """Three wheels: the cable is cut under the second, which is not counted; mended after it, and the third is."""
    axle = ["FREE", "A_FIRST", "BOTH_UP", "B_LAST"]
    assert courses("axle_head-cable-cut") == [*axle, "FREE", "A_FIRST", "DISTURBED", *axle, "FREE"]
    assert {"UP": 2} == dict(told("axle_head-cable-cut", "counted") - Counter(NONE=10**6))


# ------------------------------------------------------------------ entry records


@pytest.mark.parametrize(
    ("stem", "records", "flaw"),
    [
        ("axle_counter-service", [20, 4], None),
        ("axle_counter-braking", [20], None),
        ("axle_counter-turned", [20], "TURNED"),
        ("axle_counter-crawling", [20], "MAYBE_ANOTHER_TRAIN"),
        ("axle_counter-direction-unknown", [20], "HEAD_FAULT"),
        ("axle_counter-head-stays-damped", [20], "HEAD_DAMPED"),
        ("axle_counter-no-speed", [20], "NO_SPEED"),
        ("axle_counter-power-up", [20], "POWER_UP"),
        ("axle_counter-miscount", [19, 20], None),
    ],
)
def test_entry_records(stem: str, records: list[int], flaw: str | None) -> None:
    """Axles of every sound record, and why there was none."""
    found = recorded(stem)
    assert records == [step.outputs["record_axles"] for step in found.steps if step.outputs["record_sound"]]
    flaws = [one for one in dict.fromkeys(labels(found, "record_flaw")[1:]) if one not in ("NONE", flaw)]
    assert [] == flaws
    assert flaw is None or flaw in labels(found, "record_flaw")


def test_length_of_the_braking_train() -> None:
    """The bounds hold the length; the speed of the first axle times the time does not."""
    (made,) = [step.outputs for step in recorded("axle_counter-braking").steps if step.outputs["record_sound"]]
    length = axle_counter_streams.COACHES[-1] * 1_000
    assert made["record_length_low_um"] <= length <= made["record_length_high_um"]
    axles = [number for number, step in enumerate(recorded("axle_counter-braking").steps) if step.inputs["axle"]]
    assert 22_000 * 100 * (axles[-1] - axles[0]) > made["record_length_high_um"]


# ------------------------------------------------------------------ sections


@pytest.mark.parametrize(
    ("stem", "course"),
    [
        ("service", ["OCCUPIED", "CLEAR", "OCCUPIED", "CLEAR"]),
        ("reset-refused", ["OCCUPIED", "CLEAR"]),
        ("disturbed", ["OCCUPIED", "DISTURBED", "SWEEPING", "CLEAR", "OCCUPIED", "CLEAR"]),
        ("miscount", ["OCCUPIED", "DISTURBED", "SWEEPING", "CLEAR", "OCCUPIED", "CLEAR"]),
        ("sweep-turns", []),
    ],
)
def test_sections(stem: str, course: list[str]) -> None:
    """Unknown, swept and clear first; then as told."""
    assert ["UNKNOWN", "SWEEPING", "CLEAR", *course] == courses(f"axle_section-{stem}")


def test_resets_are_refused() -> None:
    """After power-up, with axles in, with a wheel on a head; each with its reason."""
    answers = [one for one in labels(recorded("axle_section-reset-refused"), "reset_answer") if one != "NOT_ASKED"]
    assert ["AXLE_PASSED", "ACCEPTED", "AXLES_COUNTED", "HEAD_DAMPED"] == answers
    assert 1 == told("axle_section-disturbed", "reset_answer")["HEAD_FAULT"]


def test_a_sweep_that_turns_needs_another_one() -> None:
    """Two resets for one clearing."""
    assert 2 == told("axle_section-sweep-turns", "reset_answer")["ACCEPTED"]


# ------------------------------------------------------------------ the emitter


@pytest.mark.parametrize(
    ("stem", "course", "heard"),
    [
        ("service", ["TESTED"], {"PASSED": 6}),
        ("missing-pattern", ["TESTED", "FAILED", "TESTED"], {"PASSED": 5}),
        ("foreign-pattern", ["TESTED", "FAILED"], {"PASSED": 1, "FOREIGN": 2}),
        ("not-due", ["TESTED"], {"PASSED": 3, "NOT_DUE": 1, "NO_PLACE": 1}),
        ("elsewhere", ["TESTED", "FAILED"], {"PASSED": 2, "ELSEWHERE": 1}),
        ("unanswered", ["TESTED", "FAILED"], {"PASSED": 2}),
    ],
)
def test_emitter(stem: str, course: list[str], heard: dict[str, int]) -> None:
    """Modes in order, and what became of every pattern."""
    assert ["UNTESTED", *course] == courses(f"emitter-{stem}")
    assert heard == dict(told(f"emitter-{stem}", "verdict") - Counter(NOTHING=10**6))


@pytest.mark.parametrize("stem", ["missing-pattern", "foreign-pattern"])
def test_failed_one_cycle_after_the_due_time(stem: str) -> None:
    """Counted from the last pattern that passed; not earlier, not later."""
    trace = recorded(f"emitter-{stem}")
    modes, heard = mode_labels(target("emitter").machines[0], trace), labels(trace, "verdict")
    failed = modes.index("FAILED")
    assert failed - max(n for n in range(failed) if heard[n] == "PASSED") == EmitterConfig().due_cycles + 1


# ------------------------------------------------------------------ whose a pattern is


def owners(stem: str) -> list[tuple[int, ...]]:
    """Whose the patterns are, in every cycle."""
    return [tuple(int(step.outputs[f"train_of_pattern_{n}"]) for n in (1, 2, 3)) for step in recorded(stem).steps]


def test_three_trains_in_order() -> None:
    """Each by its number, from the low end, wherever it is."""
    found = dict.fromkeys(owners("train_order-service"))
    assert [(0, 0, 0), (1, 0, 0), (2, 1, 0), (2, 1, 3)] == list(found)[:4]
    assert (2, 0, 0) in found or (2, 1, 0) == owners("train_order-service")[-1]


@pytest.mark.parametrize("stem", ["close-together", "ghost-pattern", "lost-pattern"])
def test_another_number_of_patterns_is_nobodys(stem: str) -> None:
    """Both known, then nobody's for some time, then both known again."""
    found = owners(f"train_order-{stem}")
    course = [one for number, one in enumerate(found) if number == 0 or found[number - 1] != one]
    assert [(2, 1, 0), (0, 0, 0), (2, 1, 0)] == course[-3:]


def test_a_counter_fault_ends_the_order() -> None:
    """Nobody's, also when the fault is gone, until the area is told to be empty."""
    found = owners("train_order-counter-fault")
    assert {(0, 0, 0)} == set(found[100:275])
    assert (2, 0, 0) == found[-1]
    assert ["UNKNOWN", "ORDERED"] * 2 == courses("train_order-counter-fault")


def test_a_train_out_of_an_empty_area_ends_the_order() -> None:
    """In that cycle."""
    modes = mode_labels(target("train_order").machines[0], recorded("train_order-impossible-event"))
    assert ("ORDERED", "UNKNOWN", "ORDERED") == (modes[19], modes[20], modes[-1])
