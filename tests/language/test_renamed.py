"""Renamed things: an old name is refused, and the message gives the new one; for keywords also file and line."""

from __future__ import annotations

import inspect
import re
from collections.abc import Callable
from dataclasses import replace

import pytest

from safeloc.errors import InputError, ModelError, PropertyError, SafelocError
from safeloc.language.composition import compose
from safeloc.language.expr import TRUE, boolean, number
from safeloc.language.interpret import run, start
from safeloc.language.machine import Machine, Transition, current_mode, modes
from safeloc.language.renamed import hint, name_now, renamed
from safeloc.language.spec import Property, always, never, reachable, within
from safeloc.language.system import lower
from safeloc.language.units import MM
from safeloc.railway.pictures import Approach
from safeloc.reported import Reported

ON, OFF = modes("ON", "OFF")
GO = Transition("go", ON, OFF, requirements=("R-1",))

OLD: dict[str, tuple[Callable[[], object], type[SafelocError], str]] = {
    "owes": (
        lambda: compose("both", [], {}, owes=[]),  # type: ignore[call-arg] # that is the slip
        ModelError,
        "compose: the keyword 'owes' is now 'discharge'; write discharge=.",
    ),
    "mode variable of a machine": (
        lambda: Machine("m", (ON, OFF), [], {}, {}, [GO], mode_variable=current_mode((ON, OFF))),  # type: ignore[call-arg]
        ModelError,
        "Machine: there is no keyword 'mode_variable' any more; write modes=table alone: current_mode(table) is the variable "
        "of every machine with these modes.",
    ),
    "trace of a transition": (
        lambda: Transition("go", ON, ON, trace=("R-1",)),  # type: ignore[call-arg]
        ModelError,
        "Transition: the keyword 'trace' is now 'requirements'; write requirements=.",
    ),
    "trace of a transition that is changed": (
        lambda: replace(GO, trace=("R-1",)),  # type: ignore[call-arg]
        ModelError,
        "Transition: the keyword 'trace' is now 'requirements'; write requirements=.",
    ),
    "trace of a property": (
        lambda: Property("on", "always", TRUE, trace=("R-1",)),  # type: ignore[call-arg]
        PropertyError,
        "Property: the keyword 'trace' is now 'requirements'; write requirements=.",
    ),
    "trace of always": (
        lambda: always("on", TRUE, trace=("R-1",)),  # type: ignore[call-arg]
        PropertyError,
        "always: the keyword 'trace' is now 'requirements'; write requirements=.",
    ),
    "trace of never": (
        lambda: never("on", TRUE, trace=("R-1",)),  # type: ignore[call-arg]
        PropertyError,
        "never: the keyword 'trace' is now 'requirements'; write requirements=.",
    ),
    "trace of within": (
        lambda: within("on", 3, TRUE, TRUE, trace=("R-1",)),  # type: ignore[call-arg]
        PropertyError,
        "within: the keyword 'trace' is now 'requirements'; write requirements=.",
    ),
    "trace of reachable": (
        lambda: reachable("on", TRUE, trace=("R-1",)),  # type: ignore[call-arg]
        PropertyError,
        "reachable: the keyword 'trace' is now 'requirements'; write requirements=.",
    ),
    "given of Property": (
        lambda: Property("on", "always", TRUE, given=TRUE),  # type: ignore[call-arg]
        PropertyError,
        "Property: the keyword 'given' is now 'further_assumption'; write further_assumption=.",
    ),
    "given of always": (
        lambda: always("on", TRUE, given=TRUE),  # type: ignore[call-arg]
        PropertyError,
        "always: the keyword 'given' is now 'further_assumption'; write further_assumption=.",
    ),
    "given of never": (
        lambda: never("on", TRUE, given=TRUE),  # type: ignore[call-arg]
        PropertyError,
        "never: the keyword 'given' is now 'further_assumption'; write further_assumption=.",
    ),
    "given of within": (
        lambda: within("on", 3, TRUE, TRUE, given=TRUE),  # type: ignore[call-arg]
        PropertyError,
        "within: the keyword 'given' is now 'further_assumption'; write further_assumption=.",
    ),
    "over of an interval's names": (
        lambda: Reported(over="over_mm"),  # type: ignore[call-arg]
        ModelError,
        "Reported: the keyword 'over' is now 'above'; write above=.",
    ),
    "under of an interval's names": (
        lambda: replace(Reported(), under="under_mm"),  # type: ignore[call-arg]
        ModelError,
        "Reported: the keyword 'under' is now 'below'; write below=.",
    ),
    "over of a picture": (
        lambda: Approach(title="approach", over="over_mm"),  # type: ignore[call-arg]
        ModelError,
        "Approach: the keyword 'over' is now 'above'; write above=.",
    ),
    "given of reachable": (
        lambda: reachable("on", TRUE, given=TRUE),  # type: ignore[call-arg]
        PropertyError,
        "reachable: the keyword 'given' is now 'further_assumption'; write further_assumption=.",
    ),
}


