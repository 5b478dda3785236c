"""A headless browser with the page of the WebGL ports, and the server that it asks for cases.

The page fetches `next`, reads the case's folder under `case/`, posts every array to `drawn/NAME`, and then to `done`. The
server listens on the loopback interface, and serves the files of this folder, the OpenGL port's shaders and the case that
is drawn.
"""

from __future__ import annotations

import contextlib
import io
import json
import queue
import shutil
import subprocess
import tempfile
import threading
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any

import numpy as np

from ibr_ref.ports.frame import Frame

PAGE = Path(__file__).parent
SHADERS = PAGE.parent / "glsl"
BROWSERS = ("chromium", "chromium-browser", "google-chrome", "chrome")
FLAGS = (
    "--headless",
    "--no-sandbox",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--disable-dev-shm-usage",
)
"""SwiftShader: the software driver that browsers have where there is no GPU."""
STARTS, DRAWS = 60.0, 180.0
"""Seconds that a browser may take to start, and to draw a case."""
LARGEST = 2**28
"""Bytes of an array that the page hands in."""
TYPES = {".html": "text/html", ".js": "text/javascript"}


class Browser:
    """A browser that draws cases until it is closed. Raises ValueError where there is none, or none with WebGL 2."""

    def __init__(self, command: str | None = None) -> None:
        found = command or next((path for name in BROWSERS if (path := shutil.which(name))), None)
        if found is None:
            raise ValueError(f"no browser: found none of {', '.join(BROWSERS)}")
        self._jobs: queue.Queue[bool] = queue.Queue()
        self._done: queue.Queue[str] = queue.Queue()
        self._said: queue.Queue[dict[str, Any]] = queue.Queue()
        self._case, self._drawn = Path(), dict[str, np.ndarray]()
        self._server = ThreadingHTTPServer(("127.0.0.1", 0), self._handler())
        threading.Thread(target=self._server.serve_forever, daemon=True).start()
        self._profile = tempfile.TemporaryDirectory(ignore_cleanup_errors=True)
        address = f"http://127.0.0.1:{self._server.server_address[1]}/"
        self._process = subprocess.Popen(
            [found, *FLAGS, f"--user-data-dir={self._profile.name}", address],
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
        )
        said = self._answer(found)
        if "error" in said:
            self.close()
            raise ValueError(f"no WebGL 2: {said['error']}")
        self.words, self.subpixel_bits = str(said["words"]), int(said["subpixel_bits"])

    def _answer(self, command: str) -> dict[str, Any]:
        """What the page says of the device, or that it says nothing."""
        for _ in range(int(STARTS)):
            with contextlib.suppress(queue.Empty):
                return self._said.get(timeout=1.0)
            if self._process.poll() is not None and self._said.empty():
                return {"error": f"{command} ended with exit code {self._process.returncode}"}
        return {"error": f"{command} did not open the page in {STARTS:.0f} s"}

    def draw(self, case: Path) -> Frame:
        """The frame of a case's folder, with all stages. Raises ValueError for what is not ported."""
        self._case, self._drawn = case, {}
        self._jobs.put(True)
        try:
            error = self._done.get(timeout=DRAWS)
        except queue.Empty:
            raise ValueError(f"{case}: the browser did not draw it in {DRAWS:.0f} s") from None
        if error:
            raise ValueError(f"{case.name} is not ported: {error}")
        arrays = dict(self._drawn)
        return Frame(arrays.pop("color"), arrays.pop("depth"), arrays)

    def close(self) -> None:
        """End the browser and the server."""
        self._jobs.put(False)
        self._process.terminate()
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(timeout=5)
        self._server.shutdown()
        self._server.server_close()
        self._profile.cleanup()

    def _handler(self) -> type[BaseHTTPRequestHandler]:
        browser = self

        class Handler(BaseHTTPRequestHandler):
            def do_GET(self) -> None:
                name = self.path.partition("?")[0].lstrip("/") or "index.html"
                if name == "next":
                    return self._answer(json.dumps(browser._jobs.get()).encode(), "application/json")
                folder, _, rest = name.partition("/")
                file = {"case": browser._case / rest, "glsl": SHADERS / rest}.get(folder, PAGE / name)
                if ".." in name or not file.is_file():
                    return self.send_error(404)
                return self._answer(file.read_bytes(), TYPES.get(file.suffix, "application/octet-stream"))

            def do_POST(self) -> None:
                length = int(self.headers.get("Content-Length") or 0)
                if length > LARGEST:
                    return self.send_error(413)
                body, (folder, _, name) = self.rfile.read(length), self.path.lstrip("/").partition("/")
                if folder == "drawn":
                    browser._drawn[name] = np.load(io.BytesIO(body), allow_pickle=False)
                self._answer(b"{}", "application/json")
                if folder == "device":
                    browser._said.put(json.loads(body))
                if folder == "done":
                    browser._done.put(body.decode("utf-8", "replace"))
                return None

            def _answer(self, body: bytes, kind: str) -> None:
                self.send_response(200)
                self.send_header("Content-Type", kind)
                self.send_header("Content-Length", str(len(body)))
                self.send_header("Cache-Control", "no-store")
                self.end_headers()
                self.wfile.write(body)

            def log_message(self, *_: Any) -> None:
                """Nothing."""

        return Handler
