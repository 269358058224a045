"""The JSON schema of a line, made from the models; the file beside this module is its published copy."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

from safeloc.railway.map.model import Line

PUBLISHED = Path(__file__).with_name("line.schema.json")


def line_schema() -> dict[str, Any]:
    """Return JSON Schema 2020-12 of a line. The models also check what it cannot express: references, positions on edges."""
    schema = Line.model_json_schema()
    return {"$schema": "https://json-schema.org/draft/2020-12/schema", "$id": "safeloc-line/1", **schema}


def schema_text() -> str:
    """Return the text of the published schema."""
    return json.dumps(line_schema(), indent=1, sort_keys=True) + "\n"
