"""A page on this machine with the links that open the view, and the layout to import."""

import threading
from functools import partial
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from urllib.parse import parse_qs, urlencode, urlsplit

from experiment_manager.live.steering import Steering
from lockstep import InputError

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
<h2>Where to look</h2>
<p>What the left eye sees. Eyes that make saccades (profile <code>gaze</code>) look at the place
that you click, from the next fixation of training on.</p>
<img id="left" src="left.png" width="640" alt="no picture yet" style="cursor: crosshair">
<script>
const left = document.getElementById("left");
const reload = () => { left.src = "left.png?" + Date.now(); };
left.onload = () => setTimeout(reload, 100);
left.onerror = () => setTimeout(reload, 1000);
left.onclick = (event) => {
  if (!left.naturalWidth) return;
  const scale = left.naturalWidth / left.clientWidth;
  const place = {column_px: event.offsetX * scale, row_px: event.offsetY * scale};
  fetch("look?" + new URLSearchParams(place), {method: "POST"});
};
</script>
"""


class Page:
    """Serves the page, the layout and the picture to click in from threads of its own."""

    def __init__(self, host: str, port: int, address: str, steering: Steering) -> None:
        """Listen on host and port (0: any free one); address: of the WebSocket server.

        steering: takes clicks. Raises InputError when nobody can listen there.
        """
        query = urlencode({"ds": "foxglove-websocket", "ds.url": address})
        text = _PAGE.replace("{address}", address).replace("{query}", query)
        documents = {
            "/": ("text/html; charset=utf-8", text.encode()),
            "/layout.json": ("application/json", LAYOUT.read_bytes()),
        }
        try:
            handler = partial(_Handler, documents, steering)
            self._server = ThreadingHTTPServer((host, port), handler)
        except OSError as error:
            raise InputError(f"live view: cannot listen on {host}:{port}: {error}") from error
        self.port = int(self._server.server_address[1])
        threading.Thread(target=self._server.serve_forever, daemon=True).start()

    def close(self) -> None:
        """Stop listening."""
        self._server.shutdown()
        self._server.server_close()


class _Handler(BaseHTTPRequestHandler):
    def __init__(
        self,
        documents: dict[str, tuple[str, bytes]],
        steering: Steering,
        *arguments: object,
    ) -> None:
        self._documents, self._steering = documents, steering
        super().__init__(*arguments)  # type: ignore[arg-type]

    def do_GET(self) -> None:
        """Answer with one of the documents or the picture."""
        path = urlsplit(self.path).path
        kind, content = self._documents.get(path, ("image/png", b""))
        if path == "/left.png":
            content = self._steering.png()
        if not content:
            self.send_error(404)
            return
        self.send_response(200)
        self.send_header("Content-Type", kind)
        self.send_header("Content-Length", str(len(content)))
        self.send_header("Access-Control-Allow-Origin", "*")
        self.end_headers()
        self.wfile.write(content)

    def do_POST(self) -> None:
        """Take a click."""
        address = urlsplit(self.path)
        if address.path != "/look":
            self.send_error(404)
            return
        try:
            (column,), (row,) = (parse_qs(address.query)[n] for n in ("column_px", "row_px"))
            self._steering.ask_at(float(column), float(row))
        except (KeyError, ValueError):
            self.send_error(400, "expected column_px and row_px of a picture that was shown")
            return
        self.send_response(204)
        self.end_headers()

    def log_message(self, *arguments: object) -> None:
        """Say nothing."""
