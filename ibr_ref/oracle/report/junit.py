"""Verdicts as JUnit XML, which every continuous integration shows."""

from __future__ import annotations

import re
from collections.abc import Iterable
from xml.etree import ElementTree

from ibr_ref.oracle.verdict import Outcome, Verdict

_NO_CHARACTER = re.compile("[^\t\n\r\u0020-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""What XML 1.0 has no way to write, section 2.2."""

_ELEMENTS = {Outcome.FAIL: "failure", Outcome.INCONCLUSIVE: "error"}


def junit(results: Iterable[tuple[Verdict, float]]) -> bytes:
    """The document: a test for each verdict, with the seconds that it took; FAIL is a failure, INCONCLUSIVE an error."""
    tests = [_test(verdict, seconds) for verdict, seconds in results]
    counts = {
        "tests": len(tests),
        "failures": sum(test.find("failure") is not None for test in tests),
        "errors": sum(test.find("error") is not None for test in tests),
    }
    fields = {"name": "ibr-ref check", **{name: str(count) for name, count in counts.items()}, "skipped": "0"}
    fields["time"] = f"{sum(float(test.attrib['time']) for test in tests):.3f}"
    suite = ElementTree.Element("testsuite", fields)
    suite.extend(tests)
    root = ElementTree.Element("testsuites")
    root.append(suite)
    ElementTree.indent(root)
    return bytes(ElementTree.tostring(root, encoding="utf-8", xml_declaration=True)) + b"\n"


def _test(verdict: Verdict, seconds: float) -> ElementTree.Element:
    classname = f"ibr_ref.{verdict.method}" if verdict.method else "ibr_ref"
    fields = {"classname": classname, "name": verdict.case, "time": f"{seconds:.3f}"}
    test = ElementTree.Element("testcase", {name: _text(value) for name, value in fields.items()})
    if verdict.outcome in _ELEMENTS:
        words = _text(verdict.words())
        fault = ElementTree.SubElement(
            test, _ELEMENTS[verdict.outcome], {"message": words.partition("\n")[0], "type": str(verdict.outcome)}
        )
        fault.text = words
    return test


def _text(text: str) -> str:
    return _NO_CHARACTER.sub("\ufffd", text)
