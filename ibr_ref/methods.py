"""The methods: one record each, in one registry.

A record says where the rooms of a method are, by dotted path; each is imported when it is first used, so that `--help`
answers at once. Whoever needs all methods, or one by its name, asks here: no other file knows which there are.

A further method is a folder and a record: a line here, or `register(record)` before `ibr_ref.cli` is imported, for one
that lives in another package. CONTRIBUTING.md says what each room has.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from importlib import import_module
from typing import Any


class Room(str):
    """The dotted path of a module, or "module:name" for something in it."""

    __slots__ = ()

    def open(self) -> Any:
        """The module, or what it has under the name. Raises ImportError or AttributeError where that is not there."""
        module, _, name = self.partition(":")
        found = import_module(module)
        return getattr(found, name) if name else found


@dataclass(frozen=True, kw_only=True)
class Method:
    """What there is of a method. Rooms that are None are not there: no demo, no bench, and so on."""

    name: str
    """As `case.json`, the command line and the names of its cases ("NAME-box") have it."""
    title: str
    source: str
    """Authors and year: "Yoo & Han 2006"."""
    package: Room
    """Scene, Params and `render(scene, params, *, stages, ...) -> io.Frame`."""
    contract: Room
    """`contract.StageArray` by name: every array of `Frame.stages`."""
    page: str
    """What the method does, for readers: "package:file"."""
    cases: Room
    """Functions that make a `Case`, by name."""
    schema: Room
    """`oracle.schema.document.Schema`: the method in `case.json`."""
    referee: Room
    """A class, `oracle.judgement.Referee`."""
    reads: Room
    """By array: the port's own arrays that it is computed from."""
    judged: tuple[str, tuple[str, ...]]
    """The field of Params by which systems are chosen, and those of its values that the referee judges."""
    inputs: tuple[str, ...] = ()
    """What a case may be given besides scene and parameters: `Case.inputs`. `render` is given those of them that it has
    parameters for."""
    plain_port: Room | None = None
    """Port, VARIANTS, MUTANTS: what `ibr-ref check --self-test` tries the oracle on."""
    sample_ports: Mapping[str, Room] = field(default_factory=dict, hash=False)
    """Classes by their languages, drawn by `ibr-ref draw`: of a device, with render(scene, params) of an exported case."""
    command: Room | None = None
    """command, read, EXAMPLES and goes_with: `ibr-ref render NAME`."""
    viewable: Room | None = None
    """`viewer.room.Viewable`: `ibr-ref view`."""
    demo: Room | None = None
    """SIZES and NOTE (words of the table), PICTURES (how many) and `pictures()`, of `demo.picture.Picture`."""
    sweep: Room | None = None
    """`sweep.rooms.Room`: what is measured, and how."""
    sweep_command: Room | None = None
    """command, EXAMPLES and goes_with: `ibr-ref sweep NAME`."""
    bench: Room | None = None
    """`measured(repeat, msr)`, and READS_MSR."""
    reproduction: Room | None = None
    """`reproduce.findings.Reproduction`."""
    paper: int | None = None
    """Its number for `ibr-ref reproduce`."""


def _own(
    name: str,
    paper: int,
    title: str,
    source: str,
    judged: tuple[str, tuple[str, ...]],
    inputs: tuple[str, ...] = (),
) -> Method:
    """A method of this package, whose rooms are where those of all its methods are."""
    return Method(
        name=name,
        paper=paper,
        title=title,
        source=source,
        judged=judged,
        inputs=inputs,
        page=f"ibr_ref:{name}/method.md",
        package=Room(f"ibr_ref.{name}"),
        contract=Room(f"ibr_ref.{name}.contract:STAGES"),
        cases=Room(f"ibr_ref.oracle.cases.{name}:CASES"),
        schema=Room(f"ibr_ref.oracle.schema.{name}:SCHEMA"),
        referee=Room(f"ibr_ref.oracle.referees.{name}:{name.capitalize()}Referee"),
        reads=Room(f"ibr_ref.oracle.referees.reads:{name.upper()}"),
        plain_port=Room(f"ibr_ref.oracle.faults.{name}"),
        sample_ports={language: Room(f"ibr_ref.ports.{language}.{name}:Port") for language in ("glsl", "wgsl")},
        command=Room(f"ibr_ref.cli.{name}"),
        viewable=Room(f"ibr_ref.viewer.{name}:VIEWABLE"),
        demo=Room(f"ibr_ref.demo.{name}"),
        sweep=Room(f"ibr_ref.sweep.{name}"),
        sweep_command=Room(f"ibr_ref.cli.sweeps.{name}"),
        bench=Room(f"ibr_ref.bench.{name}"),
        reproduction=Room(f"ibr_ref.reproduce.{name}:REPRODUCTION"),
    )


_JUDGED_SEARCHES = (
    "protruded",
    "relief",
    "welsh",
    "mcguire",
    "tatarchuk",
    "cone",
    "relaxed_cone",
    "donnelly",
    "maximum_mipmap",
)
_JUDGED_SHAPES = ("square", "disc", "ellipse")
_JUDGED_SHADOWS = ("warp", "direct", "grid", "pcss")

# fmt: off
_METHODS = {method.name: method for method in (
    _own("displacement", 1, "Protruded displacement mapping", "Yoo & Han 2006", ("method", _JUDGED_SEARCHES)),
    _own("splatting", 2, "Splatting of depth images", "Lee & Park 2006", ("shape", _JUDGED_SHAPES), ("normals",)),
    _own("shadows", 3, "Shadows by image warping", "Kang & Ihm 2002", ("method", _JUDGED_SHADOWS), ("maps",)),
)}
# fmt: on


def records() -> tuple[Method, ...]:
    """All methods, in the papers' order; registered ones last."""
    return tuple(_METHODS.values())


def names() -> tuple[str, ...]:
    """Theirs."""
    return tuple(_METHODS)


def named(name: str) -> Method:
    """The method of that name. Raises ValueError with all names for another."""
    if name not in _METHODS:
        raise ValueError(f"method: found {name!r:.200}, allowed: {' | '.join(_METHODS)}")
    return _METHODS[name]


def register(method: Method) -> None:
    """Add a method. Raises ValueError for a name that is taken."""
    if method.name in _METHODS:
        raise ValueError(f"method: found {method.name!r}, allowed: a name that no other method has")
    _METHODS[method.name] = method


@contextmanager
def registered(method: Method) -> Iterator[None]:
    """The same for a while."""
    register(method)
    try:
        yield
    finally:
        del _METHODS[method.name]
