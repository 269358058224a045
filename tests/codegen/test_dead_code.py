"""Statements whose result nobody reads are left out, and no others."""

from __future__ import annotations

from safeloc.codegen.dead_code import live
from safeloc.codegen.nested_statements import Bind, Block, Choice, End
from safeloc.codegen.nested_statements import Test as Branch


def bind(name: str, value: str) -> Bind:
    """A number with a name."""
    return Bind(name, value, False)


def test_names_that_are_not_read_are_left_out() -> None:
    """Also those that only such names read."""
    block: Block = [bind("a", "x + 1"), bind("b", "a * 2"), bind("c", "x - 1"), End(("c",))]
    assert live(block) == [bind("c", "x - 1"), End(("c",))]


def test_what_a_branch_reads_is_kept() -> None:
    """In tests, in branches, and behind them."""
    inner: Block = [End(("a",))]
    block: Block = [bind("a", "x"), bind("t", "y"), bind("b", "z"), Branch("t > 0", inner), End(("b",))]
    assert live(block) == block


def test_a_choice_gives_what_is_needed_only() -> None:
    """A choice keeps the names that are read behind it; one that gives none of them is left out."""

    def choice(*, extra: bool) -> Choice:
        more: list[Bind] = [bind("unread", "1")] if extra else []
        return Choice((("t", [bind("a", "1"), *more]),), [bind("a", "2"), *more])

    assert live([choice(extra=True), End(("a",))]) == [choice(extra=False), End(("a",))]
    assert live([bind("t", "x"), choice(extra=True), End(("x",))]) == [End(("x",))]
