"""The route in the reflector device: a lost route ends the position, wrong wires are not proved, the recordings say what they teach."""

from __future__ import annotations

from collections.abc import Mapping

import pytest
from pydantic import ValidationError

from safeloc.language.expr import FALSE, TRUE, Bool, any_of, as_num, between, ite, minimum
from safeloc.language.spec import earlier_bool
from safeloc.language.units import MM, NM, NM_PER_MM
from safeloc.models import reflector_device
from safeloc.models.reflector_device import ReflectorDevice, ReflectorDeviceConfig, compose_machines
from safeloc.models.reflector_device.simulate import SCENES
from safeloc.models.route.variables import CONTRADICTION, RouteConfig
from safeloc.models.turn_off import LEFT, UNDECIDED
from safeloc.models.vocabulary.absent import wired_interval
from safeloc.models.vocabulary.reasons import CONTRADICTION as CONTRADICTED
from safeloc.models.vocabulary.reflectors import NO_MODEL
from safeloc.properties.reflector_device import properties
from tests.models.anchored_wires import balise_for_the_host, whatever_is_reported
from tests.models.composed_devices import Runs, Wiring, Wrong, flag, input_of
from tests.models.owed_contracts import Wires

DEVICE = Wiring(reflector_device, properties)


# ------------------------------------------------------------------ contracts


def test_no_input_of_the_route_comes_from_a_machine() -> None:
    """Start, sighting, course and odometer are given by machines of the device; routes and their reflectors by the map."""
    left = {var.name for var in compose_machines().composition.system.inputs}
    given = ("route.sighting", "route.start_error", "route.course_taken", "route.odometer", "route.start_truth")
    assert not {name for name in left if name.startswith(given)}
    assert not left & {"line.route_contradicted", "reflector.route_contradicted", "route.route_1_candidate"}
    assert {
        "starts.routes_ahead",
        "starts.route_1_candidate",
        "route.route_1_reflector_mm",
        "route.authorised_route",
    } <= left


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("owner", "lemma"),
    [
        ("route", "balise: the interval holds the truth"),
    ],
)
def test_each_contract_follows_from_the_machines_before(owner: str, lemma: str) -> None:
    """And not without their containment."""
    assert DEVICE.owes(owner, lemma)


# ------------------------------------------------------------------ wires exchanged on purpose


def _late(whole: ReflectorDevice, against: Bool) -> Wires:
    """What contradicts the reflector machine: direction and groups at once, and this of a position that it had before."""
    at_once = [whole.direction.machine.flag("contradicts"), whole.groups.machine.output("reason").eq(CONTRADICTED)]
    return {
        whole.source.own.contradicted: any_of([*at_once, earlier_bool(whole.source.machine.flag("valid") & against)])
    }


def _refuted(whole: ReflectorDevice) -> Bool:
    return whole.course.machine.flag("contradicts") | whole.route.machine.flag("refutes_authority")


def _lost(whole: ReflectorDevice) -> Bool:
    *_, lost = whole.route.machine.modes
    return whole.route.machine.mode.eq(lost)


def _loss_unheard(whole: ReflectorDevice, _: Wires) -> Wires:
    """Only the movement authority's route and course withdraw the position."""
    return _late(whole, _refuted(whole))


def _only_contradictions(whole: ReflectorDevice, _: Wires) -> Wires:
    """A route that is lost for its width, or for the odometer, keeps the position."""
    return _late(whole, _refuted(whole) | (_lost(whole) & whole.route.own.reason.eq(CONTRADICTION)))


def _authority_unheard(whole: ReflectorDevice, _: Wires) -> Wires:
    return _late(whole, _lost(whole) | whole.course.machine.flag("contradicts"))


def _course_unheard_by_reflectors(whole: ReflectorDevice, _: Wires) -> Wires:
    return _late(whole, _lost(whole) | whole.route.machine.flag("refutes_authority"))


def _undecided_contradicts(whole: ReflectorDevice, _: Wires) -> Wires:
    """Every switch behind which the branch is open costs the position."""
    _, undecided, *_ = whole.route.machine.modes
    return _late(whole, _refuted(whole) | _lost(whole) | whole.route.machine.mode.eq(undecided))


def _every_start_contradicts(whole: ReflectorDevice, right: Wires) -> Wires:
    """A route that was lost before the step counts against the position that begins with the next route."""
    heard = whole.source.own.contradicted
    return {heard: flag(right[heard]) | earlier_bool(_lost(whole))}


def _loss_for_the_reflectors_alone(whole: ReflectorDevice, _: Wires) -> Wires:
    """The host keeps its position for the cycle in which the reflector machine does not know of the loss."""
    valid = input_of(whole.restrictive, "source_valid")
    return {valid: whole.source.machine.flag("valid") & ~_refuted(whole)}


def _no_reason(whole: ReflectorDevice, _: Wires) -> Wires:
    """Without a branch the host is told the reason of the reflector machine, which only says that it was contradicted."""
    return {input_of(whole.restrictive, "source_reason"): CONTRADICTED}


