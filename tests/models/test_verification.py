"""A train's fibre position, verified against the axle counter: what is trusted, withheld, revoked and latched."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import cache

import pytest

from safeloc.language.expr import FALSE, TRUE, Bool, Lit, Num, any_of
from safeloc.language.monitor import check_all
from safeloc.language.system import lower
from safeloc.language.trace import Trace
from safeloc.language.units import MM_S2
from safeloc.language.verdict import Violated, word
from safeloc.models.fibre.simulate import Stay, simulate_stay
from safeloc.models.verification import Verification, VerificationConfig, build, judgement, parts
from safeloc.models.verification.judgement import Judgement
from safeloc.models.verification.recorded_runs import ON_DEMAND, RUNS
from safeloc.models.verification.variables import Parts
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.properties.verification import properties
from safeloc.properties.verification.mismatch import NAMED
from safeloc.runtime.streams.steps import Cell, read_steps
from tests.models.everything_proved import shipped_runs, unproved_of
from tests.models.fibre_family import labels, mode_labels, replayed
from tests.models.inductive import changed, inductive
from tests.models.wrong_edits import lost
from tests.shipped_recordings import shipped

CONFIG = VerificationConfig()
ENTRY = 2


@cache
def made() -> Verification:
    """The machine with its variables."""
    return made_for(CONFIG)


def made_for(config: VerificationConfig) -> Verification:
    """The machine of another configuration."""
    return build(parts(config))


def stayed(stay: Stay, *, config: VerificationConfig = CONFIG, **changes: dict[int, dict[str, Cell | None]]) -> Trace:
    """A stay, with cells changed (None: absent) in single cycles; the machine holds its properties on it."""
    steps = simulate_stay(config, seed=1, stay=stay)
    for cycle, cells in changes.get("at", {}).items():
        merged = steps[cycle] | cells  # type: ignore[operator]
        steps[cycle] = {name: value for name, value in merged.items() if value is not None}
    return checked(steps, config)


def checked(steps: Sequence[Mapping[str, Cell]], config: VerificationConfig) -> Trace:
    """A run on which the machine holds its properties."""
    model = made_for(config)
    trace = replayed(lower(model.machine), steps)
    assert not [one for one in check_all(trace, properties(model)) if isinstance(one, Violated)]
    return trace


def modes(trace: Trace) -> list[str]:
    """The mode after every step."""
    return mode_labels(made().machine, trace)


def test_a_stay() -> None:
    """Nothing before the reference, trusted from it on, nothing after the train has left."""
    trace = stayed(Stay())
    assert modes(trace) == ["NO_REFERENCE"] * ENTRY + ["TRUSTED"] * (60 - ENTRY - 1) + ["NO_REFERENCE"]
    last = trace.steps[-2].outputs
    flags = ("count", "length", "speed_at_entry", "place_at_entry", "train_control", "by_emitter")
    assert [last[f"verified_{name}"] for name in flags] == [True] * 6


@pytest.mark.parametrize("name", RUNS)
def test_recordings_are_fresh_simulations(name: str) -> None:
    """The file that ships is what its named run gives."""
    assert list(read_steps(shipped(name)).steps) == list(RUNS[name].steps(CONFIG))
    assert RUNS[name].outcome.endswith(".")


@pytest.mark.parametrize(
    ("name", "reason", "revoked"),
    [
        ("miscount", "COUNT", False),
        ("split", "COUNT", True),
        ("lost-handover", "REFERENCE_LOST", False),
        ("emitter-fails", "CHAIN_FAILED", True),
        ("fibre-error", "FIBRE_ERROR", True),
    ],
)
def test_named_faults(name: str, reason: str, *, revoked: bool) -> None:
    """Each fault ends in UNTRUSTED with its reason; what had been given out is revoked."""
    trace = checked((RUNS | ON_DEMAND)[f"verification-{name}"].steps(CONFIG), CONFIG)
    assert modes(trace)[-2] == "UNTRUSTED"
    assert labels(trace, "reason")[-2] == reason
    assert trace.steps[-2].outputs["revoked"] is revoked


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize(
    ("cells", "reason"),
    [
        ({"fibre_length_mm": 160_000}, "LENGTH"),
        ({"fibre_length_mm": 249_001}, "LENGTH"),
        ({"fibre_speed_mm_s": 35_000}, "SPEED_CHANGED"),
        ({"fibre_position_mm": 900_000}, "JUMP"),
        ({"control_axles": 38}, "CONTROL_COUNT"),
        ({"control_length_mm": 100_000}, "CONTROL_LENGTH"),
        ({"reference_due": True, "record_axles": 44}, "REFERENCE_CONTRADICTS"),
        ({"reference_due": True, "record_sound": False}, "REFERENCE_REFUSED"),
        ({"reference_due": True, "record_age_cycles": 5}, "REFERENCE_REFUSED"),
        ({"reference_due": True, "record_place_low_mm": 10_001, "record_place_high_mm": 10_000}, "REFERENCE_REFUSED"),
        (
            {"reference_due": True, "record_speed_low_mm_s": 20_001, "record_speed_high_mm_s": 20_000},
            "REFERENCE_REFUSED",
        ),
        ({"reference_due": True, "record_speed_low_mm_s": 10_000, "record_speed_high_mm_s": 11_000}, "SPEED_AT_ENTRY"),
        ({"reference_due": True, "record_place_low_mm": 0, "record_place_high_mm": 10_000}, "PLACE_AT_ENTRY"),
    ],
)
def test_a_mismatch_is_latched(cells: dict[str, Cell | None], reason: str) -> None:
    """One cycle that does not match withholds in that cycle, and for the rest of the stay."""
    trace = stayed(Stay(), at={30: cells})
    assert modes(trace)[29:59] == ["TRUSTED"] + ["UNTRUSTED"] * 29
    assert set(labels(trace, "reason")[30:59]) == {reason}


@pytest.mark.parametrize(
    ("cells", "reason"),
    [
        ({"associated": False}, "NOT_ASSOCIATED"),
        ({"fibre_located": False}, "NOT_LOCATED"),
        ({"fibre_position_mm": None}, "NOT_LOCATED"),
        ({"chain_tested": False}, "CHAIN_UNTESTED"),
    ],
)
def test_what_is_missing_withholds(cells: dict[str, Cell | None], reason: str) -> None:
    """It withholds in that cycle, and a new verification is needed before anything is trusted again."""
    trace = stayed(Stay(), at={31: cells})
    assert labels(trace, "reason")[31] == reason
    assert modes(trace)[30:35] == ["TRUSTED", "WITHHELD", "WITHHELD", "WITHHELD", "TRUSTED"]


def test_a_verification_grows_old() -> None:
    """Without count and length the trust ends when the last verification is too old."""
    silent: dict[int, dict[str, Cell | None]] = {
        cycle: {"fibre_axles": None, "fibre_length_mm": None} for cycle in range(31, 59)
    }
    found = modes(stayed(Stay(), at=silent))
    assert found[30 : 30 + CONFIG.currency_cycles + 2] == ["TRUSTED"] * (CONFIG.currency_cycles + 1) + ["WITHHELD"]


def test_a_place_out_of_reach_is_latched() -> None:
    """A place to which no train can have come from its counter, even at top speed; a wide interval hides the jump."""
    front = 25_000 * 30 // 2
    far: dict[str, Cell | None] = {"fibre_position_mm": front + 1_400_000, "fibre_margin_below_mm": 300_000}
    wide: dict[str, Cell | None] = {"fibre_margin_above_mm": 500_000}
    config = VerificationConfig(jump_mm=1_000_000)
    nearer: dict[str, Cell | None] = {"fibre_position_mm": front + 900_000, **wide}
    farther: dict[str, Cell | None] = {"fibre_position_mm": front + 1_020_000, **wide}
    trace = stayed(Stay(), config=config, at={28: nearer, 29: farther, 30: far})
    assert modes(trace)[28:32] == ["TRUSTED"] * 2 + ["UNTRUSTED"] * 2
    assert set(labels(trace, "reason")[30:59]) == {"OUT_OF_REACH"}


def test_a_place_whose_record_is_old_is_withheld() -> None:
    """It is withheld where the record and the top speed leave more open than permitted, until the next counter."""
    front = 25_000 * 50 // 2
    fresh: dict[str, Cell | None] = {
        "reference_due": True,
        "record_place_low_mm": front - 5_000,
        "record_place_high_mm": front + 5_000,
    }
    config = VerificationConfig(place_doubt_limit_mm=2_000_000)
    trace = stayed(Stay(), config=config, at={50: fresh})
    last = ENTRY + (2_000_000 - 10_000) // 100_000
    assert modes(trace)[last : last + 2] == ["TRUSTED", "WITHHELD"]
    assert set(labels(trace, "reason")[last + 1 : 50]) == {"PLACE_DOUBTFUL"}
    assert modes(trace)[49:51] == ["WITHHELD", "TRUSTED"]
    assert [trace.steps[cycle].outputs["place_doubt_mm"] for cycle in (last, last + 1, 50)] == [1_940_000, 0, 40_000]


def test_place_and_speed_are_compared_at_entry_only() -> None:
    """A record with another place in a cycle in which none is due changes nothing: the train has long run on."""
    trace = stayed(Stay(), at={40: {"record_place_low_mm": -9_000, "record_place_high_mm": -8_000}})
    assert set(modes(trace)[ENTRY:59]) == {"TRUSTED"}


def test_only_another_reference_ends_a_mismatch() -> None:
    """The next counter's sound record starts anew; until then nothing does."""
    front = 25_000 * 50 // 2
    fresh: dict[str, Cell | None] = {
        "reference_due": True,
        "record_place_low_mm": front - 5_000,
        "record_place_high_mm": front + 5_000,
    }
    trace = stayed(Stay(), at={30: {"fibre_axles": 39}, 50: fresh})
    assert modes(trace)[29:52] == ["TRUSTED"] + ["UNTRUSTED"] * 20 + ["TRUSTED"] * 2


