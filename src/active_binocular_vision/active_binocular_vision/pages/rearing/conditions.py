"""What conditions of rearing are called in figures, and what is published of them."""

from collections.abc import Mapping

# By the name of the profile that has the condition.
_NAMES: Mapping[str, str] = {
    "vertical": "vertical stripes",
    "horizontal": "horizontal stripes",
    "orthogonal": "orthogonal stripes",
    "monocular": "one eye deprived",
    "strabismus_camera_3deg": "camera turned by 3°",
    "strabismus_camera_10deg": "camera turned by 10°",
    "strabismus_camera_3deg_still": "camera 3°, still eyes",
    "strabismus_camera_10deg_still": "camera 10°, still eyes",
    "aniseikonia_10": "right image 10\N{NO-BREAK SPACE}% larger",
    "aniseikonia_15": "right image 15\N{NO-BREAK SPACE}% larger",
    "aniseikonia_25": "right image 25\N{NO-BREAK SPACE}% larger",
}


def name_of(condition: str) -> str:
    """Return the name of a condition for figures."""
    profile, *model = condition.split(", ")
    return ", ".join([_NAMES.get(profile, profile.replace("_", " ")), *model])


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
