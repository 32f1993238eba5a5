"""Settings of the live view, and where it listens."""

from dataclasses import dataclass

from lockstep.settings import check_settings, setting

LOCAL_HOST = "127.0.0.1"
PORT = 8765


@dataclass(frozen=True)
class LiveViewConfig:
    """Settings of the node live_view; raises InputError for a value out of range."""

    host: str = setting(LOCAL_HOST, "address that it listens on; 0.0.0.0 for all of this machine's")
    port: int = setting(
        PORT, "port of the WebSocket server, 0 for any free one", least=0, most=65535
    )
    page_port: int = setting(
        PORT + 1, "port of the page with links and layout, 0 for any free one", least=0, most=65535
    )
    rate_hz: float = setting(20.0, "pictures a second at most", "Hz", above=0, most=100)
    n_selections: int = setting(
        10, "matching pursuit's selections per patch, as sparse_coder has it", least=1
    )
    focal_length_px: float = setting(
        257.34, "focal length of the left camera, which says where a click is", "px", above=0
    )

    def __post_init__(self) -> None:
        """Refuse values out of range."""
        check_settings(self)
