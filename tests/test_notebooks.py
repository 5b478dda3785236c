"""Every notebook runs from top to bottom, shows its page, and is stored without outputs."""

import importlib.util
from pathlib import Path
from typing import Any

import pytest

NOTEBOOKS = sorted((Path(__file__).parent.parent / "notebooks").glob("*.ipynb"))
NEEDED = ("distributed", "ipykernel", "matplotlib", "nbclient", "nbformat", "pyarrow")
MISSING = [name for name in NEEDED if importlib.util.find_spec(name) is None]

ASK = """
import re, urllib.request
with urllib.request.urlopen(page.address) as answer:
    print(re.search("<title>(.*)</title>", answer.read().decode())[1])
page.close()
"""
"""Run after each notebook's own cells; `page` is what it shows."""

pytestmark = [
    pytest.mark.skipif(bool(MISSING), reason=f"not installed: {', '.join(MISSING)} (pip install ibr_ref[test])"),
    # pyzmq says on Windows that asyncio's default loop needs an extra thread there; nothing a caller could mend.
    pytest.mark.filterwarnings("ignore:Proactor event loop does not implement add_reader:RuntimeWarning"),
    pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem),
]


def read(path: Path) -> Any:
    import nbformat

    notebook = nbformat.read(path, as_version=4)
    nbformat.validate(notebook)
    return notebook


def test_is_stored_without_outputs(path: Path) -> None:
    notebook = read(path)
    code = [cell for cell in notebook.cells if cell.cell_type == "code"]
    assert code
    assert not any(cell.outputs or cell.execution_count for cell in code)
    assert "widgets" not in notebook.metadata
    assert notebook.metadata.kernelspec.name == "python3"


@pytest.mark.long
def test_runs_and_shows_a_page(path: Path) -> None:
    import nbformat
    from nbclient import NotebookClient

    notebook = read(path)
    notebook.cells.append(nbformat.v4.new_code_cell(ASK))
    # The timeout is one cell's: the first picture may have to compile all kernels.
    client = NotebookClient(notebook, timeout=900, kernel_name="python3", resources={"metadata": {"path": path.parent}})
    client.execute()

    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    (frame,) = [html for output in outputs if "<iframe" in (html := output.get("data", {}).get("text/html", ""))]
    assert 'src="http://127.0.0.1:' in frame
    assert outputs[-1].text == "ibr-ref view\n"
    assert not [output.text for output in outputs if output.get("name") == "stderr"]