OF_THE_WORLD = {
    "ghosts": "world=World(ghosts=...)",
    "ghost_inputs": "world=World(choices=...)",
    "ghost_moves": "world=World(moves=...)",
    "assumption": "world=World(clauses={name: ...})",
    "clauses": "world=World(clauses={name: ...})",
}


@pytest.mark.parametrize("old", OF_THE_WORLD)
def test_what_is_of_the_world_is_refused_of_a_machine(old: str) -> None:
    """The message names file and line, and shows what to write."""
    message = f"Machine: there is no keyword {old!r} any more; write {OF_THE_WORLD[old]}."
    with pytest.raises(ModelError, match=rf"^\S*test_renamed\.py:\d+: {re.escape(message)}$"):
        Machine("m", (ON, OFF), [], {}, {}, [GO], **{old: {}})  # type: ignore[arg-type] # that is the slip


@pytest.mark.parametrize("old", OLD)
def test_an_old_keyword_is_refused_with_the_new_one(old: str) -> None:
    """The message names file, line, and the new keyword."""
    declare, error, message = OLD[old]
    with pytest.raises(error, match=rf"^\S*test_renamed\.py:\d+: {re.escape(message)}$"):
        declare()


def test_what_is_declared_keeps_its_name_and_its_parameters() -> None:
    """A guarded function or class keeps its name, signature and docstring."""
    assert "compose" == compose.__name__
    assert "Combine several machines into one TransitionSystem." == (compose.__doc__ or "").splitlines()[0]
    assert "discharge" in inspect.signature(compose).parameters


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("over_mm", "margin_above_mm"),
        ("under_nm", "margin_below_nm"),
        ("front_wheel_over_nm", "front_wheel_margin_above_nm"),
        ("verification.fibre_under_mm", "verification.fibre_margin_below_mm"),
    ],
)
def test_the_sides_of_an_interval_have_new_names(old: str, new: str) -> None:
    """Alone, behind other words, and behind a machine's name."""
    assert new == name_now(old)
    assert f"; {old!r} is now {new!r}" == renamed([old], [new])


@pytest.mark.parametrize(
    "name", ["margin_above_mm", "overlap_mm", "handover_mm", "overrun_mm", "over_s", "over", "rover_mm"]
)
def test_other_words_are_left(name: str) -> None:
    """Names that merely resemble old ones are unchanged."""
    assert name == name_now(name)
    assert "" == renamed([name], [name])


def test_a_name_of_somebody_elses_is_not_corrected() -> None:
    """An old name counts as one only where there is something of the new name, and nothing of the old."""
    assert "" == renamed(["over_mm"], ["height_mm"])
    assert "" == renamed(["over_mm"], ["over_mm", "margin_above_mm"])


