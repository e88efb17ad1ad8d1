"""Counts test cases; names what failed and what was skipped, and why.

  test_summary.py [--skips-fail] FILE...

A FILE is a JUnit file of ctest. The cases of a GoogleTest program NAME are read from test_results/NAME.xml beside it, as
the program wrote it; any other test is one case. A program that failed although no case of it did (a crash, a leak found
at its end, a time-out) counts as one failure more. The last line is "N passed, N failed, N skipped". Exit code 1 when one
failed or none ran. With --skips-fail a skipped test has failed, unless its reason begins with "kernel:"
(tests/support/skip.h): packages and data can be had, the machine's kernel is what it is.
"""
import os
import re
import sys
import xml.etree.ElementTree as tree

EXCUSED = "kernel:"
PASSED, FAILED, SKIPPED = "passed", "failed", "skipped"


def reason_of(text):
    found = re.search(r"Skipped\n(.+)", text) or re.search(r"SKIP(?:PED)?:? *(.+)", text)
    return found.group(1).strip() if found else "no reason given"


def outcome_of_test(case):
    """Of a test of ctest: skipped by its own word; one whose program was not built has not run either, and has failed."""
    if case.get("status") == "run":
        return PASSED, ""
    if case.get("status") == "disabled" or any("SKIP" in node.get("message", "") for node in case.iter("skipped")):
        return SKIPPED, reason_of(case.findtext("system-out") or "")
    return FAILED, ""


def outcome_of_case(case):
    """Of a case of GoogleTest."""
    if case.find("failure") is not None:
        return FAILED, ""
    if case.get("status") == "notrun":
        return SKIPPED, "disabled"
    if case.get("result") == "skipped":
        skipped = case.find("skipped")
        text = "" if skipped is None else skipped.get("message", "")
        return SKIPPED, text.split("\n", 1)[-1].strip() or "no reason given"  # the first line is the place
    return PASSED, ""


def outcomes(path):
    """(name, outcome, reason) of each case of a result file; an unreadable file has failed."""
    try:
        tests = list(tree.parse(path).getroot().iter("testcase"))
    except (OSError, tree.ParseError) as error:
        yield f"{path}: no result ({error})", FAILED, ""
        return
    for test in tests:
        name = test.get("name")
        outcome, reason = outcome_of_test(test)
        cases = []
        try:
            results = os.path.join(os.path.dirname(path), "test_results", f"{name}.xml")
            for case in tree.parse(results).getroot().iter("testcase"):
                cases.append((f"{case.get('classname')}.{case.get('name')}", *outcome_of_case(case)))
        except (OSError, tree.ParseError):
            cases = []
        yield from cases
        if not cases or (outcome == FAILED and not any(case[1] == FAILED for case in cases)):
            yield name, outcome, reason


def main(arguments):
    skips_fail = "--skips-fail" in arguments
    counts = {PASSED: 0, FAILED: 0, SKIPPED: 0}
    lines = []
    for path in (argument for argument in arguments if argument != "--skips-fail"):
        for name, outcome, reason in outcomes(path):
            if outcome == SKIPPED:
                if skips_fail and not reason.startswith(EXCUSED):
                    outcome, name = FAILED, f"{name}: skipped"
                lines.append(f"{'FAILED' if outcome == FAILED else outcome}: {name}: {reason}")
            elif outcome == FAILED:
                lines.append(f"FAILED: {name}")
            counts[outcome] += 1
    print("\n".join(sorted(lines, reverse=True)) + "\n" * bool(lines), end="")
    print(", ".join(f"{number} {outcome}" for outcome, number in counts.items()))
    return 0 if counts[PASSED] > 0 and counts[FAILED] == 0 else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
