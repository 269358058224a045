"""Proofs of the small declarations, made once, and the checker's answer to them with a text or two replaced."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from safeloc.catalogue import load_target
from safeloc.checker.folder import Checking, asked, check_target
from safeloc.checker.solve import Opinion
from safeloc.language.digest import full_digest
from safeloc.language.verdict import Proved
from safeloc.proof.provers.limits import Limits
from safeloc.proof.provers.obligations import obligations
from safeloc.proof.provers.portfolio import prove
from safeloc.proof.results import Finding
from safeloc.report.data import result_data
from safeloc.report.folder import write_folder
from safeloc.target import Target

NAMES = ("counting", "whole", "twins", "tracking", "coded")
LIMITS = Limits(seconds=20)


@dataclass(frozen=True, eq=False)
class Evidence:
    """What was proved of a target."""

    target: Target
    findings: list[Finding]
    texts: dict[str, str]
    rows: list[dict[str, Any]]
    opinions: dict[str, Opinion]

    def judged(self, changed: Mapping[str, str | None] | None = None) -> Checking:
        """The checker's answer where some texts say something else (None: are left out); runs are not looked at."""
        texts = {name: text for name, text in (self.texts | dict(changed or {})).items() if text is not None}
        found = Checking()
        found.opinions.update(self.opinions)
        found.opinions.update({name: solved(text) for name, text in (changed or {}).items() if text is not None})
        rows = [row for row in self.rows if row["certificates"]]
        check_target(self.target, rows, texts, lambda _: None, found)
        return found

    def file(self, part: str) -> str:
        """The one file whose name has this part."""
        [name] = [name for name in self.texts if part in name]
        return name


def solved(text: str) -> Opinion:
    """Return the solvers' answers about a text; they decide such small texts at once, or never."""
    [(_, said)] = asked(5, [("a text", text)])
    return said


def made(name: str) -> Evidence:
    """The proofs of a declaration of this name."""
    target = load_target(f"tests.checker.declared:{name}")
    return kept(target, prove(target.system, target.properties, LIMITS) + obligations(target.system, LIMITS))


def kept(target: Target, findings: list[Finding]) -> Evidence:
    """What was proved of a target, as a report keeps it, with the solvers' opinions."""
    proofs = [one.result for one in findings if isinstance(one.result, Proved)]
    texts = {file: text for proof in proofs for file, text in proof.certificates.items()}
    rows = [result_data(finding) for finding in findings]
    return Evidence(target, findings, texts, rows, {file: solved(text) for file, text in texts.items()})


def refused(found: Checking) -> list[str]:
    """The results that are not confirmed."""
    return [row.id for row in found.rows if row.answer != "confirmed"]


def removed(text: str, pattern: str) -> str:
    """The text without the one piece that is of this form."""
    changed, number = re.subn(pattern, "", text)
    assert number == 1, number
    return changed


def written(folder: Path, evidence: Evidence) -> Path:
    """A report folder of it."""
    write_folder(folder, evidence.findings, [evidence.target])
    assert full_digest(evidence.target.system)
    return folder
