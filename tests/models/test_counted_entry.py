"""The counted entry: a record is proved true by the counter, a wrong wire is not, and the recordings say what they teach."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import cache

import pytest
from pydantic import ValidationError

from safeloc.catalogue import load_target
from safeloc.language.expr import TRUE, Num, as_num, ceil_to, floor_to, maximum
from safeloc.language.interpret import run
from safeloc.language.system import without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.units import COUNT, MM
from safeloc.models import counted_entry
from safeloc.models.axle_counter import AxleCounterConfig
from safeloc.models.counted_entry import CountedEntry, CountedEntryConfig, compose_machines
from safeloc.models.counted_entry.simulate import RUNS, simulate
from safeloc.models.verification import VerificationConfig
from safeloc.models.verification.doubted import RECORD
from safeloc.proof.provers.implication import Refuted
from safeloc.proof.provers.replayed_evidence import admissible_run
from safeloc.runtime.streams.steps import read_steps
from tests.models.owed_contracts import Wires, contract, rewired
from tests.shipped_recordings import shipped

Wrong = Callable[[CountedEntry, Wires], Wires]
OWNER = "verification_doubted"

# ------------------------------------------------------------------ contracts


def test_only_the_laws_of_the_head_and_the_fibre_are_assumed() -> None:
    """That a record is true is owed, and no part of a record is left open."""
    system = compose_machines().composition.system
    assert {OWNER: (RECORD,)} == {part.name: part.guaranteed for part in system.parts if part.guaranteed}
    left = {var.name for var in system.inputs}
    assert not {name for name in left if name.startswith((f"{OWNER}.record_", f"{OWNER}.reference_", "train.counted_"))}
    assert {"axle_counter.axle", "axle_counter.head_fault", f"{OWNER}.fibre_axles", "train.next_overhang_nm"} <= left


LEMMAS = (
    "axle_counter: the count is true",
    "axle_counter: the run is within its bounds",
    "axle_counter: the length is within its bounds",
    "axle_counter: the speed is within its bounds",
)


def test_a_record_is_true_by_what_is_proved_of_the_counter() -> None:
    """And not without any one of count, run, length and speed."""
    whole = compose_machines().composition
    assert None is contract(whole, OWNER)
    for lemma in LEMMAS:
        assert isinstance(contract(whole, OWNER, lemma), Refuted), lemma


# ------------------------------------------------------------------ wires exchanged on purpose


def _any_record(whole: CountedEntry, _: Wires) -> Wires:
    """A record with a flaw counts as undisturbed."""
    return {whole.verified.own.sound: TRUE}


def _one_axle_more(whole: CountedEntry, _: Wires) -> Wires:
    return {whole.verified.own.record_axles: whole.counter.machine.output("record_axles") + 1}


def _length_rounded_in(whole: CountedEntry, _: Wires) -> Wires:
    high = whole.counter.machine.output("record_length_high_um")
    return {whole.verified.own.record_length_high: maximum(floor_to(high, MM), as_num(0, MM))}


def _no_room_for_late_axles(whole: CountedEntry, _: Wires) -> Wires:
    """The length is that of the axles as counted."""
    high, late = whole.counter.machine.output("record_length_high_um"), whole.config.counter.late_mm
    return {whole.verified.own.record_length_high: maximum(ceil_to(high, MM) - late, as_num(0, MM))}


def _always_upwards(whole: CountedEntry, _: Wires) -> Wires:
    """The place and the speed of every train as those of one that came upwards."""
    machine, own, config = whole.counter.machine, whole.verified.own, whole.config
    low, high = (machine.output(f"record_run_{end}_um") for end in ("low", "high"))
    return {
        own.record_place_low: floor_to(low, MM) + config.counter_mm,
        own.record_place_high: ceil_to(high, MM) + (config.counter_mm + config.overhang_mm),
    }


def _no_overhang(whole: CountedEntry, right: Wires) -> Wires:
    """The front is taken to be at the foremost axle."""
    place = whole.verified.own.record_place_high
    high = right[place]
    assert isinstance(high, Num)
    return {place: high - whole.config.overhang_mm}


def _speed_of_the_other_way(whole: CountedEntry, _: Wires) -> Wires:
    machine, own = whole.counter.machine, whole.verified.own
    return {own.record_speed_low: machine.output("record_speed_low_mm_s")}


def _older(whole: CountedEntry, _: Wires) -> Wires:
    """The record is told to be older than it is: its place is widened, and no harm is done."""
    return {whole.verified.own.record_age: as_num(1, COUNT)}


WRONG: tuple[Wrong, ...] = (
    _any_record, _one_axle_more, _length_rounded_in, _no_room_for_late_axles, _always_upwards, _no_overhang, _speed_of_the_other_way,
)  # fmt: skip


@pytest.mark.parametrize("wrong", WRONG, ids=lambda wrong: wrong.__name__.strip("_"))
def test_a_wrong_wire_is_not_proved(wrong: Wrong, monkeypatch: pytest.MonkeyPatch) -> None:
    """The contract of the record is refuted."""
    assert isinstance(
        contract(rewired(counted_entry, compose_machines, wrong, monkeypatch).composition, OWNER), Refuted
    )


def test_a_wire_that_only_widens_is_proved(monkeypatch: pytest.MonkeyPatch) -> None:
    """Otherwise the check above would refuse whatever differs."""
    assert None is contract(rewired(counted_entry, compose_machines, _older, monkeypatch).composition, OWNER)


# ------------------------------------------------------------------ configuration


@pytest.mark.parametrize(
    ("config", "message"),
    [
        ({"counter": AxleCounterConfig(period_ms=200)}, "verification.period_ms is 100, but the counter's is 200"),
        ({"verification": VerificationConfig(period_ms=100)}, "verification.length_limit_mm 1500000 is below 15"),
        ({"counter_mm": 999_999_999}, "verification.position_limit_mm 1000000000 is below 10"),
    ],
)
def test_figures_that_do_not_fit_are_refused(config: Mapping[str, object], message: str) -> None:
    """By name, with what to do."""
    with pytest.raises(ValidationError, match=message):
        CountedEntryConfig(**config)  # type: ignore[arg-type]


# ------------------------------------------------------------------ recordings


@cache
def recorded(name: str) -> Trace:
    """The run of a shipped recording, by the interpreter."""
    stream = read_steps(shipped(f"counted_entry-{name}"))
    return run(without_ghosts(load_target("counted_entry").system), [
        {key: cell for key, cell in step.items() if "true" not in key and not key.startswith("train.")} for step in stream.steps
    ])  # fmt: skip


def test_two_trains_are_verified_from_their_records_on() -> None:
    """Twenty axles and four, as the counter's own recording has them."""
    steps = recorded("service").steps
    records = [step for step in steps if step.outputs["axle_counter.record_sound"]]
    assert [20, 4] == [step.outputs["axle_counter.record_axles"] for step in records]
    assert [20, 4] == [step.outputs[f"{OWNER}.handover_axles"] for step in records]
    assert all(step.outputs[f"{OWNER}.trusted"] for step in records)


def test_a_fibre_that_counts_one_axle_too_few_is_withheld() -> None:
    """Both have their records, and from its first count on neither is trusted."""
    steps = recorded("miscounted").steps
    assert 2 == sum(bool(step.outputs["axle_counter.record_sound"]) for step in steps)
    counted = [step for step in steps if step.inputs[f"{OWNER}.fibre_axles.present"]]
    assert len(counted) > 20
    assert all(step.outputs[f"{OWNER}.untrusted"] for step in counted)


@pytest.mark.parametrize("name", RUNS)
def test_a_recording_obeys_the_laws(name: str) -> None:
    """To its end, with the truth in it."""
    system, stream = load_target("counted_entry").system, read_steps(shipped(name))
    assert len(stream.steps) == len(admissible_run(system, stream.first, stream.steps).steps)


def test_a_simulation_obeys_the_laws() -> None:
    """Trains of other lengths, that brake or accelerate on the counter."""
    system, steps = load_target("counted_entry").system, simulate(CountedEntryConfig(), seed=3)
    assert len(steps) == len(admissible_run(system, {}, steps).steps)
