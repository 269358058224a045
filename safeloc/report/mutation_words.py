"""The mutation score of a machine in the words of the page: how many wrong machines a proof notices, and which were asked."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

_Data = Mapping[str, Any]


def score_words(score: _Data | None) -> dict[str, str] | None:
    """Return what the page says of a score: the share, which mutants were judged, what no proof notices, the day; None without a score."""
    if score is None:
        return None
    mutants, judged, missed = score["mutants"], score["judged"], score["with_reason"] + score["open"]
    reasons = f"{score['with_reason']} with a written reason, {score['open']} without"
    return {
        "share": share(score),
        "judged": f"all {judged} judged" if judged == mutants else f"a sample of {judged} of {mutants}",
        "same": f"{judged - score['wrong']} of the judged are equivalent or conservative, and do not count",
        "missed": f"no proof notices {missed}: {reasons}" if missed else "",
        "day": score["since"][:10],
    }


def share(score: _Data) -> str:
    """Return the wrong machines that a proof notices, such as `585 of 588 (99 %)`; the percentage is rounded down."""
    wrong, by_proof = score["wrong"], score["by_proof"]
    return f"{by_proof} of {wrong} ({100 * by_proof // wrong} %)" if wrong else "none counts"
