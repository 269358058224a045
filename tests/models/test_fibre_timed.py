"""The fibre that is timed: true times raise no F, with one millimetre less of threshold one does, and a drifting index is noticed."""

from __future__ import annotations

from collections.abc import Mapping
from functools import cache

import pytest
from pydantic import ValidationError

from safeloc.catalogue import load_target
from safeloc.language.expr import TRUE, as_num
from safeloc.language.interpret import run
from safeloc.language.system import without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.units import MM, NM
from safeloc.language.verdict import Proved, Violated
from safeloc.models import fibre_timed
from safeloc.models.fibre import FibreConfig
from safeloc.models.fibre.simulate import Drive, steady
from safeloc.models.fibre.variables import FLIGHT_DIFFERS
from safeloc.models.fibre_timed import FibreTimed, FibreTimedConfig, compose_machines
from safeloc.models.fibre_timed.additional import TRUE_PLACE
from safeloc.models.fibre_timed.simulate import RUNS, Timed, simulate, timed
from safeloc.models.time_of_flight import TimeOfFlightConfig
from safeloc.models.vocabulary.vehicle_world import ON_THE_LINE
from safeloc.proof.provers.implication import Refuted
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.provers.replayed_evidence import admissible_run
from safeloc.properties.fibre_timed import properties
from safeloc.runtime.streams.steps import Cell, read_steps
from tests.models.owed_contracts import Wires, contract, rewired
from tests.shipped_recordings import shipped

CONFIG = FibreTimedConfig()
LEAST_MM = CONFIG.widest_margin_mm + CONFIG.off_at_a_signal_mm
NO_F, NEARBY = "a true time raises no F", "a surveyed point nearby is enough"


def verdict(whole: FibreTimed, claim: str) -> object:
    """What the provers find of one claim, with no recording and no witness."""
    [prop] = [one for one in properties(whole) if one.name == claim]
    found = {one.id: one.result for one in prove(whole.composition.system, [prop], Limits(seconds=60), jobs=1)}
    [result] = [result for name, result in found.items() if name.endswith(claim)]
    return result


# ------------------------------------------------------------------ wires and contracts


def test_no_place_by_time_of_flight_is_an_input() -> None:
    """It comes from the delay of the cycle; what the machines give each other is owed, not assumed."""
    system = compose_machines().composition.system
    left = {var.name for var in system.inputs}
    assert not {name for name in left if "flight_position" in name or name.startswith("additional.")}
    assert {"time_of_flight.delay_ps", "amplitude_cdb", "fibre.run_mm", "fibre.reflecting_point_mm"} <= left
    owed = {part.name: part.guaranteed for part in system.parts if part.guaranteed}
    assert {"additional": (TRUE_PLACE,), "fibre": (ON_THE_LINE,)} == owed


def _distance_along_the_fibre(whole: FibreTimed, _: Wires) -> Wires:
    """Ls itself, without the cable map."""
    flight = whole.flight.machine
    return {whole.additional.own.position.value: flight.output("distance_mm")}


def _no_margin(whole: FibreTimed, _: Wires) -> Wires:
    return {whole.additional.own.below: as_num(0, MM)}


def _always_there(whole: FibreTimed, _: Wires) -> Wires:
    return {whole.additional.own.position.present: TRUE}


def _light_to_another_end(whole: FibreTimed, _: Wires) -> Wires:
    """What is timed stands still at the origin, whatever the end does."""
    return {whole.flight.own.next_truth: as_num(0, NM)}


@pytest.mark.parametrize("wrong", [_distance_along_the_fibre, _no_margin, _always_there, _light_to_another_end])
def test_a_wrong_wire_is_refuted(wrong: object, monkeypatch: pytest.MonkeyPatch) -> None:
    """By the contract of the place; the right wires keep it."""
    changed = rewired(fibre_timed, compose_machines, wrong, monkeypatch)  # type: ignore[arg-type]
    assert isinstance(contract(changed.composition, "additional"), Refuted)


def test_the_right_wires_keep_the_contracts() -> None:
    """Of the place that is compared, and of the end on the line."""
    whole = compose_machines().composition
    assert [None, None] == [contract(whole, owner) for owner in ("additional", "fibre")]


# ------------------------------------------------------------------ the threshold


def test_the_least_threshold() -> None:
    """Half of what 117.9 ns, 100 ppm of 40 km, 40 m of pattern, 5 m of survey and 3 % of half a kilometre leave open, and 85 m at a signal."""
    assert 30_000 + 50_000 + 3_000 + 2_000 == CONFIG.off_at_a_signal_mm
    assert 67_000 < CONFIG.widest_margin_mm < 68_000
    assert 152_713 == LEAST_MM <= CONFIG.fibre.flight_threshold_mm


