"""Vehicles on audited lines: what the simulations are told of a route, and what the machines make of the runs."""

from __future__ import annotations

import pytest

from safeloc.errors import InputError
from safeloc.models.layout_rules.marker_readers import MarkerReaders
from safeloc.models.line_runs.configs import LineVehicle
from safeloc.models.line_runs.drive import Journey, streams
from safeloc.models.line_runs.faults import FAULTS, MACHINES, parse
from safeloc.models.line_runs.ways import (
    accuracies,
    groups,
    identities,
    limits,
    markers,
    platforms,
    reflector_route,
    reflectors,
    stop_places,
    switches_ahead,
)
from safeloc.models.stop_point.simulate import StopPlace
from safeloc.railway.audit.vehicle import SHIPPED, find_layout
from safeloc.railway.map.elements import SpeedLimit
from safeloc.railway.map.routes import Route, through_routes
from safeloc.railway.map.topology import Run, Topology
from safeloc.railway.map.walk import Walk
from safeloc.simulation.speed_profile import Limit
from safeloc.simulation.vehicles import load_vehicle
from tests.models.line_runs import (
    EXACT,
    Said,
    between,
    broken,
    driven,
    first,
    kept_all_the_way,
    routes_of,
    said,
    walk_of,
)
from tests.railway.map.made import group, reflector, straight

# ------------------------------------------------------------------ what is told of a route


def seen(route: Route, walk: Walk) -> list[tuple[int, str, int | None]]:
    """Place, model and clearance of the reflectors of a route."""
    told = reflector_route(route, walk, antenna_mm=0, national_mm=12_000, detection_mm=1_000)
    return [(one.position_mm, one.model, one.clear_mm) for one in told.reflectors]


def test_a_group_is_told_with_its_place_along_the_route_and_its_telegram() -> None:
    """Group 106 of Fig. 1, 300 m into the line and 100 m into a route that begins there; its telegram names 80 m."""
    route = between(walk_of("fig1").line, "103", 300_000, 600_000)
    (told,) = groups(route)
    assert (106, 100_000, 2, "NOMINAL", 300) == (
        told.identity, told.place_mm, told.balises, told.orientation, told.accuracy_mm,
    )  # fmt: skip
    assert (80_000, 0, True) == (told.reflector_mm, told.search_mm, told.linked)
    assert [(106, 100_000)] == markers(route, MarkerReaders())


def test_against_the_edge_places_and_orientations_turn_round() -> None:
    """Run from the far end, the group's first balise lies where its place is from there, passed in reverse."""
    line = straight(500_000, travel="both", balise_groups=(group(7, "e0", 100_000, 103_000), group(8, "e0", 300_000)))
    back = Route(Topology(line), (Run("e0", "decreasing"),), 0, 500_000)
    single, pair = groups(back)
    assert (200_000, 1) == (single.place_mm, single.balises)
    assert (400_000, "REVERSE", None) == (pair.place_mm, pair.orientation, pair.reflector_mm)


def test_a_marker_is_read_within_location_and_detection_accuracy() -> None:
    """The group's own accuracy where it has one, else the national value; and the detection accuracy on top."""
    own, without = group(1, "e0", 50_000), group(2, "e0", 90_000, location_accuracy_mm=None)
    line = straight(200_000, balise_groups=(own, without))
    (route,) = through_routes(Topology(line), 2)
    assert {1: 1_300, 2: 13_000} == accuracies(route, 12_000, 1_000, MarkerReaders())


@pytest.mark.parametrize(("numbers", "expected"), [((5, 9), [5, 9]), ((5, 5), [1, 2]), ((0, 5), [1, 2])])
def test_numbers_on_board(numbers: tuple[int, int], expected: list[int]) -> None:
    """NID_BG, unless two countries use one number, or a group has the number that on board says `none`."""
    first, second = (
        group(number, "e0", place, country=country).model_copy(update={"id": f"g{country}"})
        for number, place, country in zip(numbers, (10_000, 50_000), (1, 2), strict=True)
    )
    line = straight(100_000, balise_groups=(first, second))
    assert expected == list(identities(line).values())


def test_reflectors_are_told_with_what_else_looks_like_them() -> None:
    """Clearance counts reflectors beside other tracks too: of Fig. 3, D 312 and D 315 stand 150 m apart by kilometre."""
    adab = seen(routes_of("fig3")["ADAB"], walk_of("fig3"))
    assert [(160_000, "A"), (360_000, "D"), (560_000, "A"), (860_000, "B")] == [(at, model) for at, model, _ in adab]
    assert 150_000 == adab[1][2]


