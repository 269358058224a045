"""The published JSON schema is that of the models, and agrees with them."""

from __future__ import annotations

import json

import jsonschema
import pytest

from safeloc.railway.map.schema import PUBLISHED, line_schema, schema_text
from safeloc.railway.map.toml_files import find_line


def test_the_published_schema_is_that_of_the_models() -> None:
    """Whoever changes a model publishes the schema again."""
    assert schema_text() == PUBLISHED.read_text(encoding="utf-8")


def test_it_is_a_schema() -> None:
    """JSON Schema 2020-12 accepts it."""
    jsonschema.Draft202012Validator.check_schema(line_schema())


@pytest.mark.parametrize("name", ["fig1", "fig2", "fig3"])
def test_the_worked_examples_fit(name: str) -> None:
    """What the models accept, the schema accepts."""
    content = json.loads(find_line(name).model_dump_json(exclude_defaults=True))
    jsonschema.Draft202012Validator(line_schema()).validate(content)


@pytest.mark.parametrize("change", [{"version": 1}, {"colour": "red"}, {"checksum": "md5:0"}, {"edges": []}])
def test_what_does_not_fit_is_refused(change: dict[str, object]) -> None:
    """Types, unknown keys, patterns and lengths are in the schema."""
    content = json.loads(find_line("fig1").model_dump_json(exclude_defaults=True)) | change
    assert not jsonschema.Draft202012Validator(line_schema()).is_valid(content)


def test_units_are_told() -> None:
    """Every length names its unit in the schema."""
    reflector = line_schema()["$defs"]["Reflector"]["properties"]
    assert {"mm"} == {reflector[name]["unit"] for name in ("position_mm", "view_from_mm", "lateral_offset_mm")}