@pytest.mark.thorough
def test_one_millimetre_less_is_not_enough(monkeypatch: pytest.MonkeyPatch) -> None:
    """A true place that is a millimetre wider raises F, with a run; with the figures as they are it never does."""
    assert isinstance(verdict(compose_machines(), NO_F), Proved)
    right = CONFIG.comparable_margin_mm
    monkeypatch.setattr(FibreTimedConfig, "comparable_margin_mm", property(lambda _: right + 1))
    assert isinstance(verdict(compose_machines(), NO_F), Violated)


@pytest.mark.thorough
def test_the_least_threshold_is_the_least() -> None:
    """At it, each place with a surveyed point nearby is compared; at a millimetre less, not each."""
    least, less = (
        compose_machines(
            FibreTimedConfig.model_construct(
                fibre=FibreConfig(flight_threshold_mm=threshold),
                time_of_flight=TimeOfFlightConfig(),
                point_reach_mm=500_000,
            )
        )
        for threshold in (LEAST_MM, LEAST_MM - 1)
    )
    assert isinstance(verdict(least, NEARBY), Proved)
    assert isinstance(verdict(less, NEARBY), Violated)


@pytest.mark.parametrize(
    ("config", "message"),
    [
        (
            {"fibre": FibreConfig()},
            "flight_threshold_mm is 60000, but a true time may give a place that is up to 152713 mm",
        ),
        ({"point_reach_mm": 1_000_000}, "raise it, or survey more points"),
        ({"time_of_flight": TimeOfFlightConfig(position_limit_mm=1_000)}, "position_limit_mm is 1000, but fibre"),
    ],
)
def test_figures_that_do_not_fit_are_refused(config: Mapping[str, object], message: str) -> None:
    """By name, with what to do; the threshold of `fibre` alone is one of them."""
    with pytest.raises(ValidationError, match=message):
        FibreTimedConfig(**config)  # type: ignore[arg-type]


# ------------------------------------------------------------------ runs


@cache
def on_board(name: str) -> Trace:
    """The run of a shipped recording, without its world."""
    return _without_world(read_steps(shipped(f"fibre_timed-{name}")).steps)


def _without_world(steps: object) -> Trace:
    system = without_ghosts(load_target("fibre_timed").system)
    ghosts = ("fibre.next_", "time_of_flight.next_", "time_of_flight.pattern_", "true_run", "truth")
    kept: list[dict[str, Cell]] = [
        {name: cell for name, cell in step.items() if not name.startswith(ghosts)}
        for step in steps  # type: ignore[attr-defined]
    ]
    return run(system, kept)


def test_a_place_is_compared_at_the_signal() -> None:
    """In service all places are compared but those of two cycles without a delay, one after a missed amplitude, and the first cycle."""
    steps = on_board("service").steps
    assert [0, 20, 21, 31] == [number for number, step in enumerate(steps) if not step.outputs["additional.compared"]]
    [signal] = [step for step in steps if step.outputs["fibre.position_signal"]]
    assert signal.outputs["additional.compared"] and signal.outputs["fibre.valid"]


def test_too_few_surveyed_points() -> None:
    """Far from one nothing is compared, and no F comes."""
    steps = on_board("few-points").steps
    assert not steps[-1].outputs["additional.compared"] and steps[-1].outputs["fibre.valid"]
    assert steps[10].outputs["additional.compared"]


def test_an_index_that_drifts_is_noticed() -> None:
    """Where the time of flight moves away from the sections, F comes at the next section at the latest."""
    steps = _without_world(
        timed(CONFIG, Drive(steady(30_000, 80), flight_off_mm=None), Timed(index_ppm=750), seed=4)
    ).steps
    [first, *_] = [step for step in steps if step.outputs["fibre.error"]]
    assert FLIGHT_DIFFERS.value == first.outputs["fibre.reason"]


@pytest.mark.parametrize("name", RUNS)
def test_a_recording_is_its_run(name: str) -> None:
    """What ships is what the named run makes, and it obeys the laws to its end."""
    stream = read_steps(shipped(name))
    assert [dict(step) for step in RUNS[name].steps(CONFIG)] == [dict(step) for step in stream.steps]
    assert len(stream.steps) == len(admissible_run(load_target("fibre_timed").system, stream.first, stream.steps).steps)


def test_a_simulation_obeys_the_laws() -> None:
    """Other gaps and other amplitudes."""
    steps = simulate(CONFIG, seed=5)
    assert len(steps) == len(admissible_run(load_target("fibre_timed").system, {}, steps).steps)
