"""The mutation score of a machine, kept for reports, which judge no mutants themselves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from safeloc.assurance.kept_results import KeptResults
from safeloc.assurance.mutation.results import Judged, of_part, questions, score
from safeloc.proof.cache.store import Store, utc_now
from safeloc.target import Target

SCORES = KeptResults("mutation score")


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
    data, had = score_data(judged, of, reasons), SCORES.kept(store, target) or {}
    if not data["judged"] or data["judged"] < had.get("judged", 0) or had == {**data, "since": had.get("since")}:
        return
    SCORES.keep(store, target, {**data, "since": utc_now()})
