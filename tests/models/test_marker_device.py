"""The marker device: what the guard passes on is proved to hold end A, a wrong wire is not, and the recordings say what they teach."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from pathlib import Path

import pytest
from pydantic import ValidationError

from safeloc.catalogue import load_target
from safeloc.errors import InputError
from safeloc.language.expr import TRUE, Bool, Expr, Lit, Var, floor_div, ite
from safeloc.language.interpret import run
from safeloc.language.trace import Trace
from safeloc.language.units import MM, NM_PER_MM
from safeloc.models import guard, marker_device, supervised_odometry
from safeloc.models.guard import box
from safeloc.models.guard.variables import GuardConfig
from safeloc.models.marker_device import compose_machines
from safeloc.models.marker_device.configuration import MarkerDeviceConfig
from safeloc.models.marker_device.simulate import SCENES, SEED, Scene, first_state, simulate, write
from safeloc.models.odometry.satellite_reading import SatelliteReader
from safeloc.models.odometry.variables import OdometryConfig
from safeloc.models.odometry.world import SATELLITES
from safeloc.models.vocabulary.absent import wired_interval
from safeloc.proof.provers.implication import Refuted
from safeloc.proof.provers.proved_base import base
from safeloc.proof.provers.replayed_evidence import admissible_run
from safeloc.runtime.streams.steps import read_steps
from safeloc.simulation.faults import Fault
from safeloc.simulation.motion import Leg
from tests.models.owed_contracts import contract
from tests.proof.provers.small import told
from tests.shipped_recordings import shipped

CONFIG = MarkerDeviceConfig()
CONTRACT = "contract of odometry holds"
Wires = Mapping[Var, Expr]
Wrong = Callable[[guard.Guard, SatelliteReader], Wires]


# ------------------------------------------------------------------ contracts


def test_only_the_laws_of_sensors_are_assumed() -> None:
    """The law on positions of satellites, and that of the restrictive state, are owed; no input of a machine before is left open."""
    system = compose_machines().composition.system
    owed = {part.name: part.guaranteed for part in system.parts if part.guaranteed}
    assert {"odometry": (SATELLITES,), "delocalized": ("a valid position holds the truth",)} == owed
    left = {var.name for var in system.inputs}
    assert not {name for name in left if "satellite" in name or name.startswith("delocalized.")}
    assert {"guard.fix_mm", "odometry.front_marker", "odometry.rear_marker"} <= left


def test_the_contract_follows_from_the_guard() -> None:
    """And from the place of the antenna; without the guard's containment it does not."""
    assert None is contract(compose_machines().composition, "odometry")
    assert isinstance(contract(compose_machines().composition, "odometry", "guard: the truth is inside"), Refuted)


def _no_antenna(receiver: guard.Guard, reader: SatelliteReader) -> Wires:
    position, *_ = wired_interval(receiver.machine)
    return {reader.place.value: ite(_passed(receiver), position, 0)}


def _no_tolerance(receiver: guard.Guard, reader: SatelliteReader) -> Wires:
    return {reader.above: wired_interval(receiver.machine)[2]}


def _always(receiver: guard.Guard, reader: SatelliteReader) -> Wires:
    return {reader.place.present: TRUE, reader.place.value: receiver.own.fix.value}


def _raw_fix(receiver: guard.Guard, reader: SatelliteReader) -> Wires:
    """The fix itself with its own error on board, although the guard judged it."""
    place = receiver.own.fix.value + CONFIG.antenna_mm
    error = Lit(CONFIG.guard.fix_error_mm, MM)
    return {reader.place.value: ite(_passed(receiver), place, 0), reader.below: error, reader.above: error}


def _passed(receiver: guard.Guard) -> Bool:
    return receiver.machine.flag("passed") & receiver.machine.flag("valid")


@pytest.mark.parametrize("wrong", [_no_antenna, _no_tolerance, _always, _raw_fix])
def test_a_wrong_wire_is_not_proved(wrong: Wrong, monkeypatch: pytest.MonkeyPatch) -> None:
    """The antenna's place left out, its tolerance left out, a fix that nobody passed on, a fix in place of the guard's interval."""
    right = marker_device._into_odometry

    def into_odometry(config: MarkerDeviceConfig, receiver: guard.Guard, reader: SatelliteReader | None) -> Wires:
        assert reader is not None
        return {**right(config, receiver, reader), **wrong(receiver, reader)}

    monkeypatch.setattr(marker_device, "_into_odometry", into_odometry)
    assert isinstance(contract(compose_machines().composition, "odometry"), Refuted)


@pytest.mark.slow
def test_a_broken_guard_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    """A guard that takes half of a fix's error keeps its containment no more, and the contract is lost with it."""
    sound = box.half_nm
    monkeypatch.setattr(box, "half_nm", lambda own: floor_div(sound(own), 2))
    known = base(compose_machines().composition.system)
    assert "guard: the truth is inside" in told(known.refuted)
    assert CONTRACT not in told(known.kept)
    assert not {name for name in told(known.facts) if name.startswith("odometry:") and "holds the truth" in name}


