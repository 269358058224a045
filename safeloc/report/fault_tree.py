"""A picture of the minimal cut sets: the top event, and every breach, or pair of breaches, that leads to it."""

from __future__ import annotations

import html
from collections.abc import Iterator, Mapping, Sequence
from textwrap import wrap

from safeloc.assurance.evidence.cut_sets import CutSets
from safeloc.proof.cores.clauses import ClauseId
from safeloc.report.drawing import GREY, ORANGE, RED

_WIDTH, LEFT, ROW, BOX = 1_000, 250, 34, 26
_LETTERS = 96
"""Number of letters that fit into a box."""
_TOP_LETTERS, _LINE = 22, 18
"""Number of letters that fit into a line of the top event's box, and the height of a line."""


def fault_tree(title: str, sets: CutSets, numbers: Mapping[ClauseId, str]) -> str:
    """Return the picture as SVG text: cut sets of one clause in red, of two in orange, undecided ones in grey or orange."""
    rows = [(one, RED, "") for one in sets.found] + [(one, GREY, " (not decided)") for one in sets.undecided]
    height = max(ROW * (max(len(rows), 1) + 2), _LINE * len(wrap(sets.top, _TOP_LETTERS)) + 60)
    parts = [_text(20, 24, title, "bold"), *_top(sets.top, height)]
    if not rows:
        parts.append(
            _text(LEFT, 2 * ROW, "no breach of one clause, or of two clauses as far as checked, leads to it", "normal")
        )
    for number, (clauses, colour, note) in enumerate(rows, 1):
        parts += _row(number * ROW + 12, clauses, colour, note, numbers)
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {_WIDTH} {height}" role="img" '
        f'font-family="sans-serif" font-size="13"><title>{html.escape(title)}: {html.escape(sets.top)}</title>'
        f'<rect width="{_WIDTH}" height="{height}" fill="#ffffff"/>{"".join(parts)}</svg>'
    )


def _top(event: str, height: int) -> Iterator[str]:
    middle, lines = height / 2, wrap(event, _TOP_LETTERS)
    tall = _LINE * len(lines) + 24
    yield _box(10, middle - tall / 2, 170, tall, RED)
    for number, line in enumerate(lines):
        yield _text(20, middle - tall / 2 + 24 + _LINE * number, line, "normal")
    yield f'<line x1="180" y1="{middle:g}" x2="210" y2="{middle:g}" stroke="#333333"/>'
    yield _text(188, middle - 8, "or", "normal")
    yield f'<line x1="210" y1="{ROW + 12 + BOX / 2:g}" x2="210" y2="{height - ROW - 8:g}" stroke="#333333"/>'


def _row(y: float, clauses: Sequence[ClauseId], colour: str, note: str, numbers: Mapping[ClauseId, str]) -> list[str]:
    words = " AND ".join(f"{numbers[one]} {one.name}" for one in clauses) + note
    shown = words if len(words) <= _LETTERS else f"{words[: _LETTERS - 1]}…"
    middle = y + BOX / 2
    edge = colour if len(clauses) == 1 else ORANGE
    return [
        f'<line x1="210" y1="{middle:g}" x2="{LEFT - 10}" y2="{middle:g}" stroke="#333333"/>',
        f"<g><title>{html.escape(words)}</title>{_box(LEFT - 10, y, _WIDTH - LEFT, BOX, edge)}{_text(LEFT, y + 18, shown, 'normal')}</g>",
    ]


def _box(x: float, y: float, width: float, height: float, colour: str) -> str:
    return f'<rect x="{x:g}" y="{y:g}" width="{width:g}" height="{height:g}" rx="4" fill="#ffffff" stroke="{colour}" stroke-width="2"/>'


def _text(x: float, y: float, words: str, weight: str) -> str:
    return f'<text x="{x:g}" y="{y:g}" font-weight="{weight}" fill="#111111">{html.escape(words)}</text>'
