"""The mutation score of a machine, kept for reports: a report takes it from here, and judges no mutants itself.

It belongs to the content of a target and to the engine that judged: of a target that has changed since there is none.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from safeloc.assurance.kept_work import Keeping
from safeloc.assurance.mutation.results import Judged, of_part, questions, score
from safeloc.proof.cache.store import Store, utc_now
from safeloc.proof.cache.targets import asked
from safeloc.target import Target

_KIND, _LATEST = "mutation score", "latest"


def score_data(judged: Sequence[Judged], of: int, reasons: Mapping[str, str]) -> dict[str, Any]:
    """Return the score of a machine, with the term wrong wherever it stands, as plain data.

    mutants     number of all mutants of the machine; `judged` of them were judged
    wrong       those of the judged that are neither equivalent nor conservative
    by_proof    those of the wrong that a proof detects
    with_reason those that no proof detects, and a written reason says why none needs to; the rest is `open`
    """
    machine = of_part(judged, "machine")
    counts = score([one.everywhere for one in machine])
    missed = questions(machine)
    with_reason = sum(one.id in reasons for one in missed)
    return {
        "mutants": of,
        "judged": len(machine),
        "wrong": counts.asked,
        "by_proof": counts.killed_by_proof,
        "with_reason": with_reason,
        "open": len(missed) - with_reason,
    }


def keep_score(store: Store, target: Target, judged: Sequence[Judged], of: int, reasons: Mapping[str, str]) -> None:
    """Store the score with its date; a smaller sample does not replace a greater one, and an equal score keeps its date."""
    data, had = score_data(judged, of, reasons), kept_score(store, target) or {}
    if not data["judged"] or data["judged"] < had.get("judged", 0) or had == {**data, "since": had.get("since")}:
        return
    _keeping(store, target).keep("all", {**data, "since": utc_now()})
    before = stamp(store) + json.dumps(data)
    store.put(_KIND, _LATEST, hashlib.sha256(before.encode()).hexdigest().encode())


def kept_score(store: Store, target: Target) -> dict[str, Any] | None:
    """Return the score kept for this target; None if it was never judged, or has changed since."""
    found: dict[str, Any] | None = _keeping(store, target).kept("all")
    return found


def scores_of(store: Store, targets: Iterable[Target]) -> Mapping[str, Any]:
    """Return the score kept for each of these targets that has one, by its name."""
    found = {target.name: kept_score(store, target) for target in targets}
    return {name: data for name, data in found.items() if data is not None}


def stamp(store: Store) -> str:
    """Return a value that changes whenever a score is stored, so that a cached report without it is not used."""
    entry = store.get(_KIND, _LATEST)
    return "" if entry is None else entry.data.decode()


def _keeping(store: Store, target: Target) -> Keeping:
    return Keeping(_KIND, asked(target, _KIND).key, store, store)
