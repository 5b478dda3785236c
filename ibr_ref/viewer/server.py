"""The server of a page: on loopback alone, for whoever knows the token in its address."""

from __future__ import annotations

import io
import json
import secrets
import tempfile
import zipfile
from collections.abc import Callable, Mapping
from concurrent.futures import CancelledError, ThreadPoolExecutor
from functools import cache
from http import HTTPStatus
from http.server import ThreadingHTTPServer
from importlib.resources import files
from pathlib import Path
from typing import Any, NamedTuple

from ibr_ref.io.images import png_bytes
from ibr_ref.loopback import LOOPBACK, Handler
from ibr_ref.scene import checks
from ibr_ref.viewer.session import Session

MOST_BYTES = 2**16
"""Of a question: a state of the page."""

_OWN = ("script-src 'self'", "style-src 'self'", "connect-src 'self'", "img-src 'self' blob: data:")
_POLICY = "; ".join(("default-src 'none'", "base-uri 'none'", *_OWN))
_PAGES = {
    "": ("page.html", "text/html; charset=utf-8"),
    "page.css": ("page.css", "text/css; charset=utf-8"),
    "page.js": ("page.js", "text/javascript; charset=utf-8"),
    "orbit.js": ("orbit.js", "text/javascript; charset=utf-8"),
    "controls.js": ("controls.js", "text/javascript; charset=utf-8"),
}


class Answer(NamedTuple):
    """Of a request."""

    body: bytes
    kind: str = "application/json"
    headers: Mapping[str, str] = {}


class Server(ThreadingHTTPServer):
    """Pages about one session. `serve_forever` until `shutdown`; `address` is what to open."""

    daemon_threads = True

    def __init__(self, session: Session, port: int = 0) -> None:
        """Port 0: one that is free. Raises OSError for one that is taken."""
        self.session = session
        self.token = secrets.token_urlsafe(16)
        self.ended = False
        self.worker = ThreadPoolExecutor(1, "render")
        try:
            super().__init__((LOOPBACK, port), _Handler)
        except (OSError, OverflowError) as error:
            raise OSError(f"port: found {port}, allowed: one that is free on {LOOPBACK} ({error})") from None
        self.worker.submit(session.warm)  # while the browser opens

    @property
    def address(self) -> str:
        """With the token: whoever has it may look."""
        return f"http://{LOOPBACK}:{self.server_port}/{self.token}/"

    def answer(self, name: str, question: Mapping[str, Any]) -> Answer:
        """On the one thread that calls kernels."""
        return self.worker.submit(_ANSWERS[name], self.session, question).result()

    def server_close(self) -> None:
        """Also end the thread that renders, once it has drawn what it is at."""
        self.ended = True
        super().server_close()
        self.worker.shutdown(wait=False, cancel_futures=True)


class _Handler(Handler):
    server: Server

    def do_GET(self) -> None:  # noqa: N802 - as http.server calls it
        """The page and its files."""
        name = self.place(self.server.token)
        if name not in _PAGES:
            self._refuse(HTTPStatus.NOT_FOUND, "no such page")
        else:
            file, kind = _PAGES[name]
            self._send(HTTPStatus.OK, Answer(_asset(file), kind))

    def do_POST(self) -> None:  # noqa: N802 - as http.server calls it
        """What the page asks: a state of it, as JSON."""
        name, body = self.place(self.server.token), self.body(MOST_BYTES)
        if body is None:
            self._refuse(HTTPStatus.REQUEST_ENTITY_TOO_LARGE, f"at most {MOST_BYTES} bytes")
            return
        if name not in _ANSWERS:
            self._refuse(HTTPStatus.NOT_FOUND, "no such page")
            return
        try:
            question = json.loads(body)
            if not isinstance(question, dict):
                raise checks.reject("question", type(question).__name__, "an object")
            self._send(HTTPStatus.OK, self.server.answer(name, question))
        except (ValueError, OSError, MemoryError, RecursionError) as error:
            self._refuse(HTTPStatus.BAD_REQUEST, checks.one_line(error, checks.LONGEST_MESSAGE))
        except (CancelledError, RuntimeError):
            if not self.server.ended:
                raise
            self.close_connection = True  # nobody draws any more

    def _refuse(self, status: HTTPStatus, why: str) -> None:
        self._send(status, Answer(json.dumps({"error": why}).encode()))

    def _send(self, status: HTTPStatus, answer: Answer) -> None:
        fixed = {
            "Content-Type": answer.kind,
            "Content-Security-Policy": _POLICY,
            "Cache-Control": "no-store",
            "Referrer-Policy": "no-referrer",
            "X-Content-Type-Options": "nosniff",
        }
        self.reply(status, answer.body, {**fixed, **answer.headers})


@cache
def _asset(name: str) -> bytes:
    return files("ibr_ref.viewer").joinpath(name).read_bytes()


# --- What is asked ----------------------------------------------------------------------------------------------------


def _start(session: Session, question: Mapping[str, Any]) -> Answer:
    return Answer(json.dumps(session.start()).encode())


def _frame(session: Session, question: Mapping[str, Any]) -> Answer:
    """RGBA bytes, row by row from the top."""
    picture, seconds = session.shown(question, other=bool(question.get("right")))
    height, width = picture.pixels.shape[:2]
    headers = {"X-Size": f"{width} {height}", "X-Milliseconds": f"{1e3 * seconds:.1f}", "X-Legend": picture.legend}
    return Answer(picture.pixels.tobytes(), "application/octet-stream", headers)


def _pixel(session: Session, question: Mapping[str, Any]) -> Answer:
    x, y = question.get("x"), question.get("y")
    return Answer(json.dumps(session.numbers(question, x, y)).encode())


def _difference(session: Session, question: Mapping[str, Any]) -> Answer:
    return Answer(json.dumps(session.difference(question)).encode())


def _png(session: Session, question: Mapping[str, Any]) -> Answer:
    picture, _ = session.shown(question)
    return Answer(png_bytes(picture.pixels[..., :3] / 255.0), "image/png")


def _case(session: Session, question: Mapping[str, Any]) -> Answer:
    """A case's folder, as a ZIP archive."""
    from ibr_ref.oracle import export

    with tempfile.TemporaryDirectory(prefix="ibr_ref-") as place:
        case = session.case(question)
        folder, made = Path(place) / case.name, io.BytesIO()
        export(case, folder)
        with zipfile.ZipFile(made, "w", zipfile.ZIP_DEFLATED) as archive:
            for path in sorted(folder.rglob("*")):
                archive.write(path, path.relative_to(place))
    return Answer(made.getvalue(), "application/zip")


_ANSWERS: dict[str, Callable[[Session, Mapping[str, Any]], Answer]] = {
    "start": _start,
    "frame": _frame,
    "pixel": _pixel,
    "difference": _difference,
    "picture.png": _png,
    "case.zip": _case,
}
