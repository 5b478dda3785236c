"""`case.json`: strict models of everything that a port is given, from cases and back; the JSON Schema made of them."""

from ibr_ref.oracle.schema.document import (
    Document,
    adapter,
    build,
    describe,
    describe_inputs,
    input_files,
    read,
    schema,
    schema_text,
)

__all__ = [
    "Document",
    "adapter",
    "build",
    "describe",
    "describe_inputs",
    "input_files",
    "read",
    "schema",
    "schema_text",
]
