"""Terms of our own: nested tuples, what they mean, and what they read. Nothing here is safeloc's.

    numbers   ("lit", k) ("member", k) ("var", name) ("was", name) ("add", a, b) ("sub", a, b) ("mul", a, b)
              ("floor", a, k) ("ceil", a, k) ("min", a, b) ("max", a, b) ("abs", a) ("ite", c, a, b)
    truths    ("true",) ("false",) ("var", name) ("was", name) ("not", a) ("and", a, ...) ("or", a, ...)
              ("implies", a, b) ("iff", a, b) ("ite", c, a, b) ("lt", a, b) ("le", a, b) ("gt", a, b) ("ge", a, b)
              ("eq", a, b) ("ne", a, b) ("among", x, k, ...)
    claims    ("previous", p) ("once", p) ("since", p, q): over the steps of a run (tests.fuzz.judge)

`("was", x)` is x before the step; a state holds it under the name `was(x)`.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from typing import Any

Term = tuple[Any, ...]
Values = Mapping[str, int]

TRUE: Term = ("true",)
FALSE: Term = ("false",)
PAST = ("previous", "once", "since")
CONSTANTS = ("floor", "ceil", "among")  # what stands behind the first part is plain numbers
LEAVES = ("lit", "member", "var", "was", "true", "false")


def was(name: str) -> str:
    """The name under which values before the step are kept."""
    return f"was({name})"


def parts(term: Term) -> tuple[Term, ...]:
    """The terms directly below."""
    if term[0] in LEAVES:
        return ()
    return term[1:2] if term[0] in CONSTANTS else term[1:]


def below(term: Term) -> Iterator[Term]:
    """The term and all terms below it."""
    yield term
    for part in parts(term):
        yield from below(part)


def reads(term: Term) -> set[str]:
    """Names of the variables, those before the step as `was(x)`."""
    return {was(one[1]) if one[0] == "was" else one[1] for one in below(term) if one[0] in ("var", "was")}


def rewritten(term: Term, leaf: Callable[[Term], Term]) -> Term:
    """The term with every variable replaced by what `leaf` makes of it."""
    if term[0] in ("var", "was"):
        return leaf(term)
    if term[0] in LEAVES:
        return term
    inner = tuple(rewritten(part, leaf) for part in parts(term))
    return (term[0], *inner, *term[1 + len(inner) :])


def every(*terms: Term) -> Term:
    """Conjunction of any number of terms."""
    left = [term for term in terms if term != TRUE]
    return TRUE if not left else left[0] if len(left) == 1 else ("and", *left)


MEANING: dict[str, Callable[..., int]] = {
    "add": lambda a, b: a + b,
    "sub": lambda a, b: a - b,
    "mul": lambda a, b: a * b,
    "min": lambda a, b: a if a < b else b,
    "max": lambda a, b: a if a > b else b,
    "abs": lambda a: -a if a < 0 else a,
    "not": lambda a: not a,
    "and": lambda *all_: all(all_),
    "or": lambda *all_: any(all_),
    "implies": lambda a, b: (not a) or bool(b),
    "iff": lambda a, b: bool(a) == bool(b),
    "ite": lambda c, a, b: a if c else b,
    "lt": lambda a, b: a < b,
    "le": lambda a, b: a <= b,
    "gt": lambda a, b: a > b,
    "ge": lambda a, b: a >= b,
    "eq": lambda a, b: a == b,
    "ne": lambda a, b: a != b,
}


def value(term: Term, values: Values) -> int:
    """What the term is worth; past operators have no value here. This is the definition."""
    match term:
        case ("lit" | "member", number):
            return int(number)
        case ("true",):
            return True
        case ("false",):
            return False
        case ("var", name):
            return values[name]
        case ("was", name):
            return values[was(name)]
        case ("floor", inner, divisor):
            return _rounded_down(value(inner, values), divisor)
        case ("ceil", inner, divisor):
            return -_rounded_down(-value(inner, values), divisor)
        case ("among", inner, *numbers):
            return value(inner, values) in numbers
        case (operator, *inner):
            return MEANING[operator](*(value(part, values) for part in inner))
    raise ValueError(term)


def _rounded_down(number: int, divisor: int) -> int:
    whole = abs(number) // divisor
    return whole if number >= 0 else -whole if whole * divisor == -number else -whole - 1


WRITTEN = {
    "add": "({} + {})",
    "sub": "({} - {})",
    "mul": "({} * {})",
    "min": "min({}, {})",
    "max": "max({}, {})",
    "abs": "abs({})",
    "not": "(not {})",
    "implies": "(not {} or {})",
    "iff": "({} == {})",
    "lt": "({} < {})",
    "le": "({} <= {})",
    "gt": "({} > {})",
    "ge": "({} >= {})",
    "eq": "({} == {})",
    "ne": "({} != {})",
}


def fast(term: Term) -> Callable[[Values], int]:
    """The same as `value`, as a Python function: what the search calls a million times."""
    made: Callable[[Values], int] = eval(f"lambda v: {_written(term)}")  # our own text, of our own terms
    return made


def _written(term: Term) -> str:
    inner = [_written(part) for part in parts(term)]
    match term[0]:
        case "lit" | "member":
            return f"({term[1]})"
        case "true" | "false":
            return str(term[0] == "true")
        case "var":
            return f"v[{term[1]!r}]"
        case "was":
            return f"v[{was(term[1])!r}]"
        case "floor":
            return f"({inner[0]} // {term[2]})"
        case "ceil":
            return f"-(-{inner[0]} // {term[2]})"
        case "among":
            return f"({inner[0]} in {tuple(term[2:])})"
        case "and" | "or":
            return f"({f' {term[0]} '.join(inner)})"
        case "ite":
            return f"({inner[1]} if {inner[0]} else {inner[2]})"
        case operator:
            return WRITTEN[operator].format(*inner)
