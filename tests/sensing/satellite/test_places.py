"""Places on the ellipsoid and back."""

from __future__ import annotations

import math

import pytest

from safeloc.errors import InputError
from safeloc.sensing.satellite.places import Place


@pytest.mark.parametrize("degrees", [(35.1, 137.0, 104.9), (-62.0, -10.0, -28.0), (0.0, 180.0, 0.0), (89.9, 5.0, 4e3)])
def test_earth_fixed_and_back(degrees: tuple[float, float, float]) -> None:
    """The way back ends within a tenth of a millimetre, at every latitude."""
    there = Place.degrees(*degrees).earth_fixed_m()
    assert math.dist(there, Place.of_earth_fixed(there).earth_fixed_m()) < 1e-4


def test_what_is_no_place_is_refused() -> None:
    """The centre of the Earth, and figures that are not finite."""
    for point in ((0.0, 0.0, 0.0), (math.nan, 0.0, 6.4e6)):
        with pytest.raises(InputError, match="not near"):
            Place.of_earth_fixed(point)
    with pytest.raises(InputError, match="finite"):
        Place(0.0, math.inf, 0.0)
