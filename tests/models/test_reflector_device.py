"""The reflector device: what the balise machine rejects anchors nothing, a wrong wire is not proved, the recordings say what they teach."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

import pytest
from pydantic import ValidationError

from safeloc.language.expr import FALSE, TRUE, Bool, as_num, ite
from safeloc.language.units import MM
from safeloc.models import reflector_device
from safeloc.models.balise.variables import BaliseConfig
from safeloc.models.delocalized import DelocalizedConfig
from safeloc.models.motion import MotionConfig
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.reflector.world import PRESCRIBED, READING
from safeloc.models.reflector_device import ReflectorDevice, ReflectorDeviceConfig, compose_machines
from safeloc.models.reflector_device.simulate import SCENES, write
from safeloc.models.route.world import AT_THE_START
from safeloc.models.stop_point.variables import StopPointConfig
from safeloc.models.stop_point.world import REPORTED
from safeloc.models.turn_off import TurnOffConfig
from safeloc.models.turn_off.seen_course import TAKEN
from safeloc.models.turn_off.world import GIVEN
from safeloc.models.vocabulary.absent import wired_interval
from safeloc.properties.reflector_device import properties
from tests.models.anchored_wires import whatever_is_reported
from tests.models.composed_devices import Runs, Wiring, Wrong, flag, input_of
from tests.models.owed_contracts import Wires

DEVICE = Wiring(reflector_device, properties)


# ------------------------------------------------------------------ contracts


def test_only_the_laws_of_sensors_are_assumed() -> None:
    """What is said of a reading, of its distance to the reflector and of the reported interval is owed; none of it is an input."""
    system = compose_machines().composition.system
    owed = {part.name: part.guaranteed for part in system.parts if part.guaranteed}
    restrictive = "a valid position holds the truth"
    assert {
        "reflector": (READING, PRESCRIBED), "turn_off": (GIVEN,), "route": (AT_THE_START, TAKEN), "delocalized": (restrictive,),
        "stop_point": (REPORTED,),
    } == owed  # fmt: skip
    left = {var.name for var in system.inputs}
    assert not {name for name in left if name.startswith(("reflector.balise", "delocalized.", "turn_off.position"))}
    assert not left & {"turn_off.reflector_measured", "turn_off.lateral_mm", "turn_off.switch_position_mm"}
    assert not left & {"travel_direction.balise_read", "travel_direction.backwards", "reflector.route_contradicted"}
    assert not left & {"travel_direction.passed_model", "travel_direction.ahead_model", "met.turned"}
    assert not {name for name in left if name.startswith(("radar.", "met."))}
    assert {"travel_direction.model_before", "travel_direction.model_after", "travel_direction.route_direction"} <= left
    assert not {name for name in left if name.startswith("stop_point.") and ("position" in name or "margin" in name)} - {
        "stop_point.stop_1_position_mm", "stop_point.stop_1_position_mm.present", "stop_point.stop_2_position_mm",
        "stop_point.stop_2_position_mm.present", "stop_point.reposition_permitted",
    }  # fmt: skip
    assert {"balise.telegram_group", "line.next_position_mm", "frame_present", "echo_1_range_mm"} <= left


_OF_GROUPS = "balise: the interval holds the truth"
_OF_REFLECTORS = "reflector: a dead-reckoned interval holds the truth"
_OF_THE_HOST = "delocalized: a passed position holds the truth"


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("owner", "lemmas"),
    [
        ("reflector", (_OF_GROUPS,)),
        ("delocalized", (_OF_REFLECTORS,)),
        ("stop_point", (_OF_REFLECTORS, _OF_THE_HOST)),
    ],
)
def test_each_contract_follows_from_the_machines_before(owner: str, lemmas: tuple[str, ...]) -> None:
    """And not without their containment."""
    assert DEVICE.owes(owner, *lemmas)


# ------------------------------------------------------------------ wires exchanged on purpose


def _raw_telegram(whole: ReflectorDevice, _: Wires) -> Wires:
    """Whatever the antenna read is a reading, with the balise machine's interval."""
    given, read = whole.source.own.balise, whole.groups.own.read
    return {given.identity.present: read.group.present, given.identity.value: read.group.value}


def _raw_place(whole: ReflectorDevice, _: Wires) -> Wires:
    """The place in the telegram in place of the balise machine's position."""
    return {whole.source.own.balise.position.value: ite(_counts(whole), whole.groups.own.read.place.value, 0)}


