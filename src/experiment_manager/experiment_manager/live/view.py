"""What a viewer is shown: the graph's topics, and pictures and numbers made of them."""

import math
from collections import deque
from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from experiment_manager.anaglyph import anaglyph
from experiment_manager.live.server import NoServer, ViewServer, why_unavailable
from experiment_manager.run.recorded_topics import SMALL_TOPICS
from lockstep import InputError
from lockstep.wire.cdr import image_array
from lockstep.wire.topics import BASIS_FUNCTIONS, GAZE_TARGET, IMAGE, PICTURES, TRAINING, VECTOR
from lockstep.wire.vectors import read_vector, values_of
from sparse_coder import SparseCoder, SparseCoderConfig
from sparse_coder.patches import N_PIXELS
from sparse_coder.picture_of_code import reconstructed_windows, seen_windows

# As they are. All of an observation; the first ones are small, one each.
SHOWN_TOPICS = dict.fromkeys(SMALL_TOPICS, VECTOR) | dict.fromkeys((*PICTURES, "features"), IMAGE)

ANAGLYPH = "live/anaglyph"
RECONSTRUCTIONS = ("live/reconstruction_coarse", "live/reconstruction_fine")
LEARNING = "live/learning"
LEARNING_NAMES = ("training_iteration", "running_median_error_deg")

_N_RUNNING = 200  # episodes
_ENLARGED = 4
_TRUTH_NAMES = ("phase", "iteration", "training_iteration", "vergence_error_deg")
# A robot's head may not know it.
_UNSURE = ("vergence_error_deg",)

Messages = Mapping[str, bytes]


def open_server(host: str, port: int, ask: Callable[[bytes], None]) -> ViewServer | NoServer:
    """Return a server with all channels of a view; see `ViewServer`; none without foxglove-sdk.

    ask: takes what clients publish on gaze_target, in a thread of the server.
    """
    if why_unavailable():
        return NoServer()
    return ViewServer(
        host,
        port,
        topics=SHOWN_TOPICS,
        pictures=(ANAGLYPH, *RECONSTRUCTIONS),
        tables={LEARNING: LEARNING_NAMES},
        heard={GAZE_TARGET: ask},
    )


class View:
    """Sends what is watched, and makes only what is watched.

    learning: values of LEARNING_NAMES that the last look brought, None for none.
    """

    def __init__(self, server: ViewServer | NoServer, n_selections: int) -> None:
        """n_selections: of the sparse coder's matching pursuit."""
        self._server = server
        self._n_selections = n_selections
        self._coder: SparseCoder | None = None
        self._atoms: NDArray[np.float32] = np.zeros(0, np.float32)
        self._running_error = RunningError()
        self.learning: tuple[float, float] | None = None

    def wanted_topics(self) -> set[str]:
        """Return the topics that are worth listening to for what is watched now.

        The ground truth always is: its running median has a memory.
        """
        watched = self._server.is_watched
        topics = {"ground_truth", *filter(watched, SHOWN_TOPICS)}
        if any(map(watched, (ANAGLYPH, *RECONSTRUCTIONS))):
            topics |= set(PICTURES)
        if any(map(watched, RECONSTRUCTIONS)):
            topics.add(BASIS_FUNCTIONS)
        return topics

    def count(self, ground_truth: bytes) -> None:
        """Take note of an observation's ground truth, sent or not."""
        vector = read_vector(ground_truth, "ground_truth")
        truth = values_of(vector, _TRUTH_NAMES, "ground_truth", may_lack=_UNSURE)
        phase, iteration, training_iteration, error_deg = truth.tolist()
        if phase == TRAINING and not math.isnan(error_deg):
            self._running_error.add(int(iteration), training_iteration, error_deg)

    def take_basis_functions(self, atoms: np.ndarray) -> None:
        """Take over atoms (n_scales * n_bases, n_pixels)."""
        atoms = np.ascontiguousarray(atoms, np.float32).reshape(2, -1, N_PIXELS)
        config = SparseCoderConfig(n_bases=atoms.shape[1], n_selections=self._n_selections)
        coder = SparseCoder(config)
        coder.restore({"atoms": atoms, "learning_steps": np.array(0)})
        self._coder, self._atoms = coder, atoms

    def show(self, messages: Messages) -> None:
        """Send an observation's messages, as far as they are there, and what is made of them."""
        for topic, message in messages.items():
            if topic in SHOWN_TOPICS and self._server.is_watched(topic):
                self._server.send(topic, message)
        if all(topic in messages for topic in PICTURES):
            self._show_pictures(*(image_array(messages[topic]) for topic in PICTURES))
        self.learning = self._running_error.numbers() if self._running_error.is_new else None
        if self.learning is not None and self._server.is_watched(LEARNING):
            numbers = dict(zip(LEARNING_NAMES, self.learning, strict=True))
            self._server.send_numbers(LEARNING, numbers)

    def _show_pictures(self, left: np.ndarray, right: np.ndarray) -> None:
        if self._server.is_watched(ANAGLYPH):
            self._server.send_picture(ANAGLYPH, anaglyph(left, right))
        if self._coder is None or not any(map(self._server.is_watched, RECONSTRUCTIONS)):
            return
        encoding = self._coder.encode(left, right)
        seen = seen_windows(left, right)
        reconstructed = reconstructed_windows(encoding, self._atoms, left, right)
        for topic, *windows in zip(RECONSTRUCTIONS, seen, reconstructed, strict=True):
            self._server.send_picture(topic, compared(*windows))


class RunningError:
    """Median of |vergence error| at the ends of the latest training episodes that were heard.

    Not each message needs to be heard: an episode counts if its last one was.
    """

    def __init__(self) -> None:
        """Start without any episode."""
        self._errors_deg: deque[float] = deque(maxlen=_N_RUNNING)
        self._last_iteration = 0
        self._training_iteration = 0.0
        self.is_new = False

    def add(self, iteration: int, training_iteration: float, error_deg: float) -> None:
        """Add an observation; the highest iteration that ever came is an episode's last."""
        if iteration > self._last_iteration:
            self._last_iteration = iteration
            self._errors_deg.clear()
        if iteration == self._last_iteration and iteration > 0:
            self._errors_deg.append(abs(error_deg))
            self._training_iteration = training_iteration
            self.is_new = True

    def numbers(self) -> tuple[float, float]:
        """Return the values of LEARNING_NAMES; from then on they are old."""
        self.is_new = False
        return self._training_iteration, float(np.median(self._errors_deg))


def compared(seen: np.ndarray, reconstructed: np.ndarray) -> np.ndarray:
    """Return one enlarged picture uint8: windows seen above, reconstructed below, left and right.

    seen, reconstructed: (2, side_px, side_px) in grey levels.
    """
    if seen.shape != reconstructed.shape:
        raise InputError(f"expected windows of {seen.shape}, got {reconstructed.shape}")
    rows: Sequence[np.ndarray] = [np.hstack(list(windows)) for windows in (seen, reconstructed)]
    grey = np.clip(np.round(np.vstack(rows)), 0.0, 255.0).astype(np.uint8)
    return grey.repeat(_ENLARGED, axis=0).repeat(_ENLARGED, axis=1)
