"""Wrong edits of odometry's terms, each of which a proof must notice: world, machine and claims do not move together."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import pytest

from safeloc.codegen.smtlib import Query
from safeloc.language.expr import FALSE, TRUE, Bool, Num, all_of, as_num
from safeloc.language.spec import always, observe
from safeloc.language.system import environment, in_range, lower
from safeloc.language.terms import Substitution, variables
from safeloc.language.units import MM
from safeloc.models import odometry
from safeloc.models.odometry import distance_device
from safeloc.models.odometry.cycle import Judgement, Reading
from safeloc.models.odometry.distance_device import Cycle, Device
from safeloc.models.odometry.marker_reading import NONE, Fix, Pending, Reader, fix
from safeloc.models.odometry.variables import OdometryConfig, Parts, parts
from safeloc.models.vocabulary.error_law import ACCELEROMETER, EDDY_CURRENT, ErrorLaw
from safeloc.models.vocabulary.measured import Limits
from safeloc.proof.provers.implication import Refuted, unproved
from safeloc.proof.provers.proved_base import ranges_and_lemmas
from safeloc.properties.odometry import properties
from tests.models.inductive import inductive

FIX = "safeloc.models.odometry.cycle.fix"
Patch = pytest.MonkeyPatch
Edit = Callable[[Patch], None]


def refuted(model: odometry.Odometry, claim: str, *, seconds: float = 200) -> set[str]:
    """Which of the claim and the lemmas that tie machine and world are refuted in one step; every one is decided."""
    prop = next(one for one in properties(model) if one.name == claim)
    goal = observe(lower(model.machine), prop)
    facts = {str(fact): term for fact, term in ranges_and_lemmas(goal.original).items()}
    if prop.unconditional:
        facts = {name: term for name, term in facts.items() if not goal.original.ghosts & set(variables([term]))}
    known = {**facts, claim: goal.good}
    given = [environment(goal.system, assume=not prop.unconditional), in_range(goal.system.state), *known.values()]
    after = Substitution(dict(goal.system.next))
    tied = [name for name in known if name == claim or "holds the truth" in name or "gated" in name or "age_ms" in name]
    failed = unproved(Query("one step", given, {name: after.bool(known[name]) for name in tied}), seconds)
    assert {name: why for name, why in failed.items() if not isinstance(why, Refuted)} == {}
    return set(failed)


def reader_with(**fields: Any) -> Edit:
    """What a reading says is computed with other figures of the reader."""

    def edit(patch: Patch) -> None:
        patch.setattr(FIX, lambda reader, moved: fix(replace(reader, **fields), moved))

    return edit


def law_with(**figures: int) -> Edit:
    """What a cycle adds to a margin is computed with other figures of the law."""

    def edit(patch: Patch) -> None:
        sound = ErrorLaw.growth_nm

        def grown(law: ErrorLaw, distance: Num, age: Num, period_ms: int) -> Num:
            return sound(law.model_copy(update=figures), distance, age, period_ms)

        patch.setattr(ErrorLaw, "growth_nm", grown)

    return edit


def limits_with(**fields: int) -> Edit:
    """The devices work within other limits."""

    def edit(patch: Patch) -> None:
        sound = vars(OdometryConfig)["limits"].fget
        patch.setattr(OdometryConfig, "limits", property(lambda config: replace(sound(config), **fields)))

    return edit


def window_open(patch: Patch) -> None:
    """A reading outside its window is accepted."""
    patch.setattr(Fix, "fits", lambda fix, reference: TRUE)


def half_blind(patch: Patch) -> None:
    """Silence adds half of the highest speed."""
    patch.setattr(Limits, "blind_nm", property(lambda limits: limits.max_speed_mm_s * limits.period_ms * 500))


def measured_is_run(patch: Patch) -> None:
    """The run in the reader's latency is reckoned from the measured distance, as if that were true."""
    law = {"rate_ppm": 0, "floor_mm_s": 0, "drift_mm_s2": 0}
    patch.setattr(ErrorLaw, "portion", lambda one, share_ppm: one.model_copy(update=law))


def constant_free(patch: Patch) -> None:
    """A fresh reading gets none of the units' one-off constant."""
    sound = Fix.values
    patch.setattr(Fix, "values", lambda fix, wander, tolerance, limit: sound(fix, 0, tolerance, limit))


def since_backwards(patch: Patch) -> None:
    """The run since the marker is taken off instead of added."""

    def turned(reader: Reader, moved: Cycle) -> Fix:
        found = fix(reader, moved)
        return replace(found, position=found.position - 2 * reader.since.value_or(as_num(0, MM)))

    patch.setattr(FIX, turned)


