"""Texts that have most of their lines in common, as a list of these lines and a short line for each text.

The certificates of a machine state the same terms again and again, under other numbers. Here each line, and each definition of a term,
stands once:

    safeloc-certificates/2
     (set-logic QF_LIA)                  after a blank: the line of a text, as it is
    =Bool (and |x.present| t1)           a definition; t1 is the definition one line further up in this list
    !(not t1)                            what a text asserts
    @a-always-step-1f0c.smt2 0+4 2+1     the name of a text, and its lines: line 0 and the 4 after it; 2 lines further on, and one more

A text has its own numbers of terms: its first definition is t0. Every text is got back as it was, letter by letter, whatever it is:
what does not have one of these forms is kept as it is. The digest at the end of its name shows that.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from functools import partial

FORMAT = "safeloc-certificates/2"
_REFERENCE = re.compile(r"\|[^|]*\||\bt\d+\b")
"""A name in bars, in which nothing is a reference, or the name of a term."""
_DEFINED, _ASSERTED = "(define-fun ", "(assert "


def shared_lines(texts: Mapping[str, str]) -> str:
    """Return all the texts as one. A name has no blank and no line break."""
    lines = _Lines()
    named = [f"@{name} {_runs(lines.of(text))}" for name, text in texts.items()]
    return "\n".join([FORMAT, *lines.written(), *named]) + "\n"


class _Lines:
    """The lines of all texts, each once, with its number; a reference in it is the number of a line."""

    def __init__(self) -> None:
        self._numbers: dict[str, int] = {}

    def of(self, text: str) -> list[int]:
        """Return the numbers of the lines of a text."""
        terms: dict[str, str] = {}
        defined = set[int]()
        numbers = self._numbers
        found = []
        beginning = f"{_DEFINED}t0 () "
        for line in text.split("\n"):
            kept = f" {line}"
            if line.startswith(beginning) and line[-1] == ")":
                said = _referring(f"={line[len(beginning) : -1]}", terms)
                if (
                    said is not None and numbers.get(said) not in defined
                ):  # a second definition of the same is kept as it is
                    kept = said
                    number = numbers.setdefault(kept, len(numbers))
                    terms[f"t{len(terms)}"] = f"t{number}"
                    defined.add(number)
                    beginning = f"{_DEFINED}t{len(terms)} () "
            elif line.startswith(_ASSERTED) and line[-1] == ")":
                kept = _referring(f"!{line[len(_ASSERTED) : -1]}", terms) or kept
            found.append(numbers.setdefault(kept, len(numbers)))
        return found

    def written(self) -> Iterator[str]:
        """Yield the lines with references that count lines upwards, which are small and often equal."""
        for number, line in enumerate(self._numbers):
            yield line if line[0] == " " else _REFERENCE.sub(partial(_upwards, number), line)


def _referring(line: str, terms: Mapping[str, str]) -> str | None:
    """Return the line with other names of terms; None if it has a name that is not among them."""

    def other(one: re.Match[str]) -> str:
        name = one[0]
        return name if name[0] == "|" else terms[name]

    try:
        return _REFERENCE.sub(other, line)
    except KeyError:
        return None


def _upwards(at: int, one: re.Match[str]) -> str:
    name = one[0]
    return name if name[0] == "|" else f"t{at - int(name[1:])}"


def _runs(numbers: Iterable[int]) -> str:
    """Return numbers as runs: how far the first lies behind the last of the run before, and how many follow it."""
    found = list[str]()
    after = first = last = 0
    for number in numbers:
        if number == last + 1 and found:
            last = number
            found[-1] = f"{first - after}+{last - first}"
        else:
            after, first, last = last, number, number
            found.append(str(first - after))
    return " ".join(found)


# ------------------------------------------------------------------ read


def texts_of(content: str, most: int) -> dict[str, str]:
    """Return the texts by name.

    ValueError, or IndexError or KeyError, for any other content, and for texts of more than `most` letters together.
    """
    first, *rows = content.removesuffix("\n").split("\n")
    if first != FORMAT:
        raise ValueError(f"no {FORMAT}")
    end = next((place for place, row in enumerate(rows) if row[:1] == "@"), len(rows))
    lines, texts, left = rows[:end], dict[str, str](), most
    for row in rows[end:]:
        name, *runs = row[1:].split(" ")
        if row[:1] != "@" or name in texts:
            raise ValueError(f"no text, or one with the name of another: {row[:40]}")
        texts[name], left = _text(lines, _numbers(runs, len(lines)), left)
    return texts


def _numbers(runs: Iterable[str], end: int) -> Iterator[int]:
    last = 0
    for run in runs:
        step, _, more = run.partition("+")
        first, last = last + int(step), last + int(step) + int(more or 0)
        if not 0 <= first <= last < end:
            raise IndexError(f"no line {last}")
        yield from range(first, last + 1)


def _text(lines: Sequence[str], numbers: Iterable[int], left: int) -> tuple[str, int]:
    """Return a text of these lines, and how many letters are left for others."""
    terms: dict[int, str] = {}
    found = []
    for number in numbers:
        line = _line(lines[number], number, terms)
        found.append(line)
        left -= len(line) + 1
        if left < 0:
            raise ValueError("texts that are too large")
    return "\n".join(found), left


def _line(line: str, at: int, terms: dict[int, str]) -> str:
    """Return a line as it stands in a text, and take a definition among its terms: number of the line -> name."""
    kind, rest = line[0], line[1:]
    if kind == " ":
        return rest

    def own(one: re.Match[str]) -> str:
        name = one[0]
        return name if name[0] == "|" else terms[at - int(name[1:])]

    said = _REFERENCE.sub(own, rest)
    if kind == "=":
        return f"{_DEFINED}{terms.setdefault(at, f't{len(terms)}')} () {said})"
    if kind == "!":
        return f"{_ASSERTED}{said})"
    raise ValueError(f"no line of a text: {line[:40]}")
