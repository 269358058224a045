"""Projection: places fit the map to the mm, sides are right, other coordinate systems agree."""

from __future__ import annotations

import math
import sys

import pytest

from safeloc.errors import EngineError, InputError
from safeloc.railway.map.elements import Geometry, Node, TrackEdge
from safeloc.railway.map.model import Line
from safeloc.railway.map.places import Place
from safeloc.railway.map.projection import LAMBERT72, Projector
from tests.data_sources import rows
from tests.railway.map.recorded_trains import network

EQUATOR_M_PER_DEGREE = 111_319.490793


def line_of(*edges: TrackEdge) -> Line:
    """A line of separate edges."""
    nodes = tuple(Node(id=node) for edge in edges for node in (edge.from_node, edge.to_node))
    return Line(name="plane", version="1", nodes=nodes, edges=edges)


def edge(identity: str, *points: tuple[float, float], length_mm: int, crs: str = "EPSG:4326") -> TrackEdge:
    """An edge with a course."""
    return TrackEdge(
        id=identity,
        from_node=f"{identity}0",
        to_node=f"{identity}1",
        length_mm=length_mm,
        geometry=Geometry(crs=crs, points=points),
    )


EAST = line_of(edge("east", (0.0, 0.0), (0.01, 0.0), length_mm=1_113_195))
"""One edge along the equator, 1113.195 m to the east."""


@pytest.mark.parametrize(
    ("longitude", "latitude", "position_mm", "offset_mm"),
    [
        (0.0, 0.0, 0, 0),
        (0.01, 0.0, 1_113_195, 0),
        (0.005, 0.0, 556_598, 0),
        (0.005, 0.0001, 556_598, -11_057),
        (0.005, -0.0001, 556_598, 11_057),
        (-0.0001, 0.0, 0, 11_132),
        (0.0101, 0.0, 1_113_195, 11_132),
    ],
)
def test_places_and_sides(longitude: float, latitude: float, position_mm: int, offset_mm: int) -> None:
    """North of a track that leads east is its left, negative; beyond the ends the distance to the end is given."""
    found = Projector(EAST).project(longitude, latitude)
    assert Place("east", position_mm) == found.place
    assert offset_mm == pytest.approx(found.offset_mm, abs=2)


def test_the_maps_own_length_counts() -> None:
    """The edge is said to be 2000 m long: half way along its course is half way along the map."""
    longer = line_of(edge("east", (0.0, 0.0), (0.01, 0.0), length_mm=2_000_000))
    assert 1_000_000 == Projector(longer).project(0.005, 0.0).place.position_mm


def test_the_nearest_of_several_edges_is_taken() -> None:
    """And only among those asked for."""
    south = edge("south", (0.0, -0.001), (0.01, -0.001), length_mm=1_113_195)
    both = line_of(*EAST.edges, south)
    assert "south" == Projector(both).project(0.005, -0.0009).place.edge
    assert "east" == Projector(both, edges=["east"]).project(0.005, -0.0009).place.edge


def test_a_bend_keeps_its_sides() -> None:
    """Right and left follow the segment that is nearest."""
    bent = line_of(edge("bend", (0.0, 0.0), (0.001, 0.0), (0.001, 0.001), length_mm=221_893))
    projector = Projector(bent)
    assert projector.project(0.0011, 0.0005).offset_mm > 0
    assert projector.project(0.0009, 0.0005).offset_mm < 0


def test_lambert_and_wgs84_agree_on_the_real_network() -> None:
    """Every position of a log is given in both systems; the places agree within 25 mm."""
    projector = Projector(network())
    for row in rows("trains/log_28876.csv")[::50]:
        one = projector.project(float(row["longitude"]), float(row["latitude"]))
        other = projector.project(float(row["lambert72_x"]), float(row["lambert72_y"]), crs=LAMBERT72)
        assert one.place.edge == other.place.edge
        assert abs(one.place.position_mm - other.place.position_mm) <= 25
        assert abs(one.offset_mm - other.offset_mm) <= 25


