"""Reader of a certificate's text into nodes. It refuses every text that has not exactly this form:

; key: value                                     the header
(set-logic ...) (set-info :status unsat)
(declare-const |x| Int)  (define-fun t7 () Bool TERM)  (assert TERM)
(define-fun |witness 1.2 of x| () Int TERM)          a proposed term for x, without any claim
(push 1) (assert (not GOAL)) (check-sat) (pop 1)     once for each goal
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from itertools import takewhile

from safeloc.checker.dag import BOOL, INT, Dag
from safeloc.errors import InputError

_FORMAT = "safeloc-certificate/1"
_ARITY = {"+": 2, "-": 2, "*": 2, "div": 2, "<": 2, "<=": 2, ">=": 2, "=": 2, "not": 1, "ite": 3}
_TOKEN = re.compile(r"[ \n]+|(;[^\n]*|[()]|\|[^|\\\n]*\||:?[A-Za-z0-9_+*<>=-]+)|(.)", re.DOTALL)
_TAKEN = re.compile(
    r"true|false|not|and|or|xor|distinct|ite|forall|exists|let|match|par|as|div|mod|abs|to_real|to_int|is_int"
    r"|divisible|int\..*|real\..*|t\d+|witness \d+\.\d+ of .*|[^A-Za-z0-9]+"
)
_WITNESS = re.compile(r"\|witness (\d+\.\d+) of (.*)\|")
_COMMANDS_OF_A_GOAL = 4
_LOGICS = (["set-logic", "QF_LIA"], ["set-logic", "QF_NIA"])
_STATUS = ["set-info", ":status", "unsat"]
Command = list["str | Command"]


@dataclass(frozen=True)
class Certificate:
    """The content of a certificate: each goal follows from the hypotheses. Terms are numbers of a Dag.

    hypotheses  split into conjuncts
    witnesses   proposed terms for groups of variables; whoever uses a witness must check that it is valid
    """

    file: str
    header: dict[str, str] = field(repr=False)
    relies_on: tuple[str, ...]
    hypotheses: frozenset[int]
    goals: tuple[int, ...]
    witnesses: tuple[dict[int, int], ...] = ()


def read(file: str, text: str, dag: Dag) -> Certificate:
    """Read a certificate; InputError with the reason for any other text."""
    if not all(line.isprintable() for line in text.split("\n")):
        raise InputError(f"{file}: it has a character that cannot be printed.")
    reader = _Reader(dag)
    try:
        reader.take(list(_commands(text)))
    except (IndexError, KeyError, TypeError, ValueError, RecursionError) as error:
        raise InputError(f"{file}: not the text of a certificate ({type(error).__name__}: {error}).") from error
    header, relies_on = _header(file, text)
    hypotheses, witnesses = dag.conjuncts(reader.hypotheses), tuple(reader.witnesses.values())
    return Certificate(file, header, relies_on, hypotheses, tuple(reader.goals), witnesses)


def _header(file: str, text: str) -> tuple[dict[str, str], tuple[str, ...]]:
    """Return the header, key -> value, and the files on which the certificate relies, from the comments at the beginning."""
    comments = [line[1:].strip() for line in takewhile(lambda line: line.startswith(";"), text.split("\n"))]
    first, *lines = comments or [""]
    pairs = [(key.strip(), value.strip()) for key, sign, value in (line.partition(": ") for line in lines) if sign]
    relies_on = tuple(value for key, value in pairs if key == "relies on")
    others = [(key, value) for key, value in pairs if key != "relies on"]
    if first != _FORMAT or len(dict(others)) != len(others):
        raise InputError(f"{file}: it has no header of {_FORMAT}, or a key of the header twice.")
    return dict(others), relies_on


def _commands(text: str) -> Iterator[Command]:
    """Yield the commands as nested lists, without comments."""
    open_: list[Command] = [[]]
    for found in _TOKEN.finditer(text):
        token, strange = found.groups()
        if strange is not None:
            raise ValueError(f"unexpected {strange!r}")
        if token == "(":
            open_.append([])
        elif token == ")":
            done = open_.pop()
            open_[-1].append(done)
        elif token is not None and not token.startswith(";"):
            open_[-1].append(token)
    [commands] = open_
    for command in commands:
        if not isinstance(command, list):
            raise ValueError(f"{command!r} outside of a command")
        yield command


class _Reader:
    def __init__(self, dag: Dag) -> None:
        self._dag = dag
        self._named: dict[str, int] = {"true": dag.truth[True], "false": dag.truth[False]}
        self.hypotheses: list[int] = []
        self.goals: list[int] = []
        self.witnesses: dict[str, dict[int, int]] = {}

    def take(self, commands: Sequence[Command]) -> None:
        """Read all commands; ValueError unless they come in the prescribed order."""
        if commands[0] not in _LOGICS or commands[1] != _STATUS:
            raise ValueError(f"begins with {commands[:2]}")
        end = next((place for place, one in enumerate(commands) if one[0] == "push"), len(commands))
        for command in commands[2:end]:
            self._command(command)
        for place in range(end, len(commands), _COMMANDS_OF_A_GOAL):
            self._goal(commands[place : place + _COMMANDS_OF_A_GOAL])

    def _command(self, command: Command) -> None:
        match command:
            case ["declare-const", str(name), str(sort)] if name[0] == "|" and sort in (INT, BOOL):
                self._new(name, self._dag.variable(_plain(name), sort))
            case ["define-fun", str(name), [], str(sort), body] if re.fullmatch(r"t\d+", name) and sort in (INT, BOOL):
                self._new(name, self._of(sort, body))
            case ["assert", body]:
                self.hypotheses.append(self._of(BOOL, body))
            case ["define-fun", str(name), [], str(sort), body] if found := _WITNESS.fullmatch(name):
                variable = self._dag.variable(found[2], sort)
                self._new(name, self.witnesses.setdefault(found[1], {}).setdefault(variable, self._of(sort, body)))
            case _:
                raise ValueError(f"unexpected command {command[:2]}")

    def _new(self, name: str, term: int) -> None:
        if name in self._named:
            raise ValueError(f"{name} stands for two things")
        self._named[name] = term

    def _goal(self, group: Sequence[Command]) -> None:
        match group:
            case [["push", "1"], ["assert", ["not", body]], ["check-sat"], ["pop", "1"]]:
                self.goals.append(self._of(BOOL, body))
            case _:
                raise ValueError(f"{[one[:1] for one in group]} where a goal was expected")

    def _term(self, body: str | Command) -> int:
        if isinstance(body, str):
            return self._dag.number(int(body)) if body.isdecimal() else self._named[body]
        operator, *parts = body
        if operator == "-" and len(parts) == 1:
            return self._dag.number(-int(str(parts[0])))
        if operator not in ("and", "or") and _ARITY[str(operator)] != len(parts):
            raise ValueError(f"{operator} of {len(parts)} parts")
        terms = [self._term(part) for part in parts]
        sorts = [self._dag.sort(term) for term in terms]
        plain = [BOOL if operator in ("and", "or", "not") else INT] * len(parts)
        if sorts != ([BOOL, sorts[-1], sorts[-1]] if operator == "ite" else plain):
            raise ValueError(f"{operator} of {sorts}")
        return self._dag.make(str(operator), terms)

    def _of(self, sort: str, body: str | Command) -> int:
        term = self._term(body)
        if self._dag.sort(term) != sort:
            raise ValueError(f"no {sort}")
        return term


def _plain(symbol: str) -> str:
    """Return the variable's name: the text writes names that SMT-LIB reserves with one more apostrophe at the end.

    A mistake here could not make a proof unsound: a result about a free variable holds for any variable, if its name is not
    reserved.
    """
    name = symbol[1:-1]
    if not _TAKEN.fullmatch(name.rstrip("'")):
        return name
    if not name.endswith("'"):
        raise ValueError(f"{symbol} is no variable")
    return name[:-1]
