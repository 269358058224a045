"""The branches that a configuration takes in the Python code that declares a machine.

A configured flag can decide what is declared (`if config.single_fault_safe: ...`), and no term shows that. So the steps from
one instruction to the next are recorded while the machine is built.
"""

from __future__ import annotations

import ast
import dis
import sys
from collections.abc import Callable, Iterator
from functools import cache
from pathlib import Path
from types import CodeType, FrameType
from typing import Any, TypeVar

from safeloc.assurance.source_places import Place, place_of
from safeloc.assurance.splits.observed import Split
from safeloc.assurance.splits.places import declares

_Made = TypeVar("_Made")
_Step = tuple[str, CodeType, int, int]
"""File, code, and the places of two instructions in it; code alone is not enough: it is compared without its file."""
_Deciding = ast.If | ast.IfExp
_RETURNING = {dis.opmap[name] for name in ("RETURN_VALUE", "RETURN_CONST") if name in dis.opmap}
"""Python 3.12 and 3.13 return a constant in one instruction, also the None at the end of a function."""


def steps_of(make: Callable[[], _Made]) -> tuple[_Made, set[_Step]]:
    """Call `make`; return its result, and the steps between instructions of machine, world and claims during the call.

    Python 3.13 reports no instruction of the first call of a function, so there `make` is called twice.
    """
    steps: set[_Step] = set()

    def enter(frame: FrameType, event: str, _: Any) -> Callable[..., Any] | None:
        if event != "call" or not _decided_in(frame.f_code.co_filename, frame.f_code):
            return None
        frame.f_trace_opcodes, frame.f_trace_lines = True, False
        last, code = -2, frame.f_code

        def trace(now: FrameType, what: str, _: Any) -> Callable[..., Any]:
            nonlocal last
            if what == "opcode":
                steps.add((code.co_filename, code, last, now.f_lasti))
                last = now.f_lasti
            return trace

        return trace

    before = sys.gettrace()
    sys._getframe().f_trace_opcodes = (
        True  # Python 3.12 reports instructions only if a frame asked for them before `settrace`
    )
    sys.settrace(enter)
    try:
        if sys.version_info >= (3, 13):
            make()
        return make(), steps
    finally:
        sys.settrace(before)


def taken(steps: set[_Step]) -> tuple[set[Split], set[Split]]:
    """Return the branches that were taken, and the other branches of the same decisions."""
    live: set[Split] = set()
    met: set[Split] = set()
    for file, code, before, now in steps:
        if before < 0:
            continue
        here, there = place_of(code, before), place_of(code, now)
        for decision in _decided_in(file, code):
            if not _decides(here, decision) or (_decides(there, decision) and not _returns(code, now)):
                continue
            sides = _sides(decision, file)
            met.update(sides)
            live.add(sides[0] if any(_within(there, node) for node in _body(decision)) else sides[1])
    kept = {split for split in met if not split.kind.startswith("refusal")}
    return live & kept, kept - live


def _returns(code: CodeType, offset: int) -> bool:
    """Return whether an instruction returns: after a failed test at the end of a function, it has the place of the test."""
    return code.co_code[offset] in _RETURNING


def _decides(place: Place, decision: _Deciding) -> bool:
    """Return whether an instruction belongs to the test; the jump of `a if test else b` has the place of the whole."""
    extent = (decision.lineno, decision.end_lineno, decision.col_offset, decision.end_col_offset)
    return _within(place, decision.test) or (place.line, place.end_line, place.column, place.end_column) == extent


def _within(place: Place, node: ast.AST) -> bool:
    start = (node.lineno, node.col_offset)  # type: ignore[attr-defined]
    end = (node.end_lineno, node.end_col_offset)  # type: ignore[attr-defined]
    return start <= (place.line, place.column) and (place.end_line, place.end_column) <= end


def _body(decision: _Deciding) -> list[Any]:
    return decision.body if isinstance(decision, ast.If) else [decision.body]


def _sides(decision: _Deciding, file: str) -> tuple[Split, Split]:
    """Return the side where the test holds, and the other side."""
    test = decision.test
    place = Place(file, test.lineno, test.end_lineno or test.lineno, test.col_offset, test.end_col_offset or 0)
    other = decision.orelse if isinstance(decision, ast.If) else [decision.orelse]
    names = [
        f"{'refusal' if _refuses(side) else 'branch'} where it {what}"
        for side, what in ((_body(decision), "holds"), (other, "fails"))
    ]
    return Split(names[0], (place,)), Split(names[1], (place,))


def _refuses(side: list[Any]) -> bool:
    return bool(side) and isinstance(side[-1], ast.Raise)


@cache
def _decided_in(file: str, code: CodeType) -> tuple[_Deciding, ...]:
    """Return the decisions of this piece of code, without those of functions in it."""
    if not declares(file):
        return ()
    places = {place_of(code, 2 * number) for number in range(len(code.co_code) // 2)}
    return tuple(one for one in _decisions(file) if any(_within(place, one.test) for place in places))


@cache
def _decisions(file: str) -> tuple[_Deciding, ...]:
    return tuple(_found(ast.parse(Path(file).read_text(encoding="utf-8"))))


def _found(tree: ast.AST) -> Iterator[_Deciding]:
    for node in ast.walk(tree):
        if isinstance(node, (ast.If, ast.IfExp)) and not _about_kinds(node.test):
            yield node


def _about_kinds(test: ast.expr) -> bool:
    """Return whether a test is an `isinstance(...)`: that is about a term, not about a configuration."""
    return any(isinstance(node, ast.Name) and node.id == "isinstance" for node in ast.walk(test))