def test_handover_between_neighbours() -> None:
    """What the one area hands over is the other one's reference; an untrusted train is not taken over."""
    given = stayed(Stay()).steps[40].outputs
    cells: dict[str, Cell | None] = {
        "reference_from": "NEIGHBOUR",
        "record_sound": given["handover_trusted"],
        "record_axles": given["handover_axles"],
        "record_length_low_mm": given["handover_length_low_mm"],
        "record_length_high_mm": given["handover_length_high_mm"],
    }
    assert modes(stayed(Stay(), at={ENTRY: cells}))[ENTRY] == "TRUSTED"
    refused = stayed(Stay(), at={ENTRY: cells | {"record_sound": False}})
    assert labels(refused, "reason")[ENTRY] == "REFERENCE_REFUSED"


def test_silent_train_control() -> None:
    """Where control data are required, silence withholds; where not, it is not listed as verified."""
    silent: dict[int, dict[str, Cell | None]] = {
        cycle: {"control_axles": None, "control_length_mm": None} for cycle in range(59)
    }
    trace = stayed(Stay(), at=silent)
    assert (modes(trace)[30], trace.steps[30].outputs["verified_train_control"]) == ("TRUSTED", False)
    strict = VerificationConfig(needs_control_data=True)
    assert set(labels(stayed(Stay(), config=strict, at=silent), "reason")[ENTRY:59]) == {"CONTROL_DATA_MISSING"}


