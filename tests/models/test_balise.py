"""The balise machine: windows, telegrams of every kind, the common interval, the first group, the next reflector."""

from __future__ import annotations

from dataclasses import replace

import pytest
from pydantic import ValidationError

from safeloc.models.balise.groups import announcement, telegram
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.runtime.streams.steps import Cell
from tests.models.balise_runs import (
    LATER,
    NEXT,
    PLAIN,
    START,
    drive,
    interval,
    intervals,
    label,
    located,
    out,
    read_at,
    step,
    until,
)

# ------------------------------------------------------------------ windows and verdicts


def test_window_opens_when_the_max_safe_front_end_reaches_it() -> None:
    """3.4.4.4.3: the group at 50 m +- 1 m can be read from 49 m on; the max safe front end is 1.05 k + 2 m."""
    assert label(read_at(44), "telegram") == "TOO_EARLY"
    assert label(read_at(45), "telegram") == "ACCEPTED"


def test_window_closes_when_the_min_safe_front_end_has_passed_it() -> None:
    """3.4.4.4.3: it can be read up to 51 m; the min safe front end is 0.95 k - 2 m, and passes 51 m in cycle 56."""
    still = drive(until(56, located(NEXT)))
    closed = drive(until(57, located(NEXT)))
    assert (out(still)["expected"], out(closed)["expected"]) == (2, 0)
    assert closed.steps[-1].fired["fired"] == "expected group missed"
    assert label(read_at(55), "telegram") == "ACCEPTED"
    assert label(read_at(57), "telegram") == "TOO_LATE"


def test_antenna_and_detection_shift_and_widen_the_window() -> None:
    """The antenna is 3 m behind the front end, and may say so 1 m off: the window is 51 m to 55 m of the front end."""
    config = PLAIN.model_copy(update={"antenna_mm": 3_000, "detection_mm": 1_000})
    stream = [step(1_000, telegram(START, since_mm=0)), step(1_000, announcement(NEXT))]
    trace = drive(until(70, stream), config)
    assert interval(trace, 0) == (3_000, 3_000, 3_000)
    ends = [(place - below, out(trace, index)["expected"]) for index, (place, _, below) in enumerate(intervals(trace))]
    closing = next(index for index, (_, group) in enumerate(ends) if index > 1 and group == 0)
    assert ends[closing - 1][0] <= 55_000 < ends[closing][0]


@pytest.mark.parametrize(
    ("changed", "verdict"),
    [
        ({}, "ACCEPTED"),
        ({"telegram_check": "FAILED"}, "CORRUPTED"),
        ({"telegram_read": 1, "telegram_last": 1}, "INCOMPLETE"),
        ({"telegram_first": 2, "telegram_last": 1}, "WRONG_DIRECTION"),
        ({"telegram_age_ms": 1_001}, "STALE"),
        ({"telegram_age_ms": None}, "MALFORMED"),
        ({"telegram_group": None}, "MALFORMED"),
        ({"telegram_first": 3}, "MALFORMED"),
        ({"telegram_read": 1}, "MALFORMED"),
        ({"telegram_group": 900_001}, "NOT_ANNOUNCED"),
        ({"telegram_group": 900_001, "telegram_link": "UNLINKED"}, "UNLINKED"),
        ({"telegram_group": 1}, "REPEATED"),
        ({"telegram_position_mm": 52_000}, "MISMATCH"),
        ({"telegram_position_mm": None}, "ACCEPTED"),
    ],
)
def test_telegrams_of_every_kind(changed: dict[str, Cell | None], verdict: str) -> None:
    """What becomes of a telegram at the right moment; unless it is accepted, the interval is that of odometry."""
    trace = read_at(50, NEXT, NEXT, **changed)
    assert label(trace, "telegram") == verdict
    odometry_alone = (50_000, 4_500, 4_500)
    assert (interval(trace) == odometry_alone) == (verdict != "ACCEPTED")
    assert out(trace)["valid"] is True


