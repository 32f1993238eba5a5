"""Where the profiles are."""

from pathlib import Path

_FOLDER = Path(__file__).parents[1] / "profiles"


def profile_files() -> dict[str, Path]:
    """Return the files of all profiles by name; one in a folder has that before a slash."""
    paths = _FOLDER.rglob("*.yaml")
    return {path.relative_to(_FOLDER).with_suffix("").as_posix(): path for path in paths}
