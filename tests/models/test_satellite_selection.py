"""Satellite selection: proved, and the source's criteria in figures: equality, one-sided faults, warm-up, expiry."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Literal, get_args

import pytest

from safeloc.language.expr import FALSE, TRUE, Bool, Expr, Num, as_num, between, ite
from safeloc.language.interpret import run
from safeloc.language.spec import always
from safeloc.language.system import lower, without_ghosts
from safeloc.language.units import COUNT
from safeloc.language.verdict import Proved
from safeloc.models import satellite_selection as selection
from safeloc.models.satellite_selection import Channel, Compared, Parts, Removal, SelectionConfig, build, parts
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.properties.satellite_selection import properties
from tests.models.inductive import inductive
from tests.models.spoilt import rebuilt
from tests.models.wrong_edits import lost

CONFIG = SelectionConfig(channels=2)
LIMIT, SPEED = CONFIG.range_threshold_mm, CONFIG.speed_threshold_mm_s
WIDE, FAST = CONFIG.range_covariance_mm2, CONFIG.speed_covariance_mm2_s2


def heard(channel: int = 1, /, **changes: int | bool | None) -> dict[str, int | bool]:
    """One healthy satellite on a channel; None leaves a measurement out."""
    values: dict[str, int | bool | None] = {
        "satellite": 7,
        "ephemeris_valid": True,
        "range_off_mm": 0,
        "speed_off_mm_s": 0,
        "range_covariance_mm2": 0,
        "speed_covariance_mm2_s2": 0,
        **changes,
    }
    return {f"channel_{channel}_{name}": value for name, value in values.items() if value is not None}


def standings(config: SelectionConfig, *steps: dict[str, int | bool], channel: int = 1) -> list[str]:
    """What a channel is after each cycle; channels that are not mentioned are empty."""
    system = without_ghosts(lower(selection.machine(config)))
    empty = {f"channel_{n}_ephemeris_valid": False for n in range(1, config.channels + 1)}
    trace = run(system, [{**empty, **step} for step in steps])
    return [selection.STANDING[int(step.state[f"channel_{channel}_standing"])].label for step in trace.steps]


def last(config: SelectionConfig = CONFIG, /, **changes: int | bool | None) -> str:
    """The standing of a warm channel with one measurement changed."""
    return standings(config, heard(), heard(), heard(**changes))[-1]


def test_a_satellite_has_to_warm_up() -> None:
    """A new one has no covariance over a window and is not usable; nor is the next one on its channel."""
    assert ["WARMING", "USABLE", "WARMING", "USABLE"] == standings(
        CONFIG, heard(), heard(), heard(satellite=8), heard(satellite=8)
    )


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        ({"satellite": None}, "ABSENT"),
        ({"ephemeris_valid": False}, "EXPIRED"),
        ({"range_off_mm": None}, "SILENT"),
        ({"speed_off_mm_s": None}, "SILENT"),
        ({"range_covariance_mm2": None}, "WARMING"),
        ({"speed_covariance_mm2_s2": None}, "WARMING"),
        ({"range_off_mm": LIMIT - 1}, "USABLE"),
        ({"range_off_mm": LIMIT}, "EXCLUDED"),
        ({"range_off_mm": -LIMIT}, "EXCLUDED"),
        ({"speed_off_mm_s": -SPEED}, "EXCLUDED"),
        ({"range_covariance_mm2": WIDE}, "EXCLUDED"),
        ({"speed_covariance_mm2_s2": FAST}, "EXCLUDED"),
    ],
)
def test_the_strict_criterion(change: dict[str, int | bool | None], expected: str) -> None:
    """Strictly below each threshold, in magnitude: equal is excluded ([0066]); Doppler or pseudorange removes ([0068])."""
    assert expected == last(**change)


@pytest.mark.parametrize(
    ("off", "covariance", "expected"),
    [(LIMIT + 1, WIDE, "USABLE"), (LIMIT, WIDE + 1, "USABLE"), (LIMIT + 1, WIDE + 1, "EXCLUDED"), (10**8, 0, "USABLE")],
)
def test_the_lax_criterion(off: int, covariance: int, expected: str) -> None:
    """Only where both are above their thresholds; equal is kept ([0049])."""
    config = SelectionConfig(channels=2, removal="both")
    assert expected == last(config, range_off_mm=off, range_covariance_mm2=covariance)


MASK, OLD = CONFIG.almanac_mask_mrad, CONFIG.almanac_limit_s


@pytest.mark.parametrize(
    ("age", "elevation", "while_current", "required"),
    [
        (OLD, MASK, "USABLE", "USABLE"),
        (OLD, MASK - 1, "UNLISTED", "UNLISTED"),
        (0, None, "UNLISTED", "UNLISTED"),
        (OLD + 1, MASK - 1, "USABLE", "UNLISTED"),
        (OLD + 1, MASK, "USABLE", "UNLISTED"),
        (None, 1_000, "USABLE", "UNLISTED"),
    ],
)
def test_the_almanac(age: int | None, elevation: int | None, while_current: str, required: str) -> None:
    """A current one lists what it has at its mask or above; one that is older, or none, lists nothing."""
    known = {} if age is None else {"almanac_age_s": age}
    step = {**heard(almanac_mrad=elevation), **known}
    needs = SelectionConfig(channels=2, almanac="required")
    assert while_current == standings(CONFIG, heard(), heard(), step)[-1]
    assert required == standings(needs, step, step, step)[-1]


def test_an_almanac_too_coarse_is_refused() -> None:
    """It could list a satellite below the horizon."""
    with pytest.raises(ValueError, match="almanac_mask_mrad 87 is not above almanac_accuracy_mrad 87"):
        SelectionConfig(almanac_accuracy_mrad=87)


def test_one_quantity_alone() -> None:
    """Where only Doppler is compared, pseudorange need not be measured, and the other way round."""
    doppler = SelectionConfig(channels=2, compared="doppler")
    missing = heard(range_off_mm=None, range_covariance_mm2=None)
    assert ["WARMING", "USABLE"] == standings(doppler, missing, missing)
    assert "USABLE" == last(doppler, range_off_mm=10**8)
    pseudorange = SelectionConfig(channels=2, compared="pseudorange")
    assert "USABLE" == last(pseudorange, speed_off_mm_s=10**7)


def test_exclusion_has_no_memory() -> None:
    """The list starts anew in every cycle: a satellite that fits again is usable again."""
    assert ["WARMING", "USABLE", "EXCLUDED", "USABLE"] == standings(
        CONFIG, heard(), heard(), heard(range_off_mm=LIMIT), heard()
    )


def test_a_duplicate_counts_once() -> None:
    """The same satellite on two channels is absent on the second."""
    both = {**heard(), **heard(2)}
    assert ["ABSENT", "ABSENT"] == standings(CONFIG, both, both, channel=2)
    assert ["WARMING", "USABLE"] == standings(CONFIG, both, both, channel=1)


def test_thresholds_below_noise_are_refused() -> None:
    """A threshold that healthy satellites pass while the train brakes is no threshold."""
    with pytest.raises(
        ValueError, match=r"range_threshold_mm 9200 is not above noise, prediction and clock error .* 9200"
    ):
        SelectionConfig(range_threshold_mm=9_200)
    with pytest.raises(ValueError, match="speed_threshold_mm_s 100 is not above"):
        SelectionConfig(speed_threshold_mm_s=100)


def _unproved(config: SelectionConfig, seconds: float = 60) -> list[str]:
    model = build(parts(config))
    findings = prove(lower(model.machine), properties(model), Limits(seconds=seconds), jobs=2)
    return [finding.id for finding in findings if not isinstance(finding.result, Proved)]


@pytest.mark.thorough
@pytest.mark.parametrize("compared", get_args(Compared))
@pytest.mark.parametrize("removal", get_args(Removal))
def test_everything_is_proved(compared: Compared, removal: Removal) -> None:
    """For each criterion, without a bound."""
    assert [] == _unproved(SelectionConfig(channels=2, compared=compared, removal=removal))


@pytest.mark.slow
@pytest.mark.parametrize("channels", [8, 16, 32])
def test_everything_is_proved_for_many_channels(channels: int) -> None:
    """Channels are independent but for duplicates and the count."""
    assert [] == _unproved(SelectionConfig(channels=channels), 600)


def test_a_one_sided_comparison_is_noticed() -> None:
    """A machine that keeps a satellite whatever is measured does not have the property."""
    model = build(parts(CONFIG))
    first = model.own.channels[0]
    table = [
        replace(t, set={**t.set, first.standing: selection.USABLE}) if t.name == "satellites are selected" else t
        for t in model.machine.transitions
    ]
    asked = [prop for prop in properties(model) if prop.name == "channel 1: a violation is not usable"]
    spoilt = prove(lower(rebuilt(model.machine, table)), asked, Limits(seconds=5))
    assert not isinstance(spoilt[-1].result, Proved)


def test_a_criterion_without_magnitudes_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """A difference that is compared on one side only loses the proof of every channel."""
    monkeypatch.setattr(selection, "abs_", lambda term: term)
    wrong = build(parts(SelectionConfig(channels=2)))
    asked = [one for one in properties(wrong) if one.name.endswith("a violation is not usable")]
    assert [False, False] == [inductive(wrong.machine, one) for one in asked]


def test_a_duplicate_that_counts_twice_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """One satellite on two channels, both usable, loses the proof of the second."""
    monkeypatch.setattr(selection, "_is_twice", lambda *_: FALSE)
    wrong = build(parts(SelectionConfig(channels=2)))
    (asked,) = [one for one in properties(wrong) if one.name == "channel 2: no satellite twice"]
    assert not inductive(wrong.machine, asked)


def _excluded_for_good(own: Parts, one: Channel) -> Expr:
    return ite(one.standing.eq(selection.EXCLUDED), selection.EXCLUDED, JUDGES(own, one))


JUDGES = selection.standing
LISTS = selection.possibly_visible


def _fresher(own: Parts, one: Channel) -> Expr:
    """Believe an almanac of any age."""
    return LISTS(own, one) & (~own.almanac_age.present | _listed(own, one))


def _listed(own: Parts, one: Channel) -> Bool:
    """Whether the almanac has the satellite at its mask or above, however old it is."""
    return one.almanac.present & (one.almanac.value >= own.config.almanac_mask_mrad)


EDITS: dict[str, tuple[str, Callable[..., Expr], str]] = {
    "the almanac is not asked": (
        "possibly_visible",
        lambda *_: TRUE,
        "channel 1: what the almanac does not list is not usable",
    ),
    "so a satellite below the horizon is used": (
        "possibly_visible",
        lambda *_: TRUE,
        "channel 1: a usable satellite is above the horizon",
    ),
    "one that the almanac does not have is listed": (
        "possibly_visible",
        lambda own, one: LISTS(own, one) | ~one.almanac.present,
        "channel 1: what the almanac does not list is not usable",
    ),
    "the mask is the zenith": (
        "possibly_visible",
        lambda own, one: LISTS(own, one) & (~own.almanac_age.present | (one.almanac.value > 1_500)),
        "channel 1: the almanac refuses none in full view",
    ),
    "an expired almanac is believed": ("possibly_visible", _fresher, "an expired almanac is not used"),
    "an almanac is current for ever": (
        "is_current",
        lambda own: own.almanac_age.present,
        "an expired almanac is not used",
    ),
    "every satellite is accepted": ("accepts", lambda *_: TRUE, "channel 1: a violation is not usable"),
    "so its error has no bound": ("accepts", lambda *_: TRUE, "channel 1: a usable range is bounded"),
    "no satellite is accepted": ("accepts", lambda *_: FALSE, "channel 1: exclusion leaves no trace"),
    "excluded for good": ("standing", _excluded_for_good, "channel 1: exclusion leaves no trace"),
    "no quantity need be measured": (
        "_received",
        lambda *_: TRUE,
        "channel 1: an unusable satellite has its true reason",
    ),
    "no covariance is needed": ("_spread", lambda *_: TRUE, "channel 1: no covariance, not usable"),
    "warm at once": ("warm", lambda *_: as_num(2, COUNT), "channel 1: a window counts one satellite's measurements"),
    "one usable satellite more": (
        "how_many",
        lambda _: as_num(1, COUNT),
        "the number of usable satellites is reported",
    ),
}


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("edit", EDITS)
def test_a_wrong_edit_of_a_term_is_noticed(edit: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """SAT-1, SAT-3, SAT-4, SAT-D1: each part of what the selection judges by."""
    name, term, broken = EDITS[edit]
    monkeypatch.setattr(selection, name, term)
    wrong = build(parts(CONFIG))
    assert lost(wrong.machine, properties(wrong), broken)


@pytest.mark.parametrize("removal", get_args(Removal))
def test_the_other_criterion_in_its_place_is_noticed(removal: Removal, monkeypatch: pytest.MonkeyPatch) -> None:
    """A machine that judges by the criterion that was not configured."""
    other: Removal = "both" if removal == "either" else "either"
    accepts = selection.accepts
    monkeypatch.setattr(selection, "accepts", lambda one, config, _: accepts(one, config, other))
    wrong = build(parts(SelectionConfig(channels=2, removal=removal)))
    assert lost(wrong.machine, properties(wrong), "channel 1: exclusion leaves no trace")


# ------------------------------------------------------------------ what a usable satellite may be wrong by

Quantity = Literal["range", "speed"]


def _wrong_by(model: selection.Selection, quantity: Quantity) -> tuple[Num, Bool]:
    """The first channel's error, where prediction and clock are as good as configured."""
    one, own, config = model.own.channels[0], model.own, model.own.config
    if quantity == "range":
        hidden, clock = between(-config.range_prediction_mm, one.prediction, config.range_prediction_mm), own.clock
        return one.error, hidden & between(-config.range_clock_mm, clock, config.range_clock_mm)
    hidden = between(-config.speed_prediction_mm_s, one.prediction_mm_s, config.speed_prediction_mm_s)
    return one.speed_error, hidden & between(-config.speed_clock_mm_s, own.clock_mm_s, config.speed_clock_mm_s)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(("quantity", "most"), [("range", 14_700), ("speed", 1_950)])
