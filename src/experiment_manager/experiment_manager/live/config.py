"""Settings of the live view, and where it listens."""

from dataclasses import dataclass, field

from eye_plant.camera.config import CameraConfig
from lockstep import setting
from lockstep.task import TaskConfig

LOCAL_HOST = "127.0.0.1"
PORT = 8765


@dataclass(frozen=True)
class LiveViewConfig(TaskConfig):
    """The task, and settings of the node live_view; raises InputError for a value out of range."""

    host: str = setting(LOCAL_HOST, "address that it listens on; 0.0.0.0 for all of this machine's")
    port: int = setting(
        PORT, "port of the WebSocket server for viewers, 0 for any free one", least=0, most=65535
    )
    page_port: int = setting(
        PORT + 1, "port of the page for browsers, 0 for any free one", least=0, most=65535
    )
    run: str = setting("", "name of the run, for the page")
    rate_hz: float = setting(20.0, "images a second at most", "Hz", above=0, most=100)
    camera: CameraConfig = field(default_factory=CameraConfig)