def readers_swapped(patch: Patch) -> None:
    """The trailing reader is taken for the leading one."""
    patch.setattr(Parts, "leads", lambda own, end: own.backwards if end == 0 else ~own.backwards)


def takes_over_where_equal(taker: int) -> Callable[[Patch], None]:
    """Of two equal margins that device takes over, although the other one is in use."""

    def edit(patch: Patch) -> None:
        def takes_over(own: Parts, judged: Judgement, index: int) -> Bool:
            mine, theirs = (judged.says(own.devices[number]) for number in (index, 1 - index))
            equal = mine.alive & theirs.alive & mine.margin.eq(theirs.margin)
            return mine.better_than(theirs) | equal if index == taker else mine.better_than(theirs)

        patch.setattr(odometry, "_takes_over", takes_over)

    return edit


def front_leads_while_alive(patch: Patch) -> None:
    """The front device leads while it has a position at all, whatever its margin."""

    def leads(own: Parts, judged: Judgement, index: int) -> Bool:
        front, rear = (judged.says(device) for device in own.devices)
        return rear.alive & ~front.alive if index else front.alive

    patch.setattr(odometry, "_leads", leads)
    patch.setattr(odometry, "_takes_over", leads)


def every_device_counts(counts: Bool) -> Edit:
    """Every device counts as one that had a position when a loss gets its reason, or none does."""
    return lambda patch: patch.setattr(Device, "alive", property(lambda self: counts))


def identities_kept(patch: Patch) -> None:
    """An identity that the trailing reader has read waits on."""
    patch.setattr(Pending, "_without", lambda own, passed, trailing: list(own.places))


def refused_identities_wait(patch: Patch) -> None:
    """An identity waits for the trailing reader although the leading reading was refused."""
    patch.setattr(Reading, "consistent", property(lambda one: one.verdict.ne(NONE)))


def identities_kept_in_turning(patch: Patch) -> None:
    """Identities wait on when the direction of travel turns."""
    sound = Pending.after
    patch.setattr(Pending, "after", lambda own, *found: sound(own, *found[:-1], TRUE))


def not_remembered(field: str, kept: str) -> Edit:
    """What the leading reader read last is not taken over: what is kept stays."""

    def edit(patch: Patch) -> None:
        sound = Judgement.remembered
        patch.setattr(Judgement, "remembered", lambda own: replace(sound(own), **{field: getattr(own.own, kept)}))

    return edit


