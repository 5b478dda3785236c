"""A door for ports that live in a page, for WebGL and WebGPU: it asks for cases, and hands over what it has drawn.

HTTP on loopback. `GET next` waits for a case and answers with its number and its files; `GET case/NAME` is a file of it;
`POST drawn/NUMBER/NAME` a file of the drawing, `POST done/NUMBER` "ok" or why there is none. `GET port.js` does all that.
Pages of any origin may ask: who knows the token is let in.
"""

from __future__ import annotations

import json
import queue
import re
import secrets
import threading
from http import HTTPStatus
from http.server import ThreadingHTTPServer
from importlib.resources import files
from pathlib import Path
from typing import NamedTuple
from urllib.parse import unquote

from ibr_ref.loopback import LOOPBACK, Handler
from ibr_ref.scene import checks
from ibr_ref.testing.judging import PortError
from ibr_ref.testing.ports import LONGEST

POLL = 5.0
"""Seconds that a question for the next case may wait; then it is asked again."""
MOST_BYTES = 2**28
"""Of a file of a drawing."""
COMING = 600.0
"""Seconds that the page has to come for the first case: somebody must open it."""

_NAME = re.compile(r"[A-Za-z0-9_-][A-Za-z0-9._-]{0,99}")


class _Work(NamedTuple):
    """A case that is out."""

    number: int
    case: Path
    out: Path


class Door:
    """A port behind it draws folders as others do. Ports of several pages take cases in turn, one at a time."""

    def __init__(self, port: int = 0) -> None:
        """Port 0: one that is free. Raises OSError for one that is taken."""
        self.token = secrets.token_urlsafe(16)
        self.work: _Work | None = None
        self.over, self.came = False, False
        self.waiting = threading.Condition()
        self.answers: queue.Queue[str] = queue.Queue()
        self.number = 0
        try:
            self.server = _Server(self, port)
        except (OSError, OverflowError) as error:
            raise OSError(f"page: found port {port}, allowed: one that is free on {LOOPBACK} ({error})") from None
        threading.Thread(target=self.server.serve_forever, daemon=True).start()

    @property
    def address(self) -> str:
        """Where a page finds it."""
        return f"http://{LOOPBACK}:{self.server.server_port}/{self.token}/"

    def draw(self, case: Path, out: Path) -> None:
        """Hand a case out and wait for its drawing. Raises PortError for none within `LONGEST`, or as the page says."""
        self.answers = queue.Queue()
        with self.waiting:
            self.number += 1
            self.work = _Work(self.number, case, out)
            self.waiting.notify_all()
        try:
            said = self.answers.get(timeout=LONGEST if self.came else COMING)
        except queue.Empty:
            raise PortError(f"no answer within {LONGEST:g} s") from None
        finally:
            with self.waiting:
                self.work = None
        if said != "ok":
            raise PortError(checks.one_line(said))

    def close(self) -> None:
        """Tell pages that ask that it is over, and end."""
        with self.waiting:
            self.over = True
            self.waiting.notify_all()
        self.server.shutdown()
        self.server.server_close()

    def next(self) -> dict[str, object]:
        """What a page is to draw."""
        with self.waiting:
            self.waiting.wait_for(lambda: self.over or self.work is not None, POLL)
            work = self.work
        if work is None:
            return {"number": None, "files": [], "over": self.over}
        self.came = True
        names = [path.relative_to(work.case).as_posix() for path in sorted(work.case.rglob("*")) if path.is_file()]
        return {"number": work.number, "files": names, "over": self.over}

    def done(self, said: str) -> None:
        """What a page says of the case that is out, which it is no longer."""
        with self.waiting:
            self.work = None
        self.answers.put(said)

    def work_of(self, number: str) -> _Work | None:
        """The case of that number, if it is still out."""
        work = self.work
        return work if work is not None and number == str(work.number) else None


class _Server(ThreadingHTTPServer):
    daemon_threads = True

    def __init__(self, door: Door, port: int) -> None:
        self.door = door
        super().__init__((LOOPBACK, port), _Handler)


class _Handler(Handler):
    server: _Server

    def do_GET(self) -> None:  # noqa: N802 - as http.server calls it
        """The next case, a file of it, or the module."""
        place = self._place()
        if place == "next":
            self._send(HTTPStatus.OK, json.dumps(self.server.door.next()).encode(), "application/json")
        elif place == "port.js":
            text = files("ibr_ref.testing").joinpath("door.js").read_bytes()
            self._send(HTTPStatus.OK, text, "text/javascript; charset=utf-8")
        elif place is not None and place.startswith("case/"):
            self._send_file(place.removeprefix("case/"))
        else:
            self._send(HTTPStatus.NOT_FOUND)

    def do_POST(self) -> None:  # noqa: N802 - as http.server calls it
        """A file of the drawing, or its end."""
        place, body = self._place(), self.body(MOST_BYTES)
        if body is None:
            self._send(HTTPStatus.REQUEST_ENTITY_TOO_LARGE)
            return
        what, _, rest = (place or "").partition("/")
        number, _, name = rest.partition("/")
        work = self.server.door.work_of(number)
        if work is None:
            self._send(HTTPStatus.NOT_FOUND)
        elif what == "done" and not name:
            self.server.door.done(body[:1000].decode("utf-8", "replace"))
            self._send(HTTPStatus.NO_CONTENT)
        elif what == "drawn" and _NAME.fullmatch(name):
            (work.out / name).write_bytes(body)
            self._send(HTTPStatus.NO_CONTENT)
        else:
            self._send(HTTPStatus.NOT_FOUND)

    def do_OPTIONS(self) -> None:  # noqa: N802 - as http.server calls it
        """Browsers ask first whether they may."""
        self._send(HTTPStatus.NO_CONTENT)

    def _send_file(self, name: str) -> None:
        """Of the case that is out: one of those that `next` has named."""
        work = self.server.door.work
        named = None if work is None else {p.relative_to(work.case).as_posix(): p for p in work.case.rglob("*")}
        path = None if named is None else named.get(name)
        if path is None or not path.is_file():
            self._send(HTTPStatus.NOT_FOUND)
        else:
            self._send(HTTPStatus.OK, path.read_bytes(), "application/octet-stream")

    def _place(self) -> str | None:
        place = self.place(self.server.door.token)
        return None if place is None else unquote(place)

    def _send(self, status: HTTPStatus, body: bytes = b"", kind: str = "text/plain") -> None:
        open_to_pages = {
            "Content-Type": kind,
            "Access-Control-Allow-Origin": "*",
            "Access-Control-Allow-Methods": "GET, POST",
            "Access-Control-Allow-Headers": "Content-Type",
            "Access-Control-Allow-Private-Network": "true",
            "Cross-Origin-Resource-Policy": "cross-origin",
            "Cache-Control": "no-store",
        }
        self.reply(status, body, open_to_pages)
