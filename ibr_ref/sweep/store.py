"""The rows of a sweep: in memory, and in a Parquet file that a later sweep goes on from."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from os import PathLike
from typing import Any

from ibr_ref.io.extras import needed
from ibr_ref.io.files import contents, naming
from ibr_ref.io.outputs import atomic
from ibr_ref.scene.checks import named
from ibr_ref.sweep.settings import Setting
from ibr_ref.sweep.work import Row

Key = tuple[Any, ...]
"""Values of the parameters, in their order, and the number of the view."""

EXTRA = "sweep"

_METADATA = b"ibr_ref.sweep"


@dataclass
class Store:
    """What is known so far."""

    path: str | PathLike[str] | None
    """None: in memory alone."""
    about: dict[str, Any]
    """JSON of all that rows depend on: only a file with the same is gone on from."""
    parameters: Sequence[str]
    measures: Sequence[str]
    rows: dict[Key, Row] = field(default_factory=dict)

    def load(self) -> None:
        """Read the file, if it is there. Raises ValueError for what is no sweep, or one of something else."""
        if self.path is None:
            return
        try:
            data = contents(self.path)
        except FileNotFoundError:
            return
        pa, parquet = needed("pyarrow", "Parquet files", EXTRA), needed("pyarrow.parquet", "Parquet files", EXTRA)
        with naming(self.path):
            table = parquet.read_table(pa.BufferReader(data))
        about = json.loads((table.schema.metadata or {}).get(_METADATA, b"null"))
        if about != self.about:
            found = "another file" if about is None else "a sweep of another scene, other parameters or another version"
            raise ValueError(f"{named(self.path)}: found {found}, allowed: a new file, or this sweep's own")
        for line in table.to_pylist():
            key = (*(line[name] for name in self.parameters), line["view"])
            self.rows[key] = {name: line[name] for name in self.measures}

    def add(self, setting: Setting, view: int, row: Row) -> None:
        """A row that was measured."""
        self.rows[self.key(setting, view)] = row

    def key(self, setting: Setting, view: int) -> Key:
        """Of a row."""
        return (*(setting[name] for name in self.parameters), view)

    def write(self) -> None:
        """Write all rows; the file is whole at any time."""
        if self.path is None:
            return
        parquet = needed("pyarrow.parquet", "Parquet files", EXTRA)
        keys = sorted(self.rows, key=lambda key: tuple((type(value).__name__, value) for value in key))
        with atomic(self.path) as file:
            parquet.write_table(self._table(keys), file)

    def table(self, settings: Sequence[Setting], views: int) -> Any:
        """The `pyarrow.Table` of these settings, view by view."""
        return self._table([self.key(setting, view) for setting in settings for view in range(views)])

    def _table(self, keys: Sequence[Key]) -> Any:
        pa = needed("pyarrow", "tables", EXTRA)
        names = [*self.parameters, "view"]
        columns: dict[str, Any] = {name: _column(pa, [key[i] for key in keys]) for i, name in enumerate(names)}
        for name in self.measures:
            columns[name] = pa.array([self.rows[key][name] for key in keys], pa.float64())
        return pa.table(columns).replace_schema_metadata({_METADATA: json.dumps(self.about).encode()})


def _column(pa: Any, values: Sequence[Any]) -> Any:
    """Whole numbers, numbers, words or truth values; words where they are mixed."""
    kinds = {type(value) for value in values}
    if kinds <= {int, float} and float in kinds:
        return pa.array([float(value) for value in values], pa.float64())
    return pa.array(values if len(kinds) <= 1 else [str(value) for value in values])


def about(digest: str, rest: Mapping[str, Any]) -> dict[str, Any]:
    """For `Store.about`. rest: parameters that are not swept."""
    return {"subject": digest, "params": {name: repr(value) for name, value in sorted(rest.items())}}