def test_edges_may_be_in_a_projected_system() -> None:
    """An edge in Lambert 72 and one in degrees are the same track."""
    transformer = pytest.importorskip("pyproj").Transformer.from_crs("EPSG:4326", LAMBERT72, always_xy=True)
    degrees = ((4.45, 50.9), (4.46, 50.9))
    metres = tuple(transformer.transform(*point) for point in degrees)
    one = Projector(line_of(edge("e", *degrees, length_mm=703_000))).project(4.4512, 50.9001)
    other = Projector(line_of(edge("e", *metres, length_mm=703_000, crs=LAMBERT72))).project(4.4512, 50.9001)
    assert abs(one.place.position_mm - other.place.position_mm) <= 2
    assert abs(one.offset_mm - other.offset_mm) <= 2


def test_distance_over_ground() -> None:
    """A hundredth of a degree along the equator."""
    found = Projector(EAST).distance_mm((0.0, 0.0), (0.01, 0.0))
    assert EQUATOR_M_PER_DEGREE * 10 == pytest.approx(found, rel=1e-6)


@pytest.mark.parametrize(("x", "y"), [(math.nan, 0.0), (0.0, math.inf), (0.0, 95.0)])
def test_what_is_no_position_is_refused(x: float, y: float) -> None:
    """NaN, infinities, and a latitude beyond the pole."""
    with pytest.raises(InputError, match="is no position in EPSG:4326"):
        Projector(EAST).project(x, y)


def test_an_unknown_system_is_refused() -> None:
    """By name."""
    with pytest.raises(InputError, match=r"^'EPSG:nothing' is no coordinate system"):
        Projector(EAST).project(0.0, 0.0, crs="EPSG:nothing")


def test_a_line_without_geometry_is_refused() -> None:
    """There is nothing to project to."""
    bare = Line(
        name="bare",
        version="1",
        nodes=(Node(id="a"), Node(id="b")),
        edges=(TrackEdge(id="e", from_node="a", to_node="b", length_mm=1),),
    )
    with pytest.raises(InputError, match="bare: none of these edges has a geometry"):
        Projector(bare)


def test_a_course_without_length_is_refused() -> None:
    """All its points are one."""
    with pytest.raises(InputError, match="edge 'e': its geometry has no length"):
        Projector(line_of(edge("e", (1.0, 1.0), (1.0, 1.0), length_mm=1)))


@pytest.mark.parametrize("package", ["shapely", "pyproj"])
def test_without_the_extra_the_remedy_is_told(monkeypatch: pytest.MonkeyPatch, package: str) -> None:
    """Heavy libraries are an extra."""
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(
        EngineError, match=rf"^projecting positions to the track needs {package}; install safeloc\[geo\]"
    ):
        Projector(EAST)


def test_every_place_that_is_near() -> None:
    """All edges within the limit, nearest first; an edge that comes by twice has two places."""
    crs = "+proj=tmerc +lat_0=48 +lon_0=9 +datum=WGS84 +units=m +no_defs"
    hairpin = ((0.0, 0.0), (300.0, 0.0), (310.0, 6.0), (300.0, 12.0), (0.0, 12.0))
    far = edge("far", (0.0, 90.0), (300.0, 90.0), length_mm=300_000, crs=crs)
    projector = Projector(line_of(edge("loop", *hairpin, length_mm=623_324, crs=crs), far))
    found = projector.near(100.0, 4.0, 10_000, crs=crs)
    assert [("loop", 100_000), ("loop", 523_324)] == [(one.place.edge, one.place.position_mm) for one in found]
    assert [-4_000, -8_000] == [one.offset_mm for one in found]
    assert [] == projector.near(100.0, 50.0, 10_000, crs=crs)
    assert ["loop", "far"] == [one.place.edge for one in projector.near(305.0, 50.0, 60_000, crs=crs)]