def _place_of_the_group(whole: ReflectorDevice, _: Wires) -> Wires:
    """The group's place on the map, without the antenna's offset and the run since."""
    return {whole.source.own.balise.position.value: ite(_counts(whole), whole.groups.own.memory.last_group_position, 0)}


def _any_identity(whole: ReflectorDevice, _: Wires) -> Wires:
    """Each group with the first identity that there is."""
    given = whole.source.own.balise.identity
    return {given.value: as_num(given.value.low, given.value.unit)}


def _one_margin(whole: ReflectorDevice, _: Wires) -> Wires:
    _, below, _ = wired_interval(whole.groups.machine)
    return {whole.source.own.balise.accuracy.value: ite(_counts(whole), below, 0)}


def _untimed(whole: ReflectorDevice, _: Wires) -> Wires:
    return {whole.source.own.balise.since.present: FALSE}


def _offset_dropped(whole: ReflectorDevice, right: Wires) -> Wires:
    """The telegram's distance as it stands, although it counts from the group."""
    given = whole.source.own.balise.reference
    return {given.value: ite(flag(right[given.present]), whole.groups.own.read.reflector.value, 0)}


def _sign_turned(whole: ReflectorDevice, right: Wires) -> Wires:
    position, _, _ = wired_interval(whole.groups.machine)
    told, given = whole.groups.machine.output("reflector_mm"), whole.source.own.balise.reference
    return {given.value: ite(flag(right[given.present]) & (position > told), position - told, 0)}


def _search_for_reflector(whole: ReflectorDevice, right: Wires) -> Wires:
    given = whole.source.own.balise
    return {
        given.reference.present: right[given.search_from.present],
        given.reference.value: right[given.search_from.value],
    }


def _map_from_the_group(whole: ReflectorDevice, right: Wires) -> Wires:
    given = whole.source.own.ahead.reference
    return {given.value: ite(flag(right[given.present]), whole.line.reference.value, 0)}


def _groups_may_contradict(whole: ReflectorDevice, _: Wires) -> Wires:
    return {whole.source.own.contradicted: whole.direction.machine.flag("contradicts")}


def _host_margins_exchanged(whole: ReflectorDevice, right: Wires) -> Wires:
    machine = whole.restrictive
    above, below = input_of(machine, "source_margin_above_mm"), input_of(machine, "source_margin_below_mm")
    return {above: right[below], below: right[above]}


def _stop_margins_exchanged(whole: ReflectorDevice, right: Wires) -> Wires:
    own = whole.stop.own
    return {own.above: right[own.below], own.below: right[own.above]}


def _stop_without_a_position(whole: ReflectorDevice, _: Wires) -> Wires:
    return {whole.stop.own.valid: TRUE}


def _balise_position_for_the_host(whole: ReflectorDevice, _: Wires) -> Wires:
    """The host gets the balise machine's position with the reflector machine's margins."""
    position, _, _ = wired_interval(whole.groups.machine)
    return {input_of(whole.restrictive, "source_position_mm"): position}


def _any_image(whole: ReflectorDevice, _: Wires) -> Wires:
    """The image of whatever reflector is measured."""
    return {whole.course.own.measured: whole.source.machine.flag("precise")}


def _switch_given_late(whole: ReflectorDevice, _: Wires) -> Wires:
    """A switch that the interval may have reached."""
    given, raw = whole.course.own.switch_position, whole.switch.position
    return {given.present: raw.present, given.value: raw.value}


def _one_end(whole: ReflectorDevice, right: Wires) -> Wires:
    """The near end of the interval for both."""
    return {whole.course.own.high: right[whole.course.own.low]}


def _stop_by_the_balise(whole: ReflectorDevice, right: Wires) -> Wires:
    """The stop is made by the balise machine's interval, which holds the front end as well, and measures nothing."""
    own, groups = whole.stop.own, whole.groups.machine
    position, below, above = wired_interval(groups)
    valid = flag(right[own.valid]) & groups.flag("valid")
    return {own.valid: valid, own.position: position, own.below: below, own.above: above}


def _always_measured(whole: ReflectorDevice, right: Wires) -> Wires:
    """Whatever the host gets is taken for measured."""
    return {whole.stop.own.precise: right[whole.stop.own.valid]}


def _balise_for_the_host(whole: ReflectorDevice, right: Wires) -> Wires:
    """The host gets the balise machine's whole interval: no reflector ever counts."""
    machine, (position, below, above) = whole.restrictive, wired_interval(whole.groups.machine)
    valid, cause = input_of(machine, "source_valid"), whole.groups.machine.output("reason")
    sides = {input_of(machine, "source_margin_below_mm"): below, input_of(machine, "source_margin_above_mm"): above}
    stated = flag(right[valid]) & whole.groups.machine.flag("valid")
    return {
        valid: stated,
        input_of(machine, "source_position_mm"): position,
        **sides,
        input_of(machine, "source_reason"): cause,
    }


