"""The declaration that a report or a certificate is about, loaded again."""

from __future__ import annotations

import json
import tempfile
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from safeloc.catalogue import load_target
from safeloc.errors import InputError
from safeloc.language.digest import full_digest
from safeloc.target import Target


def declared(machine: Mapping[str, Any]) -> Target:
    """Load the target of the report, with the report's configuration; InputError if its declaration has changed."""
    configuration = machine.get("configuration")
    with tempfile.TemporaryDirectory() as place:
        path = Path(place, "configuration.json") if configuration is not None else None
        if path is not None:
            path.write_text(json.dumps(configuration), encoding="utf-8")
        target = load_target(machine["spec"], path)
    if full_digest(target.system) != machine["declaration"]:
        raise InputError(
            f"{machine['spec']}: the declaration has another digest than in the report; verify it again, or check with the "
            "version of safeloc that made the report."
        )
    return target