@pytest.mark.parametrize("first", [1, 2])
def test_a_single_balise_has_no_orientation(first: int) -> None:
    """A group of one is accepted whatever the orientation announced; a group of two is not."""
    single = replace(NEXT, balises=1)
    wanted = replace(single, orientation="NOMINAL" if first == 1 else "REVERSE")
    order = {**announcement(wanted), "linking_orientation": wanted.orientation}
    stream = until(50, [step(1_000, telegram(START, since_mm=0)), step(1_000, order)])
    trace = drive([*stream, step(1_000, telegram(single, since_mm=0))])
    assert label(trace, "telegram") == "ACCEPTED"


def test_reverse_orientation_as_announced() -> None:
    """A group announced in reverse is accepted when its last balise is read first."""
    back = replace(NEXT, orientation="REVERSE")
    assert label(read_at(50, back, back), "telegram") == "ACCEPTED"
    assert label(read_at(50, NEXT, back), "telegram") == "WRONG_DIRECTION"


def test_balises_read_while_running_backwards_are_ignored() -> None:
    """3.14.3.6: after more than D_NVROLL against the route nothing is believed; later forwards it is again."""
    config = PLAIN.model_copy(update={"max_acceleration_mm_s2": 10_000})
    slow = [step(1_000 - 100 * n) for n in range(1, 21)]
    stream = [*located(replace(NEXT, place_mm=5_000)), *slow, *(step(-1_000) for _ in range(2))]
    trace = drive([*stream, step(-1_000, telegram(replace(NEXT, place_mm=5_000), since_mm=0))], config)
    assert trace.steps[-1].state["backwards"] is True
    assert label(trace, "telegram") == "REVERSING"
    assert label(trace, "reaction") == "NONE"


# ------------------------------------------------------------------ the interval


def test_a_reset_is_the_common_part() -> None:
    """Odometry has 50 m +- 4.5 m, the group 50 m +- 1 m: the telegram's part remains."""
    assert interval(read_at(50)) == (50_000, 1_000, 1_000)


def test_a_coarse_group_narrows_nothing() -> None:
    """A group of 20 m accuracy leaves the narrower interval of odometry as it is."""
    coarse = replace(NEXT, accuracy_mm=20_000)
    assert interval(read_at(50, coarse, coarse)) == (50_000, 4_500, 4_500)


def test_overlap_on_one_side() -> None:
    """Read 3 m early: odometry has 42.65 to 51.35 m, the group 49 to 51 m; the common part is the group's."""
    position, above, below = interval(read_at(47))
    assert (position - below, position + above) == (49_000, 51_000)
    position, above, below = interval(read_at(45))
    assert (position - below, position + above) == (49_000, 49_250)


def test_intervals_that_exclude_each_other_delocalize() -> None:
    """Read in the cycle in which the window closes, with the odometer surely beyond: nothing is believed any more."""
    trace = read_at(56)
    assert trace.steps[-1].fired["fired"] == "contradiction"
    assert (label(trace, "reason"), out(trace)["valid"]) == ("CONTRADICTION", False)


def test_the_time_since_the_reading_adds_error() -> None:
    """10 ms at 44.445 m/s are 0.444 m on the side the vehicle runs to; the latched counter moves the place instead."""
    by_age = read_at(50, NEXT, NEXT, telegram_since_mm=None, telegram_age_ms=10)
    assert interval(by_age) == (50_000, 1_445, 1_000)
    by_counter = read_at(50, NEXT, NEXT, telegram_since_mm=600, telegram_age_ms=60)
    assert interval(by_counter) == (50_600, 1_030, 1_030)


def test_an_old_reading_adds_error_both_ways() -> None:
    """A reading older than the cycle: the direction of this cycle says nothing of it."""
    trace = read_at(50, NEXT, NEXT, telegram_since_mm=None, telegram_age_ms=150)
    position, above, below = interval(trace)
    assert (position - below, position + above) == (45_500, 54_500)


@pytest.mark.parametrize(
    ("linking", "national", "added"), [(1_000, 5_000, 1_000), (None, 5_000, 5_000), (None, None, 2_000)]
)
def test_accuracy_by_precedence(linking: int | None, national: int | None, added: int) -> None:
    """3.6.4.2.3: linking, else the national value (once received it stays), else the default."""
    group = replace(NEXT, accuracy_mm=linking)
    told: dict[str, Cell] = {} if national is None else {"national_accuracy_mm": national}
    stream = until(50, [step(1_000, telegram(START, since_mm=0)), step(1_000, announcement(group), told)])
    trace = drive([*stream, step(1_000, telegram(group, since_mm=0))])
    assert trace.steps[-1].state["added_accuracy_mm"] == added


