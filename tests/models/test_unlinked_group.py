"""The unlinked group as a reference: worked figures, both sides of every limit, and what must not count."""

from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydantic import ValidationError

from safeloc.errors import InputError
from safeloc.models.balise.groups import Group
from safeloc.models.unlinked_group.ahead import left_mm
from safeloc.models.unlinked_group.variables import UnlinkedGroupConfig
from safeloc.models.vocabulary.absent import NO_MARGIN_MM, NO_POSITION_MM
from safeloc.models.vocabulary.error_law import ErrorLaw
from safeloc.runtime.streams.steps import Cell
from tests.models.unlinked_runs import PLAIN, UNLINKED, Record, drive, held, interval, label, out, reading, step

NEXT = replace(UNLINKED, identity=8)
LINKED = Group(9, 0, balises=2)


# ------------------------------------------------------------------ what is measured


def test_the_distance_begins_with_antenna_and_reading() -> None:
    """3 m from antenna to front end; 1 m of detection and 4 m of one-off constant on either side."""
    trace = drive(held())
    assert (3_000, 5_000, 5_000) == interval(trace)
    assert (7, True, 0) == tuple(out(trace)[name] for name in ("group", "valid", "age_ms"))


def test_the_distance_runs_on() -> None:
    """After 100 m more, 5 m more on either side; the age counts from the reading."""
    trace = drive([*held(), *[step()] * 100])
    assert (103_000, 10_000, 10_000) == interval(trace)
    assert 10_000 == out(trace)["age_ms"]


def test_the_counted_run_since_the_reading_counts() -> None:
    """2 m since the reading, measured by the latched counter: 5 m ahead, and 5 % of 2 m more."""
    trace = drive([step(), step(1_000, reading(telegram_since_mm=2_000, telegram_age_ms=60))])
    assert (5_000, 5_100, 5_100) == interval(trace)
    assert 60 == out(trace)["age_ms"]


@pytest.mark.parametrize(
    ("distance", "age", "expected"),
    [
        (1_000, 100, (3_000, 9_445, 5_000)),
        (0, 100, (3_000, 5_000, 5_000)),
        (-1_000, 100, (3_000, 5_000, 9_445)),
        (1_000, 101, (3_000, 9_489, 9_489)),
        (None, 100, (3_000, 9_445, 9_445)),
    ],
)
def test_without_a_counter_the_run_since_the_reading_is_charged(
    distance: int | None, age: int, expected: tuple[int, int, int]
) -> None:
    """44.445 m/s for the age: forwards if the cycle ran forwards, to both sides if the reading is older or nothing was measured."""
    trace = drive([step(distance), step(distance, reading(telegram_since_mm=None, telegram_age_ms=age))])
    assert expected == interval(trace)


def test_a_missing_distance_widens() -> None:
    """The distance rests, and the farthest run of a cycle, 4.4445 m, counts on both sides, rounded up."""
    trace = drive([*held(), step(None)])
    assert (3_000, 9_445, 9_445) == interval(trace)
    assert "MISSING" == label(trace, "odometer")


def test_rolling_back_a_little_shortens_the_distance() -> None:
    """Two metres back are no turn: the distance is one metre, each metre run is charged."""
    trace = drive([step(0), step(0, reading()), *[step(-100)] * 20])
    assert (1_000, 5_100, 5_100) == interval(trace)


# ------------------------------------------------------------------ which group


def test_the_next_unlinked_group_takes_its_place() -> None:
    """With margins of its own; nothing of the one before is left."""
    trace = drive([*held(), *[step()] * 100, step(1_000, reading(NEXT))])
    assert ((3_000, 5_000, 5_000), 8, 0) == (interval(trace), out(trace)["group"], out(trace)["age_ms"])


def test_the_same_group_read_again_is_measured_anew() -> None:
    """As after a vehicle rolled back over it."""
    trace = drive([*held(), *[step()] * 100, step(1_000, reading())])
    assert ((3_000, 5_000, 5_000), 7) == (interval(trace), out(trace)["group"])


@pytest.mark.parametrize(("numbers", "expected"), [((1, 2), "NOMINAL"), ((2, 1), "REVERSE")])
def test_the_orientation_is_that_of_the_numbers(numbers: tuple[int, int], expected: str) -> None:
    """Distances that a group tells are for trains that passed it in one direction."""
    first, last = numbers
    trace = drive(held({"telegram_first": first, "telegram_last": last}))
    assert expected == label(trace, "passed")


