"""The localizer on a map with switches: what is owed to the track is proved, a wrong wire is not, and the recordings say what they teach."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import pytest
from pydantic import ValidationError

from safeloc.catalogue import load_target
from safeloc.language.expr import TRUE
from safeloc.language.interpret import run
from safeloc.language.machine import Machine
from safeloc.language.monitor import check_all
from safeloc.language.nodes import Value
from safeloc.language.trace import Step
from safeloc.language.verdict import Held, Violated
from safeloc.models import localizer_track, occupied_track
from safeloc.models.localizer import LocalizerConfig
from safeloc.models.localizer_track import NAME, LocalizerTrack, LocalizerTrackConfig, compose_machines
from safeloc.models.localizer_track.simulate import RUNS
from safeloc.models.motion import Motion
from safeloc.models.occupied_track import OccupiedTrack, OccupiedTrackConfig
from safeloc.models.occupied_track.look_up import LookUp
from safeloc.models.occupied_track.world import POSITION
from safeloc.models.turn_off import STRAIGHT, TurnOff, TurnOffConfig
from safeloc.models.turn_off.seen_course import TAKEN
from safeloc.models.vocabulary.absent import wired_interval
from safeloc.proof.provers.dead_ends import lasts
from safeloc.proof.provers.limits import Limits
from safeloc.properties.localizer_track import properties
from safeloc.railway.map.toml_files import find_line
from safeloc.railway.map.topology import Topology
from safeloc.runtime.streams.steps import read_steps
from safeloc.simulated import Steps, first_values
from tests.models.inductive import inductive_in
from tests.models.owed_contracts import Wires, contract

OWNER = "occupied_track"
Wrong = Callable[[Wires, Machine, OccupiedTrack], Wires]


def test_the_position_and_the_turn_are_owed_to_the_track() -> None:
    """What stays open is what map and sensors give."""
    system = compose_machines().composition.system
    assert {OWNER: (POSITION, TAKEN)} == {one.name: one.guaranteed for one in system.parts if one.name == OWNER}
    left = {var.name for var in system.inputs if var not in system.ghosts and var.name.startswith(f"{OWNER}.")}
    wired = {f"{OWNER}.{name}" for name in ("located", "front_low_mm", "front_high_mm", "course_taken", "start_given")}
    assert not left & wired
    assert {f"{OWNER}.group_edge", f"{OWNER}.track_1_ahead_points", f"{OWNER}.next_1_edge"} <= left


def test_they_are_proved_of_the_machines_before() -> None:
    """By their lemmas, in one step."""
    assert contract(compose_machines().composition, OWNER) is None


@pytest.mark.thorough
@pytest.mark.parametrize(
    "lemmas",
    [
        (
            "balise: the interval holds the truth",
            "arbitration: the interval holds the truth",
            "delocalized: a passed position holds the truth",
            "uplink: a report on its way holds the truth",
            "uplink: a report that arrived holds the truth",
        ),
        ("turn_off: the decided course is true",),
    ],
)
def test_without_its_lemmas_the_contract_is_not_proved(lemmas: tuple[str, ...]) -> None:
    """One position passes through balises, arbitration, restrictive state and link within a cycle: the lemma of each says it of the same one."""
    assert contract(compose_machines().composition, OWNER, *lemmas) is not None


# ------------------------------------------------------------------ the first state


@pytest.mark.thorough
def test_a_vehicle_off_its_edge_at_first_has_no_lawful_step(monkeypatch: pytest.MonkeyPatch) -> None:
    """It would have to pass more than one joint in the first cycle; every proof would be silent on such runs."""
    monkeypatch.setattr(occupied_track, "on_its_edge", lambda _: TRUE)
    wrong = lasts(compose_machines().composition.system, Limits(seconds=30))
    assert isinstance(wrong, Violated)
    assert wrong.trace is not None
    assert not wrong.trace.steps


def test_the_vehicle_has_one_coordinate() -> None:
    """The track is that of the vehicle that the odometer moves: they share the ghost, so their first states agree."""
    names = [var.name for var in compose_machines().composition.system.ghosts]
    assert "truth_nm" in names
    assert f"{OWNER}.truth_nm" not in names
    assert f"{OWNER}.next_truth_nm" not in names


# ------------------------------------------------------------------ wires exchanged on purpose


def _no_margin(right: Wires, guard: Machine, track: OccupiedTrack) -> Wires:
    """The track has the estimate for the lower end."""
    position, _, _ = wired_interval(guard)
    return {**right, track.own.low: position}


def _always_located(right: Wires, _: Machine, track: OccupiedTrack) -> Wires:
    """A position that was withdrawn counts."""
    return {**right, track.own.located: TRUE}


def _always_straight(right: Wires, _: Machine, track: OccupiedTrack) -> Wires:
    """Every vehicle is taken to run straight on."""
    return {**right, track.own.course_taken: STRAIGHT}


def _any_group(right: Wires, _: Machine, track: OccupiedTrack) -> Wires:
    """A group that the balise machine refused begins a track."""
    return {**right, track.own.start_given: TRUE}


def rewired(wrong: Wrong, monkeypatch: pytest.MonkeyPatch) -> LocalizerTrack:
    """The composition with other wires to the track."""
    right = localizer_track._into_track

    def spoilt(moves: Motion, guard: Machine, groups: Machine, course: TurnOff, track: OccupiedTrack) -> Wires:
        return wrong(right(moves, guard, groups, course, track), guard, track)

    monkeypatch.setattr(localizer_track, "_into_track", spoilt)
    return compose_machines()


@pytest.mark.thorough
@pytest.mark.parametrize("wrong", [_no_margin, _always_located, _always_straight])
def test_a_wrong_wire_is_not_proved(wrong: Wrong, monkeypatch: pytest.MonkeyPatch) -> None:
    """The contract of the track is not kept."""
    assert contract(rewired(wrong, monkeypatch).composition, OWNER) is not None


@pytest.mark.thorough
@pytest.mark.parametrize("claim", ["a refused group begins no track", "every accepted group names its track"])
def test_a_track_from_a_refused_group_is_noticed(claim: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """It keeps the contract; the claim on the wire notices it."""
    for model, kept in ((compose_machines(), True), (rewired(_any_group, monkeypatch), False)):
        [prop] = [one for one in properties(model) if one.name == claim]
        assert inductive_in(model.composition.system, prop, claim) is kept


# ------------------------------------------------------------------ configuration


@pytest.mark.parametrize(
    ("config", "message"),
    [
        (
            {"localizer": LocalizerConfig(sources=("odometry",))},
            "has no balise: a track begins with a balise group; add it",
        ),
        ({"track": OccupiedTrackConfig(period_ms=200)}, "track.period_ms is 200, but the vehicle's is 100"),
        ({"track": OccupiedTrackConfig()}, "track.position_limit_mm 1000000000 is below 1000030000"),
        (
            {"turn_off": TurnOffConfig(position_limit_mm=1_000)},
            "turn_off.position_limit_mm is 1000, but the vehicle's is",
        ),
    ],
)
def test_figures_that_do_not_fit_are_refused(config: Mapping[str, object], message: str) -> None:
    """By name, with what to do."""
    with pytest.raises(ValidationError, match=message):
        LocalizerTrackConfig(**config)  # type: ignore[arg-type]


# ------------------------------------------------------------------ recordings


def told(step: Step, seen: LookUp) -> tuple[str, bool]:
    """The edge that is told (nothing: none), and whether the host has a position."""
    outputs = step.outputs
    edge = seen.run(int(outputs[f"{OWNER}.edge"])).edge if outputs[f"{OWNER}.valid"] else ""
    return edge, not outputs["delocalized.restrictive"]


@pytest.mark.thorough
@pytest.mark.parametrize("name", sorted(RUNS, reverse=True))
def test_recordings_ship_as_they_are_made(name: str) -> None:
    """From the journey of that name, with the figures of the defaults."""
    [path] = [one for one in load_target(NAME).streams if one.name.startswith(f"{name}.")]
    kept, made = read_steps(path), RUNS[name]
    assert [dict(step) for step in made.steps(LocalizerTrackConfig())] == [dict(step) for step in kept.steps]
    assert dict(made.first) == dict(kept.first)


@pytest.mark.thorough(ordinary=1)
@pytest.mark.parametrize(
    ("name", "edges", "never"),
    [
        (f"{NAME}-other-branch", ["301", "303-305"], "302-304"),
        (f"{NAME}-turn-seen", ["301", "302-303", "303-305"], "302-304"),
        (f"{NAME}-as-announced", ["301", "302-304", "304-306"], "302-303"),
    ],
)
def test_the_recordings_tell_the_true_track(name: str, edges: list[str], never: str) -> None:
    """In this order; the announced branch is never told to a vehicle on the other one, whatever the coordinate says."""
    target = load_target(NAME)
    [path] = [one for one in target.streams if one.name.startswith(f"{name}.")]
    stream, seen = read_steps(path), LookUp(Topology(find_line("fig3")), LocalizerTrackConfig().track)
    known = {var.name for var in target.system.inputs} | {
        var.name.removesuffix(".present") for var in target.system.inputs
    }
    steps = [{key: cell for key, cell in step.items() if key in known} for step in stream.steps]
    trace = run(target.system, steps, first=stream.first)
    wrong = [
        one
        for one in trace.steps
        if one.outputs[f"{OWNER}.valid"] and one.outputs[f"{OWNER}.edge"] != one.state[f"{OWNER}.true_edge"]
    ]
    assert wrong == []
    said = [edge for edge, _ in dict.fromkeys(told(one, seen) for one in trace.steps) if edge]
    assert said == edges
    assert never not in said


def test_a_simulated_run_begins_where_the_vehicle_stands() -> None:
    """The first values are those of its scene, before the vehicle leaves its first edge, so the assumption holds where the first group is read."""
    drawn = load_target(NAME, with_recordings=False).simulate
    assert drawn is not None
    steps, recorded = drawn(4), RUNS[f"{NAME}-other-branch"]
    assert recorded.first == first_values(steps)
    model = compose_machines()
    trace = run(model.composition.system, _first_of(steps, 150), first=first_values(steps))
    assert all(isinstance(verdict, Held) for verdict in check_all(trace, properties(model)))


def _first_of(steps: Steps, many: int) -> list[dict[str, Value | str]]:
    """Return the first steps, without the remark."""
    return [{name: cell for name, cell in step.items() if name != "truth_mm"} for step in steps[:many]]