def test_reflectors_of_other_branches_are_seen_too() -> None:
    """On ADAB the radar also sees C 317 behind switch 302, C 316 and D 318 behind 304 and 306, where they would stand."""
    told = reflector_route(
        routes_of("fig3")["ADAB"], walk_of("fig3"), antenna_mm=0, national_mm=12_000, detection_mm=1_000
    )
    assert {(380_000, "C"), (540_000, "C"), (900_000, "D")} <= {(one.position_mm, one.model) for one in told.beside}
    own = {(one.position_mm, one.model) for one in told.reflectors}
    assert not own & {(one.position_mm, one.model) for one in told.beside}


def test_an_antenna_behind_the_front_reads_later() -> None:
    """The front end is the antenna's offset beyond the balise when it is read, and the telegram's search begins sooner."""
    line = walk_of("fig1").line
    told = reflector_route(
        between(line, "103", 300_000, 900_000), walk_of("fig1"), antenna_mm=3_000, national_mm=12_000, detection_mm=500
    )
    (balise,) = told.balises
    assert (103_000, 800, True, 0) == (
        balise.position_mm, balise.accuracy_mm, balise.reference, balise.search_from_mm,
    )  # fmt: skip


def test_models_that_no_machine_knows_are_refused() -> None:
    """A map may name any model; the machines tell A to H apart."""
    line = straight(300_000, reflectors=(reflector("R", "e0", 200_000, "Z9"),))
    (route,) = through_routes(Topology(line), 2)
    with pytest.raises(
        InputError, match=r"^reflector R: the machines know the models A, B, C, D, E, F, G, H, not Z9\.$"
    ):
        reflectors(route)


def test_the_platform_of_figure_2() -> None:
    """One platform with the stop points 207 and 210, and their windows."""
    (platform,) = platforms(routes_of("fig2")["CAB"])
    assert ["207", "210"] == [stop.id for _, stop in platform]
    assert (StopPlace(442_000, 450, 450), StopPlace(512_000, 450, 450)) == stop_places(platform)


COURSES = {
    "ADAB": ["STRAIGHT", "STRAIGHT", "STRAIGHT"],
    "ADAD": ["STRAIGHT", "STRAIGHT"],
    "ADCD": ["STRAIGHT", "RIGHT"],
    "ACD": ["RIGHT"],
    "DCD": [],
}


@pytest.mark.parametrize("models", COURSES)
def test_the_courses_of_figure_3(models: str) -> None:
    """The branch of the stem's track is straight on; switches that are run from a branch say nothing.

    Of ADAD, the reflector behind switch 306 comes into view only on the switch: there is nothing to note before it.
    """
    assert COURSES[models] == [one.course for one in switches_ahead(routes_of("fig3")[models])]


def test_speed_limits_run_along_the_route() -> None:
    """Of both directions, or of the route's own; from the far end they turn round."""
    told = (
        SpeedLimit(edge="e0", from_mm=10_000, to_mm=40_000, max_speed_mm_s=5_000),
        SpeedLimit(edge="e0", from_mm=0, to_mm=9_000, max_speed_mm_s=4_000, direction="increasing"),
    )
    line = straight(100_000, travel="both", speed_limits=told)
    back = Route(Topology(line), (Run("e0", "decreasing"),), 0, 100_000)
    assert [Limit(60_000, 90_000, 5_000)] == limits(back)


# ------------------------------------------------------------------ runs that keep the law


def vehicle(name: str) -> LineVehicle:
    """A shipped vehicle; the first group it reads is vouched for."""
    return LineVehicle(name, load_vehicle(SHIPPED / f"{name}.toml"), find_layout(name), trust_first=True)


@pytest.mark.thorough
@pytest.mark.parametrize("machine", ["odometry", "balise", "reflector"])
def test_every_property_holds_past_a_balise_and_its_reflector(machine: str) -> None:
    """Fig. 1 from 50 m before the balise to behind the first reflector: lawful, and all properties hold."""
    (stream,) = driven("fig1", machine, route=between(walk_of("fig1").line, "103", 350_000, 500_000))
    assert "contained" in said(stream).standing
    assert [] == broken(stream)


