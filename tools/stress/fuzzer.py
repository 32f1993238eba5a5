"""Messages and requests that none of our nodes would send, drawn at random."""

import array
import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from builtin_interfaces.msg import Time
from rcl_interfaces.msg import Parameter, ParameterValue
from sensor_msgs.msg import Image, JointState

from lockstep.wire.stamps import to_time
from lockstep.wire.topics import EPISODE_NAMES, reward_names
from lockstep.wire.vectors import vector_message
from tests.pair import COMMAND_NAMES, HORIZONTAL_RECTI

# What nodes take in. Nobody but their publisher may write these; we do.
VECTOR_NAMES: dict[str, Sequence[str]] = {
    "episode": EPISODE_NAMES,
    "muscle_activations": HORIZONTAL_RECTI,
    "reward": reward_names(),
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
        self.draw = np.random.default_rng(seed)
        self._period_ns = period_ns

    def message(self, now_ns: int) -> tuple[str, JointState | Image]:
        """Return a topic and a message on it, while the observation of now_ns is under way.

        A message with a stamp of the present has a content that must be refused; one of the past,
        of the far future or of no time at all may look as it should.
        """
        topic = self._one_of((*VECTOR_NAMES, *IMAGE_TOPICS))
        is_now = self.draw.random() < _SHARE_NOW
        make = self._vector if topic in VECTOR_NAMES else self._image
        message: JointState | Image = make(topic, may_be_sound=not is_now)
        ahead_ns = self._period_ns * int(self.draw.integers(2))
        message.header.stamp = to_time(now_ns + ahead_ns) if is_now else self._other_time(now_ns)
        return topic, message

    def _one_of(self, choices: Sequence[Any]) -> Any:
        return choices[int(self.draw.integers(len(choices)))]

    def _other_time(self, now_ns: int) -> Time:
        """Return a time that is not of the present: past, far future, none at all."""
        future_ns = now_ns + int(self.draw.integers(_FAR_NS, _END_NS))
        no_time = Time(
            sec=int(self.draw.integers(-(2**31), 2**31)),
            nanosec=int(self.draw.integers(10**9, 2**32)),
        )
        negative = Time(sec=-int(self.draw.integers(1, 2**31)))
        times = [to_time(future_ns), no_time, negative]
        # Observation 0 has no past; a sound message with its stamp would be taken for ours.
        if (newest_ns := now_ns - self._period_ns) >= 0:
            times.append(to_time(int(self.draw.integers(newest_ns + 1))))
        time: Time = self._one_of(times)
        return time

    def _vector(self, topic: str, *, may_be_sound: bool) -> JointState:
        names = VECTOR_NAMES[topic]
        values = self.draw.random(len(names)) * 0.1
        # Names, positions, efforts.
        spoilt: list[tuple[Sequence[str], Any, Any]] = [
            (names, values[:-1], ()),
            (names, (), ()),
            ((), values, ()),
            ((), (), ()),
            ([names[0]] * len(names), values, ()),
            (names, np.full(len(names), self._one_of(_NOT_FINITE)), ()),
            ([f"{name}\u00fc\u4e16" for name in names], values, ()),
            (["x" * 10_000], [1.0], ()),
            ([str(i) for i in range(5000)], np.zeros(5000), ()),
            (names, np.zeros(100_000), ()),
            (names, np.full(len(names), 1e300), [math.nan]),
        ]
        if topic in ("episode", "muscle_command"):  # whole numbers; activations
            spoilt.append((names, np.full(len(names), -0.5), ()))
        if may_be_sound:
            spoilt.append((names, values, values))
        of_one, position, effort = self._one_of(spoilt)
        return vector_message(0, of_one, position, effort=effort)

    def _image(self, topic: str, *, may_be_sound: bool) -> Image:
        encoding = "32FC1" if topic == "features" else "mono8"
        height, width = (2, 8) if topic == "features" else (240, 320)
        n_bytes = height * width * (4 if topic == "features" else 1)
        noise = self.draw.integers(0, 256, n_bytes, dtype=np.uint8).tobytes()
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
        true, other = {"run_id": run_id}, {"run_id": "somebody_elses"}
        requests: list[dict[str, str]] = [
            other | {"request": "start_run"},
            other | {"request": "end_run"},
            {"request": "start_run"},
            true,
            true | {"request": "self_destruct"},
            true | {"request": "x" * 50_000},
            true | {"request": "episode"},
            true | {"request": "load", "path": "/nowhere/state.npz"},
            true | {"request": "save", "path": "/nowhere/state.npz"},
            true | {"request": "load", "path": "/dev/null"},
        ]
        parameters = [
            Parameter(name=name, value=ParameterValue(type=4, string_value=value))
            for name, value in self._one_of(requests).items()
        ]
        spoilt = [
            [],
            [Parameter(name="distance", value=ParameterValue(type=3, double_value=math.nan))],
            [Parameter(name="x", value=ParameterValue(type=250))],
            [Parameter(name="", value=ParameterValue(type=0))],
            [Parameter(name="y" * 5000, value=ParameterValue(type=8, double_array_value=[0.0]))],
            parameters[:1],
        ]
        more: list[Parameter] = self._one_of(spoilt) if self.draw.random() < 0.5 else []
        return [*parameters, *more]
