"""Results that ship beside a machine: `NAME.KIND` in its folder of `models/`, read for the machine in its default figures only."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TypeVar

from pydantic import BaseModel, ConfigDict, ValidationError

from safeloc.catalogue import ENTRIES
from safeloc.errors import InputError
from safeloc.target import MODELS, Target, beside


class ShippedFile(BaseModel):
    """The head that each such file has: its schema, and the digest of the machine that it is about."""

    model_config = ConfigDict(extra="forbid", strict=True)
    schema_: str
    digest: str


Form = TypeVar("Form", bound=ShippedFile)


def has_shipped_figures(target: Target) -> bool:
    """Return whether the target is a machine that ships, in its default figures."""
    named = target.spec.isidentifier() and target.spec in ENTRIES
    return named and target.config == ENTRIES[target.spec].config()


def shipped_file(target: Target, kind: str) -> Path | None:
    """Return the file of this kind that ships with the machine; None if there is none."""
    return beside(ENTRIES[target.spec].name, kind)


def place_of(target: Target, kind: str) -> Path:
    """Return the path of the file of this kind in the machine's folder, whether or not it is there."""
    entry = ENTRIES[target.spec]
    return MODELS / entry.folder / f"{entry.name}.{kind}"


def read_shipped(path: Path, form: type[Form], schema: str, what: str) -> Form:
    """Return the content of a file, read as `form`; InputError for a file of another form or schema.

    what  the content in words, for the message
    """
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        found = form.model_validate({"schema_": content.pop("schema", ""), **content})
    except (ValueError, AttributeError, TypeError, ValidationError) as error:
        raise InputError(f"{path}: no file of {what}: {error}") from error
    if found.schema_ != schema:
        raise InputError(f"{path}: written as {found.schema_!r}, not as {schema!r}.")
    return found
