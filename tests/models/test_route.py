"""Route recognition: proved for all streams, and the five routes of the worked figure, whole and with a reflector missed."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

import pytest

from safeloc.errors import InputError
from safeloc.language.expr import TRUE
from safeloc.language.interpret import run
from safeloc.language.machine import Machine
from safeloc.language.monitor import check_all
from safeloc.language.nodes import Value
from safeloc.language.system import lower
from safeloc.language.trace import Trace
from safeloc.language.units import NM_PER_MM
from safeloc.language.verdict import Held, Proved
from safeloc.models import route
from safeloc.models.line_runs.ways import seen_beside
from safeloc.models.route.recorded_runs import ON_DEMAND, RUNS, Run, recorded
from safeloc.models.route.simulate import Steps, Way, answers, quiet, simulate, way
from safeloc.models.route.variables import RouteConfig, parts
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.properties.route import properties
from safeloc.railway.map.routes import through_routes
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.walk import Walk
from safeloc.runtime.streams.steps import Cell, read_steps
from safeloc.simulation.motion import Leg
from tests.models.everything_proved import shipped_runs
from tests.models.spoilt import rebuilt
from tests.shipped_recordings import shipped

CONFIG = RouteConfig()
MODEL = route.build(parts(CONFIG))
SYSTEM = lower(MODEL.machine)
WALK = Walk(find_line("fig3"))
ROUTES = [r for r in through_routes(WALK.topology, 100) if r.runs[0].direction == "increasing"]
WAYS = [way(number, one) for number, one in enumerate(ROUTES, 1)]
WITH_OTHERS = [way(number, one, seen_beside(one, ROUTES, WALK)) for number, one in enumerate(ROUTES, 1)]
NAMES = [one.models() for one in ROUTES]
LEGS = [Leg(30_000, 50.0)]
UNSEEN: dict[str, Cell] = {
    "sighted_place_nm": 0,
    "sighted_model": "NONE",
    "sighted_elsewhere": False,
    "true_course": "UNDECIDED",
}


def runs(taken: int, missed: tuple[str, ...] = (), **more: object) -> Trace:
    """A simulated run along one of the five routes, by the interpreter."""
    return followed(simulate(CONFIG, WAYS, taken, seed=taken, legs=LEGS, missed=missed, **more))  # type: ignore[arg-type]


def followed(steps: Steps) -> Trace:
    """The run of a stream."""
    return run(SYSTEM, [{name: value for name, value in step.items() if name != "truth_mm"} for step in steps])


def decisions(trace: Trace) -> set[int]:
    """Every route that was stated in the run."""
    return {int(step.outputs["route"]) for step in trace.steps if step.outputs["valid"]}


def carried(trace: Trace, number: int) -> list[int]:
    """The routes possible after a step."""
    return [n for n in range(1, 6) if trace.steps[number].outputs[f"route_{n}_possible"]]


def all_hold(trace: Trace, *names: str) -> bool:
    """Every property (or those named) holds in the run, and so does the assumption."""
    asked = [prop for prop in properties(MODEL) if prop.kind != "reachable" and (not names or prop.name in names)]
    return all(isinstance(verdict, Held) for verdict in check_all(trace, asked))


def test_the_routes_are_those_of_the_source() -> None:
    """ADAB, ACD, ADCD, ADAD and DCD, with the last being the end of the third."""
    assert sorted(["ADAB", "ACD", "ADCD", "ADAD", "DCD"]) == sorted(NAMES)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("taken", range(1, 6), ids=NAMES)
def test_each_route_is_recognised(taken: int) -> None:
    """With every reflector seen, the route taken is decided, and no other one is ever stated."""
    trace = runs(taken)
    assert {taken} == decisions(trace)
    assert [1, 2, 3, 4, 5] == carried(trace, 0)
    assert all_hold(trace)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize("taken", range(1, 6), ids=NAMES)
def test_reflectors_of_other_branches_are_sighted(taken: int) -> None:
    """The radar sees them as well as the own ones, never where those of the own track stand; and the map has them in view of the true route."""
    steps = simulate(CONFIG, WITH_OTHERS, taken, seed=taken, legs=LEGS)
    foreign = [step for step in steps if step["sighted_elsewhere"]]
    assert any("sighting_range_mm" in step for step in foreign)
    assert not any(step["sighting_by_own_track"] for step in foreign)
    assert all(
        step[f"route_{taken}_other_in_view"] for step in foreign if "sighting_range_mm" in step and possible(step)
    )

    assert {taken} == decisions(followed(steps))
    assert all_hold(followed(steps))


def possible(step: Mapping[str, Cell]) -> bool:
    """Whether the map was asked in a cycle: it answers with something for some route."""
    return any(f"route_{n}_reflector_mm" in step or step[f"route_{n}_other_in_view"] for n in range(1, 6))


def test_a_reflector_of_another_branch_leaves_the_route() -> None:
    """A C 80 m ahead on ACD is sighted from ADAB, which has none: without the map's word on it the true route is gone, and the other is told."""
    adab, acd = NAMES.index("ADAB") + 1, NAMES.index("ACD") + 1
    start: dict[str, Cell] = {
        **quiet(CONFIG), **UNSEEN, "start_error_mm": 1_000, "start_truth_nm": 0, "odometer_mm": 0,
        "start_route": adab, "true_cycle_distance_nm": 0, "next_wander_nm": 0,
        f"route_{adab}_candidate": True, f"route_{acd}_candidate": True,
    }  # fmt: skip
    seen: dict[str, Cell] = {
        **quiet(CONFIG), **UNSEEN, "start_truth_nm": 0, "start_route": adab, "true_cycle_distance_nm": 0, "next_wander_nm": 0,
        "odometer_mm": 0, "sighting_range_mm": 80_000, "sighting_error_mm": 200, "sighting_model": "C", "sighted_model": "C",
        "sighted_place_nm": 80_000 * NM_PER_MM, "sighted_elsewhere": True,
        f"route_{acd}_reflector_mm": 80_000, f"route_{acd}_model": "C",
    }  # fmt: skip
    told = followed([start, {**seen, f"route_{adab}_other_in_view": True}])
    assert sorted((adab, acd)) == carried(told, 1)
    assert all_hold(told)
    assert [acd] == carried(followed([start, seen]), 1)
    near = followed([start, {**seen, f"route_{adab}_other_in_view": True, "sighting_by_own_track": True}])
    assert [acd] == carried(near, 1)


