"""Case splits of shipped machines that are live in no declared configuration.

Targets of one folder (`satellite` and `satellite_drift`) are checked together. Of a composition only its own declarations
are checked: its members are checked by themselves.
"""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from pydantic import BaseModel

from safeloc.assurance.source_places import Place, shown
from safeloc.assurance.splits.deciding import Change, deciding
from safeloc.assurance.splits.live_splits import Splits, splits_of, together
from safeloc.assurance.splits.observed import Split
from safeloc.assurance.splits.places import source_of
from safeloc.catalogue import DEFAULTS, ENTRIES
from safeloc.target import Entry

SHARED = {
    "models/motion/world.py: laws is None": "every shipped machine passes its own laws; the default is for tests",
    "models/motion/world.py: seen is None": "every shipped machine passes its own ghosts; the default is for tests",
}
"""Branches of shared rooms that no shipped machine takes, and why."""
OnBuilt = Callable[[str, str], None]


def _quiet(_: str, __: str) -> None:
    """Do nothing."""


@dataclass(frozen=True, eq=False)
class Covered:
    """The case splits in the declarations of one folder.

    found    target and name of the configuration -> its splits
    hidden   splits that are live in no configuration, without a declared reason
    never    splits that are live in no configuration, with the declared reason
    shared   branches in folders of several machines that these targets do not take
    idle     declared reasons without a split: it is live, or no longer exists
    """

    folder: str
    found: Mapping[tuple[str, str], Splits]
    hidden: Mapping[Split, str]
    never: Mapping[Split, str]
    shared: Mapping[Split, str]
    idle: tuple[str, ...]

    def live_in(self, split: Split) -> tuple[tuple[str, str], ...]:
        """Return the targets and configurations in which a split is live."""
        return tuple(where for where, splits in self.found.items() if split in splits.live)

    def figures(self) -> dict[Split, Change]:
        """Return, for each hidden split, a change of one figure of the defaults that makes it live, if there is one."""
        if not self.hidden:
            return {}
        hidden = Splits(frozenset(), self.hidden)
        every = [deciding(entry, entry.config(), hidden) for entry in targets_of(self.folder)]
        return {split: change for found in every for split, change in found.items()}

    def folded(self) -> Mapping[Split, str]:
        """Return the splits that the defaults of all targets fold away, each with the reason why it is constant."""
        return together(splits for (_, name), splits in self.found.items() if name == DEFAULTS).dead


def folder_of(target: str) -> str:
    """Return the folder of `models/` that declares a shipped target."""
    return ENTRIES[target].folder


def targets_of(folder: str) -> list[Entry[Any]]:
    """Return the shipped targets that a folder declares."""
    return [entry for name, entry in ENTRIES.items() if folder_of(name) == folder]


def configurations_of(entry: Entry[Any]) -> dict[str, BaseModel]:
    """Return every configuration in which a machine is proved, the defaults first."""
    return {DEFAULTS: entry.config(), **entry.configurations.named}


def covered(folder: str, on_built: OnBuilt = _quiet) -> Covered:
    """Build every target of a folder in each of its configurations; return the live and the folded splits."""
    return judge(folder, targets_of(folder), on_built)


def judge(folder: str, entries: Sequence[Entry[Any]], on_built: OnBuilt = _quiet) -> Covered:
    """Build these targets in each of their configurations; return the live and the folded splits."""
    found: dict[tuple[str, str], Splits] = {}
    for entry in entries:
        for name, config in configurations_of(entry).items():
            on_built(entry.name, name)
            found[entry.name, name] = _own(folder, _made(entry, config))
    dead = together(found.values()).dead
    reasons = {place: why for entry in entries for place, why in entry.configurations.never.items()}
    shared = {split: why for split, why in dead.items() if _is_shared(split)}
    never = {split: reasons[text_of(split)] for split in dead if text_of(split) in reasons}
    needed = {text_of(split) for split in never}
    hidden = {split: why for split, why in dead.items() if split not in never and split not in shared}
    return Covered(folder, found, hidden, never, shared, tuple(place for place in reasons if place not in needed))


def _made(entry: Entry[Any], config: BaseModel) -> Splits:
    return splits_of(lambda: entry.make(config))


def text_of(split: Split) -> str:
    """Return the name of a split in `Configurations.never`: file, expression, and the call that led there.

    It contains no line number, so it does not change when lines are added above.
    """
    called = f" from {_called(split.way[1])}" if len(split.way) > 1 else ""
    return f"{shown(split.place.file)}: {source_of(split.place)}{called}"


def _called(place: Place) -> str:
    """Return the text of a call; of a comprehension what it goes over, whose place alone Python 3.13 reports."""
    try:
        found = ast.parse(place.text, mode="eval").body
    except SyntaxError:  # a statement, as `yield from`
        return source_of(place)
    over = found.generators[-1].iter if isinstance(found, ast.ListComp | ast.GeneratorExp) else None
    return source_of(place) if over is None else ast.unparse(over)


def _own(folder: str, splits: Splits) -> Splits:
    others = {folder_of(name) for name in ENTRIES} - {folder}
    live = frozenset(split for split in splits.live if not _of_others(split, others))
    return Splits(live, {split: why for split, why in splits.dead.items() if not _of_others(split, others)})


def _of_others(split: Split, others: Iterable[str]) -> bool:
    """Return whether a split belongs to another machine, whose own configurations cover it."""
    return not _rooms(split).isdisjoint(others)


def _rooms(split: Split) -> set[str]:
    """Return the folders of the calls that led to a split."""
    files = [shown(place.file) for place in split.way]
    return {file.split("/")[1].removesuffix(".py") for file in files if "/" in file}


def _is_shared(split: Split) -> bool:
    """Return whether a branch is in a folder of several machines, such as `vocabulary`; one machine that takes it suffices."""
    return len(split.way) == 1 and _rooms(split).isdisjoint({folder_of(name) for name in ENTRIES})


def hidden_in_shared_rooms(found: Iterable[Covered]) -> dict[Split, str]:
    """Return the branches in shared folders that no machine takes in any configuration."""
    every = list(found)
    live = frozenset().union(*(splits.live for one in every for splits in one.found.values()))
    dead = {split: why for one in every for split, why in one.shared.items() if split not in live}
    return {split: why for split, why in dead.items() if text_of(split) not in SHARED}
