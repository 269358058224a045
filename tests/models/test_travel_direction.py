"""Direction of travel from the models before and after a balise: what states it, and what does not."""

from __future__ import annotations

from dataclasses import replace

import pytest

from safeloc.language.expr import FALSE
from safeloc.language.interpret import run
from safeloc.language.machine import Machine
from safeloc.language.spec import Property
from safeloc.language.system import lower, without_ghosts
from safeloc.language.trace import Trace
from safeloc.language.verdict import word
from safeloc.models.travel_direction import TravelDirection, build, machine, parts
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import obligations
from safeloc.proof.provers.portfolio import prove
from safeloc.properties.travel_direction import properties
from safeloc.runtime.streams.steps import Cell
from tests.models.everything_proved import shipped_runs
from tests.models.inductive import changed, inductive

ON_BOARD = without_ghosts(lower(machine()))


def step(passed: str = "NONE", ahead: str = "NONE", balise: str = "", *, backwards: bool = False) -> dict[str, Cell]:
    """One cycle; `balise` names the map's models before and after it, such as "AB"."""
    return {
        "passed_model": passed,
        "ahead_model": ahead,
        "balise_read": bool(balise),
        "model_before": balise[0] if balise else "NONE",
        "model_after": balise[1] if balise else "NONE",
        "backwards": backwards,
        "route_direction": "ALONG",
    }


def stated(*steps: dict[str, Cell]) -> list[str]:
    """The direction after every step."""
    trace: Trace = run(ON_BOARD, steps)
    unit = trace.system.outputs["direction"].unit
    return [str(unit.members[one.outputs["direction"]]) for one in trace.steps]


@pytest.mark.parametrize(("first", "second", "direction"), [("A", "B", "ALONG"), ("B", "A", "AGAINST")])
def test_both_models_tell(first: str, second: str, direction: str) -> None:
    """A before, B behind: along; the other way round: against, which contradicts the route."""
    steps = [step(passed=first), step(balise="AB"), step(ahead=second)]
    assert stated(*steps) == ["UNKNOWN", "UNKNOWN", direction]
    assert run(ON_BOARD, steps).steps[-1].outputs["contradicts"] is (direction == "AGAINST")


@pytest.mark.parametrize(
    "steps",
    [
        [step(balise="AB"), step(ahead="B")],
        [step(passed="A"), step(balise="AA"), step(ahead="A")],
        [step(passed="C"), step(balise="AB"), step(ahead="B")],
        [step(passed="A"), step(balise="AB"), step(ahead="C")],
        [step(passed="A"), step(balise="AB"), step(passed="A", ahead="A")],
        [step(passed="A"), step(balise="AB"), step(balise="CD"), step(ahead="B")],
        [step(passed="A"), step(balise="AB"), step(backwards=True), step(ahead="B")],
        [step(passed="A"), step(backwards=True), step(balise="AB"), step(ahead="B")],
    ],
    ids=["nothing passed", "equal models", "foreign before", "foreign after", "same on both sides", "two balises",
         "turned after", "turned before"],
)  # fmt: skip
def test_nothing_is_stated(steps: list[dict[str, Cell]]) -> None:
    """One balise alone, or models that do not fit in this order, state no direction."""
    assert set(stated(*steps)) == {"UNKNOWN"}


def test_a_stated_direction_stays_until_contradicted() -> None:
    """Later balises that agree change nothing; one that fits the other direction takes the statement back."""
    known = [step(passed="A"), step(balise="AB"), step(ahead="B")]
    assert stated(*known, step(passed="B"), step(balise="BC"), step(ahead="C"))[2:] == ["ALONG"] * 4
    assert stated(*known, step(passed="B"), step(balise="CB"))[-1] == "UNKNOWN"
    assert stated(*known, step(backwards=True))[-1] == "UNKNOWN"


def made() -> TravelDirection:
    """The machine with its variables."""
    return build(parts())


@pytest.mark.thorough
def test_everything_is_proved() -> None:
    """All properties and obligations, without bound."""
    whole = made()
    system = lower(whole.machine)
    known = shipped_runs("travel_direction")
    found = [
        *prove(system, properties(whole), Limits(seconds=30), jobs=1, **known),
        *obligations(system, Limits(seconds=30), **known),
    ]
    assert {one.id: word(one.result) for one in found if word(one.result) != "proved"} == {}


@pytest.mark.parametrize(
    ("transition", "target", "broken"),
    [
        ("fits along", "ALONG", "along is along"),
        ("confirmed against", "ALONG", "along is along"),
        ("confirmed along", "AGAINST", "against is against"),
        ("refuted", "ALONG", "along is along"),
        ("stay half", "AGAINST", "against is against"),
    ],
)
def test_a_wrong_row_is_noticed(transition: str, target: str, broken: str) -> None:
    """A direction taken for the other one, or stated on one model alone, is found."""
    whole = made()
    modes = {mode.label: mode for mode in whole.machine.modes}
    wrong = changed(whole.machine, transition, target=modes[target])
    assert not inductive(wrong, _named(whole, wrong, "direction is true"), broken)


def test_a_forgotten_turn_is_noticed() -> None:
    """A vehicle that turned and goes on stating its direction is found."""
    whole = made()
    wrong = changed(whole.machine, "turned", when=FALSE)
    assert not inductive(wrong, _named(whole, wrong, "turning forgets"), "turning forgets")


def _named(whole: TravelDirection, wrong: Machine, name: str) -> Property:
    return next(prop for prop in properties(replace(whole, machine=wrong)) if prop.name == name)