def test_gravity_run_wagons_brake_as_control_says() -> None:
    """A braking ability told by train control narrows what the speed may change by."""
    slower: dict[int, dict[str, Cell | None]] = {
        cycle: {"control_brake_mm_s2": 100, "fibre_speed_mm_s": 25_000 if cycle < 31 else 21_900} for cycle in range(60)
    }
    assert labels(stayed(Stay(), at=slower), "reason")[31] == "SPEED_CHANGED"


@pytest.mark.thorough
def test_everything_is_proved() -> None:
    """All properties and lemmas, without bound."""
    assert unproved_of(made().machine, properties(made())) == {}


@pytest.mark.slow
@pytest.mark.parametrize(
    "config",
    [
        VerificationConfig(needs_control_data=True),
        VerificationConfig(needs_emitter=False, currency_cycles=0),
        VerificationConfig(needs_control_data=True, traction_mm_s2=1_000, brake_mm_s2=2_500),
    ],
)
def test_other_configurations_are_proved(config: VerificationConfig) -> None:
    """The same holds where control data are required, and where every cycle has to be verified."""
    model = made_for(config)
    found = prove(lower(model.machine), properties(model), Limits(seconds=30), jobs=1, **shipped_runs("verification"))
    assert {one.id: word(one.result) for one in found if word(one.result) != "proved"} == {}