def test_the_bound_of_a_usable_satellite_is_tight(quantity: Quantity, most: int) -> None:
    """Threshold, prediction and clock together: 14.7 m and 1.95 m/s are never reached; 1 mm, or 1 mm/s, less is, in a run."""
    model = build(parts(CONFIG))
    error, as_configured = _wrong_by(model, quantity)
    usable = model.own.channels[0].standing.eq(selection.USABLE) & as_configured
    asked = [
        always(f"below {n}", usable.implies((error < n) & (error > -n)), statement=f"below {n}")
        for n in (most, most - 1)
    ]
    assert {f"below {most - 1}": "violated"} == lost(model.machine, asked)
    assert (CONFIG.usable_range_error_mm, CONFIG.usable_speed_error_mm_s) == (14_700, 1_950)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("term", ["threshold", "prediction", "clock"])
@pytest.mark.parametrize("quantity", get_args(Quantity))
def test_no_term_of_that_bound_can_be_left_out(quantity: Quantity, term: str) -> None:
    """A usable satellite may be wrong by more than any two of the three terms make."""
    model = build(parts(CONFIG))
    error, as_configured = _wrong_by(model, quantity)
    terms = {one: getattr(CONFIG, f"{quantity}_{one}_{'mm' if quantity == 'range' else 'mm_s'}") for one in TERMS}
    most = sum(terms.values()) - terms[term]
    usable = model.own.channels[0].standing.eq(selection.USABLE) & as_configured
    claim = always("less", usable.implies((error < most) & (error > -most)), statement="two of the three terms")
    assert {"less": "violated"} == lost(model.machine, [claim])


TERMS = ("threshold", "prediction", "clock")
