"""Statements whose result nobody reads are left out, and no others."""

from __future__ import annotations

from safeloc.codegen.dead_code import live
from safeloc.codegen.naming_terms import Text
from safeloc.codegen.nested_statements import Bind, Block, Choice, End
from safeloc.codegen.nested_statements import Test as Branch


def text(code: str, *uses: str) -> Text:
    """Code that reads the names."""
    return Text(code, frozenset(uses))


def bind(name: str, code: str, *uses: str) -> Bind:
    """A number with a name."""
    return Bind(name, text(code, *uses), False)


def test_names_that_are_not_read_are_left_out() -> None:
    """Also those that only such names read."""
    block: Block = [
        bind("a", "x + 1", "x"),
        bind("b", "a * 2", "a"),
        bind("c", "x - 1", "x"),
        End((text("c", "c"),)),
    ]
    assert live(block) == [bind("c", "x - 1", "x"), End((text("c", "c"),))]


def test_what_a_branch_reads_is_kept() -> None:
    """In tests, in branches, and behind them."""
    inner: Block = [End((text("a", "a"),))]
    block: Block = [
        bind("a", "x", "x"),
        bind("t", "y", "y"),
        bind("b", "z", "z"),
        Branch(text("t > 0", "t"), inner),
        End((text("b", "b"),)),
    ]
    assert live(block) == block


def test_a_choice_gives_what_is_needed_only() -> None:
    """A choice keeps the names that are read behind it; one that gives none of them is left out."""

    def choice(*, extra: bool) -> Choice:
        more: list[Bind] = [bind("unread", "1")] if extra else []
        return Choice(((text("t", "t"), [bind("a", "1"), *more]),), [bind("a", "2"), *more])

    ended = End((text("a", "a"),))
    assert live([choice(extra=True), ended]) == [choice(extra=False), ended]
    assert live([bind("t", "x", "x"), choice(extra=True), End((text("x", "x"),))]) == [End((text("x", "x"),))]


def test_what_is_read_is_not_looked_up_in_the_code() -> None:
    """A name that the code happens to contain, without reading it, keeps nothing alive."""
    assert live([bind("a", "1"), End((text("a"),))]) == [End((text("a"),))]