MISSED = [(one.number, sight.identity) for one in WAYS for sight in one.sights]


@pytest.mark.thorough(ordinary=2)
@pytest.mark.parametrize(("taken", "identity"), MISSED, ids=[f"{NAMES[n - 1]}-{i}" for n, i in MISSED])
def test_a_missed_reflector_never_makes_another_route(taken: int, identity: str) -> None:
    """Whichever reflector is missed, no wrong route is stated: ADCD without its first A is not DCD, without D not ACD."""
    trace = runs(taken, (identity,))
    assert decisions(trace) <= {taken}
    assert all_hold(trace, "the true route is carried", "containment")


def test_places_decide_where_models_do_not() -> None:
    """ADCD without its second reflector shows A, C, D like ACD; the place of C tells them apart."""
    adcd, second = NAMES.index("ADCD") + 1, WAYS[NAMES.index("ADCD")].sights[1].identity
    assert {adcd} == decisions(runs(adcd, (second,)))


def test_a_misread_model_is_a_contradiction_or_found_out() -> None:
    """A model read wrongly breaks the assumption; here no route has it there, and nothing is reported any more."""
    first = WAYS[0].sights[0].identity
    trace = runs(1, misread={first: "H"})
    assert "no route fits" in {name for step in trace.steps for name in step.fired.values()}
    assert set() == decisions(trace)
    assert "LOST" == MODEL.machine.modes[int(trace.steps[-1].state["mode"])].label


def test_an_authority_for_another_route_is_flagged() -> None:
    """A vehicle that is not on the route of its movement authority is told so, once that route is refuted and not before."""
    steps = simulate(CONFIG, WAYS, 5, seed=5, legs=LEGS)
    trace = followed([{**step, "authorised_route": 1} for step in steps])
    flags = [bool(step.outputs["refutes_authority"]) for step in trace.steps]
    routes = [carried(trace, number) for number in range(len(trace.steps))]
    assert flags == [bool(possible) and 1 not in possible for possible in routes]
    assert any(flags)
    right = followed([{**step, "authorised_route": 5} for step in steps])
    assert not any(step.outputs["refutes_authority"] for step in right.steps)


def test_a_turn_refutes_what_goes_the_other_way() -> None:
    """A turn to the left that one route does not take leaves the others; a switch that a route does not have tells nothing."""
    start: dict[str, Cell] = {
        **quiet(CONFIG),
        "start_error_mm": 1_000,
        "start_truth_nm": 0,
        "start_route": 2,
        "true_cycle_distance_nm": 0,
    }
    start |= {"next_wander_nm": 0, "odometer_mm": 0, **{f"route_{n}_candidate": True for n in (1, 2, 3)}, **UNSEEN}
    turn: dict[str, Cell] = {
        **quiet(CONFIG),
        "start_truth_nm": 0,
        "start_route": 2,
        "true_cycle_distance_nm": 0,
        "next_wander_nm": 0,
        "odometer_mm": 0,
    }
    turn |= UNSEEN | {
        "true_course": "LEFT",
        "course_taken": "LEFT",
        "route_1_course": "RIGHT",
        "route_2_course": "LEFT",
        "route_3_course": "UNDECIDED",
    }
    trace = followed([start, turn])
    assert [1, 2, 3] == carried(trace, 0)
    assert [2, 3] == carried(trace, 1)


