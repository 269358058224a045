"""A finding in at most two lines of a terminal, with its id in full, so that it can be given to `--property` or `--run`."""

from __future__ import annotations

from textwrap import shorten

from safeloc.cli.console import folded
from safeloc.language.verdict import SHOWN, Result, told
from safeloc.proof.results import Finding

_INDENT = " " * 10
"""The verdict is printed in front of it."""
_CUT = " ..."
_LEAST_OF_METHOD = 20
"""If fewer characters are left for the method, it is left to the report."""


def verdict_word(result: Result) -> str:
    """Return the verdict in one word: `proved` of what always holds, `shown` of what one run shows."""
    return one_word(told(result))


def one_word(verdict: str) -> str:
    """Return a verdict as it is told, shortened for a column."""
    return "shown" if verdict == SHOWN else verdict


def finding_line(finding: Finding) -> str:
    """Return verdict, id and method in one line, for a pipe."""
    return f"{verdict_word(finding.result):9} {finding.id}  [{finding.method}]"


def finding_lines(finding: Finding, width: int) -> list[str]:
    """Return the same in lines of this width: the id is never cut, the method only if there is no room for it."""
    line = finding_line(finding)
    if len(line) <= width:
        return [line]
    *first, last = folded(f"{verdict_word(finding.result):9} {finding.id}", width, _INDENT)
    if not first:
        return [last, f"{_INDENT}{_method(finding, width - len(_INDENT))}"]
    left = width - len(last) - 2
    return [*first, f"{last}  {_method(finding, left)}"] if left >= _LEAST_OF_METHOD else [*first, last]


def _method(finding: Finding, width: int) -> str:
    return f"[{shorten(finding.method, width - 2, placeholder=_CUT)}]"
