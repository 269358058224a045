"""An edit, verified warm (with what the unedited run left) and cold: what was kept may save time, and change nothing."""

from __future__ import annotations

import random
import tempfile
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from tests.edits.checkout import Checkout, Ran, edited
from tests.edits.edit import Edit, drawn

DRAWS = 60
ENGINE = ("proof/provers", "proof/drawn_runs", "codegen", "proof/verification")


@dataclass(frozen=True)
class Case:
    """Which machine is verified, and what of which kind is edited: a `machine`'s declaration, or the `engine`."""

    number: int
    kind: str
    machine: str


@dataclass(frozen=True)
class Judged:
    """What came of a case: `wrong` says why it failed, and is empty where both runs agree."""

    case: Case
    where: str
    change: str
    wrong: str
    undecided: bool
    warm_seconds: float
    cold_seconds: float
    codes: tuple[int, int]

    def data(self) -> dict[str, Any]:
        """For the file of a long run."""
        return asdict(self)


def judged(checkout: Checkout, cache: Path, case: Case, seed: int) -> Judged:
    """One case. `cache` is where the unedited machine's run left what it found; it is left there first if it is not."""
    draw = random.Random(f"{seed} {case.kind} {case.number}")
    checkout.verified(case.machine, cache)
    path, edit = edit_of(checkout, case, draw)
    with edited(path, edit.made(path.read_text(encoding="utf-8"))):
        warm, warm_seconds = _timed(checkout, case.machine, cache)
        with tempfile.TemporaryDirectory() as empty:
            cold, cold_seconds = _timed(checkout, case.machine, Path(empty))
    where = f"{path.relative_to(checkout.folder)}:{edit.line}"
    change = f"{edit.before.strip()} -> {edit.after.strip()}"
    undecided = not (warm.decided and cold.decided)
    wrong = _wrong(case, warm, cold, undecided)
    return Judged(case, where, change, wrong, undecided, warm_seconds, cold_seconds, (warm.code, cold.code))


def _timed(checkout: Checkout, machine: str, cache: Path) -> tuple[Ran, float]:
    began = time.monotonic()
    return checkout.verified(machine, cache), round(time.monotonic() - began, 1)


def _wrong(case: Case, warm: Ran, cold: Ran, undecided: bool) -> str:
    if case.kind == "engine" and warm.kept:
        return f"with another engine findings of {', '.join(sorted(warm.kept))} were taken from an earlier one"
    if warm.said == cold.said:
        return ""
    differ = [
        name for name in sorted({*warm.verdicts, *cold.verdicts}) if warm.verdicts.get(name) != cold.verdicts.get(name)
    ]
    told = [f"{name}: {warm.verdicts.get(name)} warm, {cold.verdicts.get(name)} cold" for name in differ]
    against = [
        one
        for one, name in zip(told, differ, strict=True)
        if "unknown" not in (warm.verdicts.get(name), cold.verdicts.get(name))
    ]
    if undecided and not against:
        return ""
    return "; ".join(against or told) or f"exit codes {warm.code} warm, {cold.code} cold: {warm.error} / {cold.error}"


def edit_of(checkout: Checkout, case: Case, draw: random.Random) -> tuple[Path, Edit]:
    """An edit after which the machine can still be made."""
    files = checkout.files_of(case.machine) if case.kind == "machine" else _engine_files(checkout)
    for _ in range(DRAWS):
        path = draw.choice(files)
        text = path.read_text(encoding="utf-8")
        try:
            edit = drawn(text, draw)
        except IndexError:  # nothing to edit in it
            continue
        with edited(path, edit.made(text)):
            if checkout.loads(case.machine):
                return path, edit
    raise AssertionError(f"no edit of {case.machine} out of {DRAWS} leaves a machine")


def _engine_files(checkout: Checkout) -> list[Path]:
    return sorted(path for folder in ENGINE for path in (checkout.folder / "safeloc" / folder).rglob("*.py"))
