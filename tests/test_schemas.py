"""Schema names of files: each stands for one form."""

from __future__ import annotations

import re
from collections import defaultdict

from tests.rooms import ROOT, files

SHARED = {
    "safeloc-certificate/1": {"safeloc/codegen/smtlib.py", "safeloc/checker/text.py"},
    "safeloc-stream/1": {"safeloc/runtime/streams/steps.py", "safeloc/codegen/javascript.py"},
}
"""Schemas with a writer and a reader that may not import each other: the checker states the form for itself, and a machine as a script
writes the streams that the runtime reads."""


def test_a_schema_is_one_form() -> None:
    """Each name is assigned in one file, but for those above; whoever else needs it imports it."""
    declared: dict[str, set[str]] = defaultdict(set)
    for path in files():
        for name in re.findall(r'^\w+ = "(safeloc-[a-z-]+/\d+)"', path.read_text(encoding="utf-8"), re.MULTILINE):
            declared[name].add(path.relative_to(ROOT).as_posix())
    assert {"safeloc-runs/2", "safeloc-line-runs/1"} <= set(declared)
    assert {name: where for name, where in declared.items() if len(where) > 1} == SHARED
