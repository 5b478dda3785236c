"""The reader and writer of .npy files in C++: what NumPy wrote comes back as it was."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest

import ibr_ref.ports

HEADER = Path(ibr_ref.ports.__file__).parent / "cpp" / "npy.hpp"
PROGRAM = f"""
#include "{HEADER}"
#include <iostream>
template <class T> void copy(const char* from, const char* to) {{ npy::write(to, npy::read<T>(from)); }}
int main(int, char** a) try {{
    const std::string kind = a[1];
    if (kind == "f8") copy<double>(a[2], a[3]);
    if (kind == "f4") copy<float>(a[2], a[3]);
    if (kind == "i8") copy<std::int64_t>(a[2], a[3]);
    if (kind == "i4") copy<std::int32_t>(a[2], a[3]);
    if (kind == "u1") copy<std::uint8_t>(a[2], a[3]);
    if (kind == "b1") copy<bool>(a[2], a[3]);
    return 0;
}} catch (const std::exception& error) {{ std::cerr << error.what(); return 1; }}
"""


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> Path:
    compiler = shutil.which("g++") or shutil.which("clang++")
    if compiler is None:
        pytest.skip("no C++ compiler")
    folder = tmp_path_factory.mktemp("cpp")
    (folder / "copy.cpp").write_text(PROGRAM)
    command = [compiler, "-std=c++17", "-Wall", "-Wextra", "-Werror", "copy.cpp", "-o", "copy"]
    subprocess.run(command, cwd=folder, check=True)
    return folder / "copy"


@pytest.mark.parametrize("kind", ["f8", "f4", "i8", "i4", "u1", "b1"])
@pytest.mark.parametrize("shape", [(), (3,), (2, 3), (0, 4), (2, 1, 5)])
def test_there_and_back(kind: str, shape: tuple[int, ...], copy: Path, tmp_path: Path) -> None:
    array = np.random.default_rng(1).integers(0, 2, shape).astype(kind)
    np.save(tmp_path / "a.npy", array)
    subprocess.run([copy, kind, tmp_path / "a.npy", tmp_path / "b.npy"], check=True)
    found = np.load(tmp_path / "b.npy", allow_pickle=False)
    assert (found.dtype, found.shape) == (array.dtype, array.shape)
    np.testing.assert_array_equal(found, array)


def test_what_is_none_is_said(copy: Path, tmp_path: Path) -> None:
    np.save(tmp_path / "fortran.npy", np.asfortranarray(np.zeros((2, 3))))
    whole = (tmp_path / "fortran.npy").read_bytes()
    (tmp_path / "short.npy").write_bytes(whole[:-1].replace(b"True", b"False"))
    (tmp_path / "none.npy").write_text("nothing")
    for name, message in (("fortran", "not in C order"), ("none", "is no .npy file")):
        run = subprocess.run([copy, "f8", tmp_path / f"{name}.npy", tmp_path / "b.npy"], capture_output=True, text=True)
        assert (run.returncode, run.stderr) == (1, f"{tmp_path / name}.npy: {message}")
    assert not (tmp_path / "b.npy").exists()
