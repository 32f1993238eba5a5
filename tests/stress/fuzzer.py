"""Messages and requests that no node of ours would send, drawn at random."""

import array
import math
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from rcl_interfaces.msg import Parameter, ParameterValue
from sensor_msgs.msg import Image, JointState

from lockstep.wire.stamps import to_time
from lockstep.wire.topics import EPISODE_NAMES, REWARD_NAMES
from lockstep.wire.vectors import vector_message
from tests.pair import COMMAND_NAMES, HORIZONTAL_RECTI

# What nodes take in. Nobody but their publisher may write these; we do.
VECTOR_NAMES: dict[str, Sequence[str]] = {
    "episode": EPISODE_NAMES,
    "muscle_activations": HORIZONTAL_RECTI,
    "reward": REWARD_NAMES,
    "muscle_command": COMMAND_NAMES,
}
IMAGE_TOPICS = ("left/image_raw", "right/image_raw", "features")
# More would measure the queues of the middleware, which keep the largest message in each place.
LARGEST_BYTES = 1_000_000
_FAR_NS, _END_NS = 10**15, 2 * 10**18
# Each time one gets between the parts of an observation, the plant must repeat it after a second.
_SHARE_NOW = 0.01
_NOT_FINITE = (math.nan, math.inf, -math.inf)


