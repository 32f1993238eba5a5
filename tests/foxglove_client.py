"""A client of the Foxglove WebSocket protocol, for the tests of the live view."""

import json
import struct
import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import TracebackType
from typing import Any

from websockets.sync.client import ClientConnection, connect

from tests.patience import PATIENCE_S

_HEADER = struct.Struct("<BIQ")  # opcode, subscription, log time
_CLIENT_HEADER = struct.Struct("<BI")  # opcode, channel
_MESSAGE_DATA = 1  # in both directions


@dataclass
class FoxgloveClient:
    """Connects, as soon as somebody listens, and subscribes to topics by their names."""

    port: int
    channels: dict[str, dict[str, Any]] = field(default_factory=dict)
    received: dict[str, list[bytes]] = field(default_factory=dict)
    _published: list[str] = field(default_factory=list)

    def __enter__(self) -> "FoxgloveClient":
        end_s = time.monotonic() + PATIENCE_S
        while True:
            try:
                self._connection: ClientConnection = connect(
                    f"ws://127.0.0.1:{self.port}",
                    subprotocols=["foxglove.sdk.v1"],  # type: ignore[list-item]
                    max_size=None,
                ).__enter__()
            except OSError:
                assert time.monotonic() < end_s, f"nobody listens on port {self.port}"
                time.sleep(0.05)
            else:
                break
        self.server = json.loads(self._connection.recv(PATIENCE_S))
        advertised = json.loads(self._connection.recv(PATIENCE_S))
        self.channels = {c["topic"]: c for c in advertised["channels"]}
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._connection.close()

    def subscribe(self, topics: Sequence[str]) -> None:
        """Subscribe; the channel's number is the subscription's, too."""
        numbers = [self.channels[topic]["id"] for topic in topics]
        subscriptions = [{"id": number, "channelId": number} for number in numbers]
        self._connection.send(json.dumps({"op": "subscribe", "subscriptions": subscriptions}))

    def publish(self, topic: str, vector: Mapping[str, Any]) -> None:
        """Publish a JointState as a viewer's Publish panel does, as JSON."""
        if topic not in self._published:
            self._published.append(topic)
            channel = {
                "id": self._published.index(topic),
                "topic": topic,
                "encoding": "json",
                "schemaName": "sensor_msgs/msg/JointState",
            }
            self._connection.send(json.dumps({"op": "advertise", "channels": [channel]}))
        head = _CLIENT_HEADER.pack(_MESSAGE_DATA, self._published.index(topic))
        self._connection.send(head + json.dumps(vector).encode())

    def receive_of_each(self, topics: Sequence[str], n_messages: int = 1) -> None:
        """Receive until there are so many messages of each topic; fails when the server ends."""
        by_number = {channel["id"]: topic for topic, channel in self.channels.items()}
        while any(len(self.received.get(topic, ())) < n_messages for topic in topics):
            frame = self._connection.recv(PATIENCE_S)
            if isinstance(frame, bytes) and frame[0] == _MESSAGE_DATA:
                _, number, _ = _HEADER.unpack_from(frame)
                self.received.setdefault(by_number[number], []).append(frame[_HEADER.size :])