def _measured_only(whole: ReflectorDevice, right: Wires) -> Wires:
    """The host gets a position only while a reflector is measured, and none in the odometry zone."""
    valid = input_of(whole.restrictive, "source_valid")
    return {valid: flag(right[valid]) & whole.source.machine.flag("precise")}


def _telegram_unused(whole: ReflectorDevice, _: Wires) -> Wires:
    """No telegram's distance reaches the reflector machine."""
    given = whole.source.own.balise.reference
    return {given.present: FALSE, given.value: as_num(0, MM)}


def _map_unused(whole: ReflectorDevice, _: Wires) -> Wires:
    """The map's distance never reaches the reflector machine."""
    given = whole.source.own.ahead.reference
    return {given.present: FALSE, given.value: as_num(0, MM)}


def _nothing_sought(whole: ReflectorDevice, _: Wires) -> Wires:
    """The map's next reflector never reaches the reflector machine."""
    given = whole.source.own.ahead.position
    return {given.present: FALSE, given.value: as_num(0, MM)}


WRONG: Mapping[str, tuple[Wrong, str]] = {
    "a raw telegram anchors": (_raw_telegram, "a rejected telegram is no reading"),
    "the telegram's place": (_raw_place, "contract of reflector"),
    "the group's place": (_place_of_the_group, "an accepted group is handed over"),
    "a group with another identity": (_any_identity, "an accepted group is handed over"),
    "one margin for both": (_one_margin, "contract of reflector"),
    "a reading without its time": (_untimed, "an accepted group is handed over"),
    "the telegram's distance from the group": (_offset_dropped, "contract of reflector"),
    "the sign turned": (_sign_turned, "the telegram's reflector distance is used"),
    "search and reflector exchanged": (_search_for_reflector, "the telegram's reflector distance is used"),
    "the map's distance from the group": (_map_from_the_group, "contract of reflector"),
    "groups may contradict": (_groups_may_contradict, "groups that contradict withdraw the position"),
    "the image of any reflector": (_any_image, "only the reflector behind the switch shows the course"),
    "a switch given late": (_switch_given_late, "contract of turn_off"),
    "one end of the interval for both": (_one_end, "the course is judged by the reported interval"),
    "another course is passed on": (whatever_is_reported, "a course that is not permitted withdraws the position"),
    "the host's margins exchanged": (_host_margins_exchanged, "contract of delocalized"),
    "the balise's position for the host": (_balise_position_for_the_host, "contract of delocalized"),
    "the stop's margins exchanged": (_stop_margins_exchanged, "contract of stop_point"),
    "a stop without a position": (_stop_without_a_position, "without a position nothing moves"),
    "a stop by the balise's interval": (_stop_by_the_balise, "the stop is made by the interval that the host gets"),
    "every position measured": (_always_measured, "a stop is measured only while a reflector is"),
    "the balise's interval for the host": (_balise_for_the_host, "the host gets the reflector machine's interval"),
    "no position by odometer for the host": (_measured_only, "the host gets every position that is reported"),
    "the telegram's distance unused": (_telegram_unused, "the telegram's reflector distance is used"),
    "the map's distance unused": (_map_unused, "the map's distance is used"),
    "no reflector sought": (_nothing_sought, "the map's next reflector is searched"),
}
"""Wires exchanged on purpose, and what is no longer proved: a contract, or a claim of the whole."""