def test_missing_distance_charges_the_top_speed_and_silence_delocalizes() -> None:
    """A cycle without distance: the estimate rests, both margins grow by 4.445 m; after the gap limit all is lost."""
    one = drive([*located(), {}])
    assert interval(one) == (0, 6_445, 6_445)
    silent = PLAIN.model_copy(update={"tolerance_mm": 100_000})
    lost = drive([*located(), *({} for _ in range(PLAIN.gap_limit_cycles + 1))], silent)
    assert (label(lost, "reason"), out(lost)["valid"], out(lost, -2)["valid"]) == ("SENSOR_FAILURE", False, True)


def test_passed_tolerance_delocalizes_and_withdraws_linking() -> None:
    """30 m are used up after 560 m at 5 %; nothing is expected then, and announcements are refused."""
    far = replace(NEXT, place_mm=5_000_000)
    trace = drive([*until(600, located(far)), step(1_000, announcement(far))])
    lost = next(index for index, one in enumerate(trace.steps) if one.outputs["reason"] != 0)
    assert interval(trace, lost - 1)[1] <= 30_000
    assert label(trace, "reason") == "TOLERANCE"
    assert (out(trace)["expected"], label(trace, "linking")) == (0, "NOT_LOCATED")


def test_a_group_at_the_last_moment_saves_the_position() -> None:
    """The cycle that passes the tolerance is the one in which the group is read: the common part is tolerable."""
    far = replace(NEXT, place_mm=560_000)
    lost = drive(until(562, located(far)))
    saved = drive([*until(560, located(far)), step(1_000, telegram(far, since_mm=0))])
    assert out(lost)["valid"] is False
    assert interval(saved) == (560_000, 1_000, 1_000)


# ------------------------------------------------------------------ the first group


def test_a_first_group_is_only_a_candidate() -> None:
    """By default nothing is reported until a different group agrees by measured distance."""
    config = PLAIN.model_copy(update={"trust_first_group": False})
    second = replace(START, identity=2, place_mm=20_000)
    first = [*until(20, located()), step(1_000, telegram(START, since_mm=0))]
    assert label(drive(first, config), "telegram") == "REPEATED"
    agreeing = drive([*until(20, located()), step(1_000, telegram(second, since_mm=0))], config)
    assert (out(agreeing, -2)["valid"], out(agreeing)["valid"]) == (False, True)
    wrong = drive([*until(20, located()), step(1_000, telegram(replace(second, place_mm=40_000)))], config)
    assert (label(wrong, "telegram"), out(wrong)["valid"]) == ("CANDIDATE", False)


@pytest.mark.parametrize(
    ("changed", "verdict"),
    [
        ({"telegram_position_mm": None}, "NO_PLACE"),
        ({"telegram_link": "UNLINKED", "telegram_total": 1, "telegram_read": 1, "telegram_last": 1}, "SINGLE"),
        ({"telegram_orientation": "REVERSE"}, "WRONG_DIRECTION"),
        ({"telegram_read": 1, "telegram_last": 1}, "INCOMPLETE"),
        ({"telegram_check": "FAILED"}, "CORRUPTED"),
        ({"national_accuracy_mm": 40_000}, "TOO_COARSE"),
    ],
)
def test_first_groups_that_do_not_serve(changed: dict[str, Cell | None], verdict: str) -> None:
    """3.4.4.3.2, 3.6.1.4: a first group needs a place, and is unlinked only with two balises or more."""
    read = {name: value for name, value in {**telegram(START), **changed}.items() if value is not None}
    trace = drive([step(1_000, read)])
    assert (label(trace, "telegram"), out(trace)["valid"]) == (verdict, False)