@pytest.mark.parametrize(
    ("row", "fields", "broken"),
    [
        ("mismatch", {"when": FALSE}, "mismatch withholds in the same cycle"),
        ("mismatch", {"when": FALSE}, "a lost hand-over is untrusted"),
        ("mismatch", {"when": FALSE}, "fibre error withholds"),
        ("mismatch", {"when": FALSE}, "another train is withheld"),
        ("still verified", {"when": TRUE}, "trusted is currently verified"),
        ("verified", {"when": TRUE}, "trust begins with a verification"),
        ("mismatch stays latched", {"target": "WITHHELD"}, "mismatch is latched"),
        ("no train", {"target": "WITHHELD"}, "no train without a reference"),
        ("still verified", {"set": {}}, "containment"),
    ],
)
def test_a_broken_row_is_noticed(row: str, fields: dict[str, object], broken: str) -> None:
    """A row without its guard, its updates or its target loses a proof."""
    table = {mode.label: mode for mode in made().machine.modes}
    given = {name: table.get(value, value) if isinstance(value, str) else value for name, value in fields.items()}
    wrong = replace(made(), machine=changed(made().machine, row, **given))
    prop = next(one for one in properties(wrong) if one.name == broken)
    assert not inductive(wrong.machine, prop)


def giving(row: str, given: Bool) -> Verification:
    """The machine whose row says itself whether something was given out."""
    model = made()
    [right] = [one for one in model.machine.transitions if one.name == row]
    return replace(model, machine=changed(model.machine, row, set={**right.set, model.own.given_out: given}))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("row", "given"), [("not verified now", FALSE), ("not verified now", TRUE), ("mismatch stays latched", FALSE)]
)
def test_what_was_given_out_and_is_forgotten_is_noticed(row: str, given: Bool) -> None:
    """What was given out stays known while the train is withheld, and while it is untrusted."""
    claim, wrong = "the machine stores that a position was reported", giving(row, given)
    assert set(lost(wrong.machine, properties(wrong), claim)) == {claim}
    assert lost(made().machine, properties(made()), claim) == {}


@pytest.mark.parametrize("given", [FALSE, TRUE])
def test_revoked_says_whether_something_was_given_out(given: Bool) -> None:
    """A mismatch after a pause revokes just what was given out: not nothing, and not always."""
    claim, wrong = "a reported position is revoked after a pause too", giving("mismatch", given)
    [prop] = [one for one in properties(wrong) if one.name == claim]
    assert not inductive(wrong.machine, prop, claim)
    assert not lacking(claim)


NAMES = {
    "REFERENCE_LOST": "a lost hand-over is untrusted",
    "FIBRE_ERROR": "fibre error withholds",
    "CHAIN_FAILED": "chain failed withholds",
    "REFERENCE_REFUSED": "only sound references",
} | {reason.label: name for name, (reason, *_) in NAMED.items()}


@pytest.mark.thorough(ordinary=4)
@pytest.mark.parametrize("reason", [why.label for _, why in made().judgement.flaws])
def test_a_comparison_that_is_left_out_is_noticed(reason: str) -> None:
    """A mismatch that does not count loses the proof of what it is there for, and that every mismatch is latched."""
    known, flaws = made().judgement.known, made().judgement.flaws
    counted = any_of(flaw for flaw, why in flaws if why.label != reason)
    wrong = replace(made(), machine=changed(made().machine, "mismatch", when=(made().own.due | known) & counted))
    named = {one.name: one for one in properties(wrong)}
    assert not inductive(wrong.machine, named["mismatch withholds in the same cycle"])
    assert not inductive(wrong.machine, named[NAMES[reason]])


def _own_brake(own: Parts) -> Num:
    """The configured brakes, whatever train control tells."""
    return Lit(own.config.brake_mm_s2, MM_S2)


