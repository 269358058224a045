"""A reader of certificates, independent of the checker's other one: it returns the question of each goal."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TypeAlias

from safeloc.checker.proofs.terms import FALSE, TRUE, Sort, Term, make, number, variable
from safeloc.errors import InputError

_TOKEN = re.compile(r'[ \t\r\n]+|(;[^\n]*)|(\|[^|]*\||[()]|"[^"]*"|[^\s()|;"]+)')
_NAME = r"\|[^|\\]+\||[A-Za-z_.$@!~&^*+-][A-Za-z0-9_.$@!~&^*+-]*"
_OPERATORS = {"not": 1, "and": 0, "or": 0, "=>": 2, "=": 2, "<": 2, "<=": 2, ">=": 2, ">": 2, "ite": 3, "div": 2}
_OPERATORS |= {"+": 2, "-": 2, "*": 2}
_RESERVED = _OPERATORS.keys() | {"true", "false", "xor", "distinct", "let", "mod", "abs", "to_real", "to_int", "/"}
_SORTS: Mapping[str, Sort] = {"Int": "Int", "Bool": "Bool"}

Expression: TypeAlias = "str | list[Expression]"


@dataclass(frozen=True)
class Goal:
    """The question of one `check-sat`: can the assertions, with definitions expanded, hold together?"""

    name: str
    logic: str
    assertions: tuple[Term, ...]


@dataclass
class _Reading:
    logic: str = "ALL"
    comment: str = ""
    symbols: dict[str, Term] = field(default_factory=dict)
    assertions: list[Term] = field(default_factory=list)
    levels: list[int] = field(default_factory=list)
    goals: list[Goal] = field(default_factory=list)


def read_goals(text: str) -> list[Goal]:
    """Return the goals of a certificate, in order. InputError for a text that is no certificate, naming the command."""
    reading = _Reading()
    for command in _expressions(text):
        try:
            _command(command, reading)
        except (TypeError, ValueError, KeyError, IndexError, RecursionError) as error:
            raise InputError(
                f"a certificate holds what this checker does not read: {_short(command)}: {error}"
            ) from None
    return reading.goals


def _short(command: Expression) -> str:
    text = str(command)
    return text if len(text) <= 200 else f"{text[:200]}..."


def _expressions(text: str) -> Iterator[Expression]:
    """Yield the top-level expressions, and the comments between them as strings that begin with a semicolon."""
    open_lists: list[list[Expression]] = []
    for comment, token in _tokens(text):
        if comment:
            if not open_lists:
                yield comment
        elif token == "(":
            open_lists.append([])
        elif token == ")":
            if not open_lists:
                raise InputError("a certificate closes a bracket that was not opened.")
            closed = open_lists.pop()
            if open_lists:
                open_lists[-1].append(closed)
            else:
                yield closed
        elif open_lists:
            open_lists[-1].append(token)
        else:
            raise InputError(f"a certificate has {token[:80]!r} outside of every command.")
    if open_lists:
        raise InputError("a certificate ends within a command.")


def _tokens(text: str) -> Iterator[tuple[str, str]]:
    at = 0
    while at < len(text):
        found = _TOKEN.match(text, at)
        if found is None:
            raise InputError(f"a certificate cannot be read at {text[at : at + 40]!r}.")
        at = found.end()
        if found.group(1) or found.group(2):
            yield found.group(1) or "", found.group(2) or ""


def _command(command: Expression, reading: _Reading) -> None:
    match command:
        case str():
            reading.comment = command[1:].strip()
        case ["set-info", *_]:
            pass
        case ["set-logic", str(logic)]:
            reading.logic = logic
        case ["declare-const", str(name), str(sort)]:
            reading.symbols[_new(name, reading)] = variable(_bare(name), _SORTS[sort])
        case ["define-fun", str(name), [], str(sort), body]:
            _define(name, _SORTS[sort], _read(body, reading), reading)
        case ["assert", body]:
            reading.assertions.append(_truth(_read(body, reading)))
        case ["push", "1"]:
            reading.levels.append(len(reading.assertions))
        case ["pop", "1"]:
            del reading.assertions[reading.levels.pop() :]
        case ["check-sat"]:
            reading.goals.append(Goal(reading.comment, reading.logic, tuple(reading.assertions)))
        case _:
            raise ValueError("a command unknown here")


def _new(token: str, reading: _Reading) -> str:
    """Return the name, if it is new, so that no definition refers to itself and none is changed later; else ValueError."""
    name = _bare(token)
    if reading.levels:
        raise ValueError("a declaration between push and pop")
    if name in reading.symbols or name in _RESERVED or not re.fullmatch(_NAME, token):
        raise ValueError("the name is taken")
    return name


def _define(token: str, sort: Sort, body: Term, reading: _Reading) -> None:
    if body.sort != sort:
        raise TypeError("the body is of another sort")
    reading.symbols[_new(token, reading)] = body


def _bare(token: str) -> str:
    return token[1:-1] if token.startswith("|") else token


def _truth(term: Term) -> Term:
    if term.sort != "Bool":
        raise TypeError("the assertion is no truth value")
    return term


def _read(expression: Expression, reading: _Reading) -> Term:
    if isinstance(expression, str):
        return _atom(expression, reading)
    operator, *rest = expression
    if not isinstance(operator, str):
        raise ValueError("an operator that is no word")
    args = [_read(one, reading) for one in rest]
    if operator == "-" and len(args) == 1:
        return make("neg", *args)
    wanted = _OPERATORS[operator]
    if len(args) != wanted if wanted else len(args) < 2:
        raise ValueError(f"{operator!r} of {len(args)} arguments")
    return make(operator, *args)


def _atom(token: str, reading: _Reading) -> Term:
    if token.isascii() and token.isdecimal():
        return number(int(token))
    if token in ("true", "false"):
        return TRUE if token == "true" else FALSE
    return reading.symbols[_bare(token)]
