"""What may be asked of a tube, and what is refused: unknown names get candidates."""

from __future__ import annotations

import pytest

from safeloc.errors import InputError
from safeloc.language.expressions import condition
from safeloc.language.system import lower
from safeloc.language.written_claims import signals
from safeloc.proof.around.claims import written_claim
from safeloc.proof.around.deviations import deviations
from tests.examples import doors
from tests.proof.around.small import machine

SYSTEM = lower(machine())


@pytest.mark.parametrize(
    ("widths", "drops", "delays", "said"),
    [
        ({"distnce_mm": 1}, {}, {}, "--within: integrator has no input 'distnce_mm'; it has distance_mm, fix_mm. Did you mean 'distance_mm'?"),
        ({"place_mm": 1}, {}, {}, "--within: integrator has no input 'place_mm' (it is a state variable, no input); it has distance_mm, fix_mm. Did you mean 'distance_mm'?"),
        ({"fix_mm.present": 1}, {}, {}, "--within: integrator has no input 'fix_mm.present'; it has distance_mm, fix_mm. Did you mean 'fix_mm'?"),
        ({}, {"distance_mm": 1}, {}, "--drop distance_mm: distance_mm is never absent, so no value of it can be missing."),
        ({}, {"fixx_mm": 1}, {}, "--drop: integrator has no input 'fixx_mm'; it has distance_mm, fix_mm. Did you mean 'fix_mm'?"),
        ({}, {"fix_mm+fix_mm": 1}, {}, "--drop fix_mm+fix_mm: an input is named twice."),
        (
            {}, {}, {"distance_mm+fix_mm": 1},
            "--delay distance_mm+fix_mm: distance_mm is never absent and the others may be, so they come in no one message; "
            "give each a --delay of its own.",
        ),
        (
            {}, {"fix_mm": 1}, {"distance_mm": 1, "fix_mm+distance_mm": 1},
            "--delay fix_mm+distance_mm: distance_mm is never absent and the others may be, so they come in no one message; "
            "give each a --delay of its own.",
        ),
    ],
)  # fmt: skip
def test_deviations_that_no_input_has(
    widths: dict[str, int], drops: dict[str, int], delays: dict[str, int], said: str
) -> None:
    """Each is refused with what is wrong and what to do."""
    with pytest.raises(InputError) as refused:
        deviations(SYSTEM, widths, drops, delays)
    assert str(refused.value) == said


def test_a_truth_value_and_a_member_have_no_width() -> None:
    """They may come late."""
    system = doors().system
    with pytest.raises(InputError, match="obstructed: it is true or false and has no width"):
        deviations(system, {"obstructed": 1}, {}, {})
    with pytest.raises(InputError, match="command: it is one of NOTHING, TO_OPEN, TO_CLOSE and has no width"):
        deviations(system, {"command": 1}, {}, {})
    assert deviations(system, {}, {}, {"command": 1}).channels[0].delay == 1


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("", "an empty condition; write one, such as valid and margin_mm <= 1000."),
        ("place_mm", "'place_mm' is a number; a condition is wanted, such as place_mm <= 100."),
        ("(place_mm < 3", "'(place_mm < 3': a parenthesis is not closed."),
        ("place_mm <", "'place_mm <': something is missing at the end."),
        ("place_mm < 3 4", "'place_mm < 3 4': 4 is too much."),
        ("place_mm and true", "'place_mm and true': a number is neither true nor false."),
        ('mode = "RUNING"', "'mode = \"RUNING\"': \"RUNING\" is no member; there are RUNNING. Did you mean 'RUNNING'?"),
        ("place_mm ? 3", "'place_mm ? 3': not understood from '? 3'."),
        ("age_cycles < place_mm", "'age_cycles < place_mm': cannot compare count and mm. They are of different kinds; with_unit(term, unit) says that a number of one kind stands for one of the other."),
        ("< 3", "'< 3': < has nothing before it."),
    ],
)  # fmt: skip
def test_conditions_that_say_nothing(text: str, said: str) -> None:
    """Each is refused with the text and what is wrong with it."""
    with pytest.raises(InputError) as refused:
        condition(text, signals(SYSTEM))
    assert str(refused.value) == said


def test_an_unknown_name_gets_candidates() -> None:
    """All names are listed, and the nearest is suggested."""
    with pytest.raises(
        InputError, match=r"there is no 'plce_mm'; there are distance_mm, .*out_mm\. Did you mean 'place_mm'\?$"
    ):
        condition("plce_mm < 3", signals(SYSTEM))


@pytest.mark.parametrize(
    ("text", "term"),
    [
        ("place_mm + 2 * age_cycles * 0 <= 3", None),
        ("not place_mm < 3 and true", "(not (< place_mm 3))"),
        ("place_mm < 3 or place_mm = 4 and age_cycles != 5", "(or (< place_mm 3) (and (== place_mm 4) (not (== age_cycles 5))))"),
        ("-place_mm + 3 >= -4", "(<= -4 (+ (- 0 place_mm) 3))"),
    ],
)  # fmt: skip
def test_conditions_are_read_as_they_bind(text: str, term: str | None) -> None:
    """`or` binds least, then `and`, `not`, comparisons, sums, products; units are checked."""
    if term is None:
        with pytest.raises(InputError):
            condition(text, signals(SYSTEM))
    else:
        assert repr(condition(text, signals(SYSTEM)).term) == term


def test_an_absent_value_makes_no_claim() -> None:
    """A claim that reads an optional input is judged where it is present."""
    claim = written_claim(SYSTEM, "fix_mm <= 3", 1, None)
    assert repr(claim.prop.term) == "(or (not fix_mm.present) (<= fix_mm 3))"