def test_coarse_groups_keep_the_law_too() -> None:
    """Groups that may lie 13 m from their place, far more than a cycle runs: lawful, and never wrong."""
    coarse = tuple(group(n, "e0", place, location_accuracy_mm=None) for n, place in ((1, 20_000), (2, 90_000)))
    line = straight(150_000, balise_groups=coarse)
    (route,) = through_routes(Topology(line), 2)
    (stream,) = streams(Journey(route, Walk(line), LineVehicle(trust_first=True), 5), "odometry")
    assert {"contained", "INVALID"} == set(said(stream).standing)
    assert [] == broken(stream)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(("line", "machine", "models"), [("fig2", "stop_point", ""), ("fig3", "turn_off", "ACD")])
def test_every_property_holds_at_the_platform_and_over_a_switch(line: str, machine: str, models: str) -> None:
    """A stop at Fig. 2 and a turn at Fig. 3: lawful, and all properties hold."""
    assert [] == broken(first(line, machine, models=models))


ALL = [(line, machine) for line in ("fig1", "fig2", "fig3") for machine in MACHINES]


@pytest.mark.slow
@pytest.mark.parametrize("who", ["", "desiro-br642", "freight-v90"])
@pytest.mark.parametrize(("line", "machine"), ALL, ids=[f"{line}-{machine}" for line, machine in ALL])
def test_every_property_holds_on_every_route_of_the_worked_figures(line: str, machine: str, who: str) -> None:
    """Whole routes, every machine, several vehicles: lawful in every step, all properties hold, no interval is wrong."""
    runner = vehicle(who) if who else LineVehicle(trust_first=True)
    for models in routes_of(line):
        for stream in driven(line, machine, models=models, vehicle=runner):
            assert [] == broken(stream)
            assert "WRONG" not in said(stream).standing


@pytest.mark.parametrize("models", COURSES)
def test_each_route_of_figure_3_is_recognised(models: str) -> None:
    """Among the five, the one that is run, and its interval holds the truth."""
    (stream,) = driven("fig3", "route", models=models)
    told = said(stream)
    assert {0, list(routes_of("fig3")).index(models) + 1} == told.every("route")
    assert {"contained", "INVALID"} == set(told.standing)


@pytest.mark.parametrize("models", [models for models, courses in COURSES.items() if courses])
def test_each_course_of_figure_3_is_seen(models: str) -> None:
    """At every switch in view, in order, the course that is taken."""
    (stream,) = driven("fig3", "turn_off", models=models)
    told = said(stream)
    decided = [str(one["course"]) for one in told.outputs if one["course"] != "UNDECIDED"]
    changes = [name for name in told.fired if name in ("turns left", "turns right", "runs straight on")]
    names = {"STRAIGHT": "runs straight on", "LEFT": "turns left", "RIGHT": "turns right"}
    assert [names[course] for course in COURSES[models]] == changes
    assert COURSES[models][-1] == decided[-1]
    assert not any(one["contradicts"] for one in told.outputs)


@pytest.mark.thorough
def test_both_stop_points_of_figure_2_are_met() -> None:
    """Each stop is made in its window, and left on the order to depart."""
    for stream in driven("fig2-fine", "stop_point", vehicle=EXACT):
        told = said(stream)
        assert told.fired[-1] == "departs"
        assert "STOPPED" in told.modes


def test_a_coarse_balise_confirms_no_precise_stop() -> None:
    """30 cm of the balise and 1 m of its detection: what the self-test leaves open is wider than the window."""
    assert "STOPPED" not in said(first("fig2", "stop_point")).modes


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("who", [path.stem for path in sorted(SHIPPED.glob("*.toml"))])
def test_shipped_vehicles_locate_precisely(who: str) -> None:
    """Each with its own law, antenna, radar and speed: at the reflectors of Fig. 2 precise, and never wrong."""
    (stream,) = driven("fig2", "reflector", vehicle=vehicle(who))
    told = said(stream)
    assert told.every("precise") == {False, True}
    assert set(told.standing) <= {"contained", "INVALID"}


def test_seeds_make_runs() -> None:
    """The same seed gives the same stream, another one another."""
    route = between(walk_of("fig1").line, "103", 350_000, 480_000)
    one, same, other = (first("fig1", "reflector", route=route, seed=seed).steps for seed in (1, 1, 2))
    assert one == same
    assert one != other


# ------------------------------------------------------------------ faults


def withheld_or_contained(told: Said) -> bool:
    """No interval misses the truth."""
    return "WRONG" not in told.standing


