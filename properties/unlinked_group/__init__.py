"""Properties of the machine of the unlinked group: what it may take, how far the front end is beyond it, and when that is lost."""

from __future__ import annotations

from safeloc.language.spec import Property
from safeloc.models.unlinked_group import UnlinkedGroup
from safeloc.properties.unlinked_group.distance import distance_properties
from safeloc.properties.unlinked_group.reference import reference_properties


def properties(model: UnlinkedGroup) -> list[Property]:
    """Return every property of the machine."""
    return [*distance_properties(model), *reference_properties(model)]
