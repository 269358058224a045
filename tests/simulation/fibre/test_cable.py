"""Cables: slack, coupling, sections, points, ends."""

from __future__ import annotations

import numpy as np
import pytest

from safeloc.errors import InputError
from safeloc.sensing.fibre.figures import Interrogator
from safeloc.simulation.fibre.cable import Cable, CableFigures, Section, cable

INTER = Interrogator(fibre_mm=20_000_000)


def made(seed: int = 0, **more: object) -> Cable:
    """A cable of 20 km."""
    return cable(INTER, np.random.default_rng(seed), **more)  # type: ignore[arg-type]


def test_the_seed_makes_the_cable() -> None:
    """The same one twice, another one else."""
    one, same, other = made(1), made(1), made(2)
    assert np.array_equal(one.scatterers, same.scatterers)
    assert np.array_equal(one.coupling, same.coupling)
    assert not np.array_equal(one.scatterers, other.scatterers)


def test_coupling_varies_as_its_figures_say() -> None:
    """2 dB of amplitude, alike over 100 m, unlike over a kilometre."""
    level = 20 * np.log10(made().coupling)
    assert 2 == pytest.approx(level.std(), rel=0.25)
    assert 0 == pytest.approx(level.mean(), abs=0.5)
    near = np.corrcoef(level[:-8], level[8:])[0, 1]
    far = np.corrcoef(level[:-400], level[400:])[0, 1]
    assert near > 0.9
    assert abs(far) < 0.3
    assert np.array_equal(np.ones(8_000), made(figures=CableFigures(coupling_cdb=0)).coupling)


def test_scatter_has_unit_power() -> None:
    """In the mean over cells."""
    assert 1 == pytest.approx((np.abs(made().scatterers) ** 2).mean(), rel=0.05)


def test_sections_change_coupling_or_material() -> None:
    """Only where they are."""
    plain = made()
    laid = made(sections=(Section(100, 150, 4.0), Section(300, 400, 0.25, by="material")))
    assert np.allclose(4, (laid.coupling / plain.coupling)[40:60])
    assert np.allclose(1, np.delete(laid.coupling / plain.coupling, slice(40, 60)))
    assert np.allclose(0.25, laid.material[120:160])
    assert np.allclose(1, np.delete(laid.material, slice(120, 160)))


def test_slack_and_loops_are_laid() -> None:
    """2 % of slack, and a loop of 30 m at one place."""
    laid = made(map_points=((0, 0), (10_200, 10_000), (10_230, 10_000), (20_000, 19_500)))
    assert 10_000 / 10_200 * 5_001.25 == pytest.approx(laid.track_m[2_000])
    loop = (laid.places_m > 10_200) & (laid.places_m < 10_230)
    assert np.allclose(10_000, laid.track_m[loop])
    assert np.all(np.diff(laid.track_m) >= 0)


def test_points_and_ends_reflect() -> None:
    """Much more than scatter; an absorber takes the end away."""
    plain, pointed, open_end = made(), made(points_m=(5_000.0,)), made(absorber=False)
    assert 30 == pytest.approx(abs(pointed.scatterers[2_000] - plain.scatterers[2_000]), rel=1e-5)
    assert 300 == pytest.approx(abs(open_end.scatterers[-1] - plain.scatterers[-1]), rel=1e-5)
    assert (0, 0.05) == (plain.ghost, open_end.ghost)


def test_impossible_cables_are_refused() -> None:
    """Points beyond the end, a map that goes back."""
    with pytest.raises(InputError, match="not on a fibre of 20000"):
        made(points_m=(20_001.0,))
    with pytest.raises(InputError, match="ascending order of fibre"):
        made(map_points=((0, 0), (10, 5), (10, 6)))