def test_unlinked_groups_serve_only_where_that_is_configured() -> None:
    """3.6.1.4: never a reference; `free_references` lets one with coordinates of its own narrow the interval."""
    unlinked = replace(NEXT, linked=False)
    assert label(read_at(50, unlinked), "telegram") == "ACCEPTED"  # announced after all: linking speaks of it
    stream = [*until(50, located(LATER)), step(1_000, telegram(unlinked, since_mm=0))]
    assert label(drive(stream), "telegram") == "UNLINKED"
    free = PLAIN.model_copy(update={"free_references": True})
    assert interval(drive(stream, free)) == (50_000, 2_000, 2_000)
    displaced = [*until(50, located(LATER)), step(1_000, telegram(replace(unlinked, place_mm=80_000), since_mm=0))]
    assert (label(drive(displaced, free), "telegram"), interval(drive(displaced, free))[1]) == ("OUT_OF_PLACE", 4_500)


@pytest.mark.parametrize(("balises", "direction"), [(1, "UNKNOWN"), (2, "ALONG")])
def test_direction_needs_an_orientation(balises: int, direction: str) -> None:
    """A single balise tells no direction; a second group surely beyond it does."""
    first = replace(START, balises=balises)
    trace = drive([step(1_000, telegram(first, since_mm=0))])
    assert label(trace, "direction") == direction
    second = replace(NEXT, balises=1)
    stream = until(50, [step(1_000, telegram(first, since_mm=0)), step(1_000, announcement(second))])
    assert label(drive([*stream, step(1_000, telegram(second, since_mm=0))]), "direction") == "ALONG"


# ------------------------------------------------------------------ the next reflector (RFL-9)


def test_the_telegram_tells_of_the_reflector() -> None:
    """RFL-9: place of the reflector and of the search, from the group's place on; forgotten once surely passed."""
    telling = replace(NEXT, reflector_mm=20_000, search_mm=5_000)
    stream = [*until(50, located(telling)), step(1_000, telegram(telling, since_mm=0))]
    trace = drive([*stream, *(step() for _ in range(30))])
    told = out(trace, len(stream) - 1)
    assert (told["reflector_known"], told["reflector_mm"]) == (True, 70_000)
    assert (told["search_known"], told["search_mm"]) == (True, 55_000)
    assert (out(trace)["reflector_known"], out(trace)["search_known"]) == (False, False)


def test_a_rejected_telegram_tells_nothing() -> None:
    """RFL-9: what a telegram outside its window says of a reflector is not taken."""
    telling = replace(NEXT, reflector_mm=20_000)
    assert out(read_at(30, telling, telling))["reflector_known"] is False


# ------------------------------------------------------------------ what the audit reckons with


def test_the_audited_stretch_is_run_without_loss() -> None:
    """RFL-D4: 560 m at 5 % and 2 m use up the audit's 30 m; up to there nothing is lost, and the run says so."""
    trace = drive(until(580, located()))
    kept = next(index for index, one in enumerate(trace.steps) if not one.outputs["valid"]) - 1
    assert out(trace, kept)["distance_run_mm"] == 559_000  # one millimetre of the tolerance goes to rounding
    assert out(trace, kept)["run_measured"] is True
    assert out(drive([*located(), {}, step()]))["run_measured"] is False


# ------------------------------------------------------------------ configuration


@pytest.mark.parametrize(
    ("fields", "message"),
    [
        ({"tolerance_mm": 6_000}, "no group can locate within it"),
        ({"odometer": ErrorLaw(kind="accelerometer", drift_mm_s2=5)}, "takes a unit that counts distance"),
        ({"odometer": ErrorLaw(kind="wheel", rate_ppm=950_000)}, "such an odometer measures no distance"),
        ({"announced_groups": 1}, "greater than or equal to 2"),
        ({"tolerance_m": 5}, "Extra inputs are not permitted"),
    ],
)
def test_configurations_that_cannot_work_are_refused(fields: dict[str, object], message: str) -> None:
    """A wrong configuration says what is wrong."""
    with pytest.raises(ValidationError, match=message):
        BaliseConfig(**fields)  # type: ignore[arg-type]


def test_every_field_carries_unit_and_source() -> None:
    """Each figure of the configuration says its unit and where it comes from."""
    for name, info in BaliseConfig.model_fields.items():
        if info.annotation is int:
            assert isinstance(info.json_schema_extra, dict), name
            assert set(info.json_schema_extra) == {"unit", "source"}, name