def _raw_telegram(whole: ReflectorDevice, _: Wires) -> Wires:
    """Routes begin at whatever group the antenna read."""
    return {whole.route.own.start_error.present: whole.groups.own.read.group.present & whole.starts.place.present}


def _nearer_end(whole: ReflectorDevice, right: Wires) -> Wires:
    """The error at a start is the distance to the nearer end of the interval."""
    begun, place = flag(right[whole.route.own.start_error.present]), whole.starts.place.value
    position, below, above = wired_interval(whole.groups.machine)
    nearer = minimum(position + above - place, place - (position - below))
    return {whole.route.own.start_error.value: ite(begun & (nearer >= 0), nearer, 0)}


def _only_margins(whole: ReflectorDevice, right: Wires) -> Wires:
    """The error at a start is the balise machine's margin, as if the vehicle stood over the start."""
    begun, (_, below, above) = flag(right[whole.route.own.start_error.present]), wired_interval(whole.groups.machine)
    return {whole.route.own.start_error.value: ite(begun, ite(below > above, below, above), 0)}


def _at_the_start(whole: ReflectorDevice, _: Wires) -> Wires:
    """Distances are counted from where the vehicle is, not from the start's place."""
    return {whole.route.own.ghosts.start_truth: as_num(0, NM)}


def _however_many(whole: ReflectorDevice, _: Wires) -> Wires:
    """Of more routes than are carried those that have a number are carried."""
    return {one.candidate: mapped for one, mapped in zip(whole.route.own.routes, whole.starts.candidates, strict=True)}


def _course_unheard(whole: ReflectorDevice, _: Wires) -> Wires:
    return {whole.route.own.course_taken: UNDECIDED}


def _always_left(whole: ReflectorDevice, _: Wires) -> Wires:
    return {whole.route.own.course_taken: LEFT}


def _weak_echoes(whole: ReflectorDevice, _: Wires) -> Wires:
    """An echo that shows a model is a sighting, however weak it is."""
    shown = any_of(one.range.present & one.model.ne(NO_MODEL) for one in whole.radar.echoes)
    return {whole.route.own.sighting_range.present: whole.radar.sighted | shown}


def _error_of_the_echo(whole: ReflectorDevice, _: Wires) -> Wires:
    """Without the radar's systematic error, its latency and the survey."""
    alone = whole.radar.error - whole.config.sighting_error_mm
    return {whole.route.own.sighting_error: ite(whole.radar.sighted, alone, 0)}


def _nothing_sighted(whole: ReflectorDevice, _: Wires) -> Wires:
    own = whole.route.own
    return {own.sighting_range.present: FALSE, own.sighting_range.value: as_num(0, MM), own.sighting_model: NO_MODEL}


def _all_by_own_track(whole: ReflectorDevice, _: Wires) -> Wires:
    """Every sighting is taken for one of the own track's reflector, wherever it stands."""
    return {whole.route.own.sighting_by_own_track: TRUE}


def _none_by_own_track(whole: ReflectorDevice, _: Wires) -> Wires:
    """The lateral place of no image is asked, so that a branch with others in view is never given up."""
    return {whole.route.own.sighting_by_own_track: FALSE}


def _far_by_own_track(whole: ReflectorDevice, right: Wires) -> Wires:
    """The side alone tells, from any range."""
    figures, slots = whole.config, whole.radar.echoes
    aside = any_of(between(figures.own_track_right_mm, one.lateral, figures.own_track_left_mm) for one in slots)
    own = whole.route.own.sighting_by_own_track
    return {own: flag(right[own]) | (whole.radar.sighted & aside)}


_LOST, _START = "a lost route withdraws the position", "a route begins at every accepted group that is a start"
_SIGHTING = "a sighting is an echo that the reflector machine hears"
_NOTHING_ELSE = "direction, route and groups contradict, and nothing else"
WRONG: Mapping[str, tuple[Wrong, str]] = {
    "a lost route unheard": (_loss_unheard, _LOST),
    "only contradictions withdraw": (_only_contradictions, _LOST),
    "a lost route unheard by the host": (_loss_for_the_reflectors_alone, _LOST),
    "every start contradicts": (_every_start_contradicts, _NOTHING_ELSE),
    "a refuted authority unheard": (_authority_unheard, "a refuted authority withdraws the position"),
    "a course unheard by the reflectors": (_course_unheard_by_reflectors, "a refuted authority withdraws the position"),
    "an undecided switch contradicts": (_undecided_contradicts, _NOTHING_ELSE),
    "a position without a route": (whatever_is_reported, "no position without a branch"),
    "one reason for all": (_no_reason, "the host is told why no branch is carried"),
    "a raw telegram begins a route": (_raw_telegram, _START),
    "the nearer end of the interval": (_nearer_end, "contract of route"),
    "margins without the distance from the start": (_only_margins, "contract of route"),
    "distances from where the vehicle is": (_at_the_start, "a start holds the front end"),
    "more routes than are carried": (_however_many, "more branches than are carried are no position"),
    "the turn unheard": (_course_unheard, "the route hears the course at a switch"),
    "every turn to the left": (_always_left, "contract of route"),
    "weak echoes are sightings": (_weak_echoes, _SIGHTING),
    "the echo's error alone": (_error_of_the_echo, _SIGHTING),
    "nothing is sighted": (_nothing_sighted, _SIGHTING),
    "every sighting by the own track": (_all_by_own_track, "another track's reflector in view leaves the branch"),
    "no sighting by the own track": (_none_by_own_track, _SIGHTING),
    "far sightings by the own track": (_far_by_own_track, "another track's reflector in view leaves the branch"),
    "the balise's interval for the host": (balise_for_the_host, "no position without a branch"),
}
"""Wires exchanged on purpose, and what is no longer proved: a contract, or a claim of the whole."""


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