EDITS: Mapping[str, tuple[Edit, str]] = {
    "rear reading without the vehicle length": (reader_with(offset=as_num(0, MM)), "containment"),
    "length tolerance not added": (reader_with(offset_tolerance_mm=0), "containment"),
    "error of the run since the marker not added": (reader_with(since_ppm=0), "containment"),
    "latency not added": (reader_with(latency_ppm=0), "containment"),
    "a changing speed not added": (reader_with(unsteady_nm=(0, 0)), "containment"),
    "accuracy of the map not added": (reader_with(accuracy_mm=0), "containment"),
    "run since the marker on the wrong side": (since_backwards, "containment"),
    "what is measured in the latency is taken for what is run": (measured_is_run, "containment"),
    "reading outside its window accepted": (window_open, "containment"),
    "floor of the law dropped": (law_with(floor_mm_s=0), "containment"),
    "rate of the law too small": (law_with(rate_ppm=20_000), "containment"),
    "knee of the law too high": (law_with(knee_mm_s=10_000), "containment"),
    "one-off constant not added": (constant_free, "containment"),
    "silence adds half the top speed": (half_blind, "containment"),
    "silence adds half the top speed, without the world": (
        half_blind,
        "silence of front_wheel widens the margins",
    ),
    "age limit doubled": (limits_with(age_limit_ms=172_800_000), "age limit"),
    "change of speed not gated": (limits_with(max_cycle_distance_change_mm=100_000), "front_wheel gate"),
    "top speed not gated": (limits_with(max_cycle_distance_mm=9_000), "front_wheel gate"),
    "a gate that lets pass what no vehicle runs": (limits_with(max_cycle_distance_change_mm=100_000), "containment"),
    "readers swapped": (readers_swapped, "rear reading pairs"),
    "an identity read at both ends waits on": (
        identities_kept,
        "an identity that the trailing reader has read waits no longer",
    ),
    "an identity that was refused waits": (
        refused_identities_wait,
        "an identity waits only once the leading reader has read it",
    ),
    "identities wait on in turning": (identities_kept_in_turning, "no identity waits after turning"),
    "the last marker is not taken over": (
        not_remembered("last_marker", "last_marker"),
        "the marker that the leading reader read last is stored",
    ),
    "the last marker's place is not taken over": (
        not_remembered("last_place", "last_marker_position"),
        "the marker that the leading reader read last is stored",
    ),
    "the rear device takes over where margins are equal": (
        takes_over_where_equal(1),
        "the rear device takes over only with a smaller margin",
    ),
    "the front device takes over where margins are equal": (
        takes_over_where_equal(0),
        "the front device takes over only with a smaller margin",
    ),
    "the front device leads while it has a position": (
        front_leads_while_alive,
        "the front device takes over only with a smaller margin",
    ),
    "a silent device without a position makes a loss a failure of sensors": (
        every_device_counts(TRUE),
        "a failure of sensors is stated only of a device in use",
    ),
    "a failure of sensors is told as tolerance": (
        every_device_counts(FALSE),
        "tolerance is not stated where sensors failed",
    ),
}


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", EDITS)
def test_a_wrong_edit_is_noticed(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """After the edit the claim, or a lemma that it rests on, does not hold any more."""
    edit, claim = EDITS[name]
    edit(monkeypatch)
    assert refuted(odometry.build(parts(OdometryConfig())), claim)


def test_a_forgotten_drift_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """A unit that drifts with the time since its marker gets that added."""
    law_with(drift_mm_s2=0)(monkeypatch)
    config = OdometryConfig(devices=1, first_unit=EDDY_CURRENT, second_unit=ACCELEROMETER)
    assert refuted(odometry.build(parts(config)), "containment")


AGED = OdometryConfig(
    devices=1, first_unit=EDDY_CURRENT, second_unit=ACCELEROMETER, single_fault_safe=True, tolerance_mm=45_000
)
GROWN = "front_{} holds the drift of its age"


@pytest.mark.parametrize("unit", ["eddy_current", "accelerometer"])
def test_the_drift_that_a_margin_holds_is_asked_of_both_units(unit: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each margin of a device that is safe against a single fault grows by the drift of either unit; a forgotten one is noticed."""
    claim = always("the lemmas", TRUE)
    right = odometry.build(parts(AGED, with_fault=True))
    assert inductive(right.machine, claim, GROWN.format(unit))
    law_with(drift_mm_s2=0)(monkeypatch)
    wrong = odometry.build(parts(AGED, with_fault=True))
    assert not inductive(wrong.machine, claim, GROWN.format(unit))


@pytest.mark.parametrize(
    ("law", "vehicle"),
    [({"drift_mm_s2": 1_000}, {}), ({"drift_mm_s2": 1_000}, {"max_speed_mm_s": 1}), ({}, {"period_ms": 1_000})],
)
def test_the_drift_of_their_age_is_held_whatever_the_figures(law: dict[str, int], vehicle: dict[str, int]) -> None:
    """Also where the drift of a cycle soon exceeds the farthest run."""
    unit = ACCELEROMETER.model_copy(update=law)
    config = OdometryConfig.model_validate({**dict(AGED), "second_unit": unit, **vehicle})
    machine = odometry.build(parts(config, with_fault=True)).machine
    assert inductive(machine, always("the lemmas", TRUE), GROWN.format("accelerometer"))


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("claim", sorted({claim for _, claim in EDITS.values()}))
def test_without_an_edit_nothing_is_refuted(claim: str) -> None:
    """The machine as it is keeps all that the edits break."""
    assert refuted(odometry.build(parts(OdometryConfig())), claim) == set()


@pytest.mark.slow
@pytest.mark.parametrize("good", [0, 1])
def test_a_unit_that_may_be_silent_for_ever_is_noticed(good: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """The lone limit holds for either unit of a device: asked of one of them only, the other one's claim is lost."""
    claims = [f"front device loses its position without front_{unit}" for unit in ("wheel", "radar")]
    right = odometry.build(parts(OdometryConfig()))
    assert [True, True] == [_keeps(right, claim) for claim in claims]

    def failed(device: Device, admitted: tuple[Bool, Bool]) -> Bool:
        gaps = [unit.gap + 1 for unit in device.units]
        limits, missing = device.limits, [~ok for ok in admitted]
        both = all_of(one & (gap > limits.gap_limit) for one, gap in zip(missing, gaps, strict=True))
        return both | (missing[good] & (gaps[good] > limits.lone_limit))

    monkeypatch.setattr(distance_device, "_failed", failed)
    wrong = odometry.build(parts(OdometryConfig()))
    assert not _keeps(wrong, claims[1 - good], claims[1 - good])
    assert _keeps(wrong, claims[good])


def _keeps(model: odometry.Odometry, claim: str, only: str = "") -> bool:
    return inductive(model.machine, next(one for one in properties(model) if one.name == claim), only)
