"""The messages of each eye's camera."""

from sensor_msgs.msg import CameraInfo, Image

from eye_plant.camera.config import CameraConfig
from lockstep.topics import SIDES


def camera_info(config: CameraConfig, i_eye: int, baseline_m: float) -> CameraInfo:
    """Return the intrinsics of one eye's ideal pinhole camera (0 left, 1 right), without a stamp.

    The principal point is the picture's centre between pixels, (width - 1) / 2 counting from pixel
    centres; the projection matrix names the baseline as for straight-ahead gaze (Tx = -F b for the
    right eye). A region of interest is announced as cameras do.
    """
    focal_px = config.focal_length_px
    cx, cy = (config.width_px - 1) / 2.0, (config.height_px - 1) / 2.0
    tx = -focal_px * baseline_m * i_eye
    info = CameraInfo(
        height=config.height_px,
        width=config.width_px,
        distortion_model="plumb_bob",
        d=[0.0] * 5,
        k=[focal_px, 0.0, cx, 0.0, focal_px, cy, 0.0, 0.0, 1.0],
        r=[1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        p=[focal_px, 0.0, cx, tx, 0.0, focal_px, cy, 0.0, 0.0, 0.0, 1.0, 0.0],
    )
    info.header.frame_id = f"{SIDES[i_eye]}_eye"
    if (config.roi_width_px, config.roi_height_px) != (config.width_px, config.height_px):
        info.roi.x_offset = (config.width_px - config.roi_width_px) // 2
        info.roi.y_offset = (config.height_px - config.roi_height_px) // 2
        info.roi.width, info.roi.height = config.roi_width_px, config.roi_height_px
    return info


def picture_message(config: CameraConfig, i_eye: int) -> Image:
    """Return the mono8 message of one eye's pictures, without stamp and data."""
    message = Image(
        height=config.roi_height_px,
        width=config.roi_width_px,
        encoding="mono8",
        step=config.roi_width_px,
    )
    message.header.frame_id = f"{SIDES[i_eye]}_eye"
    return message