REJECTED = {
    "group-corrupted": "CORRUPTED",
    "group-incomplete": "INCOMPLETE",
    "group-reversed": "WRONG_DIRECTION",
    "group-early": "TOO_EARLY",
    "group-late": "TOO_LATE",
    "group-stale": "STALE",
    "group-malformed": "MALFORMED",
    "group-repeated": "REPEATED",
    "group-foreign": "NOT_ANNOUNCED",
}


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("fault", REJECTED)
def test_a_faulty_group_is_rejected_with_its_reason(fault: str) -> None:
    """Each in its own words; groups before and after it count."""
    (stream,) = driven("few", "balise", f"{fault}:g4", vehicle=LineVehicle())
    told = said(stream)
    assert withheld_or_contained(told)
    assert {"NONE", "CANDIDATE", "ACCEPTED", REJECTED[fault]} == told.every("telegram")


def test_a_missed_group_is_counted_with_its_linking_reaction() -> None:
    """Its window closes without it: one group missed in a row, service brake; the interval holds the truth."""
    told = said(first("few", "balise", "group-missed:g4", vehicle=LineVehicle()))
    assert withheld_or_contained(told)
    assert "expected group missed" in told.fired
    assert "SERVICE_BRAKE" in told.every("reaction")


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("fault", "reading"), [("group-missed", None), ("group-repeated", "REPEATED"), ("group-foreign", "FOREIGN")]
)
def test_faulty_readings_of_the_front_reader(fault: str, reading: str | None) -> None:
    """Missed: the rear end's reading counts; twice or foreign: rejected with its reason."""
    told = said(first("few", "odometry", f"{fault}:g4", vehicle=LineVehicle()))
    whole = said(first("few", "odometry", vehicle=LineVehicle()))
    assert withheld_or_contained(told)
    assert (told.fired.count("leading reading at front") < whole.fired.count("leading reading at front")) is (
        fault != "group-repeated"
    )
    assert reading is None or reading in told.every("front_reading")


@pytest.mark.parametrize(
    ("fault", "judged"),
    [("distance-missing", "MISSING"), ("distance-jump", "TOO_FAST"), ("wheel-slide", "JUMP"), ("wheel-slip", "JUMP"),
     ("wheel-stuck", "JUMP")],
)  # fmt: skip
def test_a_faulty_wheel_beside_a_radar(fault: str, judged: str) -> None:
    """The wheel's distances are refused, or added to the error; the interval goes on to hold the truth by the other unit."""
    told = said(first("few", "odometry", fault, vehicle=LineVehicle()))
    assert withheld_or_contained(told)
    assert judged in told.every("front_wheel_last_verdict")
    assert "contained" == told.standing[-1]


@pytest.mark.parametrize(
    ("fault", "judged", "reason"),
    [("distance-missing", "MISSING", {"NO_REFERENCE", "NONE", "TOLERANCE"}),
     ("distance-jump", "TOO_FAST", {"NO_REFERENCE", "NONE"})],
)  # fmt: skip
def test_the_balise_machines_odometer_fails(fault: str, judged: str, reason: set[str]) -> None:
    """Silent for long: nothing is reported; one impossible distance: refused and added to the error, and the report goes on."""
    told = said(first("few", "balise", fault, vehicle=LineVehicle()))
    assert withheld_or_contained(told)
    assert judged in told.every("odometer")
    assert reason == told.every("reason")


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize(
    ("fault", "fired", "precise_at_last"),
    [("group-missed", "wait for a balise", False), ("distance-missing", "odometer failed", False),
     ("distance-jump", "reflector found", True), ("frames-missing", "reflector not found", False),
     ("reflector-hidden", "reflector not found", False), ("echoes-weak", "reflector not found", False),
     ("echoes-shifted", "reflector lost", True), ("decoy", "reflector found", True),
     ("reflector-gone", "reflector not found", False)],
)  # fmt: skip
def test_faults_at_the_last_reflector(fault: str, fired: str, precise_at_last: bool) -> None:
    """Fig. 1: without its echo, reflector 111 is never a source of position, and nothing that is reported is wrong."""
    (stream,) = driven("fig1", "reflector", fault)
    told = said(stream)
    assert withheld_or_contained(told)
    assert fired in told.fired
    near = [one for one, step in zip(told.outputs, stream.steps, strict=True) if int(step["truth_mm"]) > 760_000]
    assert any(one["precise"] for one in near) is precise_at_last