def test_the_map_answers_with_the_nearest_of_that_model() -> None:
    """Of several reflectors of the sighted model, the one nearest to where the sighting puts it."""
    outputs: dict[str, Value] = {f"route_{n}_{end}_mm": 500_000 for n in range(1, 6) for end in ("low", "high")}
    outputs |= {f"route_{n}_possible": n == 1 for n in range(1, 6)}
    seen: dict[str, Cell] = {"sighting_range_mm": 70_000, "sighting_error_mm": 200, "sighting_model": "A"}
    found = answers(WAYS, outputs, seen)
    assert 560_000 == found["route_1_reflector_mm"]
    assert 160_000 == found["route_4_reflector_mm"]
    assert "route_5_reflector_mm" not in found
    assert {} == answers(WAYS, outputs, {})
    assert {} == answers(WAYS, {**outputs, "route_1_possible": False}, seen)


@pytest.mark.parametrize("name", RUNS)
def test_shipped_recordings_are_fresh_simulations(name: str) -> None:
    """The recording is what its run gives."""
    assert recorded(RUNS[name]) == list(read_steps(shipped(f"route-{name}")).steps)


@pytest.mark.thorough(ordinary=3)
@pytest.mark.parametrize("run", [*RUNS.values(), *ON_DEMAND.values()])
def test_the_route_taken_is_stated_or_none(run: Run) -> None:
    """Along every route of the line, whether or not a reflector is missed."""
    assert decisions(followed(recorded(run))) <= {NAMES.index(run.models) + 1}


def test_wrong_simulations_are_refused() -> None:
    """A way that is none, or a number beyond the configured routes."""
    with pytest.raises(InputError, match=r"^route 9 of 5: the ways are numbered \[1, 2, 3, 4, 5\]\.$"):
        simulate(CONFIG, WAYS, 9, seed=0, legs=LEGS)
    with pytest.raises(InputError, match="route 1 of 5"):
        simulate(CONFIG, [*WAYS, Way(6, ())], 1, seed=0, legs=LEGS)


def test_impossible_configurations_are_refused() -> None:
    """A start too coarse for the tolerance, and a unit that drifts with time."""
    with pytest.raises(ValueError, match="nothing can be reported; raise it"):
        RouteConfig(tolerance_mm=18_000)
    with pytest.raises(ValueError, match="drift_mm_s2 must be 0"):
        RouteConfig(odometer={"kind": "accelerometer", "drift_mm_s2": 5})


@pytest.mark.thorough
@pytest.mark.parametrize("routes", [2, *(pytest.param(n, marks=pytest.mark.slow) for n in (5, 16))])
def test_everything_is_proved(routes: int) -> None:
    """Every property, for any number of routes, without a bound on the length of the run."""
    model = route.build(parts(RouteConfig(routes=routes)))
    findings = prove(lower(model.machine), properties(model), Limits(seconds=60), jobs=2, **shipped_runs("route"))
    wrong = [finding.id for finding in findings if not isinstance(finding.result, Proved)]
    assert [] == wrong


def _broken(machine: Machine, fault: str) -> Machine:
    """The machine with one transition left out or spoilt."""
    table = [t for t in machine.transitions if (fault, t.name) != ("refutes nothing", "no route fits")]
    if fault == "narrows too far":
        low = next(var for var in table[1].set if var.name == "route_1_low_nm")
        table = [replace(t, set={**t.set, low: t.set[low] + 1}) if t.name.startswith("run on") else t for t in table]
    if fault == "decides at once":
        table = [replace(t, when=TRUE) if t.name == "one route is left" else t for t in table]
    return rebuilt(machine, table)


@pytest.mark.thorough
@pytest.mark.parametrize(
    ("fault", "noticed"),
    [
        ("refutes nothing", "no route left is no report"),
        ("narrows too far", "the true route is carried"),
        ("decides at once", "the decided route is true"),
    ],
)
def test_a_wrong_table_is_noticed(fault: str, noticed: str) -> None:
    """A machine with one fault does not have the property that the fault concerns."""
    model = route.build(parts(RouteConfig(routes=2)))
    asked = [prop for prop in properties(model) if prop.name == noticed]

    def is_proved(machine: Machine) -> bool:
        return isinstance(prove(lower(machine), asked, Limits(seconds=5))[-1].result, Proved)

    assert is_proved(model.machine)
    assert not is_proved(_broken(model.machine, fault))
