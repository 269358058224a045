"""Coupling and material of a section: which sections make a position signal, and which fibre makes none."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import pytest
from pydantic import ValidationError

from safeloc.language.expr import FALSE
from safeloc.language.interpret import run
from safeloc.language.system import lower
from safeloc.language.trace import Trace
from safeloc.language.world import World
from safeloc.models.fibre import CoupledConfig, Fibre, build, build_coupled, parts
from safeloc.models.fibre.coupled_runs import RUNS
from safeloc.properties.fibre.coupled import properties
from safeloc.runtime.streams.steps import read_steps
from tests.models.fibre_family import labels
from tests.models.inductive import changed, inductive
from tests.shipped_recordings import shipped

CONFIG = CoupledConfig()
SPREAD_CDB = CONFIG.unevenness_cdb + CONFIG.material_spread_cdb + CONFIG.reading_error_cdb
MADE = ("BESIDE", "COUPLED", "DAMPED", "MORE_SENSITIVE", "LESS_SENSITIVE", "ELSEWHERE")


@cache
def made() -> Fibre:
    """The machine in the world of coupling and material."""
    return build_coupled(parts(CONFIG), CONFIG)


def recorded(name: str) -> Trace:
    """A recording, with its ghosts."""
    return run(lower(made().machine), list(read_steps(shipped(name)).steps))


@pytest.mark.parametrize("name", RUNS)
def test_a_recording_is_its_run(name: str) -> None:
    """What ships is what the named run makes."""
    assert list(RUNS[name].steps(CONFIG)) == [dict(step) for step in read_steps(shipped(name)).steps]


def test_every_making_makes_one_signal() -> None:
    """Rods, dampers, a more and a less sensitive guide: a signal for each section that was run into, and none else."""
    trace = recorded("fibre_coupled-every-making")
    signals = [event == "POSITION_SIGNAL" for event in labels(trace, "section_event")]
    lay = [MADE[step.state["section_last_received"]] for step in trace.steps]
    entered = [now != "BESIDE" and before == "BESIDE" for before, now in zip(["BESIDE", *lay], lay, strict=False)]
    assert entered == signals
    assert {*MADE} - {"ELSEWHERE"} == set(lay)


def test_turning_back_in_a_section() -> None:
    """Counted, uncounted, and counted again: each entry is one signal."""
    events = labels(recorded("fibre_coupled-turned-back"), "section_event")
    assert ["POSITION_SIGNAL", "TURNED_BACK", "POSITION_SIGNAL"] == [one for one in events if one != "NONE"]


@pytest.mark.parametrize("figure", ["coupling_gain_cdb", "damper_loss_cdb", "material_gain_cdb", "material_loss_cdb"])
def test_the_weakest_section_that_cannot_be_missed(figure: str) -> None:
    """One hundredth of a dB less, and it is refused."""
    least = CONFIG.change_cdb + SPREAD_CDB
    assert least == getattr(CoupledConfig(**{figure: least}), figure)
    with pytest.raises(ValidationError, match=rf"{figure} \({least - 1}\) .* such a section could be missed"):
        CoupledConfig(**{figure: least - 1})


def test_uneven_fibre_is_refused() -> None:
    """Fibre beside the sections may not differ by more than what is normal."""
    more = CONFIG.return_cdb - SPREAD_CDB + 1
    with pytest.raises(ValidationError, match=r"the fibre beside the sections would look like one"):
        CoupledConfig(unevenness_cdb=CONFIG.unevenness_cdb + more)


def _without(law: str) -> Fibre:
    """The machine in a world without one law."""
    whole = made().machine
    world = World(
        whole.world.ghosts, whole.world.choices, whole.world.moves,
        {name: one for name, one in whole.world.clauses.items() if name != law},
    )  # fmt: skip
    return replace(made(), machine=replace(whole, world=world))


@pytest.mark.parametrize(
    "law",
    [
        "coupling decides how much vibration reaches the fibre",
        "material decides how the guide answers to it",
        "the amplitude is vibration and answer together",
    ],
)
def test_each_law_is_needed(law: str) -> None:
    """Without it a section can be entered without a signal, and a signal can come beside the sections."""
    model = _without(law)
    lost = {one.name for one in properties(model) if not inductive(model.machine, one, one.name)}
    assert {"beside the sections the amplitude is normal", "no signal without a section"} <= lost
    assert "a section that is entered makes a signal" in lost


@pytest.mark.parametrize(
    ("row", "broken"),
    [
        ("first signal", "a section that is entered makes a signal"),
        ("signal counted", "a section that is entered makes a signal"),
    ],
)
def test_a_broken_row_is_noticed(row: str, broken: str) -> None:
    """A machine that lets a rise or a fall pass loses the proof."""
    wrong = replace(made(), machine=changed(made().machine, row, when=FALSE))
    (prop,) = [one for one in properties(wrong) if one.name == broken]
    assert not inductive(wrong.machine, prop, broken)


def test_claims_need_their_world() -> None:
    """The machine in its other world is refused."""
    with pytest.raises(TypeError, match="hand in what build_coupled returns"):
        properties(build(parts(CONFIG)))


@pytest.mark.thorough
@pytest.mark.parametrize("config", [CONFIG, CoupledConfig(coupling_gain_cdb=1_100, damper_loss_cdb=1_100)])
def test_everything_is_proved(config: CoupledConfig) -> None:
    """Each claim is inductive with the lemmas, also of sections as weak as may be."""
    model = build_coupled(parts(config), config)
    claims = [one for one in properties(model) if one.kind == "always"]
    assert 6 == len(claims)
    assert [] == [one.name for one in claims if not inductive(model.machine, one)]