class Hostility:
    """Draws one hostile input after the other; what is drawn depends on the seed alone."""

    def __init__(self, seed: int, period_ns: int) -> None:
        """period_ns: between the stamps of successive observations."""
        self._draw = np.random.default_rng(seed)
        self._period_ns = period_ns

    def message(self, now_ns: int) -> tuple[str, JointState | Image]:
        """Return a topic and a message on it, while the observation of now_ns is under way.

        A message with a stamp of the present has a content that must be refused; one of the past,
        of the far future or of no time at all may look as it should.
        """
        topic = self._one_of((*VECTOR_NAMES, *IMAGE_TOPICS))
        is_now = self._draw.random() < _SHARE_NOW
        if topic in VECTOR_NAMES:
            message = self._vector(topic, may_be_sound=not is_now)
        else:
            message = self._image(topic, may_be_sound=not is_now)
        if is_now:
            ahead = self._period_ns * int(self._draw.integers(2))
            message.header.stamp = to_time(now_ns + ahead)
        else:
            message.header.stamp = self._other_time(now_ns)
        return topic, message

    def _one_of(self, choices: Sequence[Any]) -> Any:
        return choices[int(self._draw.integers(len(choices)))]

    def _other_time(self, now_ns: int) -> Time:
        """Return a time that is not of the present: past, far future, none at all."""
        future_ns = now_ns + int(self._draw.integers(_FAR_NS, _END_NS))
        no_time = Time(
            sec=int(self._draw.integers(-(2**31), 2**31)),
            nanosec=int(self._draw.integers(10**9, 2**32)),
        )
        negative = Time(sec=-int(self._draw.integers(1, 2**31)))
        times = [to_time(future_ns), no_time, negative]
        # Observation 0 has no past; a sound message with its stamp would be taken for ours.
        if (newest_ns := now_ns - self._period_ns) >= 0:
            times.append(to_time(int(self._draw.integers(newest_ns + 1))))
        time: Time = self._one_of(times)
        return time

    def _vector(self, topic: str, *, may_be_sound: bool) -> JointState:
        names = VECTOR_NAMES[topic]
        values = self._draw.random(len(names)) * 0.1
        spoilt: list[Callable[[], JointState]] = [
            lambda: vector_message(0, names, values[:-1]),
            lambda: vector_message(0, names, ()),
            lambda: vector_message(0, (), values),
            lambda: vector_message(0, (), ()),
            lambda: vector_message(0, [names[0]] * len(names), values),
            lambda: vector_message(0, names, np.full(len(names), self._one_of(_NOT_FINITE))),
            lambda: vector_message(0, [f"{name}\u00fc\u4e16" for name in names], values),
            lambda: vector_message(0, ["x" * 10_000], [1.0]),
            lambda: vector_message(0, [str(i) for i in range(5000)], np.zeros(5000)),
            lambda: vector_message(0, names, np.zeros(100_000)),
            lambda: vector_message(0, names, np.full(len(names), 1e300), effort=[math.nan]),
        ]
        if topic in ("episode", "muscle_command"):  # whole numbers; activations
            spoilt.append(lambda: vector_message(0, names, np.full(len(names), -0.5)))
        if may_be_sound:
            spoilt.append(lambda: vector_message(0, names, values, effort=values))
        make: Callable[[], JointState] = self._one_of(spoilt)
        return make()

    def _image(self, topic: str, *, may_be_sound: bool) -> Image:
        encoding = "32FC1" if topic == "features" else "mono8"
        height, width = (2, 8) if topic == "features" else (240, 320)
        n_bytes = height * width * (4 if topic == "features" else 1)
        noise = self._draw.integers(0, 256, n_bytes, dtype=np.uint8).tobytes()
        not_finite = np.full(n_bytes // 4, math.nan, np.float32).tobytes()
        spoilt = [
            (height, width, "rgb8", noise),
            (height, width, "", noise),
            (height, width, "\u00fc" * 300, noise),
            (height, width, encoding, noise[:-1]),
            (height, width, encoding, b""),
            (0, 0, encoding, b""),
            (1, 1, encoding, noise[:4]),
            (2**32 - 1, 2**32 - 1, encoding, noise[:16]),
            (height + 1, width, encoding, noise),
            (1000, 1000, "rgb8", bytes(LARGEST_BYTES)),
        ]
        if topic == "features":
            spoilt.append((height, width, encoding, not_finite))
        if may_be_sound:
            spoilt.append((height, width, encoding, noise))
        rows, columns, name, data = self._one_of(spoilt)
        step = columns * (4 if topic == "features" else 1)
        message = Image(height=rows, width=columns, encoding=name, step=min(step, 2**32 - 1))
        message.data = array.array("B", data)
        return message

    def request(self, run_id: str) -> list[Parameter]:
        """Return the parameters of a request that must be refused; run_id: of the true run."""
        text = {
            "other run": {"run_id": "somebody_elses", "request": "start_run"},
            "other end": {"run_id": "somebody_elses", "request": "end_run"},
            "no run": {"request": "start_run"},
            "no kind": {"run_id": run_id},
            "unknown kind": {"run_id": run_id, "request": "self_destruct"},
            "long kind": {"run_id": run_id, "request": "x" * 50_000},
            "no episode": {"run_id": run_id, "request": "episode"},
            "no file": {"run_id": run_id, "request": "load", "path": "/nowhere/state.npz"},
            "no place": {"run_id": run_id, "request": "save", "path": "/nowhere/state.npz"},
            "no state": {"run_id": run_id, "request": "load", "path": "/dev/null"},
        }
        chosen = text[self._one_of(sorted(text))]
        parameters = [
            Parameter(name=name, value=ParameterValue(type=4, string_value=value))
            for name, value in chosen.items()
        ]
        spoilt = [
            [],
            [Parameter(name="distance", value=ParameterValue(type=3, double_value=math.nan))],
            [Parameter(name="x", value=ParameterValue(type=250))],
            [Parameter(name="", value=ParameterValue(type=0))],
            [Parameter(name="y" * 5000, value=ParameterValue(type=8, double_array_value=[0.0]))],
            parameters[:1],
        ]
        more: list[Parameter] = self._one_of(spoilt) if self._draw.random() < 0.5 else []
        return [*parameters, *more]

    def is_request(self) -> bool:
        """Return whether the next input is a request rather than a message."""
        return bool(self._draw.random() < 0.1)

    def node(self, names: Sequence[str]) -> str:
        """Return the node to ask."""
        name: str = self._one_of(names)
        return name
