"""Statements as C: names are declared once, in the scope that all their readers share."""

from __future__ import annotations

from safeloc.codegen.c99_layout import Field
from safeloc.codegen.c99_statements import given, given_names, statements, used
from safeloc.codegen.c99_step import _Slot, _writing
from safeloc.codegen.naming_terms import Text
from safeloc.codegen.nested_statements import Bind, Block, Choice, End
from safeloc.codegen.nested_statements import Test as Branch

SLOT = _Slot("state", Field("x", "x", "int64_t", 0, 9, ""), "x")


def text(code: str, *uses: str) -> Text:
    """Code that reads the names."""
    return Text(code, frozenset(uses))


def choice(name: str) -> Choice:
    """One name, given in either branch; one more in the first."""
    first: Block = [Bind("t9", text("a + 1", "a"), False), Bind(name, text("t9", "t9"), False)]
    return Choice(((text("a > 0", "a"), first),), [Bind(name, text("0"), False)])


def test_a_choice_declares_what_every_branch_gives() -> None:
    """A name that only one branch needs is declared in that branch."""
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
    block: Block = [
        Bind("t1", text("a * 2", "a"), False),
        Branch(text("a > 3", "a"), [End((text("t1", "t1"),))]),
        End((text("t1", "t1"),)),
    ]
    code = _writing(block, [SLOT]).code
    assert code.count("state->x = t1;") == 1
    assert code.index("state->x = t1;") < code.index("if (a > 3)")


def test_a_name_that_branches_give_by_themselves_is_written_in_each() -> None:
    """One name in two branches is two values, though it reads alike."""
    ended = End((text("next_x", "next_x"),))
    block: Block = [Branch(text("a > 3", "a"), [choice("next_x"), ended]), choice("next_x"), ended]
    code = _writing(block, [SLOT]).code
    assert code.count("state->x = next_x;") == 2
    assert code.index("if (a > 3)") < code.index("state->x = next_x;")


def test_what_is_read_and_called_is_known_without_looking_at_the_code() -> None:
    """Of everything that is written: tests, values, branches, and what is done at the end of them."""
    block: Block = [
        Branch(text("a > 3", "a"), [End((text("floor_div(b, 2)", "floor_div", "b"),))]),
        choice("next_x"),
        End((text("next_x", "next_x"),)),
    ]
    assert used(block, lambda values: values) == {"a", "b", "floor_div", "t9", "next_x"}
    assert _writing(block, [SLOT]).uses == {"a", "b", "floor_div", "t9", "next_x", "state"}
    assert _writing([End((text("x", "x"),))], [SLOT]).uses == set()


def test_long_lines_go_on_indented() -> None:
    """Text stays within the width, broken at spaces only."""
    value = " + ".join(f"quantity_{n}_mm" for n in range(12))
    block: Block = [Bind("t1", text(value), False), End((text("t1", "t1"),))]
    lines = statements(block, lambda values: [values[0].within("return ", ";")]).splitlines()
    assert len(lines) == 3
    assert max(map(len, lines)) <= 118
    assert " ".join(part.strip() for part in lines[:2]) == f"const int64_t t1 = {value};"
