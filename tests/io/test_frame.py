"""Frames: pictures and stage dumps that are there completely or not at all."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import array_shapes, arrays

from ibr_ref import io, metrics
from ibr_ref.io.outputs import atomic
from tests.io.test_images import check_refused, small


def frame(**stages):
    color = np.random.default_rng(0).random((4, 5, 3))
    return io.Frame(color=color, depth=np.linspace(0.0, 1.0, 20).reshape(4, 5), stages=stages)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    return tmp_path_factory.mktemp("frames")


def test_save(tmp_path):
    frame().save(tmp_path / "out.png")
    np.testing.assert_array_equal(io.read_image(tmp_path / "out.png"), np.floor(255 * frame().color + 0.5) / 255)


@small
@given(
    index=arrays(np.int32, array_shapes(min_dims=2, max_dims=2)),
    margin=arrays(np.float64, array_shapes(max_dims=4), elements=st.floats()),
    steep=arrays(np.bool_, array_shapes(min_dims=2, max_dims=2)),
)
def test_stages_come_back_bit_for_bit(folder, index, margin, steep):
    stages = {"march.hit_index": index, "march.margin": margin, "march.steep": steep}
    saved = frame(**stages)
    saved.save_stages(folder / "dump.npz")
    with np.load(folder / "dump.npz", allow_pickle=False) as dump:
        assert set(dump) == {"color", "depth", *stages}
        for name, array in {"color": saved.color, "depth": saved.depth, **stages}.items():
            assert dump[name].dtype == array.dtype
            np.testing.assert_array_equal(dump[name], array)


def test_a_frame_without_stages_is_saved_too(tmp_path):
    frame().save_stages(tmp_path / "dump.npz")
    with np.load(tmp_path / "dump.npz", allow_pickle=False) as dump:
        assert set(dump) == {"color", "depth"}


def test_the_name_is_taken_as_it_is(tmp_path):
    frame().save_stages(tmp_path / "dump.bin")
    assert [path.name for path in tmp_path.iterdir()] == ["dump.bin"]


@pytest.mark.parametrize("name", ["none/dump.npz", "."])
def test_places_that_cannot_be_written(tmp_path, name):
    check_refused(frame().save_stages, tmp_path / name)


def test_a_failed_dump_leaves_nothing(tmp_path, monkeypatch):
    def fails(file, **arrays):
        file.write(b"half of it")
        raise RuntimeError("interrupted")

    monkeypatch.setattr("numpy.savez_compressed", fails)
    with pytest.raises(RuntimeError):
        frame().save_stages(tmp_path / "dump.npz")
    assert not list(tmp_path.iterdir())


def test_a_failed_block_leaves_what_was_there(tmp_path):
    path = tmp_path / "a"
    with atomic(path) as file:
        file.write(b"whole")

    def write_half():
        with atomic(path) as file:
            file.write(b"half")
            raise RuntimeError("interrupted")

    with pytest.raises(RuntimeError):
        write_half()
    assert path.read_bytes() == b"whole"
    assert list(tmp_path.iterdir()) == [path]


def test_a_frame_is_said_in_one_line_and_shown_as_a_picture(tmp_path):
    stages = {name: np.zeros(3) for name in ("vertex.clip", "vertex.patch", "march.hit")}
    assert repr(frame(**stages)) == "Frame(5 x 4, stages vertex, march)"
    assert repr(frame()) == "Frame(5 x 4, no stages)"
    frame().save(tmp_path / "out.png")
    assert frame()._repr_png_() == (tmp_path / "out.png").read_bytes()


def test_where_a_picture_is_wrong():
    truth = frame()
    color = truth.color.copy()
    color[1, 2, 0] += 1.5 / 255
    color[3, 4] += 0.9 / 255
    changed = io.Frame(color=color, depth=truth.depth)
    assert np.argwhere(metrics.wrong(changed, truth)).tolist() == [[1, 2]]
    assert metrics.wrong(changed, truth, steps=0.5).sum() == 2
    with pytest.raises(ValueError, match="frame: found 5 x 3 pixels, allowed: 5 x 4 as in truth"):
        metrics.wrong(io.Frame(color=color[1:], depth=truth.depth[1:]), truth)
