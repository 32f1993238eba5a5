"""The WebSocket server of the Foxglove protocol: topics as they are, and what is made of them.

foxglove-sdk, which it is made with, is optional; it is imported where it is needed.
"""

import importlib.util
import threading
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from experiment_manager.bag.message_definitions import message_definition
from experiment_manager.live.address import Address
from lockstep import InputError

_NAME = "active binocular vision"
_LOCK_FILE = "requirements-live.lock"
# Of messages for one client: what a slow one cannot take is dropped, the oldest first.
_BACKLOG = 64
_ENCODINGS = {2: "mono8", 3: "rgb8"}
# Of what clients publish: viewers write it without the message's definition.
_HEARD_ENCODING = "json"
# With clients that are still connecting when the server stops.
_PATIENCE_S = 2.0


def why_unavailable() -> str:
    """Return what is missing and the command that installs it, "" when nothing is."""
    if importlib.util.find_spec("foxglove") is not None:
        return ""
    lock = Path(__file__).parents[4] / _LOCK_FILE
    what = f"--require-hashes -r {lock}" if lock.is_file() else "foxglove-sdk"
    return (
        f"viewers need foxglove-sdk, which is not installed: .venv/bin/python -m pip install {what}"
    )


class NoServer:
    """In the place of a server where foxglove-sdk is not installed: nobody watches."""

    port = 0

    def is_watched(self, topic: str) -> bool:
        """Nobody does."""
        return False

    def send(self, topic: str, message: bytes) -> None:
        """Send nothing."""

    def send_picture(self, topic: str, picture: np.ndarray) -> None:
        """Send nothing."""

    def send_numbers(self, topic: str, numbers: Mapping[str, float]) -> None:
        """Send nothing."""

    def close(self) -> None:
        """Do nothing."""


class ViewServer:
    """Serves channels to any number of clients; nobody waits for them."""

    def __init__(
        self,
        host: str,
        port: int,
        *,
        topics: Mapping[str, str],
        pictures: Sequence[str],
        tables: Mapping[str, Sequence[str]],
        heard: Mapping[str, Callable[[bytes], None]],
    ) -> None:
        """Listen on host and port (0: any free one).

        topics: ROS message type by topic; pictures: topics of pictures that are made here;
        tables: names of the numbers by topic, of numbers that are made here; heard: by topic, what
        takes the JSON messages that clients publish, in a thread of the server.
        Raises InputError when foxglove-sdk is not installed or nobody can listen there.
        """
        if why := why_unavailable():
            raise InputError(why)
        import foxglove  # noqa: PLC0415 (optional)
        from foxglove.channels import RawImageChannel  # noqa: PLC0415

        # Kept: a context that nothing refers to takes its channels with it.
        self._context = foxglove.Context()
        self._channels: dict[str, Any] = {
            topic: RawImageChannel(f"/{topic}", context=self._context) for topic in pictures
        }
        for topic, kind in topics.items():
            text = message_definition(kind).text
            schema = foxglove.Schema(name=kind, encoding="ros2msg", data=text.encode())
            self._channels[topic] = foxglove.Channel(
                f"/{topic}", message_encoding="cdr", schema=schema, context=self._context
            )
        for topic, names in tables.items():
            numbers = {"type": "object", "properties": {n: {"type": "number"} for n in names}}
            self._channels[topic] = foxglove.Channel(
                f"/{topic}", schema=numbers, context=self._context
            )
        self._server = self._listen(host, port, heard)
        self.port: int = self._server.port

    def _listen(self, host: str, port: int, heard: Mapping[str, Callable[[bytes], None]]) -> Any:
        import foxglove  # noqa: PLC0415 (optional)
        from foxglove.websocket import Capability  # noqa: PLC0415 (optional)

        listener: Any = _Listener(heard)
        try:
            return foxglove.start_server(
                name=_NAME,
                host=host,
                port=port,
                context=self._context,
                message_backlog_size=_BACKLOG,
                capabilities=[Capability.ClientPublish],
                supported_encodings=[_HEARD_ENCODING],
                server_listener=listener,
            )
        except RuntimeError as error:
            where = Address(host, port)
            raise InputError(f"live view: cannot listen on {where}: {error}") from error

    def is_watched(self, topic: str) -> bool:
        """Whether a client subscribes to the topic now."""
        return bool(self._channels[topic].has_sinks())

    def send(self, topic: str, message: bytes) -> None:
        """Send a serialized ROS message."""
        self._channels[topic].log(message)

    def send_picture(self, topic: str, picture: np.ndarray) -> None:
        """Send a picture (height, width) or (height, width, 3) uint8."""
        from foxglove.messages import RawImage  # noqa: PLC0415 (optional)

        height, width = picture.shape[:2]
        message = RawImage(
            frame_id=topic,
            width=width,
            height=height,
            encoding=_ENCODINGS[picture.ndim],
            step=picture[0].nbytes,
            data=picture.tobytes(),
        )
        self._channels[topic].log(message)

    def send_numbers(self, topic: str, numbers: Mapping[str, float]) -> None:
        """Send numbers by their names."""
        self._channels[topic].log(dict(numbers))

    def close(self) -> None:
        """Stop listening; nobody waits long for a client that has connected and says nothing."""
        # foxglove-sdk would wait for what it says.
        stopping = threading.Thread(target=self._server.stop, daemon=True)
        stopping.start()
        stopping.join(_PATIENCE_S)


class _Listener:
    """Hands over what clients publish; foxglove-sdk calls the methods, from its threads."""

    def __init__(self, heard: Mapping[str, Callable[[bytes], None]]) -> None:
        self._heard = heard
        self._advertised: dict[tuple[int, int], Callable[[bytes], None]] = {}

    def on_client_advertise(self, client: Any, channel: Any) -> None:
        """Take note of a client's channel whose topic is heard."""
        take = self._heard.get(channel.topic.removeprefix("/"))
        if take is not None and channel.encoding == _HEARD_ENCODING:
            self._advertised[client.id, channel.id] = take

    def on_client_unadvertise(self, client: Any, client_channel_id: int) -> None:
        """Forget a client's channel."""
        self._advertised.pop((client.id, client_channel_id), None)

    def on_message_data(self, client: Any, client_channel_id: int, data: bytes) -> None:
        """Hand over a message."""
        take = self._advertised.get((client.id, client_channel_id))
        if take is not None:
            take(bytes(data))

    def on_subscribe(self, client: Any, channel: Any) -> None:
        """Do nothing: who subscribes is looked up when it matters."""

    def on_unsubscribe(self, client: Any, channel: Any) -> None:
        """Do nothing."""
