"""Check of `unsat` without trust in a solver: for every certificate in a folder, the proof steps that remain to be trusted."""

from __future__ import annotations

import multiprocessing
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

from safeloc.checker.folder import processes
from safeloc.checker.proofs.goals import check_unsat_proofs
from safeloc.checker.proofs.steps import Checked
from safeloc.errors import InputError
from safeloc.report.certificates import FOLDER, read_archives
from safeloc.report.stored import read_report


@dataclass
class Survey:
    """The results of checking the proofs of all certificates.

    sure      certificates of which every proof step was checked: they need no trust in a solver
    trusted   certificate -> rules with unchecked steps, each with the number of these steps
    unproved  certificate -> the goal without a proof in time, or the place of a wrong step
    """

    sure: list[str] = field(default_factory=list)
    trusted: dict[str, dict[str, int]] = field(default_factory=dict)
    unproved: dict[str, str] = field(default_factory=dict)

    @property
    def rules(self) -> Counter[str]:
        """The number of steps that were not checked, by rule."""
        return sum((Counter(counts) for counts in self.trusted.values()), Counter[str]())


def survey(folder: Path, *, jobs: int, seconds: float, progress: Callable[[int, int], None]) -> Survey:
    """Make and check a proof of every goal of every certificate; `seconds` is the solver's limit for each goal.

    progress  called with the number of certificates that are done, and of all

    InputError if the folder has no certificates.
    """
    read = read_archives(folder / FOLDER, read_report(folder)["certificates"])
    if not read.texts and not read.damaged:
        raise InputError(f"{folder}: no certificates; write a report with `safeloc verify --out {folder}`.")
    found = Survey(unproved=dict(read.damaged))
    with multiprocessing.get_context("fork").Pool(processes(jobs, len(read.texts))) as pool:
        looked_at = pool.imap_unordered(partial(_looked_at, seconds), sorted(read.texts.items()))
        for done, (name, trusted, where) in enumerate(looked_at, 1):
            if where:
                found.unproved[name] = where
            elif trusted:
                found.trusted[name] = trusted
            else:
                found.sure.append(name)
            progress(done, len(read.texts))
    return found


def _looked_at(seconds: float, certificate: tuple[str, str]) -> tuple[str, dict[str, int], str]:
    """Return the certificate's name, its unchecked steps by rule, and the error ("" for none)."""
    name, text = certificate
    trusted: Counter[str] = Counter()
    try:
        for one in check_unsat_proofs(text, seconds=seconds):
            if not isinstance(one.result, Checked):
                return name, {}, f"{one.goal}: {one.result.where}"
            trusted.update(one.result.trusted)
    except InputError as error:
        return name, {}, str(error)
    return name, dict(trusted), ""
