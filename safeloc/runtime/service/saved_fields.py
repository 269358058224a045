"""The required fields of a snapshot of the process: a correct checksum alone does not guarantee them."""

from __future__ import annotations

import json
from collections.abc import Mapping
from typing import Annotated, Any, Literal, TypeVar

from pydantic import BaseModel, ConfigDict, Field, ValidationError

from safeloc.errors import SnapshotError

Count = Annotated[int, Field(ge=0)]
_Text = Annotated[str, Field(max_length=10_000)]


class SavedVehicle(BaseModel):
    """The fields of one vehicle, for records and steps alike."""

    model_config = ConfigDict(strict=True, extra="forbid", frozen=True)

    controller: str | None
    lost: tuple[_Text, _Text]
    count: tuple[Count | None, _Text]
    recount: tuple[Count | None, Count] = (None, 0)
    streak: tuple[Count | None, Count]
    rhythm: tuple[Count | None, Count] = (None, 0)
    stopped: _Text


class SavedRecords(SavedVehicle):
    """The fields of a vehicle that sends records: also the records of the open cycle, with their lines."""

    pending: list[tuple[Count, dict[str, Any]]]


class SavedSteps(SavedVehicle):
    """The fields of a vehicle that sends steps.

    kept     inputs that the stream leaves out while they are unchanged
    before   their last values
    bare     lines without a cycle number in a row
    """

    numbered: bool
    bare: Count = 0
    kept: tuple[str, ...] = ()
    before: dict[str, Any] = Field(default_factory=dict)


class SavedProcess(BaseModel):
    """The snapshot of the entire process."""

    model_config = ConfigDict(strict=True, frozen=True)

    lines: Literal["records", "steps"]
    feed: dict[str, Any]
    outlet: dict[str, Any]
    vehicles: dict[Annotated[str, Field(pattern=r"^[A-Za-z0-9_.:-]{1,64}$")], dict[str, Any]]


class SavedPlace(BaseModel):
    """A position in a file, and a digest of the text before it."""

    model_config = ConfigDict(strict=True, frozen=True)

    consumed: Count
    line: Count
    mark: str | None


Model = TypeVar("Model", bound=BaseModel)


def checked_fields(model: type[Model], content: Mapping[str, Any]) -> Model:
    """Return the content as a model; SnapshotError for a field that is missing, unknown or of a wrong type."""
    try:
        return model.model_validate_json(json.dumps(content))
    except (ValidationError, TypeError, ValueError) as error:
        raise SnapshotError(f"a field of the snapshot is wrong ({_first(error)}).") from error


def _first(error: Exception) -> str:
    if not isinstance(error, ValidationError):
        return str(error)
    found = error.errors(include_url=False, include_input=False, include_context=False)[0]
    return f"{'.'.join(map(str, found['loc']))}: {found['msg']}"
