"""The server: loopback, a token, small questions, and answers that are files."""

from __future__ import annotations

import http.client
import io
import json
import threading
import zipfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import imageio.v3 as imageio
import numpy as np
import pytest

from ibr_ref import oracle, viewer
from ibr_ref.displacement import render
from ibr_ref.oracle.accept.bytes import color_bytes
from ibr_ref.viewer import Server, Session
from ibr_ref.viewer.server import MOST_BYTES
from tests.viewer.subjects import block


@pytest.fixture(scope="module")
def server() -> Iterator[Server]:
    with Server(Session(block())) as made:
        thread = threading.Thread(target=made.serve_forever)
        thread.start()
        yield made
        made.shutdown()
        thread.join()


def asked(
    server: Server, method: str, path: str, body: bytes | None = None, headers: dict[str, str] | None = None
) -> tuple[int, bytes, Any]:
    connection = http.client.HTTPConnection("127.0.0.1", server.server_port, timeout=60)
    connection.request(method, path, body, headers or {})
    answer = connection.getresponse()
    found = answer.status, answer.read(), answer.headers
    connection.close()
    return found


def question(server: Server, name: str, state: Any) -> tuple[int, bytes, Any]:
    return asked(server, "POST", f"/{server.token}/{name}", json.dumps(state).encode())


def test_it_listens_on_loopback_alone(server: Server) -> None:
    assert server.server_address[0] == "127.0.0.1"
    assert server.address == f"http://127.0.0.1:{server.server_port}/{server.token}/"
    assert len(server.token) >= 22


def test_nothing_without_the_token_or_by_another_name(server: Server) -> None:
    for path in ("/", "/page.js", "/x/", f"/{server.token}", f"/{server.token[:-1]}/", "/%ff/"):
        assert asked(server, "GET", path)[0] == 404, path
    assert asked(server, "POST", "/frame", b"{}")[0] == 404
    assert asked(server, "GET", f"/{server.token}/", headers={"Host": "attacker.example"})[0] == 404
    assert asked(server, "GET", f"/{server.token}/../secrets")[0] == 404
    status, body, headers = asked(server, "GET", f"/{server.token}/")
    assert (status, headers["Referrer-Policy"]) == (200, "no-referrer")
    assert b"<title>ibr-ref view" in body
    assert "default-src 'none'" in headers["Content-Security-Policy"]
    assert "Access-Control-Allow-Origin" not in headers


@pytest.mark.parametrize(
    "body", [b"", b"[", b"[]", b"1e999", b"\xff", b'{"params": {"linear_steps": NaN}}', b"[" * 9000]
)
def test_what_is_no_question(server: Server, body: bytes) -> None:
    status, answer, _ = asked(server, "POST", f"/{server.token}/frame", body)
    assert status == 400
    assert "\n" not in json.loads(answer)["error"]


def test_a_question_is_small(server: Server) -> None:
    status, answer, _ = asked(server, "POST", f"/{server.token}/frame", b" " * (MOST_BYTES + 1))
    assert (status, json.loads(answer)["error"]) == (413, f"at most {MOST_BYTES} bytes")
    for length in ("-1", "x", "9" * 40):
        assert asked(server, "POST", f"/{server.token}/frame", b"{}", {"Content-Length": length})[0] == 413


def test_a_frame_is_its_bytes(server: Server) -> None:
    status, body, headers = question(server, "frame", {"show": "color"})
    frame = render(server.session.subject.scene, server.session.subject.params)
    assert (status, headers["X-Size"]) == (200, "48 36")
    assert np.array_equal(np.frombuffer(body, np.uint8).reshape(36, 48, 4)[..., :3], color_bytes(frame.color))
    assert question(server, "frame", {"params": {"linear_steps": 0}})[0] == 400


def test_a_picture_and_a_case_are_files(server: Server, tmp_path: Path) -> None:
    _, body, _ = question(server, "picture.png", {})
    frame = render(server.session.subject.scene, server.session.subject.params)
    assert np.array_equal(imageio.imread(body), color_bytes(frame.color))
    _, body, _ = question(server, "case.zip", {"params": {"linear_steps": 4}})
    zipfile.ZipFile(io.BytesIO(body)).extractall(tmp_path)
    case = oracle.load_case(tmp_path / "view")
    assert case.params.linear_steps == 4


def test_a_port_that_is_taken(server: Server) -> None:
    with pytest.raises(OSError, match=f"port: found {server.server_port}, allowed: one that is free"):
        Server(server.session, server.server_port)
    with pytest.raises(OSError, match="port: found 70000"):
        Server(server.session, 70000)


def test_a_notebook_is_served_by_another_process() -> None:
    subject = block()
    shown = viewer.view(subject.scene, subject.params, height=500)
    try:
        host, port = shown.address.split("/")[2].split(":")
        connection = http.client.HTTPConnection(host, int(port), timeout=60)
        connection.request("GET", "/" + shown.address.split("/")[3] + "/")
        assert connection.getresponse().status == 200
        connection.close()
        assert f'<iframe src="{shown.address}"' in shown._repr_html_()
        assert "height: 500px" in shown._repr_html_()
    finally:
        shown.close()
    with pytest.raises(ConnectionRefusedError):
        http.client.HTTPConnection(host, int(port), timeout=5).connect()