@pytest.mark.slow
def test_everything_owed_is_kept() -> None:
    """Guard, then odometry, then the restrictive state: each is proved from those before it."""
    known = base(compose_machines().composition.system)
    assert {CONTRACT, "contract of delocalized holds"} <= told(known.kept)
    assert not known.refuted


# ------------------------------------------------------------------ recordings


@cache
def recorded(name: str) -> Trace:
    """A shipped recording, refused in the first step that breaks what is assumed."""
    stream = read_steps(shipped(f"marker_device-{name}"))
    return admissible_run(load_target("marker_device").system, dict(stream.first), stream.steps)


def label(trace: Trace, name: str, at: int) -> str:
    """An enumerated variable as its member."""
    return str(trace.system.variable(name).unit.members[trace.steps[at].state[name]])  # type: ignore[union-attr]


def course(trace: Trace, name: str) -> list[str]:
    """The values of an enumerated variable, each as often as it was come to."""
    found = [label(trace, name, at) for at in range(len(trace.steps))]
    return [one for at, one in enumerate(found) if at == 0 or found[at - 1] != one]


def fired(trace: Trace, machine: str, name: str) -> list[int]:
    """The cycles in which a machine took a transition."""
    return [at for at, one in enumerate(trace.steps) if one.fired[f"{machine}.fired"] == name]


def margins(trace: Trace, cycles: range) -> list[int]:
    """The greater margin that the host gets, mm."""
    sides = ("delocalized.margin_below_mm", "delocalized.margin_above_mm")
    return [max(int(trace.steps[at].outputs[side]) for side in sides) for at in cycles]


def assert_truth_inside(trace: Trace) -> None:
    """End A lies in each interval that the host gets."""
    for one in trace.steps:
        if not one.outputs["delocalized.restrictive"]:
            position, truth = int(one.outputs["delocalized.position_mm"]), int(one.state["truth_nm"])
            assert position - int(one.outputs["delocalized.margin_below_mm"]) <= truth / NM_PER_MM
            assert position + int(one.outputs["delocalized.margin_above_mm"]) >= truth / NM_PER_MM


@pytest.mark.thorough
@pytest.mark.parametrize("name", SCENES)
def test_every_interval_holds_the_truth(name: str) -> None:
    """The recording obeys every law to its end, and end A lies in each interval that the host gets."""
    trace = recorded(name)
    assert len(trace.steps) == len(read_steps(shipped(f"marker_device-{name}")).steps)
    assert_truth_inside(trace)


@pytest.mark.thorough
def test_in_the_open_satellites_lead_and_in_the_tunnel_markers_do() -> None:
    """MRK-D6: 1.8 km without a marker in the open, markers every 400 m in the tunnel, read at both ends."""
    trace = recorded("tunnel")
    assert len(fired(trace, "odometry", "satellites confirm the candidate")) == 1
    by_satellites = fired(trace, "odometry", "position of satellites")
    assert [] == [at for at in by_satellites if 850 <= at < 1_650]
    assert {at < 850 for at in by_satellites} == {True, False}
    assert [at for at in fired(trace, "odometry", "trailing reading at rear") if 850 <= at < 1_650]
    assert ["DELOCALIZED", "LOCALIZED"] == course(trace, "delocalized.mode")


@pytest.mark.thorough
def test_whichever_end_leads() -> None:
    """While the vehicle sets back, end B reads first and end A second, and satellites count all the same; then it turns."""
    trace = recorded("backwards")
    back = [bool(one.state["odometry.backwards"]) for one in trace.steps]
    assert [False, True, False] == [one for at, one in enumerate(back) if at == 0 or back[at - 1] != one]
    for name in (
        "marker confirmed at rear",
        "leading reading at rear",
        "trailing reading at front",
        "position of satellites",
    ):
        assert [at for at in fired(trace, "odometry", name) if back[at]], name
    assert [at for at in fired(trace, "odometry", "leading reading at front") if not back[at]]
    assert ["DELOCALIZED", "LOCALIZED"] == course(trace, "delocalized.mode")


@pytest.mark.thorough
def test_after_a_loss_the_receiver_waits_for_a_marker() -> None:
    """Restrictive until a marker agrees with the satellites; the one with a wrong place only replaced the candidate."""
    trace = recorded("loss")
    assert ["DELOCALIZED", "LOCALIZED", "DELOCALIZED", "LOCALIZED"] == course(trace, "delocalized.mode")
    [lost] = fired(trace, "delocalized", "position lost")
    wrong = fired(trace, "odometry", "candidate marker at front")
    again = [at for at in fired(trace, "odometry", "marker confirmed at front") if at > lost]
    candidates = [at for at in fired(trace, "odometry", "candidate of satellites") if at > lost]
    assert len(again) == 1
    assert len([at for at in wrong if at > lost]) == 1
    assert candidates[0] < wrong[-1] < candidates[-1] < again[0]