@pytest.mark.parametrize(
    ("changed", "verdict"),
    [
        ({"telegram_age_ms": None}, "MALFORMED"),
        ({"telegram_first": 3}, "MALFORMED"),
        ({"telegram_last": 1}, "MALFORMED"),
        ({"telegram_check": "FAILED"}, "CORRUPTED"),
        ({"telegram_age_ms": 1_001}, "STALE"),
        ({"telegram_link": "LINKED"}, "LINKED"),
        ({"telegram_total": 1, "telegram_read": 1, "telegram_last": 1}, "SINGLE"),
        ({"telegram_read": 1, "telegram_last": 1}, "INCOMPLETE"),
        ({"telegram_total": 3}, "INCOMPLETE"),
    ],
)
def test_what_is_not_taken_changes_nothing(changed: dict[str, Cell | None], verdict: str) -> None:
    """Reference, distance and margins are those of a run without the reading; without a reference there is none afterwards."""
    read = step(1_000, reading(NEXT, **changed))
    trace, quiet = (drive([*held(), step(), one]) for one in (read, step()))
    assert verdict == label(trace, "telegram")
    assert {**out(quiet), "telegram": out(trace)["telegram"]} == out(trace)
    assert not out(drive([step(), read]))["valid"]


def test_a_group_of_one_second_ago_is_taken() -> None:
    """The limit itself is recent."""
    assert "TAKEN" == label(drive(held({"telegram_age_ms": 1_000})), "telegram")


def test_linked_groups_change_nothing() -> None:
    """However many are passed."""
    linked = [step(1_000, reading(replace(LINKED, identity=20 + number))) for number in range(5)]
    assert out(drive([*held(), *linked, step()])) == out(drive([*held(), *[step()] * 6]))


# ------------------------------------------------------------------ location accuracy


def test_the_location_accuracy_is_the_default() -> None:
    """Without national values: 12 m."""
    assert 12_000 == out(drive(held()))["location_accuracy_mm"]


def test_a_national_value_of_the_cycle_of_the_reading_counts() -> None:
    """And one received before."""
    told: Record = {"national_accuracy_mm": 5_000}
    assert 5_000 == out(drive(held(told)))["location_accuracy_mm"]
    assert 5_000 == out(drive([step(1_000, told), *held()]))["location_accuracy_mm"]


def test_a_later_national_value_does_not_change_it() -> None:
    """SUBSET-026 3.6.4.1.4; it counts for the next group."""
    later = [*held(), step(1_000, {"national_accuracy_mm": 5_000})]
    assert 12_000 == out(drive(later))["location_accuracy_mm"]
    assert 5_000 == out(drive([*later, step(1_000, reading(NEXT))]))["location_accuracy_mm"]


# ------------------------------------------------------------------ when it is withdrawn


def gone(stream: list[Record], config: UnlinkedGroupConfig = PLAIN) -> tuple[bool, str]:
    """Whether the reference is withdrawn exactly in the last step, and why."""
    trace = drive(stream, config)
    return bool(out(trace, -2)["valid"]) and not out(trace)["valid"], label(trace, "reason")


def test_a_silent_odometer_withdraws_it() -> None:
    """Five cycles without a distance are permitted; in the sixth there is no reference."""
    assert (True, "SENSOR_FAILURE") == gone([*held(), *[step(None)] * 6])


def test_a_turned_vehicle_withdraws_it() -> None:
    """More than D_NVROLL of 2 m backwards."""
    assert (True, "REVERSED") == gone([step(0), step(0, reading()), *[step(-100)] * 21])


def test_a_wide_margin_withdraws_it() -> None:
    """5 m and 5 % of 1100 m are the tolerance of 60 m; a metre more is too much."""
    reached = [*held(), *[step()] * 1_100]
    assert (1_103_000, 60_000, 60_000) == interval(drive(reached))
    assert (True, "TOLERANCE") == gone([*reached, step()])


def test_the_reach_of_packets_withdraws_it() -> None:
    """The longest distance is one that can be told; one metre more is not."""
    config = PLAIN.model_copy(update={"reach_mm": 103_000})
    assert 103_000 == interval(drive([*held(), *[step()] * 100], config))[0]
    assert (True, "TOLERANCE") == gone([*held(), *[step()] * 100, step()], config)


def test_nothing_is_reported_after_a_withdrawal() -> None:
    """No identity, no distance, no accuracy, no age, no orientation; the reason stays."""
    trace = drive([*held(), *[step(None)] * 6, step(), step()])
    assert (NO_POSITION_MM, NO_MARGIN_MM, NO_MARGIN_MM) == interval(trace)
    assert (0, 0, 0) == tuple(out(trace)[name] for name in ("group", "location_accuracy_mm", "age_ms"))
    assert ("UNKNOWN", "SENSOR_FAILURE") == (label(trace, "passed"), label(trace, "reason"))


