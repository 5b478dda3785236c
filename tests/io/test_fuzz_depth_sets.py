"""A small part of `python -m tests.io.fuzz_depth_sets`."""

from __future__ import annotations

from tests.io.fuzz_depth_sets import tally

COUNT = 400


def test_changed_files_are_read_or_refused_in_one_line(tmp_path, capsys):
    found = tally(tmp_path, COUNT, seed=0)
    assert found["read"] + found["refused"] == COUNT, (dict(found), capsys.readouterr().out)
    assert found["read"] > COUNT // 20
    assert found["refused"] > COUNT // 20
