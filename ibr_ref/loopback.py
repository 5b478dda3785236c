"""HTTP on the loopback interface, for whoever knows the token in the address."""

from __future__ import annotations

import secrets
from collections.abc import Mapping
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, HTTPServer
from urllib.parse import urlsplit

LOOPBACK = "127.0.0.1"


class Handler(BaseHTTPRequestHandler):
    """What handlers share: who is let in, how much is read, and a reply in one write."""

    server: HTTPServer
    protocol_version = "HTTP/1.1"
    disable_nagle_algorithm = True  # headers and body are two writes
    wbufsize = -1

    def place(self, token: str) -> str | None:
        """What follows the token; None for whoever does not know it, or came by another name, as a site of the net might."""
        hosts = {f"{host}:{self.server.server_port}" for host in (LOOPBACK, "localhost")}
        parts = urlsplit(self.path).path.split("/", 2)
        if len(parts) != 3 or self.headers.get("Host") not in hosts:
            return None
        return parts[2] if secrets.compare_digest(parts[1].encode(), token.encode()) else None

    def body(self, most: int) -> bytes | None:
        """What was sent; None where it is more than so many bytes, or does not say how many: the connection ends then."""
        length = self.headers.get("Content-Length", "")
        if not length.isascii() or not length.isdigit() or int(length) > most:
            self.close_connection = True
            return None
        return self.rfile.read(int(length))

    def reply(self, status: HTTPStatus, body: bytes, headers: Mapping[str, str]) -> None:
        """A whole answer; whoever asked may have gone."""
        self.send_response(status)
        for name, value in {"Content-Length": str(len(body)), **headers}.items():
            self.send_header(name, value)
        self.end_headers()
        try:
            self.wfile.write(body)
            self.wfile.flush()
        except OSError:
            self.close_connection = True

    def log_message(self, format: str, *arguments: object) -> None:  # noqa: A002 - as it is overridden
        """Nothing: a line for every frame would be many."""
