"""Cameras: axes and fitting as the design says, depths in order, and which side is seen."""

import numpy as np
import pytest

from mfr_bench.scene.meshes.view import (
    DIRECTIONS,
    axes_of,
    facing,
    orthographic_camera,
    perspective_camera,
)

CUBE = np.array([[x, y, z] for x in (0.0, 2.0) for y in (0.0, 1.0) for z in (0.0, 4.0)])
FACE = np.array([[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]])  # seen by who looks along -z


def seen(camera, point):
    x, y, z, w = camera.clip(np.array(point, dtype=np.float64))
    return np.array([x, y, z]) / w


@pytest.mark.parametrize(("direction", "right", "up"), [("-z", "+x", "+y"), ("+z", "-x", "+y"), ("-x", "-z", "+y"),
                                                        ("+x", "+z", "+y"), ("-y", "+x", "-z"), ("+y", "-x", "-z")])
def test_axes_of_a_direction(direction, right, up):
    assert axes_of(DIRECTIONS[direction]).tolist() == [list(map(float, DIRECTIONS[name]))
                                                       for name in (right, up, direction)]


@pytest.mark.parametrize("place", [orthographic_camera, perspective_camera])
def test_looking_along_minus_z_a_larger_z_is_nearer(place):
    camera = place(CUBE, (100, 100), axes_of(DIRECTIONS["-z"]))
    assert 0.0 <= seen(camera, (1, 0.5, 4))[2] < seen(camera, (1, 0.5, 0))[2] <= 1.0  # window depth in [1/2, 1)
    assert seen(camera, (2, 0.5, 2))[0] > seen(camera, (0, 0.5, 2))[0]


@pytest.mark.parametrize("direction", DIRECTIONS)
@pytest.mark.parametrize("place", [orthographic_camera, perspective_camera])
@pytest.mark.parametrize("size", [(100, 100), (300, 50)])
def test_everything_is_in_view_and_touches_the_margin(place, direction, size):
    clip = place(CUBE, size, axes_of(DIRECTIONS[direction])).clip(CUBE)
    window = np.abs(clip[:, :3] / clip[:, 3:])
    assert (window <= 1.0).all()
    assert window[:, :2].max() == pytest.approx(1 / 1.02)


def test_a_box_is_shown_exactly():
    camera = orthographic_camera(CUBE, (100, 100), axes_of(DIRECTIONS["-z"]), (0.0, 0.0, 1.0, 2.0))
    assert seen(camera, (0, 0, 1))[:2].tolist() == [-1.0, -1.0]
    assert seen(camera, (1, 2, 1))[:2].tolist() == [1.0, 1.0]


def test_perspective_depth_is_as_in_a_projection_matrix():
    """Equal steps of 1/distance are equal steps of depth, and lines stay straight."""
    camera = perspective_camera(CUBE, (100, 100), axes_of(DIRECTIONS["-z"]), eye=(1.0, 0.5, 10.0))
    inverse = 1 / np.array([6.0, 7.0, 9.0, 10.0])
    depth = np.array([seen(camera, (1.0, 0.5, 10.0 - 1 / i))[2] for i in inverse])
    np.testing.assert_allclose(np.diff(depth) / np.diff(inverse), (depth[-1] - depth[0]) / (inverse[-1] - inverse[0]))


def test_a_mesh_around_the_eye_keeps_what_is_before_it():
    camera = perspective_camera(CUBE, (100, 100), axes_of(DIRECTIONS["-z"]), eye=(1.0, 0.5, 2.0), field_degrees=60.0)
    clip = camera.clip(CUBE)
    assert set(np.sign(clip[:, 3])) == {-1.0, 1.0}
    assert seen(camera, (1, 0.5, 0))[2] < 1.0
    with pytest.raises(ValueError, match="behind the eye"):
        perspective_camera(CUBE, (100, 100), axes_of(DIRECTIONS["+z"]), eye=(1.0, 0.5, 9.0))


def test_the_front_is_seen_where_corners_go_round_against_the_clock():
    before = orthographic_camera(FACE, (10, 10), axes_of(DIRECTIONS["-z"]))
    behind = orthographic_camera(FACE, (10, 10), axes_of(DIRECTIONS["+z"]))
    beside = orthographic_camera(FACE, (10, 10), axes_of(DIRECTIONS["+x"]))
    assert facing(before.clip(FACE))[0] > 0 > facing(behind.clip(FACE))[0]
    assert facing(beside.clip(FACE))[0] == pytest.approx(0.0, abs=1e-12)


def test_a_flat_mesh_and_a_single_point_have_a_camera():
    for points in (FACE, FACE[:, :1]):
        for place in (orthographic_camera, perspective_camera):
            assert np.isfinite(place(points, (10, 10), axes_of(DIRECTIONS["-z"])).clip(points)).all()


def test_an_orbit_turns_about_the_up_axis():
    quarter = axes_of(DIRECTIONS["-z"], np.pi / 2)
    np.testing.assert_allclose(quarter[1], [0, 1, 0], atol=1e-12)
    np.testing.assert_allclose(abs(quarter[2]), [1, 0, 0], atol=1e-12)
