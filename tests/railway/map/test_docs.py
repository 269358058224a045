"""docs/line.md says what is so: its example is a sound line, its program runs, its tables are complete."""

from __future__ import annotations

import re
import subprocess
import sys
from pathlib import Path

from safeloc.models.layout_rules import LayoutConfig
from safeloc.models.layout_rules.marker_readers import MarkerReaders
from safeloc.railway.audit import audit
from safeloc.railway.audit.rules import Rule, Rules
from safeloc.railway.map.integrity import kinds
from safeloc.railway.map.model import Line
from safeloc.railway.map.toml_files import find_line, from_toml

ROOT = Path(__file__).parents[3]
TEXT = (ROOT / "docs" / "line.md").read_text(encoding="utf-8")


def block(language: str) -> str:
    """The first code block in a language."""
    found = re.search(rf"```{language}\n(.*?)```", TEXT, re.DOTALL)
    assert found is not None
    return found.group(1)


def test_the_example_keeps_every_rule() -> None:
    """It can be copied as it stands."""
    assert () == audit(from_toml(block("toml"), "docs/line.md")).findings


def test_the_program_runs() -> None:
    """It prints the three routes from track 301 to track 310 of Fig. 3."""
    done = subprocess.run([sys.executable, "-c", block("python")], capture_output=True, text=True, check=True, cwd=ROOT)
    assert ["ACD", "ADAD", "ADCD"] == sorted(line.split(" [")[0].split()[-1] for line in done.stdout.splitlines())


def test_every_list_and_figure_is_told() -> None:
    """Lists of elements, figures of the vehicle with their defaults, and rules."""
    lists = {name for name, value in find_line("fig1") if isinstance(value, tuple)}
    assert set(kinds(find_line("fig1"))) <= lists <= set(Line.model_fields)
    assert [] == [name for name in lists if f"[[{name}]]" not in TEXT and f"`{name}`" not in TEXT]
    figures = (*LayoutConfig.model_fields, *MarkerReaders.model_fields)
    assert [] == [name for name in figures if f"`{name}`" not in TEXT]
    rules = [getattr(Rules(LayoutConfig()), name) for name in vars(Rules) if not name.startswith("_")]
    named = [rule.name for rule in rules if isinstance(rule, Rule)]
    assert 27 == len(named)
    assert [] == [name for name in named if f"{name} |" not in TEXT and f"{name}," not in TEXT]
