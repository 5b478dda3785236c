"""What a verdict does not need is not imported: a small case is judged about as fast as Python starts."""

from __future__ import annotations

import subprocess
import sys

import pytest

from ibr_ref import methods

CODE = """
import sys
from ibr_ref.oracle import check, load_submission
from ibr_ref.oracle.schema.document import schema_of
from ibr_ref.oracle.referees import referee
schema_of({method!r}), referee({method!r})
print(*sys.modules)
"""


@pytest.mark.parametrize("method", methods.names())
def test_a_referee_needs_no_other_method_no_filters_and_no_bugs(method: str) -> None:
    made = subprocess.run(
        [sys.executable, "-c", CODE.format(method=method)], capture_output=True, text=True, check=True
    )
    imported = set(made.stdout.split())
    others = {f"ibr_ref.{other}" for other in methods.names() if other != method}
    assert not imported & (others | {"scipy.ndimage", f"ibr_ref.oracle.faults.{method}"})
    assert f"ibr_ref.{method}" in imported
