"""The scene's model, its landscape and its textures."""

import numpy as np

from eye_plant.camera.config import CameraConfig
from eye_plant.camera.landscape import landscape_picture
from eye_plant.camera.opengl.scene import LANDSCAPE_GEOM, PLANE_GEOM, build_scene, build_scene_model

EYE_HEIGHT_M = 1.7


def test_plane_and_landscape_have_the_sizes_of_the_paper() -> None:
    scene = build_scene(build_scene_model(CameraConfig(), EYE_HEIGHT_M, (640, 240)))
    assert scene.ngeom == 2
    plane, landscape = scene.geoms[PLANE_GEOM], scene.geoms[LANDSCAPE_GEOM]
    np.testing.assert_allclose(2.0 * np.array(plane.size[:2]), [3.0, 3.0])
    np.testing.assert_allclose(2.0 * np.array(landscape.size[:2]), [39.0, 12.0])
    np.testing.assert_allclose(landscape.pos, [9.1, 0.0, EYE_HEIGHT_M], rtol=1e-6)


def test_both_surfaces_face_the_eyes_upright() -> None:
    scene = build_scene(build_scene_model(CameraConfig(), EYE_HEIGHT_M, (640, 240)))
    for geom in scene.geoms[:2]:
        right, up, normal = np.array(geom.mat).reshape(3, 3).T
        np.testing.assert_allclose(right, [0.0, -1.0, 0.0], atol=1e-6)
        np.testing.assert_allclose(up, [0.0, 0.0, 1.0], atol=1e-6)
        np.testing.assert_allclose(normal, [-1.0, 0.0, 0.0], atol=1e-6)


def test_nothing_lights_the_scene() -> None:
    scene = build_scene(build_scene_model(CameraConfig(), EYE_HEIGHT_M, (640, 240)))
    assert scene.nlight == 0
    assert not scene.flags.any()


def test_the_landscape_is_a_function_of_its_seed() -> None:
    first = landscape_picture(0)
    np.testing.assert_array_equal(landscape_picture(0), first)
    assert (landscape_picture(1) != first).mean() > 0.5


def test_no_part_of_the_landscape_is_even() -> None:
    picture = landscape_picture(0)
    assert picture.dtype == np.uint8
    tiles = picture.reshape(10, 80, 26, 100)  # 1.2 m x 1.5 m each
    assert tiles.std(axis=(1, 3)).min() > 5.0
