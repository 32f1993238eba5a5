"""A robot's head: two cameras on a neck that pans and tilts, before a board, simulated by MuJoCo.

It runs as the plant of the graph; docs/how_to/own_head.md explains how to train it.
"""

import math
import os

os.environ.setdefault("MUJOCO_GL", "egl")  # or osmesa, glfw
import mujoco
import numpy as np

from active_binocular_vision import Head, run_head

SCENE = """<mujoco>
  <visual><headlight ambient="1 1 1" diffuse="0 0 0" specular="0 0 0"/></visual>
  <asset>
    <texture name="board" type="2d" builtin="flat" width="1024" height="1024"/>
    <material name="board" texture="board"/>
  </asset>
  <worldbody>
    <body mocap="true"><geom type="plane" size="1.5 1.5 .1" material="board"/></body>
    <body><joint name="pan" axis="0 -1 0"/><joint name="tilt" axis="1 0 0"/><geom size=".02"/>
      <body pos="-.035 0 -.06"><joint name="left" axis="0 -1 0"/><geom size=".01"/>
        <camera name="left" fovy="45" pos="0 0 -.02"/></body>
      <body pos=".035 0 -.06"><joint name="right" axis="0 1 0"/><geom size=".01"/>
        <camera name="right" fovy="45" pos="0 0 -.02"/></body>
    </body>
  </worldbody>
</mujoco>"""


def noise(size: int) -> np.ndarray:
    """Return a square picture with structure of all sizes, as natural scenes have it."""
    draw, squares = np.random.default_rng(0), [2**k for k in range(2, 11)]
    octaves = [np.kron(draw.normal(size=(n, n)), np.ones([size // n] * 2)) / n for n in squares]
    return np.clip(128 + 180 * sum(octaves), 0, 255).astype(np.uint8)


class PanTiltHead(Head):
    """The head of the scene."""

    def __init__(self, height_px: int = 240, width_px: int = 320) -> None:
        """Compile the scene, with a picture on its board."""
        self.limits_rad = {"pan": (-0.5, 0.5), "tilt": (-0.4, 0.4), "vergence": (0.0, 0.3)}
        self.baseline_m = 0.07
        self.focal_length_px = height_px / 2 / math.tan(math.radians(45 / 2))
        model = mujoco.MjModel.from_xml_string(SCENE)
        model.tex_data[:] = np.repeat(noise(1024).ravel(), 3)
        self.data = mujoco.MjData(model)
        self.renderer = mujoco.Renderer(model, height_px, width_px)

    def show(self, stimulus: int, distance_m: float) -> bool:
        """Place the board, another part of its picture in front for each stimulus."""
        aside_m = np.random.default_rng(stimulus).uniform(-0.5, 0.5, 2)
        self.data.mocap_pos[0] = (*aside_m, -distance_m - 0.08)
        return True

    def move(self, angles_rad: dict[str, float]) -> None:
        """Jump to the angles: each camera makes half of the vergence."""
        half_rad = angles_rad["vergence"] / 2
        for name, angle_rad in (angles_rad | {"left": half_rad, "right": half_rad}).items():
            if name != "vergence":
                self.data.joint(name).qpos[0] = angle_rad
        mujoco.mj_forward(self.renderer.model, self.data)

    def pictures(self) -> tuple[np.ndarray, np.ndarray]:
        """Render what both cameras see."""
        return self.picture("left"), self.picture("right")

    def picture(self, camera: str) -> np.ndarray:
        """Return what one camera sees, in BGR."""
        self.renderer.update_scene(self.data, camera)
        return self.renderer.render()[..., ::-1]

    def truth(self) -> dict[str, float]:
        """Return how far the right camera must still turn in to look where the left one does."""
        left, right = self.data.camera("left"), self.data.camera("right")
        sight = -left.xmat.reshape(3, 3)[:, 2]
        point = left.xpos + sight * (self.data.mocap_pos[0, 2] - left.xpos[2]) / sight[2]
        x, y, z = right.xmat.reshape(3, 3).T @ (point - right.xpos)
        return {
            "vergence_error_deg": math.degrees(math.atan2(-x, -z)),
            "vertical_error_deg": math.degrees(math.atan2(y, -z)),
        }


if __name__ == "__main__":
    run_head(PanTiltHead())
