"""docs/guard.md says what is so: its program runs, every reason is explained, its figures are those of the code."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

import pytest

from safeloc.models.guard.variables import JUDGED, GuardConfig

pytest.importorskip("pyproj")
ROOT = Path(__file__).parents[3]
TEXT = (ROOT / "docs" / "guard.md").read_text(encoding="utf-8")


def test_the_program_runs() -> None:
    """The fourth fix is the first one passed on."""
    code = re.search(r"```python\n(.*?)```", TEXT, re.DOTALL)
    assert code is not None
    done = subprocess.run([sys.executable, "-c", code.group(1)], capture_output=True, text=True, check=True, cwd=ROOT)
    assert ["UNCONFIRMED"] * 3 + ["PASSED"] * 3 == [line.split()[0] for line in done.stdout.splitlines()]


def test_every_reason_is_explained() -> None:
    """But for those of a position that is passed on, and of a step in which nothing came."""
    told = set(re.findall(r"`([A-Z_]{4,})`", TEXT))
    assert {reason.label for reason in JUDGED} - {"PASSED", "NOTHING"} <= told


def test_figures_are_named_as_they_are() -> None:
    """Every figure that the text names is one of the configuration."""
    named = set(re.findall(r"`([a-z_]+_(?:mm|ms|permille)|confirmations)`", TEXT))
    assert named - {"at_ms", "time_ms", "position_mm", "way_mm", "offset_mm", "known_from_mm", "known_to_mm"} <= set(
        GuardConfig.model_fields
    )