def told(name: str) -> list[int]:
    """In each cycle of a recording the route that is told, 0 for none."""
    return [int(one.outputs["route.route"]) for one in recorded(name).steps]


def restrictive(name: str) -> list[bool]:
    """In each cycle of a recording whether the host gets no position."""
    return [bool(one.outputs["delocalized.restrictive"]) for one in recorded(name).steps]


@pytest.mark.thorough
@pytest.mark.parametrize("name", SCENES)
def test_every_branch_that_is_told_is_true(name: str) -> None:
    """And each recording tells one."""
    true = [int(one.state["route.true_route"]) for one in recorded(name).steps]
    assert any(told(name))
    assert all(number in (0, branch) for number, branch in zip(told(name), true, strict=True))


@pytest.mark.thorough
def test_a_turn_that_is_seen_decides() -> None:
    """The sighting of a reflector that both branches have does not; the host keeps its position throughout."""
    [begun], [turned] = (
        fired("turn-off", "route", "start on several routes"),
        fired("turn-off", "turn_off", "turns left"),
    )
    assert [turned] == fired("turn-off", "route", "one route is left")
    assert [0] * turned == told("turn-off")[:turned]
    assert {2} == set(told("turn-off")[turned:])
    assert [begun] == fired("turn-off", "delocalized", "reference accepted")
    assert not any(restrictive("turn-off")[begun:])


@pytest.mark.thorough
def test_an_undecided_switch_leaves_both_branches() -> None:
    """They are carried over the switch and far behind it, with a position, until a reflector is sighted that one of them lacks."""
    [begun], [decided] = (fired("undecided", "route", one) for one in ("start on several routes", "one route is left"))
    steps = recorded("undecided").steps[begun:decided]
    assert all(one.outputs["route.route_1_possible"] and one.outputs["route.route_2_possible"] for one in steps)
    assert any(int(one.state["truth_nm"]) > 500_000 * NM_PER_MM for one in steps)
    assert not any(restrictive("undecided")[begun:])
    assert {2} == set(told("undecided")[decided:])


@pytest.mark.thorough
def test_a_lost_route_ends_the_position_in_its_cycle() -> None:
    """At the host, and in the next cycle at the reflector machine; up to the group at which routes begin again."""
    [lost], [begun] = fired("lost", "route", "no route fits"), fired("lost", "route", "start on one route")
    assert lost < begun
    assert [lost + 1] == fired("lost", "reflector", "route contradicted")
    assert [lost] == fired("lost", "delocalized", "position lost")
    gone = recorded("lost").steps[lost:begun]
    assert all(one.outputs["delocalized.restrictive"] for one in gone)
    assert [True, *[False] * (len(gone) - 1)] == [one.outputs["reflector.valid"] for one in gone]
    assert begun in fired("lost", "delocalized", "reference accepted")
    assert not any(restrictive("lost")[begun:])
    assert {3} == set(told("lost")[begun:])


# ------------------------------------------------------------------ configuration


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"route": RouteConfig()}, r"route\.routes is 5: no more than 4 are carried; lower it"),
        (
            {"own_track_right_mm": 0},
            r"own_track_right_mm 0 is to the left of own_track_left_mm -1000: no image would stand by the own track; exchange them",
        ),
        (
            {"route": RouteConfig(routes=4, range_limit_mm=200_000)},
            r"route\.range_limit_mm 200000 is below reflector\.range_limit_mm 300000",
        ),
        (
            {"route": RouteConfig(routes=2, period_ms=50)},
            r"route\.period_ms is 50, but the vehicle's is 100 \(motion, reflector\); make them the same",
        ),
        (
            {"route": RouteConfig(routes=2, checked_distance=True)},
            r"route\.checked_distance is True, but the vehicle's is False",
        ),
    ],
)
def test_figures_that_do_not_fit_are_refused(changed: dict[str, object], message: str) -> None:
    """One vehicle has one cycle and one line, and no more than four routes are carried; the message says what to do."""
    with pytest.raises(ValidationError, match=message):
        ReflectorDeviceConfig(**changed)  # type: ignore[arg-type]