def test_what_is_not_the_reflector_is_called_so() -> None:
    """A shifted echo lies out of the window; a decoy is of another model."""
    assert "OUT_OF_WINDOW" in said(first("fig1", "reflector", "echoes-shifted")).every("echo_1_last_verdict")
    decoy = said(first("fig1", "reflector", "decoy"))
    assert "OTHER_MODEL" in decoy.every("echo_1_last_verdict") | decoy.every("echo_2_last_verdict")


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("fault", "modes"),
    [("group-missed", {"IDLE"}), ("distance-missing", {"IDLE"}), ("frames-missing", {"IDLE", "APPROACH", "BRAKING"}),
     ("reflector-hidden", {"IDLE", "APPROACH", "BRAKING"}), ("echoes-weak", {"IDLE", "APPROACH", "BRAKING"}),
     ("reflector-gone", {"IDLE", "APPROACH", "BRAKING"}),
     ("distance-jump", {"IDLE", "APPROACH", "BRAKING", "STOPPED"}),
     ("stop-overrun", {"IDLE", "APPROACH", "BRAKING", "OVERRUN", "REPOSITIONING", "STOPPED"}),
     ("stop-short", {"IDLE", "APPROACH", "BRAKING", "SHORT", "CREEPING", "STOPPED"})],
)  # fmt: skip
def test_faults_on_the_way_to_a_stop(fault: str, modes: set[str]) -> None:
    """In place only on a measurement; beside the window it is backed or crept into at reduced speed."""
    told = said(first("fig2-fine", "stop_point", fault, vehicle=EXACT))
    assert modes == set(told.modes)


@pytest.mark.parametrize(
    ("fault", "decisions", "reason"),
    [("reflector-gone", {0}, "NONE"), ("model-misread:311", {0}, "CONTRADICTION"),
     ("distance-missing", {0}, "SENSOR_FAILURE"), ("distance-jump", {0, 1}, "NONE"), ("authority-wrong", {0, 1}, "NONE")],
)  # fmt: skip
def test_faults_on_the_way_to_recognition(fault: str, decisions: set[int], reason: str) -> None:
    """ADAB of Fig. 3: undecided, lost with a reason, or decided for the route that is run; never another one."""
    told = said(first("fig3", "route", fault, models=next(iter(routes_of("fig3")))))
    assert decisions == told.every("route")
    assert reason == told.outputs[-1]["reason"]
    assert withheld_or_contained(told)
    assert told.outputs[-1]["refutes_authority"] is (fault == "authority-wrong")


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize(
    ("fault", "seen_courses"),
    [("group-missed", 0), ("distance-missing", 1), ("frames-missing", 2), ("reflector-hidden", 2), ("echoes-weak", 2),
     ("reflector-gone", 2), ("distance-jump", 3), ("authority-wrong", 3)],
)  # fmt: skip
def test_faults_over_switches(fault: str, seen_courses: int) -> None:
    """ADAB of Fig. 3, three switches: where the reflector is not measured no course is stated, and never a wrong one."""
    told = said(first("fig3", "turn_off", fault, models="ADAB"))
    assert seen_courses == told.fired.count("runs straight on")
    assert told.every("course") <= {"UNDECIDED", "STRAIGHT"}
    assert any(one["contradicts"] for one in told.outputs) is (fault == "authority-wrong")


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("fault", ["distance-missing:60000-62000", "reflector-gone:109"])
def test_lawful_faults_keep_every_property(fault: str) -> None:
    """A fault that is called lawful breaks no assumption: here a silent odometer and a missed reflector."""
    route = between(walk_of("fig1").line, "103", 350_000, 500_000)
    (stream,) = driven("fig1", "reflector", fault, route=route)
    assert [] == broken(stream)


EACH = [(name, machine) for name, fault in FAULTS.items() for machine in fault.outcomes]
LAWFUL = [(name, machine) for name, machine in EACH if FAULTS[name].lawful_for(machine)]
UNLAWFUL = [(name, machine) for name, machine in EACH if not FAULTS[name].lawful_for(machine)]
HOMES = {"reflector": "fig1", "stop_point": "fig2", "route": "fig3", "turn_off": "fig3"}
"""The line on which a machine has to show its reaction; the others on "few"."""


@pytest.mark.slow
@pytest.mark.parametrize(("name", "machine"), LAWFUL, ids=[f"{name}-{machine}" for name, machine in LAWFUL])
def test_every_lawful_fault_keeps_every_property(name: str, machine: str) -> None:
    """Of every machine that has it: the assumption is kept in every step, and all properties hold."""
    for stream in driven(HOMES.get(machine, "few"), machine, name, vehicle=LineVehicle()):
        assert stream.struck
        assert [] == broken(stream)


