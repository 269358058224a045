"""Statements as C: names are declared once, in the scope that all their readers share."""

from __future__ import annotations

from safeloc.codegen.c99_layout import Field
from safeloc.codegen.c99_statements import given, given_names, statements
from safeloc.codegen.c99_step import _Slot, _writing
from safeloc.codegen.nested_statements import Bind, Block, Choice, End
from safeloc.codegen.nested_statements import Test as Branch

SLOT = _Slot("state->x", Field("x", "x", "int64_t", 0, 9, ""), "x")


def choice(name: str) -> Choice:
    """One name, given in either branch; one more in the first."""
    first: Block = [Bind("t9", "a + 1", False), Bind(name, "t9", False)]
    return Choice((("a > 0", first),), [Bind(name, "0", False)])


def test_a_choice_declares_what_every_branch_gives() -> None:
    """What one branch needs for itself is declared there."""
    assert given(choice("t1")) == {"t1": False}
    assert list(given_names([choice("t1")])) == ["t9", "t1", "t1"]
    assert statements([choice("t1")], lambda _: []).splitlines() == [
        "    int64_t t1;",
        "    if (a > 0) {",
        "        const int64_t t9 = a + 1;",
        "        t1 = t9;",
        "    } else {",
        "        t1 = 0;",
        "    }",
    ]


def test_what_branches_write_alike_is_written_before_they_part() -> None:
    """A value that has its name there already."""
    block: Block = [Bind("t1", "a * 2", False), Branch("a > 3", [End(("t1",))]), End(("t1",))]
    text = _writing(block, [SLOT])
    assert text.count("state->x = t1;") == 1
    assert text.index("state->x = t1;") < text.index("if (a > 3)")


def test_a_name_that_branches_give_by_themselves_is_written_in_each() -> None:
    """One name in two branches is two values, though it reads alike."""
    block: Block = [Branch("a > 3", [choice("next_x"), End(("next_x",))]), choice("next_x"), End(("next_x",))]
    text = _writing(block, [SLOT])
    assert text.count("state->x = next_x;") == 2
    assert text.index("if (a > 3)") < text.index("state->x = next_x;")


def test_long_lines_go_on_indented() -> None:
    """Text stays within the width, broken at spaces only."""
    value = " + ".join(f"quantity_{n}_mm" for n in range(12))
    lines = statements([Bind("t1", value, False), End(("t1",))], lambda values: [f"return {values[0]};"]).splitlines()
    assert len(lines) == 3
    assert max(map(len, lines)) <= 118
    assert " ".join(part.strip() for part in lines[:2]) == f"const int64_t t1 = {value};"
