"""A recorded bag in the live view: its sampled episodes one after another, at the pace of time."""

import sys
import time
from pathlib import Path

import numpy as np

from active_binocular_vision.runs.recorded_run import PicturedEpisodes, pictured_episodes
from experiment_manager.bag.metadata import CONFIGURATION_ATTACHMENT
from experiment_manager.bag.reader import Bag
from experiment_manager.live.page import Page
from experiment_manager.live.view import SHOWN_TOPICS, TRUTH_NAMES, View, open_server
from experiment_manager.run import checkpoint
from experiment_manager.run.config_file import parameters_in
from lockstep.errors import InputError
from lockstep.state_file import read_state

_NS_PER_S = 1e9
_LOOK_S = 0.1


def play(path: Path, host: str, port: int, rate: float) -> None:
    """Serve a bag until it has been played to whoever watches.

    path: of the bag; beside it, checkpoints/ have the dictionaries for the reconstruction. rate:
    simulated seconds in a second.
    Raises InputError for a bag without pictures, or when nobody can listen there.
    """
    bag = Bag(path)
    server = open_server(f"bag {path}", host, port)
    try:
        view = View(server, _n_selections(bag))
        episodes = pictured_episodes(bag)
        page = Page(host, port + 1 if port else 0, f"ws://{host}:{server.port}")
        print(f"live view: ws://{host}:{server.port}; http://{host}:{page.port} opens it in")
        print("Lichtblick or Foxglove; playing begins when someone watches", flush=True)
        if not _take_dictionaries(view, path.parent / "checkpoints"):
            print("no checkpoint beside the bag: no reconstruction", file=sys.stderr)
        while not view.is_watched():
            time.sleep(_LOOK_S)
        _show(bag, episodes, view, rate)
        page.close()
    finally:
        server.close()


def _show(bag: Bag, episodes: PicturedEpisodes, view: View, rate: float) -> None:
    """Show the episodes with pictures; what lies between them is only counted."""
    stamps_ns = episodes.truth.stamps_ns
    truth = np.stack([episodes.truth.column(name) for name in TRUTH_NAMES], axis=1)
    counted = 0
    for rows in episodes.rows:
        messages = _messages(bag, stamps_ns[rows])
        period_s = float(np.diff(stamps_ns[rows]).min(initial=_NS_PER_S)) / _NS_PER_S
        for row in rows.tolist():
            for values in truth[counted : row + 1]:
                view.count_values(values)
            counted = row + 1
            view.show(messages.get(int(stamps_ns[row]), {}))
            time.sleep(period_s / rate)


def _messages(bag: Bag, stamps_ns: np.ndarray) -> dict[int, dict[str, bytes]]:
    """Return the messages of an episode, by stamp and topic."""
    found: dict[int, dict[str, bytes]] = {}
    for topic in filter(bag.has, SHOWN_TOPICS):
        for stamp_ns, message in bag.messages(topic, stamps_ns.tolist()):
            found.setdefault(stamp_ns, {})[topic] = message
    return found


def _n_selections(bag: Bag) -> int:
    """Return n_selections of the run's coder; of a bag without configuration, the default."""
    try:
        parameters = parameters_in(bag.attachment(CONFIGURATION_ATTACHMENT).decode())
        return int(parameters["task"]["n_selections"])
    except (InputError, KeyError, TypeError, ValueError):
        return 10


def _take_dictionaries(view: View, checkpoints: Path) -> bool:
    found = checkpoint.newest(checkpoints) if checkpoints.is_dir() else None
    if found is None:
        return False
    view.take_basis_functions(read_state(found[1] / "sparse_coder.npz", "sparse_coder")["atoms"])
    return True