@pytest.mark.thorough
def test_a_false_receiver_changes_nothing() -> None:
    """While the guard withholds, the margin grows by the odometers' error alone, unless a marker is read."""
    trace = recorded("false-fixes")
    spans = [range(300, 306), range(450, 530), range(650, 666)]
    for span in spans:
        passed = [at for at in span if trace.steps[at].outputs["guard.passed"]]
        assert [] == passed
        grown = margins(trace, span)
        assert grown == sorted(grown)
    assert fired(trace, "guard", "receiver believed again")
    assert ["DELOCALIZED", "LOCALIZED"] == course(trace, "delocalized.mode")


@pytest.mark.thorough
def test_a_receiver_that_lies_for_long_is_refused_where_markers_locate() -> None:
    """Beyond the guard's law: false fixes 180 m ahead fill a row and are passed on, and odometry refuses every one of them."""
    markers = [(number, 250_000 * number - 150_000) for number in range(1, 14)]
    scene = Scene([Leg(0, 8), Leg(30_000, 100)], markers, receiver=(Fault("jump", "", 300, 900),))
    system = compose_machines().composition.system
    trace = run(system, simulate(CONFIG, scene, seed=SEED), first=first_state(CONFIG))
    false = [at for at in range(300, 900) if trace.steps[at].outputs["guard.passed"]]
    ends = [f"odometry.{end}_reading" for end in ("front", "rear")]
    read = {at for at in false if "ACCEPTED" in [label(trace, end, at) for end in ends]}
    refused = [label(trace, "odometry.satellite_reading", at) for at in false if at not in read]
    assert len(refused) > 10
    assert {"OUT_OF_WINDOW"} == set(refused)
    assert ["DELOCALIZED", "LOCALIZED"] == course(trace, "delocalized.mode")
    assert_truth_inside(trace)


@pytest.mark.thorough
def test_recordings_are_what_the_simulation_writes(tmp_path: Path) -> None:
    """To the byte."""
    for path in write(tmp_path):
        assert shipped(path.name.removesuffix(".jsonl.gz")).read_bytes() == path.read_bytes()


def test_a_receiver_has_no_other_fault() -> None:
    """An unknown kind is refused: it would test nothing."""
    wrong = replace(SCENES["tunnel"], receiver=(Fault("spoofed", "", 10, 20),))
    with pytest.raises(InputError, match="spoofed"):
        simulate(CONFIG, wrong, seed=SEED)


# ------------------------------------------------------------------ configuration


@pytest.mark.parametrize(
    ("changed", "message"),
    [
        ({"odometry": OdometryConfig()}, r"odometry\.satellite_markers must be true: without positions of satellites"),
        ({"guard": GuardConfig(period_ms=200)}, r"guard\.period_ms is 200, but the vehicle's is 100 \(odometry\)"),
        ({"guard": GuardConfig(max_speed_mm_s=40_000)}, r"guard\.max_speed_mm_s is 40000, but the vehicle's is 44445"),
        (
            {"guard": GuardConfig(brake_mm_s2=2_501)},
            r"odometry\.max_acceleration_mm_s2 2500 is below the 2501 that guard",
        ),
        (
            {
                "odometry": OdometryConfig(satellite_markers=True, position_limit_mm=132_199),
                "guard": GuardConfig(position_limit_mm=132_199),
            },
            r"odometry\.position_limit_mm 132199 is below 132200, by which the guard's window",
        ),
    ],
)
def test_figures_that_do_not_fit_are_refused(changed: dict[str, object], message: str) -> None:
    """One vehicle has one cycle, one speed and one line; the message says what to do."""
    with pytest.raises(ValidationError, match=message):
        MarkerDeviceConfig(**changed)  # type: ignore[arg-type]


def test_figures_at_their_limits_are_taken() -> None:
    """The strongest brake that odometry's gate knows, and the shortest line."""
    line = {"position_limit_mm": 132_200}
    MarkerDeviceConfig(guard=GuardConfig(brake_mm_s2=2_500))
    MarkerDeviceConfig(odometry=OdometryConfig(satellite_markers=True, **line), guard=GuardConfig(**line))


def test_the_first_state_is_that_of_a_vehicle_at_rest() -> None:
    """The antenna is behind end A, where the guard's world has it too."""
    first = first_state(CONFIG)
    assert first["antenna_nm"] == first["truth_nm"] - CONFIG.antenna_mm * NM_PER_MM


def test_without_the_guard_no_position_of_satellites_is_taken() -> None:
    """The composition without a receiver refuses the option, with the one that checks them."""
    with pytest.raises(InputError, match=r"satellite_markers must be false here: .*marker_device has the guard"):
        supervised_odometry.compose_machines(OdometryConfig(satellite_markers=True))
