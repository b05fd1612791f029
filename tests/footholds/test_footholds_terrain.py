from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from surefoot.footholds.generators import strips
from surefoot.footholds.terrain import PolygonError, cone_hull, hull_of, polygon

SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    ("vertices", "says"),
    [
        ([[0, 0, 0], [1, 0, 0], [1, 1, 0.01], [0, 1, 0]], "not planar"),
        ([[0, 0, 0], [1, 0, 0], [0.2, 0.2, 0], [0, 1, 0]], "not convex"),
        ([[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]], "crosses itself"),
        ([[np.cos(k * 0.8 * np.pi), np.sin(k * 0.8 * np.pi), 0] for k in range(5)], "crosses itself"),
        ([[0, 0, 0], [1, 0, 0], [2, 0, 0]], "no area"),
        ([[0, 0, 0], [0, 0, 0], [1, 0, 0]], "three different"),
        ([[0, 0, 0], [1, 0, 0], [1, 0, 1], [0, 0, 1]], "upright"),
    ],
)
def test_what_is_no_polygon_is_refused(vertices: list[list[float]], says: str) -> None:
    with pytest.raises(PolygonError, match=says):
        polygon(vertices)


def test_the_sense_of_rotation_does_not_matter() -> None:
    one, other = polygon(SQUARE), polygon(SQUARE[::-1])
    assert one.normal == pytest.approx([0, 0, 1])
    assert other.normal == pytest.approx([0, 0, 1])
    for point in ([0.5, 0.5, 0.0], [1.5, 0.5, 0.0], [0.5, 0.5, 0.1]):
        assert one.excess(np.array(point)) == pytest.approx(other.excess(np.array(point)))


def test_the_pyramid_is_inside_the_cone_and_its_rays_on_its_border() -> None:
    one = polygon([[0, 0, 0], [1, 0, 0.3], [1, 1, 0.4], [0, 1, 0.1]], 0.5)
    assert (one.rays @ one.pyramid.T).max() == pytest.approx(0.0, abs=1e-12)
    for ray in one.rays:
        press = ray @ one.normal
        assert np.linalg.norm(ray - press * one.normal) == pytest.approx(0.5 * press)


@settings(max_examples=40, deadline=None)
@given(st.integers(0, 10_000), st.floats(0, 0.5), st.integers(2, 4))
def test_hulls_hold_every_polygon_and_cones_every_pyramid(seed: int, tilt: float, bands: int) -> None:
    ground = strips(seed, tilt=tilt, bands=bands).polygons
    hull, cone = hull_of(ground), cone_hull(ground)
    for one in ground:
        assert (one.vertices_m @ hull.planes.T <= hull.bounds + 1e-12).all()
        if hull.normal is not None:
            assert one.vertices_m @ hull.normal == pytest.approx(hull.offset, abs=1e-8)
        assert (one.rays @ cone.T).max(initial=-1.0) <= 1e-9


@settings(max_examples=40, deadline=None)
@given(st.tuples(*[st.floats(-2, 2)] * 3), st.integers(0, 1000))
def test_the_nearest_point_is_in_the_polygon_and_no_corner_is_nearer(place: tuple[float, ...], seed: int) -> None:
    one, point = strips(seed, tilt=0.4).polygons[1], np.array(place)
    nearest = one.nearest(point)
    assert one.excess(nearest) <= 1e-9
    assert np.linalg.norm(nearest - point) <= np.linalg.norm(one.vertices_m - point, axis=1).min() + 1e-12
