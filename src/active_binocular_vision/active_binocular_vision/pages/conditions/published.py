"""What is published of conditions of rearing, by the name of the profile."""

from collections.abc import Mapping

# Klimmasch et al. (2021, eLife 10:e56212) after 500,000 iterations, five seeds each.
_NEVER = "never learns vergence: a flat landscape, monocular cells"

PUBLISHED: Mapping[str, str] = {
    "normal": "0.12 +- 0.17 deg; random-dot stereograms 0.21 +- 0.22 deg; 98 % Gabor (left half)",
    "vertical": "about as normal while training (0.3 deg with noise)",
    "horizontal": "worse, but learns",
    "orthogonal": _NEVER,
    "monocular": _NEVER,
    "strabismus_camera_10deg": _NEVER,
    "strabismus_camera_10deg_still": _NEVER,
    "strabismus_camera_3deg_still": "preferred disparities shift to 3 deg",
    "aniseikonia_10": "slower and worse",
    "aniseikonia_15": "still improves",
    "aniseikonia_25": "fails; accuracy falls about quadratically",
}
