"""The case splits that the defaults of shipped machines fold away, each with the configurations in which it is live."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from safeloc.assurance.short_lists import first_few
from safeloc.assurance.source_places import Place
from safeloc.assurance.splits.covered import Covered, covered, folder_of
from safeloc.assurance.splits.deciding import Change
from safeloc.assurance.splits.observed import Split
from safeloc.assurance.splits.places import source_of
from safeloc.catalogue import ENTRIES
from safeloc.errors import InputError

_HIDDEN = "live in no configuration"


@dataclass(frozen=True)
class FoldedCase:
    """One case split that the defaults fold away.

    split   its kind
    at      file and line
    source  the expression as it is written there
    folded  the reason why the defaults fold it away
    live    the configurations in which it is live, or the reason why there is none
    """

    split: str
    at: str
    source: str
    folded: str
    live: str

    @property
    def is_hidden(self) -> bool:
        """True if it is live in no configuration, and no reason is written."""
        return self.live.startswith(_HIDDEN)


def folded_cases(machines: Sequence[str]) -> list[FoldedCase]:
    """Return the folded cases of these shipped machines, of all if none is named. InputError for an unknown name."""
    unknown = [name for name in machines if name not in ENTRIES]
    if unknown:
        raise InputError(f"no shipped machine {unknown[0]!r}; cases are looked for in {', '.join(ENTRIES)}.")
    folders = dict.fromkeys(map(folder_of, machines or ENTRIES))
    return [case for folder in folders for case in cases_of(covered(folder))]


def cases_of(found: Covered) -> Iterator[FoldedCase]:
    """Yield each case once, even if its expression is used often; of a hidden case tell a figure that makes it live."""
    seen: set[tuple[str, Place, str]] = set()
    figures = found.figures()
    for split, why in sorted(found.folded().items(), key=lambda pair: pair[0].place):
        live = [f"{target}, {name}" for target, name in found.live_in(split)]
        where = f"live in {first_few(live)}" if live else _not_live(found, split, figures)
        if (split.kind, split.place, where) not in seen:
            seen.add((split.kind, split.place, where))
            yield FoldedCase(split.kind, str(split.place), source_of(split.place), why, where)


def _not_live(found: Covered, split: Split, figures: Mapping[Split, Change]) -> str:
    if split in found.never:
        return f"never live: {found.never[split]}"
    if split in found.shared:
        return "in a folder that several machines use"
    return (
        f"{_HIDDEN}; {figures[split]} makes it live"
        if split in figures
        else f"{_HIDDEN}; no figure alone makes it live"
    )