@pytest.mark.slow
@pytest.mark.parametrize(("name", "machine"), UNLAWFUL, ids=[f"{name}-{machine}" for name, machine in UNLAWFUL])
def test_every_unlawful_fault_breaks_the_assumption(name: str, machine: str) -> None:
    """Of every machine of which the list says so: else properties should hold, and the list would excuse them."""
    streams = driven(HOMES.get(machine, "few"), machine, name, vehicle=LineVehicle())
    assert any(not kept_all_the_way(stream) for stream in streams)


def test_every_outcome_is_put_to_the_test() -> None:
    """Each fault of each machine occurs in a test above: none is only promised."""
    tested = {
        "balise": {*REJECTED, "group-missed", "distance-missing", "distance-jump"},
        "odometry": {name for name in FAULTS if "odometry" in FAULTS[name].outcomes},
        "reflector": {"group-missed", "distance-missing", "distance-jump", "frames-missing", "reflector-hidden",
                      "echoes-weak", "echoes-shifted", "decoy", "reflector-gone"},
        "stop_point": {"group-missed", "distance-missing", "frames-missing", "reflector-hidden", "echoes-weak",
                       "reflector-gone", "distance-jump", "stop-overrun", "stop-short"},
        "route": {"reflector-gone", "model-misread", "distance-missing", "distance-jump", "authority-wrong"},
        "turn_off": {"group-missed", "distance-missing", "frames-missing", "reflector-hidden", "echoes-weak",
                     "reflector-gone", "distance-jump", "authority-wrong"},
    }  # fmt: skip
    assert tested == {
        machine: {name for name, fault in FAULTS.items() if machine in fault.outcomes} for machine in MACHINES
    }


# ------------------------------------------------------------------ what is refused


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ("no-such", r"^no fault 'no-such'\. Faults \(NAME, or NAME:PLACE\):\n  group-missed: "),
        ("model-misread", r"^fault model-misread is for route, but the run is for balise\.$"),
    ],
)
def test_unknown_and_unfit_faults_are_refused(asked: str, message: str) -> None:
    """With what there is instead."""
    with pytest.raises(InputError, match=message):
        parse([asked], ["balise"])


@pytest.mark.parametrize("name", ["group-early", "group-late", "group-foreign"])
def test_a_group_that_may_be_displaced_is_not_vouched_for(name: str) -> None:
    """Both at once contradict each other."""
    with pytest.raises(InputError, match=f"^fault {name} and --trust-first contradict each other"):
        parse([name], ["balise"], trust_first=True)


@pytest.mark.parametrize(
    ("asked", "message"),
    [
        ("group-missed:nowhere", r"^fault group-missed:nowhere: the line has no such group; it has \['g1', "),
        ("distance-missing:5", r"^fault distance-missing:5: expected FROM-TO in mm along the route\.$"),
        ("distance-missing:9-5", r"^fault distance-missing: 9-5 is no stretch of a route of 1200000 mm\.$"),
    ],
)
def test_faults_off_the_line_are_refused(asked: str, message: str) -> None:
    """A place that is none would test nothing."""
    with pytest.raises(InputError, match=message):
        first("few", "balise", asked, vehicle=LineVehicle())


def test_a_machine_that_drives_on_no_line_is_refused() -> None:
    """With those that do."""
    journey = Journey(next(iter(routes_of("fig1").values())), walk_of("fig1"), LineVehicle(), 0)
    with pytest.raises(InputError, match=r"^no machine 'door' to drive on a line; there are odometry, balise, "):
        list(streams(journey, "door"))


def test_a_vehicle_that_no_machine_suits_is_refused() -> None:
    """A start error and a constant that the tolerance does not hold."""
    layout = find_layout("metro").model_copy(update={"odometry_constant_mm": 9_999})
    unfit = LineVehicle("coarse", LineVehicle().motion, layout)
    with pytest.raises(InputError, match=r"^vehicle coarse does not suit machine balise:  ?tolerance_mm 10000 is not"):
        first("few", "balise", vehicle=unfit)


def test_without_switches_there_is_nothing_to_turn_off_at() -> None:
    """No facing switch, no stream; no stop point, none either."""
    assert [] == list(driven("fig1", "turn_off"))
    assert [] == list(driven("fig1", "stop_point"))
