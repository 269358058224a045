"""Costs of a design, and the elements that it adds: figures of the engineer, with defaults that are marked as such."""

from __future__ import annotations

from safeloc.config import Config, quantity
from safeloc.railway.map.elements import BaliseGroup, Marker, Reflector


class Costs(Config):
    """Costs over the life of a line. Only their ratios decide what is chosen; a project gives its own (`--cost`)."""

    keep_group_eur: int = quantity(
        2_000, "EUR", 0, 10**9, "engineering default: inspection and spares of a group in place"
    )
    add_group_eur: int = quantity(
        10_000, "EUR", 0, 10**9, "engineering default: two balises, survey, data, and their upkeep"
    )
    keep_reflector_eur: int = quantity(500, "EUR", 0, 10**9, "engineering default: inspection of a passive reflector")
    add_reflector_eur: int = quantity(
        3_000, "EUR", 0, 10**9, "engineering default: reflector, mast and survey, and their upkeep"
    )

    keep_marker_eur: int = quantity(300, "EUR", 0, 10**9, "engineering default: inspection of a passive marker")
    add_marker_eur: int = quantity(
        2_500, "EUR", 0, 10**9, "engineering default: marker, survey and data, and their upkeep"
    )

    def of(self, element: BaliseGroup | Reflector | Marker, *, new: bool) -> int:
        """Return the cost of an element: of keeping one, or of a new one."""
        if isinstance(element, Marker):
            return self.add_marker_eur if new else self.keep_marker_eur
        if isinstance(element, BaliseGroup):
            return self.add_group_eur if new else self.keep_group_eur
        return self.add_reflector_eur if new else self.keep_reflector_eur


class Added(Config):
    """The elements that a design may add."""

    location_accuracy_mm: int = quantity(1_000, "mm", 0, 63_000, "engineering default: surveyed to 1 m")
    balise_spacing_mm: int = quantity(
        3_000, "mm", 2_300, 12_000, "[S] SUBSET-036: 2.3 m to 12 m between two balises of a group"
    )
    view_from_mm: int = quantity(100_000, "mm", 1, 10_000_000, "engineering default: as on the worked lines")
    view_to_mm: int = quantity(3_000, "mm", 0, 10_000_000, "engineering default: as on the worked lines")
    reflector_models: int = quantity(
        0,
        "count",
        0,
        20,
        "engineering default: none, since not every vehicle has a radar; the models that it tells apart",
    )
    markers: int = quantity(
        0,
        "count",
        0,
        10_000,
        "engineering default: none, since not every vehicle reads them; at most so many are added",
    )
    marker_accuracy_mm: int = quantity(300, "mm", 0, 63_000, "engineering default: surveyed to 0.3 m")
    lateral_offset_mm: int = quantity(2_500, "mm", -100_000, 100_000, "engineering default: as on the worked lines")
