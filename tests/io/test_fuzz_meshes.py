"""A small part of `python -m tests.io.fuzz_meshes`."""

from __future__ import annotations

import pytest

from tests.io.fuzz_meshes import tally

COUNT = 2000


@pytest.mark.parametrize("seed", [0, 77])
def test_changed_files_are_read_alike_or_refused_in_one_line(tmp_path, capsys, seed):
    found = tally(tmp_path, COUNT, seed)
    assert found["read"] + found["refused"] == COUNT, (dict(found), capsys.readouterr().out)
    assert found["read"] > COUNT // 20
    assert found["refused"] > COUNT // 20
