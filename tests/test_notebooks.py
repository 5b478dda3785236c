"""Every notebook runs from top to bottom, shows its sliders, survives them being moved, and is stored without outputs."""

import importlib.util
from pathlib import Path
from typing import Any

import pytest

NOTEBOOKS = sorted((Path(__file__).parent.parent / "notebooks").glob("*.ipynb"))
NEEDED = ("distributed", "ipykernel", "ipywidgets", "matplotlib", "nbclient", "nbformat", "pyarrow")
MISSING = [name for name in NEEDED if importlib.util.find_spec(name) is None]

WIDGET_VIEW = "application/vnd.jupyter.widget-view+json"
WIDGET_STATE = "application/vnd.jupyter.widget-state+json"

MOVE_SLIDERS = """
for control in CONTROLS.values():
    if hasattr(control, "max"):
        before = control.value
        control.value = -(10**9)  # sliders clamp to their ends
        control.value = 10**9
        control.value = before
"""
"""Run after each notebook's own cells; `CONTROLS` holds its widgets by name."""

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


def test_runs_and_shows_sliders(path: Path) -> None:
    import nbformat
    from nbclient import NotebookClient

    notebook = read(path)
    notebook.cells.append(nbformat.v4.new_code_cell(MOVE_SLIDERS))
    # The timeout is one cell's: the first picture may have to compile all kernels.
    client = NotebookClient(notebook, timeout=900, kernel_name="python3", resources={"metadata": {"path": path.parent}})
    client.execute()

    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    assert any(WIDGET_VIEW in output.get("data", {}) for output in outputs)
    state = notebook.metadata.widgets[WIDGET_STATE]["state"].values()
    assert any(widget["model_name"].endswith("SliderModel") for widget in state)
    # What a control's callback prints or raises ends in an Output widget.
    printed = [widget["state"]["outputs"] for widget in state if widget["model_name"] == "OutputModel"]
    assert not any(printed)
    assert not [output.text for output in outputs if output.get("name") == "stderr"]