RIGHT_ABILITIES: Callable[[Judgement], tuple[Num, Num]] = Judgement.__dict__["abilities"].func


def _either(judged: Judgement) -> tuple[Num, Num]:
    """Brake and traction taken for one another."""
    slower, faster = RIGHT_ABILITIES(judged)
    return faster, slower


def _lengths_in_order(judged: Judgement) -> Bool:
    """Only the bounds of the length are compared, as it was before: a crossed place was trusted for too long."""
    own, config = judged.own, judged.own.config
    recent = own.record_age <= config.reference_age_limit_cycles
    return own.sound & recent & (own.record_axles > 0) & (own.record_length_low <= own.record_length_high)


EDITS: list[tuple[str, Callable[[Judgement], object], str]] = [
    ("usable", _lengths_in_order, "a record whose bounds are crossed is not accepted"),
    ("count_matches", lambda j: j.own.associated & j.own.fibre_axles.present, "mismatch withholds in the same cycle"),
    ("length_matches", lambda j: j.own.associated & j.own.fibre_length.present, "another length is withheld"),
    ("verified", lambda j: j.count_matches, "the age of a verification is counted"),
    ("controlled", lambda j: j.own.control_axles.present, "train control is listed where it agreed"),
    ("age", lambda j: j.own.verified_ago, "the age of a verification is counted"),
    ("reach", lambda j: j.own.reach_since, "reach grows by the fastest run"),
    ("placed", lambda j: j.own.associated & j.own.fibre_position.present, "not located withholds"),
    ("missing", lambda j: ~j.own.associated, "containment"),
    ("usable", lambda j: j.own.sound & (j.own.record_axles > 0), "only sound references"),
    (
        "speed_fits",
        lambda j: j.own.record_speed_low <= j.own.fibre_speed.value,
        "another speed at the counter is withheld",
    ),
    (
        "place_fits",
        lambda j: j.own.fibre_position.value <= j.own.record_place_high,
        "another place at the counter is withheld",
    ),
    (
        "length_changed",
        lambda j: j.own.fibre_length.value > j.own.last_length + 80_000,
        "a length that changes withholds",
    ),
    ("abilities", _either, "speed is bounded by the train's abilities"),
    ("possible", lambda j: (j.own.possible_low, j.own.possible_high), "bounds of the front widen by the fastest run"),
    ("_was_doubtful", lambda _: TRUE, "bounds of the front widen by the fastest run"),
    ("doubtful", lambda j: j.own.due, "a doubtful place is withheld"),
    ("out_of_reach", lambda j: j.own.due, "a place out of reach is withheld"),
]


@pytest.mark.thorough(ordinary=6)
@pytest.mark.parametrize(("name", "wrong", "broken"), EDITS, ids=[name for name, *_ in EDITS])
def test_a_wrong_term_is_noticed(
    name: str, wrong: Callable[[Judgement], object], broken: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A term that is shared by several rows and wrong in all of them loses a proof."""
    monkeypatch.setattr(Judgement, name, property(wrong))
    assert lacking(broken)


def test_brakes_that_train_control_tells_are_used(monkeypatch: pytest.MonkeyPatch) -> None:
    """A braking ability told by train control and ignored loses a proof, over one cycle and over several."""
    monkeypatch.setattr(judgement, "_braking", _own_brake)
    assert lacking("a speed that no train changes withholds")
    assert lacking("speed is bounded by the train's abilities")


def lacking(claim: str) -> bool:
    """Whether the machine, as it is at present, does not keep a claim."""
    model = made_for(CONFIG)
    return not inductive(model.machine, next(one for one in properties(model) if one.name == claim))


@pytest.mark.thorough(ordinary=10)
@pytest.mark.parametrize("claim", sorted({broken for *_, broken in EDITS} | set(NAMES.values())))
def test_the_right_machine_keeps_it(claim: str) -> None:
    """What wrong edits lose, the machine as it ships has."""
    assert not lacking(claim)


def test_traction_and_brake_differ() -> None:
    """What is proved with the shipped figures tells them apart."""
    assert CONFIG.traction_mm_s2 != CONFIG.brake_mm_s2
