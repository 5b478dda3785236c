"""Options that nothing would read are refused, by name and with the reason: the table, and every pair of it."""

from __future__ import annotations

from collections.abc import Iterator
from enum import Enum
from itertools import product
from pathlib import Path
from typing import Any

import pytest
import typer

from ibr_ref.cli import app
from ibr_ref.cli.command import refuse
from ibr_ref.cli.what_goes_with_what import ABSENT, GIVEN, rules, table
from tests.cli.conftest import Run
from tests.cli.errors import assert_one_line


def commands(group: Any = None, path: str = "") -> Iterator[tuple[str, Any]]:
    group = typer.main.get_command(app) if group is None else group
    for name, command in group.commands.items():
        here = f"{path} {name}".strip()
        yield from commands(command, here) if hasattr(command, "commands") else [(here, command)]


COMMANDS = dict(commands())


def defaults(command: Any) -> dict[str, Any]:
    return {param.name: getattr(param.default, "value", param.default) for param in command.params}


def modes(name: str) -> Iterator[dict[str, Any]]:
    """All combinations of the values that any rule of a command asks for, and of one more each."""
    seen: dict[str, set[Any]] = {}
    for rule in rules(name).values():
        for alternative in rule.alternatives:
            for other, wanted in alternative.items():
                values = wanted if isinstance(wanted, tuple) else () if wanted in (GIVEN, ABSENT) else (wanted,)
                seen.setdefault(other, set()).update({None, "x"} if wanted in (GIVEN, ABSENT) else values)
    for param in COMMANDS[name].params:
        if param.name in seen and None not in seen[param.name]:
            chosen = isinstance(param.default, Enum)
            seen[param.name] |= {each.value for each in type(param.default)} if chosen else {param.default}
    names = sorted(seen)
    for values in product(*(sorted(seen[other], key=str) for other in names)):
        yield dict(zip(names, values, strict=True))


def refusal(name: str, values: dict[str, Any], given: str) -> str | None:
    try:
        refuse(rules(name), COMMANDS[name].params, values, {given})
    except typer.BadParameter as error:
        return str(error)
    return None


def test_every_parameter_of_every_command_is_in_the_table() -> None:
    assert set(table()) == set(COMMANDS)
    for name, command in COMMANDS.items():
        assert set(rules(name)) == {param.name for param in command.params}, name
        for rule in rules(name).values():
            assert all(set(alternative) <= set(rules(name)) for alternative in rule.alternatives), name


def test_view_has_the_rules_of_render() -> None:
    """But for what is written: so they need not be tried again."""
    for name in ("displacement", "splatting", "shadows"):
        seen, rendered = table()[f"view {name}"], table()[f"render {name}"]
        assert set(seen) - set(rendered) == {"port", "no_browser"}
        for param in set(seen) & set(rendered):
            kept = [each for each in rendered[param].alternatives if set(each) <= set(seen)]
            assert list(seen[param].alternatives) == kept, param


@pytest.mark.sampled(3)
@pytest.mark.parametrize("name", [name for name in COMMANDS if not name.startswith("view ")])
def test_every_option_beside_every_mode(name: str) -> None:
    """Read or refused as the table says, written out here a second time; each rule is kept and broken by some mode."""
    command, outcomes = COMMANDS[name], {}
    for mode in modes(name):
        values = {**defaults(command), **mode}
        for param in command.params:
            rule = rules(name)[param.name]
            if param.name not in mode:
                values[param.name] = values[param.name] or "x"
            read = not rule.alternatives or any(
                all(
                    bool(values[other]) == (wanted is GIVEN)
                    if wanted in (GIVEN, ABSENT)
                    else values[other] in (wanted if isinstance(wanted, tuple) else (wanted,))
                    for other, wanted in alternative.items()
                )
                for alternative in rule.alternatives
            )
            said = refusal(name, values, param.name)
            assert (said is None) == read, (param.name, values)
            if said is not None:
                flag = max(param.opts, key=len) if param.param_type_name == "option" else ""
                assert said.startswith(flag)
                assert "allowed: " in said
                assert rule.why in said
            outcomes.setdefault(param.name, set()).add(said is not None)
    for param, found in outcomes.items():
        assert found == ({True, False} if rules(name)[param].alternatives else {False}), param


HEIGHT = ("render", "displacement", "--height", "h.png", "--out", "a.png")
MESH = ("render", "splatting", "--mesh", "t.obj", "--out", "a.png")
MSR = ("render", "splatting", "--msr", "folder", "--view", "1", "--out", "a.png")
CASTER = ("render", "shadows", "--caster", "t.obj", "--out", "a.png")