def test_what_is_told_in_parts_now_names_both() -> None:
    """The level of a solution, whose error the machine adds itself: with the machine's name, and only where there are the parts."""
    parts = ["position.fix_dilution_permille", "position.fix_further_mm"]
    told = (
        "; 'position.fix_protection_mm' is replaced by 'position.fix_dilution_permille' and 'position.fix_further_mm'"
    )
    assert told == renamed(["position.fix_protection_mm"], parts)
    assert "" == renamed(["fix_protection_mm"], parts)


def test_a_hint_says_the_new_name_or_the_nearest_one() -> None:
    """Or nothing, where nothing is near."""
    assert " 'over_mm' is now 'margin_above_mm'." == hint("over_mm", ["margin_above_mm"])
    assert " Did you mean 'speed_mm_s'?" == hint("sped_mm_s", ["speed_mm_s"])
    assert "" == hint("colour", ["speed_mm_s"])


TOLD, SEEN = boolean("told"), number("seen_margin_below_mm", MM, 0, 9)
ABOVE = number("margin_above_mm", MM, 0, 9)
GATE = Machine(
    name="gate",
    modes=[ON, OFF],
    inputs=[TOLD, SEEN],
    state={ABOVE: 0},
    outputs={"margin_above_mm": ABOVE, "told_before": ABOVE.eq(0)},
    transitions=[Transition("go", ON, OFF, TOLD, {ABOVE: SEEN})],
)


@pytest.mark.parametrize(
    ("ask", "message"),
    [
        (
            lambda: GATE.output("over_mm"),
            "gate has no output 'over_mm'; it has margin_above_mm, told_before. 'over_mm' is now 'margin_above_mm'.",
        ),
        (lambda: GATE.flag("told_befor"), "it has margin_above_mm, told_before. Did you mean 'told_before'?"),
        (lambda: lower(GATE).variable("over_mm"), "'seen_margin_below_mm']. 'over_mm' is now 'margin_above_mm'."),
    ],
)
def test_what_is_looked_up_by_an_old_name_is_told_the_new_one(ask: Callable[[], object], message: str) -> None:
    """Outputs and variables of a machine."""
    with pytest.raises(KeyError) as raised:
        ask()
    assert raised.value.args[0].endswith(message)


def test_inputs_and_first_values_by_old_names_are_refused() -> None:
    """Also where the input is missed before the name that nobody knows is seen."""
    wrong = r"^gate: input 'seen_margin_below_mm' is missing; .*; 'seen_under_mm' is now 'seen_margin_below_mm'\.$"
    with pytest.raises(InputError, match=wrong):
        run(lower(GATE), [{"told": True, "seen_under_mm": 3}])
    beside = r"^gate: unknown inputs \['seen_under_mm'\]; 'seen_under_mm' is now 'seen_margin_below_mm'\.$"
    with pytest.raises(InputError, match=beside):
        run(lower(GATE), [{"told": True, "seen_under_mm": 3, "seen_margin_below_mm": 3}])
    first = r"^gate: unknown state variables \['over_mm'\]; 'over_mm' is now 'margin_above_mm'\.$"
    with pytest.raises(InputError, match=first):
        start(lower(GATE), {"over_mm": 3})


def test_a_keyword_that_is_not_taken_is_told_with_those_that_are() -> None:
    """And with the nearest one, if one is near."""
    (mode,) = modes("A")
    with pytest.raises(
        ModelError,
        match=r"Transition takes no 'updates'; it takes name, source, target, when, set, requirements, rank\.$",
    ):
        Transition("go", mode, mode, updates={})  # type: ignore[call-arg]
    with pytest.raises(ModelError, match=r"Transition takes no 'requirement'; .* Did you mean 'requirements'\?"):
        Transition("go", mode, mode, requirement=())  # type: ignore[call-arg]


def test_a_missing_argument_is_pythons_own_error() -> None:
    """Only keywords are checked: a call that lacks an argument gets the ordinary message, with the argument's name."""
    with pytest.raises(TypeError, match=r"missing 1 required positional argument: 'term'$"):
        always("P")  # type: ignore[call-arg]