def _counts(whole: ReflectorDevice) -> Bool:
    return whole.groups.machine.flag("reference_accepted")


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("name", WRONG)
def test_a_wrong_wire_is_not_proved(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each is refused by the contract or the claim that is named, which the right wires keep."""
    assert DEVICE.loses(*WRONG[name], monkeypatch)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("claim", sorted({claim for _, claim in WRONG.values()}))
def test_the_right_wires_keep_it(claim: str) -> None:
    """So that a refusal is due to the wire."""
    assert DEVICE.keeps(claim)


# ------------------------------------------------------------------ recordings


RUNS = Runs("reflector_device")
recorded, fired = RUNS.recorded, RUNS.fired


@pytest.mark.thorough
@pytest.mark.parametrize("name", SCENES)
def test_every_interval_holds_the_truth(name: str) -> None:
    """The recording obeys every law to its end, and the front end lies in each interval that the host gets."""
    assert RUNS.located(name) > 50


@pytest.mark.thorough
def test_along_the_line_groups_anchor_and_reflectors_are_measured() -> None:
    """A passes the self-test at the group whose telegram tells of it, B is found by itself, and the position comes back by groups alone."""
    assert len(fired("line", "reflector", "self-test passed at the balise")) == 1
    [test] = fired("line", "reflector", "self-test passed at the balise")
    assert test in fired("line", "balise", "expected group resets the position")
    [found] = fired("line", "reflector", "reflector found")
    [lost] = fired("line", "delocalized", "position lost")
    first, again = fired("line", "delocalized", "reference accepted")
    assert first < test < found < lost < again
    assert [first, again] == fired("line", "balise", "group confirms the candidate")
    assert fired("line", "reflector", "reference measurement begins") > [again]


@pytest.mark.thorough
def test_a_rejected_telegram_anchors_nothing() -> None:
    """The same line with one corrupted telegram: the balise machine rejects it, and the radar measures nothing up to the next groups."""
    right = fired("line", "reflector", "self-test passed at the balise")
    assert right == fired("rejected", "balise", "telegram rejected")
    assert not fired("rejected", "reflector", "self-test passed at the balise", "reflector found", "reflector tracked")
    assert all(one.outputs["reflector.source"] != 2 for one in recorded("rejected").steps)
    [lost] = fired("rejected", "delocalized", "position lost")
    assert right[0] < lost < fired("line", "delocalized", "position lost")[0]
    assert fired("rejected", "delocalized", "reference accepted") == fired("line", "delocalized", "reference accepted")


@pytest.mark.thorough
def test_a_stop_is_made_on_the_measured_distance() -> None:
    """Over the window, back into it, and in place; the brake order came before that."""
    orders = ("brakes", "overruns", "repositions", "backs into the window", "stops in place", "departs")
    cycles = [fired("stop", "stop_point", one)[0] for one in orders]
    assert cycles == sorted(cycles)
    assert recorded("stop").steps[cycles[-2]].outputs["stop_point.in_position"]


@pytest.mark.thorough
def test_another_course_than_permitted_ends_the_report() -> None:
    """The image turns, and in that cycle the host gets nothing, although the reflector is measured."""
    [turns] = fired("astray", "turn_off", "turns left")
    assert [turns] == fired("astray", "delocalized", "position lost")
    assert recorded("astray").steps[turns].outputs["reflector.precise"]
    assert not [at for at in fired("astray", "delocalized", "reference accepted") if at > turns]


@pytest.mark.thorough
def test_recordings_are_what_the_simulation_writes(tmp_path: Path) -> None:
    """To the byte."""
    assert RUNS.are_written(write, tmp_path)


# ------------------------------------------------------------------ configuration


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        (
            {"motion": MotionConfig(period_ms=200)},
            r"balise\.period_ms is 100, but the vehicle's is 200 \(motion\); make them the same",
        ),
        (
            {"reflector": ReflectorConfig()},
            r"reflector\.last_balise_identity 1000000 is below balise\.last_group_identity 16777216",
        ),
        (
            {"balise": BaliseConfig(tolerance_mm=100_001)},
            r"balise\.tolerance_mm 100001 is above 100000, the widest reading",
        ),
        (
            {"reflector": ReflectorConfig(last_balise_identity=16_777_216, reference_distance_mm=60_000)},
            r"reflector\.reference_distance_mm must be 0: it counts from the balise",
        ),
        (
            {"turn_off": TurnOffConfig(position_limit_mm=5_000)},
            r"turn_off\.position_limit_mm is 5000, but the vehicle's is 1000000000 \(motion, reflector\); make them the same",
        ),
        (
            {"stop": StopPointConfig(tolerance_mm=20_000)},
            r"stop\.tolerance_mm is 20000, but the vehicle's is 30000 \(motion, reflector\)",
        ),
    ],
)
def test_figures_that_do_not_fit_are_refused(changed: dict[str, object], message: str) -> None:
    """One vehicle has one cycle and one line, and each accepted group has to be a reading; the message says what to do."""
    with pytest.raises(ValidationError, match=message):
        ReflectorDeviceConfig(**changed)  # type: ignore[arg-type]


def test_the_host_has_the_reflector_machines_limits() -> None:
    """So no position of it is lost on the way, and figures at their limits are taken."""
    assert DelocalizedConfig(tolerance_mm=30_000) == ReflectorDeviceConfig().host
    ReflectorDeviceConfig(balise=BaliseConfig(tolerance_mm=100_000))
