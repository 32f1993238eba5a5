"""A page on this machine with the links that open the view, and the layout to import."""

import threading
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import urlencode

from lockstep.errors import InputError

LAYOUT = Path(__file__).with_name("layout.json")
_PAGE = """<!DOCTYPE html>
<html lang="en">
<meta charset="utf-8">
<title>Active binocular vision: live view</title>
<body style="font-family: sans-serif; max-width: 45em; margin: 2em auto">
<h1>Live view</h1>
<p>Served at <code>{address}</code>, the Foxglove protocol.</p>
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
    """Serves the page and the layout from a thread of its own."""

    def __init__(self, host: str, port: int, address: str) -> None:
        """Listen on host and port (0: any free one); address: of the WebSocket server.

        Raises InputError when nobody can listen there.
        """
        query = urlencode({"ds": "foxglove-websocket", "ds.url": address})
        documents = {
            "/": ("text/html; charset=utf-8", _PAGE.format(address=address, query=query).encode()),
            "/layout.json": ("application/json", LAYOUT.read_bytes()),
        }
        try:
            self._server = ThreadingHTTPServer((host, port), partial(_Handler, documents))
        except OSError as error:
            raise InputError(f"live view: cannot listen on {host}:{port}: {error}") from error
        self.port = int(self._server.server_address[1])
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    def close(self) -> None:
        """Stop listening."""
        self._server.shutdown()
        self._server.server_close()


class _Handler(BaseHTTPRequestHandler):
    def __init__(self, documents: dict[str, tuple[str, bytes]], *arguments: object) -> None:
        self._documents = documents
        super().__init__(*arguments)  # type: ignore[arg-type]

    def do_GET(self) -> None:
        """Answer with one of the documents."""
        if self.path not in self._documents:
            self.send_error(404)
            return
        kind, content = self._documents[self.path]
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Access-Control-Allow-Origin", "*")
        self.end_headers()
        self.wfile.write(content)

    def log_message(self, *arguments: object) -> None:
        """Say nothing."""
