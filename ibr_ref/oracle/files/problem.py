"""What is wrong with a file of a case or of a submission: which file, what was found, what is allowed."""

from __future__ import annotations

from dataclasses import dataclass

from pydantic import ValidationError

_LONGEST = 200


@dataclass(frozen=True)
class Problem:
    """One line for people."""

    file: str
    """A file's name, or that of an argument."""
    found: str
    allowed: str

    def __post_init__(self) -> None:
        for name in ("file", "found", "allowed"):  # names of files need not be text
            text = getattr(self, name).encode("utf-8", "backslashreplace").decode()
            object.__setattr__(self, name, text)

    def __str__(self) -> str:
        return f"{self.file}: found {self.found}, allowed: {self.allowed}"


class UnusableError(ValueError):
    """Raised for a file that cannot be used."""

    def __init__(self, file: object, found: object, allowed: str) -> None:
        self.problem = Problem(str(file), shortened(found), allowed)
        super().__init__(str(self.problem))


def shortened(found: object) -> str:
    """What was found, on one line of bounded length."""
    text = " ".join(str(found).split())
    return text if len(text) <= _LONGEST else text[: _LONGEST - 3] + "..."


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
    return UnusableError(where, repr(found) if isinstance(found, (str, bytes)) else found, shortened(first["msg"]))
