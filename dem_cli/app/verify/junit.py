"""Write verdicts as JUnit XML, which continuous integration shows as tests."""

from __future__ import annotations

import xml.etree.ElementTree as ET
from collections.abc import Iterable

from dem_cli.app.verify.case_selection import SHELVES
from dem_cli.app.verify.records import Record
from dem_cli.app.verify.verdict_words import judgement

NOT_SOLVED = "not solved"


def junit(records: Iterable[Record]) -> str:
    """Create a suite for each shelf, a test for each reference.

    Known misses, and blind ones that are not met, are skipped; unsolved cases are errors.
    """
    root = ET.Element("testsuites", name="dem verify")
    suites: dict[str, ET.Element] = {}
    for record in records:
        timed = record["seconds"]
        for answer in record["references"] if "error" not in record else ():
            test = _test(root, suites, SHELVES[answer["kind"]], record["case"], answer["quantity"], timed)
            timed = 0.0  # a case with several references ran once
            if answer["state"] in ("missed", "predicted", "outside"):
                ET.SubElement(test, "skipped", message=_clean(judgement(answer)))
            elif answer["state"] != "passed":
                ET.SubElement(test, "failure", message=_clean(judgement(answer)))
        if "error" in record:
            test = _test(root, suites, NOT_SOLVED, record["case"], "run", timed)
            ET.SubElement(test, "error", message=_clean(record["error"]))
    for suite in suites.values():
        suite.set("tests", str(len(suite)))
        for name, key in (("failure", "failures"), ("error", "errors"), ("skipped", "skipped")):
            suite.set(key, str(len(suite.findall(f"testcase/{name}"))))
        suite.set("time", f"{sum(float(test.get('time', 0.0)) for test in suite):.3f}")
    ET.indent(root)
    return '<?xml version="1.0" encoding="utf-8"?>\n' + ET.tostring(root, encoding="unicode") + "\n"


def _test(root: ET.Element, suites: dict[str, ET.Element], shelf: str, case: str, name: str, time: float) -> ET.Element:
    if shelf not in suites:
        suites[shelf] = ET.SubElement(root, "testsuite", name=shelf)
    names = {"classname": _clean(case), "name": _clean(name), "time": f"{time:.3f}"}
    return ET.SubElement(suites[shelf], "testcase", names)


def _clean(text: str) -> str:
    """Replace control characters, which XML does not allow."""
    return "".join(letter if letter.isprintable() or letter in "\n\t" else "?" for letter in text)
