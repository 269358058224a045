"""The example of docs/campaigns.md prints what the page shows."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from safeloc.campaign.declaration import Declaration
from safeloc.campaign.distributions import Choice, Fixed, LogUniform, Normal, Uniform
from safeloc.campaign.regression import NAME
from tests.cli.calling import Call
from tests.started_pytest import run_pytest

ROOT = Path(__file__).parents[2]
PAGE = (ROOT / "docs" / "campaigns.md").read_text(encoding="utf-8")
[(LINE, SHOWN)] = re.findall(r"```text\n\$ safeloc (.*?)\n(.*?)```", PAGE, re.DOTALL)


@pytest.mark.thorough
def test_the_page_shows_what_is_printed(call: Call, tmp_path: Path) -> None:
    """Every line of the example's output, to the last digit."""
    words = LINE.replace("docs/examples", str(ROOT / "docs" / "examples")).replace("found", str(tmp_path / "found"))
    called = call(*words.split())
    assert 0 == called.code
    assert [line for line in SHOWN.splitlines() if line not in called.out.splitlines()] == []
    told = run_pytest("-q", str(tmp_path / "found" / "streams" / NAME), folder=tmp_path)
    assert told.returncode == 0, told.stdout


def test_the_page_names_every_key() -> None:
    """Those of the declaration, and every distribution."""

    kinds = [one.model_fields["distribution"].annotation for one in (Fixed, Uniform, Normal, LogUniform, Choice)]
    names = [str(kind.__args__[0]) for kind in kinds if kind is not None]
    assert [
        name for name in [*Declaration.model_fields, *names] if f"`{name}`" not in PAGE and f"[{name}]" not in PAGE
    ] == []