@pytest.mark.parametrize(
    ("call", "option", "words"),
    [
        (HEIGHT, ("--max-steps", "3"), ("--method protruded", "tatarchuk")),
        (HEIGHT, ("--max-steps", "50"), ("--method protruded", "tatarchuk")),  # its default, but given
        (HEIGHT, ("--lod-bias", "1", "--method", "relief"), ("--method relief", "mcguire")),
        (HEIGHT, ("--interval", "paper", "--method", "relief"), ("protruded | exact",)),
        (HEIGHT, ("--faces", "base", "--method", "texture"), ("protruded | exact",)),
        (HEIGHT, ("--facade", "c.png", "--method", "relief"), ("protruded | exact",)),
        (HEIGHT, ("--facade-tile", "1,1"), ("--facade",)),
        (HEIGHT, ("--delta", "0.2"), ("--facade",)),
        (HEIGHT, ("--steps", "5", "--method", "tatarchuk"), ("--method tatarchuk",)),
        (HEIGHT, ("--normal-height", "n.png"), ("--height",)),
        (MESH, ("--cameras", "99"), ("--msr",)),
        (MESH, ("--view", "7"), ("--msr",)),
        (MESH, ("--frame", "0"), ("--msr",)),
        (MESH, ("--law", "1,0,0,1", "--shape", "ellipse"), ("--shape ellipse",)),
        (MESH, ("--fit", "--shape", "ellipse"), ("--shape ellipse",)),
        (MESH, ("--law", "1,0,0,1", "--fit"), ("--fit",)),
        (MESH, ("--min-width", "1", "--shape", "ellipse"), ("--shape ellipse",)),
        (MESH, ("--cutoff", "2"), ("--shape square",)),
        (MESH, ("--simple-texture", "s.xmt"), ("--mesh",)),
        *((MSR, option, ("--msr",)) for option in (
            ("--eye", "0,0,1"), ("--target", "0,0,0"), ("--up", "0,0,1"), ("--fov", "45"), ("--size", "640x480"))),
        (MSR, ("--count", "9"), ("--mesh",)),
        (MSR, ("--reference-size", "320"), ("--mesh",)),
        *((CASTER, (*option, "--method", "traced"), ("--method traced",)) for option in (
            ("--samples", "9"), ("--policy", "nearest"), ("--content", "depth"), ("--controls", "best"), ("--rows", "200"),
            ("--columns", "5"), ("--map-size", "512"), ("--map-samples", "1"), ("--maps", "m.npz"))),
        (CASTER, ("--controls", "fast", "--method", "direct"), ("--method direct",)),
        (CASTER, ("--light-size", "0.3"), ("--samples",)),
        (CASTER, ("--map-samples", "3", "--content", "depth"), ("--content depth",)),
        (("render", "shadows", "--out", "a.png"), ("--up", "z"), ("--caster",)),
        (("export", "--schema"), ("--list",), ("--schema",)),
        (("export", "--list"), ("--force",), ("--list",)),
        (("check", "--self-test"), ("--report", "v.html"), ("--self-test",)),
        (("check", "--self-test"), ("--device", "gl"), ("--self-test",)),
        (("check", "case", "port"), ("--method", "shadows"), ("--self-test",)),
        (("bench", "shadows"), ("--msr", "folder"), ("shadows",)),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, tuple) else None,
)  # fmt: skip
def test_what_does_not_apply_is_refused_by_name(
    run: Run, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, call: tuple[str, ...], option: tuple[str, ...],
    words: tuple[str, ...],
) -> None:  # fmt: skip
    monkeypatch.chdir(tmp_path)
    assert_one_line(run(*call, *option), f"{option[0]}: found", *words)
    assert not list(tmp_path.iterdir())


NO_NUMBERS = ("½", "1_0", "٣", "１", "True", "None", "0x10", "", "1,", "1e999,0,0")


def numeric() -> Iterator[tuple[str, str]]:
    for name, command in COMMANDS.items():
        for param in command.params if not name.startswith("view ") else ():
            number = isinstance(param.default, (int, float, tuple)) and not isinstance(param.default, bool)
            if param.param_type_name == "option" and number:
                yield name, max(param.opts, key=len)
    for name, flag in (("splatting", "eye"), ("splatting", "target"), ("splatting", "law"), ("splatting", "view")):
        yield f"render {name}", f"--{flag}"
    for name, flag in product(("displacement", "splatting", "shadows"), ("near", "far")):
        yield f"render {name}", f"--{flag}"


@pytest.mark.sampled(4)
@pytest.mark.parametrize(("name", "flag"), sorted(numeric()))
def test_what_is_no_number_is_refused_wherever_it_stands(run: Run, tmp_path: Path, name: str, flag: str) -> None:
    for text in NO_NUMBERS:
        out = ("--out", tmp_path / "a.png") if name.startswith("render") else ()
        assert_one_line(run(*name.split(), *out, f"{flag}={text}"), flag, "allowed")


@pytest.mark.parametrize("flag", ["--eye", "--target", "--light"])
@pytest.mark.parametrize("text", ["inf,3,1", "nan,0,0", "1,2", "1,2,3,4", "½,-1.75"])
def test_a_vector_is_finite(run: Run, flag: str, text: str) -> None:
    assert_one_line(run(*HEIGHT, f"{flag}={text}"), flag, "3 numbers")
