"""What an error of the command line looks like."""

from __future__ import annotations


def assert_one_line(result: tuple[int, str, str], *words: str) -> None:
    """Exit code 2 and one line on standard error that names all of `words`."""
    code, out, err = result
    assert code == 2, (code, out, err)
    assert err.startswith("ibr-ref: ")
    assert err.count("\n") == 1
    assert "Traceback" not in err
    for word in words:
        assert word in err, err
