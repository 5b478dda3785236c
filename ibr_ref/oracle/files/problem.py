"""What is wrong with a file of a case or of a submission: which file, what was found, what is allowed."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import ValidationError
from pydantic_core import ErrorDetails

from ibr_ref.scene.checks import LONGEST_NAME, named, one_line


@dataclass(frozen=True)
class Problem:
    """One line for people."""

    file: str
    """A file's name, or that of an argument."""
    found: str
    allowed: str

    def __post_init__(self) -> None:
        object.__setattr__(self, "file", named(self.file))  # names of files need not be text
        object.__setattr__(self, "found", one_line(self.found))
        object.__setattr__(self, "allowed", one_line(self.allowed, LONGEST_NAME))

    def __str__(self) -> str:
        return f"{self.file}: found {self.found}, allowed: {self.allowed}"


class UnusableError(ValueError):
    """Raised for a file that cannot be used."""

    def __init__(self, file: object, found: object, allowed: str) -> None:
        self.problem = Problem(str(file), str(found), allowed)
        super().__init__(str(self.problem))


def field_problem(file: object, error: ValidationError) -> UnusableError:
    """The first thing that a document's model refuses, with the field's path in the file."""
    first = error.errors(include_url=False)[0]
    path = ".".join(str(part) for part in first["loc"])
    where = f"{file}: {path}" if path else str(file)
    if first["type"] == "extra_forbidden":
        return UnusableError(where, "an unknown field", "the fields of the schema (ibr-ref export --schema)")
    if first["type"] == "missing":
        return UnusableError(where, "nothing", "this field, which the schema requires")
    found = first["input"] if first["type"] != "json_invalid" else "what is no JSON"
    return UnusableError(where, repr(found) if isinstance(found, (str, bytes)) else found, _allowed(first))


def _allowed(first: ErrorDetails) -> str:
    """What pydantic asks for, without its own words around it."""
    reason = first.get("ctx", {}).get("error")
    words = str(reason).rpartition("allowed: ")[2] if first["type"] == "value_error" else first["msg"]
    return words.removeprefix("Input should be ")
