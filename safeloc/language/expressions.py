"""Terms written as text by a user: `valid and upper_mm - lower_mm <= 12000`, `mode = "FRONT"`.

The language is that of watched expressions in a report (safeloc/report/explorer/watch.js): names, whole numbers, labels in
quotes, `+ - *`, comparisons, `and`, `or`, `not` and parentheses. `==` may be written for `=`. A whole number takes the unit of
what it is compared with or added to.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TypeAlias

from safeloc.errors import InputError, ModelError
from safeloc.language.expr import Bool, Expr, Lit, Num, all_of, any_of, as_bool, as_num, exact_to
from safeloc.language.nodes import Truth, product
from safeloc.language.renamed import hint
from safeloc.language.units import ONE, Enumeration, Unit

_TOKEN = re.compile(
    r'\s*(?:(?P<number>\d+)|"(?P<label>[^"]*)"|(?P<sign><=|>=|!=|==|[-+*()<>=])|(?P<word>[A-Za-z_][\w.]*))'
)
_LEVELS = (("or",), ("and",), ("=", "==", "!=", "<", "<=", ">", ">="), ("+", "-"), ("*",))
_KEYWORDS = ("and", "or", "not")
_TRUTHS = {"true": True, "false": False}


@dataclass(frozen=True)
class _Label:
    text: str


@dataclass(frozen=True)
class _Token:
    """A sign or keyword, or else a value; a name is looked up when it is read."""

    sign: str = ""
    value: _Value | None = None


_Value: TypeAlias = Expr | int | bool | _Label


@dataclass(frozen=True, eq=False)
class Written:
    """A condition as written, and the names that it reads, in order."""

    term: Bool
    names: tuple[str, ...]


def condition(text: str, known: Mapping[str, Expr]) -> Written:
    """Return the condition that a text writes over known names; InputError says what is wrong with it, and names candidates."""
    reader = _Reader(text, known)
    try:
        found = reader.whole()
    except ModelError as error:
        raise InputError(f"{text!r}: {str(error).partition(': ')[2] or error}") from error
    if not isinstance(found, (Bool, bool)):
        raise InputError(f"{text!r} is a number; a condition is wanted, such as {text.strip()} <= 100.")
    return Written(as_bool(found), tuple(dict.fromkeys(reader.names)))


class _Reader:
    """Reads one text from left to right, level by level of the operators."""

    def __init__(self, text: str, known: Mapping[str, Expr]) -> None:
        self._text, self._known, self._at = text, known, 0
        self._spaced = sorted((name for name in known if not re.fullmatch(r"[\w.]+", name)), key=len, reverse=True)
        self.names: list[str] = []
        self._tokens = self._all_tokens()

    def whole(self) -> _Value:
        """Return the value of the whole text."""
        if not self._tokens:
            raise InputError("an empty condition; write one, such as valid and margin_mm <= 1000.")
        found = self._level(0)
        if self._at < len(self._tokens):
            raise self._wrong(f"{_shown(self._tokens[self._at])} is too much")
        return found

    def _all_tokens(self) -> list[_Token]:
        found, at = list[_Token](), 0
        while self._text[at:].strip():
            at += len(self._text[at:]) - len(self._text[at:].lstrip())
            name = next((one for one in self._spaced if self._text.startswith(one, at)), None)
            if name is not None:
                found.append(_Token(value=self._named(name)))
                at += len(name)
                continue
            token = _TOKEN.match(self._text, at)
            if token is None:
                raise self._wrong(f"not understood from {self._text[at:]!r}")
            found.append(self._token(token))
            at = token.end()
        return found

    def _token(self, found: re.Match[str]) -> _Token:
        if found["number"] is not None:
            return _Token(value=int(found["number"]))
        if found["label"] is not None:
            return _Token(value=_Label(found["label"]))
        if found["sign"] is not None:
            return _Token(sign=found["sign"])
        word = found["word"]
        if word in self._known:
            return _Token(value=self._named(word))
        if word in _KEYWORDS:
            return _Token(sign=word)
        return _Token(value=_TRUTHS[word] if word in _TRUTHS else self._named(word))

    def _named(self, name: str) -> Expr:
        if name not in self._known:
            near = hint(name, self._known)
            raise self._wrong(f"there is no {name!r}; there are {', '.join(self._known)}.{near}".rstrip("."))
        self.names.append(name)
        return self._known[name]

    def _level(self, depth: int) -> _Value:
        if depth == len(_LEVELS):
            return self._single()
        left = self._level(depth + 1)
        while self._at < len(self._tokens) and self._tokens[self._at].sign in _LEVELS[depth]:
            sign = self._tokens[self._at].sign
            self._at += 1
            left = self._joined(sign, left, self._level(depth + 1))
        return left

    def _single(self) -> _Value:
        if self._at == len(self._tokens):
            raise self._wrong("something is missing at the end")
        token = self._tokens[self._at]
        self._at += 1
        if token.value is not None:
            return token.value
        match token.sign:
            case "-":
                inner = self._number(self._single())
                return -inner
            case "not":
                return ~as_bool(self._truth(self._level(2)))
            case "(":
                inside = self._level(0)
                if self._at == len(self._tokens) or self._tokens[self._at].sign != ")":
                    raise self._wrong("a parenthesis is not closed")
                self._at += 1
                return inside
            case sign:
                raise self._wrong(f"{sign} has nothing before it")

    def _joined(self, sign: str, left: _Value, right: _Value) -> _Value:
        match sign:
            case "or":
                return any_of([self._truth(left), self._truth(right)])
            case "and":
                return all_of([self._truth(left), self._truth(right)])
            case "=" | "==":
                return self._equal(left, right)
            case "!=":
                return ~as_bool(self._equal(left, right))
            case "+" | "-" | "*":
                return self._computed(sign, self._number(left), self._number(right))
            case _:
                return self._compared(sign, self._number(left), self._number(right))

    def _computed(self, sign: str, left: Num | int, right: Num | int) -> Num | int:
        if isinstance(left, int) and isinstance(right, int):
            return left + right if sign == "+" else left - right if sign == "-" else left * right
        if sign == "*":
            return product(as_num(left, ONE), as_num(right, ONE))
        one, other = _in_one_unit(left, right)
        return one + other if sign == "+" else one - other

    def _compared(self, sign: str, left: Num | int, right: Num | int) -> Bool:
        one, other = _in_one_unit(left, right)
        match sign:
            case "<":
                return one < other
            case "<=":
                return one <= other
            case ">":
                return one > other
            case _:
                return one >= other

    def _equal(self, left: _Value, right: _Value) -> Bool:
        if isinstance(left, _Label) or isinstance(right, _Label):
            label, other = (left, right) if isinstance(left, _Label) else (right, left)
            assert isinstance(label, _Label)
            return self._is_member(label, other)
        if isinstance(left, (Bool, bool)) and isinstance(right, (Bool, bool)):
            return as_bool(left).iff(right)
        one, other = _in_one_unit(self._number(left), self._number(right))
        return one.eq(other)

    def _is_member(self, label: _Label, other: _Value) -> Bool:
        if not (isinstance(other, Num) and isinstance(other.unit, Enumeration)):
            raise self._wrong(f'"{label.text}" is a label, and what it is compared with has none')
        members = other.unit.members
        if label.text not in members:
            near = hint(label.text, members)
            raise self._wrong(f'"{label.text}" is no member; there are {", ".join(members)}.{near}'.rstrip("."))
        return other.eq(Lit(members.index(label.text), other.unit))

    def _number(self, value: _Value) -> Num | int:
        if isinstance(value, (bool, Bool, _Label)):
            raise self._wrong(f"{_word(value)} is no number")
        return value

    def _truth(self, value: _Value) -> Bool | bool:
        if isinstance(value, (Bool, bool)):
            return value
        raise self._wrong(f"{_word(value)} is neither true nor false")

    def _wrong(self, why: str) -> InputError:
        return InputError(f"{self._text!r}: {why}{'' if why.endswith('?') else '.'}")


def _in_one_unit(left: Num | int, right: Num | int) -> tuple[Num, Num]:
    """Return both as terms; a whole number takes the unit of the other, and of two units of one kind the finer one is taken."""
    unit = left.unit if isinstance(left, Num) else right.unit if isinstance(right, Num) else ONE
    one, other = as_num(left, unit), as_num(right, unit)
    if _are_of_one_kind(one.unit, other.unit) and not one.unit.same(other.unit):
        finer = min((unit for unit in (one.unit, other.unit) if isinstance(unit, Unit)), key=lambda each: each.scale)
        return exact_to(one, finer), exact_to(other, finer)
    return one, other


def _are_of_one_kind(one: Unit | Enumeration, other: Unit | Enumeration) -> bool:
    return isinstance(one, Unit) and isinstance(other, Unit) and one.dimension == other.dimension


def _word(value: _Value) -> str:
    match value:
        case _Label(text):
            return f'"{text}"'
        case bool() | Truth():
            return "a truth value"
        case int() | Lit():
            return str(value)
        case Bool():
            return "a truth value"
        case _:
            return "a number"


def _shown(token: _Token) -> str:
    return token.sign or ("a name" if token.value is None else _word(token.value))
