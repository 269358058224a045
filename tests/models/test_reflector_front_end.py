"""The radar front end and the reflector machine fit together: names, units and thresholds."""

from __future__ import annotations

from safeloc.language.interpret import run
from safeloc.language.system import lower, without_ghosts
from safeloc.models.reflector import machine
from safeloc.models.reflector.step_inputs import completed
from safeloc.models.reflector.variables import ReflectorConfig
from safeloc.models.vocabulary.reflectors import MODEL
from safeloc.sensing.along_track import Delay
from safeloc.sensing.echoes import Echo
from safeloc.sensing.figures import RadarConfig
from safeloc.sensing.radar import Frame
from safeloc.sensing.reflector_inputs import step_inputs
from safeloc.sensing.signature import Doubt, Model

CONFIG, RADAR = ReflectorConfig(), RadarConfig()
STILL = Delay(0, 0, 0, 0)


def echo(model: Model, range_mm: int, intensity_cdb: int) -> Echo:
    """A candidate of the front end."""
    doubt = Doubt.SHAPE if model is Model.UNKNOWN else None
    return Echo(model, doubt, range_mm, 20, 3_000, 300, intensity_cdb, 2_146)


def judged(*echoes: Echo) -> tuple[str, bool]:
    """The first echo's verdict, and whether the self-test passed, at a balise 80 m before reflector A."""
    seen = step_inputs(Frame(0, 0, 0, echoes), RADAR, STILL, CONFIG.echo_slots)
    told = {
        "distance_mm": 0,
        "balise": 7,
        "balise_position_mm": 0,
        "balise_accuracy_mm": 1_000,
        "balise_since_mm": 0,
        "next_position_mm": 80_000,
        "next_model": "A",
        "next_view_from_mm": 100_000,
        "next_view_to_mm": 5_000,
        "next_clear_mm": 1_000_000,
        "next_reference_mm": 80_000,
    }
    trace = run(without_ghosts(lower(machine(CONFIG))), [completed(CONFIG, {**told, **seen.inputs})])
    unit = trace.system.variable("echo_1_last_verdict").unit
    return str(unit.members[trace.steps[-1].state["echo_1_last_verdict"]]), bool(trace.steps[-1].outputs["precise"])


def test_a_frame_becomes_a_position() -> None:
    """An echo of the front end, with clutter beside it, passes the self-test."""
    assert judged(echo(Model.UNKNOWN, 20_000, 7_000), echo(Model.A, 80_000, 4_400)) == ("FITS", True)


def test_the_minimum_intensity_is_one_figure() -> None:
    """What the front end calls the prescribed minimum over noise is the machine's minimum below full scale."""
    assert RADAR.reflectors.minimum_cdb - RADAR.sensor.full_scale_cdb == CONFIG.minimum_intensity_cdb
    assert judged(echo(Model.A, 80_000, RADAR.reflectors.minimum_cdb)) == ("FITS", True)
    assert judged(echo(Model.A, 80_000, RADAR.reflectors.minimum_cdb - 1)) == ("WEAK", False)


def test_every_model_of_the_front_end_is_known() -> None:
    """The models that signatures tell apart are models of the machine."""
    assert {model.value for model in Model if model is not Model.UNKNOWN} <= {model.label for model in MODEL}


def test_the_blind_range_is_one_figure() -> None:
    """Nearer than the radar hears, the machine takes no echo."""
    assert RADAR.sensor.blind_mm == CONFIG.near_range_mm


def test_an_empty_frame() -> None:
    """A frame without echoes is read, and gives nothing."""
    assert judged() == ("NONE", False)