def test_no_group_before_the_first() -> None:
    """The reason is that none was read."""
    assert (False, "NO_GROUP") == (out(drive([step()]))["valid"], label(drive([step()]), "reason"))


def test_a_group_read_with_a_silent_odometer_is_taken() -> None:
    """Its own reading tells where the front end is; the next silent cycle withdraws it."""
    silent = [*[step(None)] * 8, reading(telegram_since_mm=None, telegram_age_ms=50)]
    assert (3_000, 7_223, 7_223) == interval(drive(silent))
    assert (True, "SENSOR_FAILURE") == gone([*silent, step(None)])


def test_a_group_read_while_running_backwards_is_not_taken() -> None:
    """3.14.3.6; once the vehicle has run forwards again for more than D_NVROLL, the next one is."""
    back = [step(0), *[step(-100)] * 21]
    assert "REVERSING" == label(drive([*back, step(-100, reading())]), "telegram")
    forth = [*back, step(0), *[step(100)] * 20]
    assert "REVERSING" == label(drive([*forth, step(0, reading())]), "telegram")
    assert "TAKEN" == label(drive([*forth, step(100, reading())]), "telegram")


# ------------------------------------------------------------------ what a host does with it


def report(stream: list[Record]) -> dict[str, int | bool | None]:
    """The outputs of the last step."""
    return dict(out(drive(stream)))


def test_the_way_left_to_a_place_that_the_group_told() -> None:
    """1000 m told, 103 m run, 10 m of margin and 12 m of location accuracy."""
    assert (875_000, 919_000) == left_mm(1_000_000, report([*held(), *[step()] * 100]), group=7)


def test_a_place_that_was_passed_has_a_negative_way() -> None:
    """Told right at the group, 103 m behind."""
    least, most = left_mm(0, report([*held(), *[step()] * 100]), group=7)
    assert (-125_000, -81_000) == (least, most)


def test_no_way_is_left_without_a_reference() -> None:
    """The message says what to do."""
    with pytest.raises(
        InputError, match=r"^no distance beyond group 7 is reported; .*whichever is more restrictive\.$"
    ):
        left_mm(1_000_000, report([step()]), group=7)


def test_no_way_is_told_of_another_group() -> None:
    """A distance is never taken from the wrong group."""
    with pytest.raises(InputError, match=r"^the reported distance is that beyond group 7, not 8; carry places"):
        left_mm(1_000_000, report(held()), group=8)


@given(st.integers(0, 30_000_000), st.integers(-1_000, 1_000), st.integers(-12_000, 12_000), st.integers(0, 60))
def test_the_true_way_left_is_within(told: int, permille: int, off: int, cycles: int) -> None:
    """For every error within the margins and every group within its location accuracy."""
    found = report([*held(), *[step()] * cycles])
    margin = int(found["margin_above_mm"] or 0)
    true_beyond = int(found["distance_mm"] or 0) + margin * permille // 1_000
    least, most = left_mm(told, found, group=7)
    assert least <= told + off - true_beyond <= most


# ------------------------------------------------------------------ figures that are refused


@pytest.mark.parametrize(
    ("figures", "message"),
    [
        ({"odometer": {"kind": "wheel", "rate_ppm": 900_001}}, r"odometer\.rate_ppm must not exceed 900000"),
        ({"odometer": {"kind": "accelerometer", "drift_mm_s2": 5}}, r"odometer\.drift_mm_s2 must be 0"),
        ({"telegram_age_limit_ms": 10}, r"telegram_age_limit_ms 10 must be above a tenth of period_ms 100"),
        ({"tolerance_mm": 50_458}, r"tolerance_mm 50458 is below 50459 mm, the widest margin right after a reading"),
        (
            {"reach_mm": 47_589, "tolerance_mm": 60_000},
            r"reach_mm 47589 is below 47590 mm, the farthest distance right after",
        ),
    ],
)
def test_figures_without_a_sense_are_refused(figures: dict[str, object], message: str) -> None:
    """The message names the figure and what to do."""
    with pytest.raises(ValidationError, match=message):
        UnlinkedGroupConfig.model_validate(figures)


def test_the_least_figures_are_accepted() -> None:
    """The widest margin right after a reading, and the farthest distance."""
    least = UnlinkedGroupConfig(tolerance_mm=50_459, reach_mm=47_590)
    assert (50_459, 44_590) == (least.first_margin_mm, 10 * least.max_cycle_distance_mm)


def test_a_precise_odometer_needs_less() -> None:
    """The margin right after a reading follows the odometer."""
    assert 48_459 == UnlinkedGroupConfig(odometer=ErrorLaw(kind="wheel", constant_mm=3_000)).first_margin_mm
