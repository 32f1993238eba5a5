"""A page on this machine that shows a run in a browser, with links to viewers that show more."""

import functools
import ipaddress
import socket
import threading
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import parse_qs, urlencode, urlsplit

from experiment_manager.live.address import Address, resolved
from experiment_manager.live.steering import Steering
from lockstep import InputError

LAYOUT = Path(__file__).with_name("layout.json")
_PAGE = Path(__file__).with_name("page.html")
_VIEWERS = """<h2>More, in a viewer</h2>
<p>Features, reconstructions, muscles and all numbers are served at <code>{address}</code>, by the
Foxglove protocol.</p>
<ol>
<li>Open it in Lichtblick (newer than 1.21.0), which is free software:
<a href="lichtblick://open?{query}">on the desktop</a>, or
<a href="http://localhost:8080/?{query}">in the browser</a> after
<code>docker run --rm -p 8080:8080 ghcr.io/lichtblick-suite/lichtblick:latest</code>;
or <a href="https://app.foxglove.dev/?{query}">in Foxglove</a>.</li>
<li>The first time: save the <a href="layout.json" download>layout</a>, then <em>Layouts</em>,
<em>Import from file</em>.</li>
</ol>
"""


class Page:
    """Serves the page, what it shows and the layout from threads of its own."""

    def __init__(self, host: str, port: int, address: str, steering: Steering) -> None:
        """Listen on host and port (0: any free one).

        address: of the WebSocket server, "" for none; steering: takes clicks. Raises InputError
        when nobody can listen there.
        """
        query = urlencode({"ds": "foxglove-websocket", "ds.url": address})
        viewers = _VIEWERS.replace("{address}", address).replace("{query}", query)
        text = _PAGE.read_text("utf-8").replace("{viewers}", viewers if address else "")
        documents = {
            "/": ("text/html; charset=utf-8", text.encode()),
            "/layout.json": ("application/json", LAYOUT.read_bytes()),
        }
        try:
            self._server = _Server(host, port, partial(_Handler, host, documents, steering))
        except (OSError, UnicodeError) as error:
            where = Address(host, port)
            raise InputError(f"live view: cannot listen on {where}: {error}") from error
        self.port = int(self._server.server_address[1])
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    def close(self) -> None:
        """Stop listening."""
        self._server.shutdown()
        self._server.server_close()


class _Server(ThreadingHTTPServer):
    def __init__(self, host: str, port: int, handler: partial["_Handler"]) -> None:
        self.address_family, *_, place = resolved(host, port)
        super().__init__(place, handler)


class _Handler(BaseHTTPRequestHandler):
    def __init__(
        self,
        host: str,
        documents: dict[str, tuple[str, bytes]],
        steering: Steering,
        *arguments: object,
    ) -> None:
        self._host, self._documents, self._steering = host, documents, steering
        super().__init__(*arguments)  # type: ignore[arg-type]

    def do_GET(self) -> None:
        """Answer with one of the documents, an image or the state."""
        if self._refuses():
            return
        path, shown = urlsplit(self.path).path, self._steering.shown
        kind, content = self._documents.get(path, ("image/png", b""))
        if path == "/state.json":
            kind, content = "application/json", shown.state()
        elif path.endswith(".png"):
            content = shown.png(path.removeprefix("/").removesuffix(".png"))
        if not content:
            self.send_error(404)
            return
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.end_headers()
        self.wfile.write(content)

    def do_POST(self) -> None:
        """Take a click."""
        if self._refuses():
            return
        address = urlsplit(self.path)
        if address.path != "/look":
            self.send_error(404)
            return
        try:
            (column,), (row,) = (parse_qs(address.query)[n] for n in ("column_px", "row_px"))
            column_px, row_px = float(column), float(row)
        except (KeyError, ValueError):
            self.send_error(400, "expected a number as column_px and one as row_px")
            return
        try:
            self._steering.ask_at(column_px, row_px)
        except InputError as error:
            self.send_error(400, str(error))
            return
        self.send_response(204)
        self.end_headers()

    def _refuses(self) -> bool:
        """Refuse requests from other web pages, and return whether this is one.

        Its browser names that page as Origin; or, where a name was given the address of this
        machine while the page was open (DNS rebinding), that name as Host.
        """
        host, origin = self.headers.get("Host", ""), self.headers.get("Origin")
        if host and not _names_this_machine(host, self._host):
            reason = (
                f"expected {self._host} or this machine as Host, got {host[:80]}; open the page by"
                " the machine's address, or give this name to --live"
            )
        elif origin is not None and origin.partition("://")[2].lower() != host.lower():
            reason = f"expected requests of this page, got one of {origin[:80]}"
        else:
            return False
        self.send_error(403, reason)
        return True

    def log_message(self, *arguments: object) -> None:
        """Say nothing."""


@functools.cache
def _full_name() -> str:
    return socket.getfqdn().lower()


def _names_this_machine(host: str, configured: str) -> bool:
    """Whether the host of a request is what the page was told to listen on, or a name of it here.

    A number is no name that somebody else gives an address to.
    """
    try:
        name = urlsplit(f"//{host}").hostname or ""
    except ValueError:
        return False
    own = socket.gethostname().lower()
    if name in (configured.lower(), "localhost", own, f"{own}.local"):
        return True
    try:
        ipaddress.ip_address(name)
    except ValueError:
        return name == _full_name()
    return True
