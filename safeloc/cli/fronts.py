"""The fronts of pairs of figures, for `safeloc margins`: pairs given with --pair, and those declared with a machine that ships."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, cast, get_args

import typer

from safeloc.assurance.margins.figures import Figure, chosen_figures
from safeloc.assurance.margins.limits_of_figures import Direction
from safeloc.assurance.margins.margin_data import in_words
from safeloc.assurance.margins.margin_work import Margins, Moving, Point, fronts
from safeloc.catalogue import ENTRIES
from safeloc.cli.console import out
from safeloc.cli.show import Progressing
from safeloc.errors import InputError
from safeloc.target import Pair, Target


def declared_pairs(target: Target) -> list[Pair]:
    """Return the pairs that are declared with a machine; InputError if there are none."""
    entry = ENTRIES.get(target.spec)
    if entry is not None and entry.pairs_of:
        commands = " or ".join(f"`safeloc margins {name} --pairs`" for name in entry.pairs_of)
        raise InputError(f"{target.name} has the pairs of its machines: {commands}.")
    if entry is None or not entry.pairs:
        raise InputError(f"{target.name} declares no pairs of figures; give two with --pair FIGURE:up,FIGURE:down.")
    return list(entry.pairs)


def given_pairs(texts: Sequence[str], where: str) -> list[Pair]:
    """Return the pairs of --pair, each by its own text."""
    found = []
    for text in texts:
        first, comma, second = (part.strip() for part in text.partition(","))
        if not comma or "," in second:
            raise typer.BadParameter(f"--pair takes two figures joined by a comma: {text!r}.")
        found.append(Pair(text, first, second, "design" if where == "design" else "world"))
    return found


def check_pairs(target: Target, pairs: Sequence[Pair]) -> None:
    """Refuse figures that the target does not have, and directions that are none."""
    if pairs:
        known = {one.name: one for one in chosen_figures(target, None)}
        for one in pairs:
            _moving(one.first, known)
            _moving(one.second, known)


def found_fronts(work: Margins, pairs: Sequence[Pair], *, quiet: bool) -> list[dict[str, Any]]:
    """Search the front of each pair; return them as data, in order."""
    known = {one.name: one for one in chosen_figures(work.target, None)}
    both = {one.name: (_moving(one.first, known), _moving(one.second, known)) for one in pairs}
    found = dict[str, list[Point]]()
    with Progressing(len(pairs), quiet=quiet) as progress:
        progress.say(f"fronts of {work.target.name}", len(pairs))
        for where in dict.fromkeys(one.where for one in pairs):
            chosen = {one.name: both[one.name] for one in pairs if one.where == where}
            for name, points in fronts(replace(work, where=where), chosen):
                progress.tick(f"{name}: {len(points)} points")
                found[name] = points
    return [_as_data(one, both[one.name], found[one.name]) for one in pairs]


def print_front(front: dict[str, Any]) -> None:
    """Print a front: values of the first figure, and how far the second may move beside each."""
    out.print(f"{front['name']} ({front['where']}): {front['first']}, {front['second']}", markup=False)
    for value, limit, words in front["points"]:
        out.print(f"    {value:>12} {limit:>12}  {words}", markup=False, soft_wrap=True)


def _as_data(pair: Pair, both: tuple[Moving, Moving], points: Sequence[Point]) -> dict[str, Any]:
    names = [f"{figure.name} ({figure.unit})" if figure.unit else figure.name for figure, _ in both]
    return {
        "name": pair.name,
        "where": pair.where,
        "first": names[0],
        "second": names[1],
        "points": [[value, one.holds_to, in_words(one)] for value, one in points],
    }


def _moving(text: str, known: dict[str, Figure]) -> Moving:
    name, _, way = text.partition(":")
    if name not in known or way not in get_args(Direction):
        raise typer.BadParameter(
            f"--pair takes two of {', '.join(known)}, each with :up or :down and joined by a comma; got {text!r}."
        )
    return known[name], cast(Direction, way)
