"""The nine positions as text tables for a terminal."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from active_binocular_vision.examinations.positions.posture import ERROR_AXES
from experiment_manager.measures.tables import number, percent, text_table
from lockstep import SIDES

Json = Mapping[str, Any]

_NAMES = {"learned": "learned", "least": "least energy"}
_ERRORS = tuple(f"{axis}_error_deg" for axis in ERROR_AXES)
_GAZE = tuple(f"{side}_{angle}_deg" for side in SIDES for angle in ("azimuth", "elevation"))
_YOKED_MEASURES = ("correlation", "slope")
# Of W and of mW.
_MILLI = 1000.0


def tables(document: Json) -> str:
    """Return the tables of a `document`."""
    covered = f", {document['covered']} eye covered" if document["covered"] else ""
    parts = {
        f"Medians over pictures after {document['n_iterations']} iterations{covered} (angles in "
        "deg, C in mW)": _positions(document["positions"]),
        "Medians over pictures and positions, of absolute values": _summary(document["summary"]),
        "Silent antagonists at the nine positions": _antagonists(document["antagonists"]),
        "Displacement planes of nine positions and random places (deg)": _planes(
            document["listing"]
        ),
        "Temporal tilt of the plane per deg of vergence": _tilts(document["listing"]),
        "Yoked muscles at random places": _yoked(document["yoked"]),
    }
    return "\n\n".join(f"{title}\n{table}" for title, table in parts.items())


def _positions(entries: Sequence[Json]) -> str:
    header = ["distance/m", "azimuth", "elevation", "missed"]
    header += ["left az.", "el.", "right az.", "el.", "horizontal", "vertical", "cyclo"]
    header += ["C", "least C", "ratio"]
    rows = [
        (
            f"{entry['object_distance_m']:g}",
            *(f"{angle_deg:g}" for angle_deg in entry["target_deg"]),
            number(entry["learned"]["missed_deg"]),
            *(number(entry["learned"][name], 2) for name in _GAZE),
            *(number(entry["learned"][name]) for name in _ERRORS),
            *_costs(
                entry["learned"]["metabolic_rate_w"],
                entry["least"] and entry["least"]["metabolic_rate_w"],
                entry["cost_ratio"],
            ),
        )
        for entry in entries
    ]
    return text_table(header, rows, n_left=0)


def _summary(medians: Json) -> str:
    header = ["distance/m", "missed", "horizontal", "vertical", "cyclo", "C", "least C", "ratio"]
    rows = [
        (
            distance,
            *(number(of[name]) for name in ("missed_deg", *_ERRORS)),
            *_costs(of["metabolic_rate_w"], of["least_metabolic_rate_w"], of["cost_ratio"]),
        )
        for distance, of in medians.items()
    ]
    return text_table(header, rows, n_left=0)


def _costs(learned_w: float | None, least_w: float | None, ratio: float | None) -> Iterator[str]:
    for rate_w in (learned_w, least_w):
        yield number(None if rate_w is None else _MILLI * rate_w, 1)
    yield number(ratio, 2)


def _antagonists(silences: Json) -> str:
    header = ["antagonists", "one silent", "with least energy", "the same silent", "of cases"]
    rows = [
        (
            name.replace("_", " "),
            percent(silence["share_silent"]),
            percent(silence["share_silent_in_optimum"]),
            percent(silence["share_optimally_silent"]),
            str(silence["n_silent_in_optimum"]),
        )
        for name, silence in silences.items()
    ]
    return text_table(header, rows)


def _planes(listing: Json) -> str:
    header = ["", "eye", "distance/m", "offset", "temporal tilt", "upward tilt", "thickness"]
    rows = [
        (
            _NAMES[name],
            side,
            distance,
            *(
                number(plane and plane[f"{measure}_deg"])
                for measure in ("offset", "temporal_tilt", "upward_tilt", "thickness")
            ),
        )
        for name, of_eyes in listing.items()
        for side in SIDES
        for distance, plane in of_eyes[side]["by_distance"].items()
    ]
    return text_table(header, rows, n_left=2)


def _tilts(listing: Json) -> str:
    rows = [
        (
            _NAMES[name],
            *(number(of_eyes[side]["tilt_per_vergence"]) for side in SIDES),
            number(of_eyes["mean_tilt_per_vergence"]),
        )
        for name, of_eyes in listing.items()
    ]
    return text_table(["", *(f"{side} eye" for side in SIDES), "mean"], rows)


def _yoked(yoked: Json) -> str:
    header = ["yoked muscles"]
    header += [f"{measure}, {_NAMES[name]}" for name in yoked for measure in _YOKED_MEASURES]
    rows = [
        (
            pair.replace("_", " "),
            *(number(of_pairs[pair][m]) for of_pairs in yoked.values() for m in _YOKED_MEASURES),
        )
        for pair in yoked["learned"]
    ]
    return text_table(header, rows)
