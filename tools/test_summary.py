"""Counts the tests of JUnit result files; names what failed and what was skipped, and why.

  test_summary.py [--skips-fail] FILE...

The last line is "N passed, N failed, N skipped". Exit code 1 when one failed or none ran. With --skips-fail a skipped
test has failed, unless its reason begins with "kernel:" (tests/support/skip.h): packages and data can be had, the
machine's kernel is what it is.
"""
import re
import sys
import xml.etree.ElementTree as tree

EXCUSED = "kernel:"


def reason_of(case):
    output = case.findtext("system-out") or ""
    found = re.search(r"Skipped\n(.+)", output) or re.search(r"SKIP(?:PED)?:? *(.+)", output)
    return found.group(1).strip() if found else "no reason given"


def was_skipped(case):
    """By its own word; a test whose program was not built has not run either, and has failed."""
    return any("SKIP" in node.get("message", "") for node in case.iter("skipped"))


def main(arguments):
    skips_fail = "--skips-fail" in arguments
    passed, failed, skipped = 0, [], []
    for path in (argument for argument in arguments if argument != "--skips-fail"):
        try:
            cases = tree.parse(path).getroot().iter("testcase")
        except (OSError, tree.ParseError) as error:
            failed.append(f"{path}: no result ({error})")
            continue
        for case in cases:
            status = case.get("status")
            if status == "run":
                passed += 1
            elif status == "disabled" or was_skipped(case):
                reason = reason_of(case)
                if skips_fail and not reason.startswith(EXCUSED):
                    failed.append(f"{case.get('name')}: skipped: {reason}")
                else:
                    skipped.append(f"{case.get('name')}: {reason}")
            else:
                failed.append(case.get("name"))
    for name in skipped:
        print(f"skipped: {name}")
    for name in failed:
        print(f"FAILED: {name}")
    print(f"{passed} passed, {len(failed)} failed, {len(skipped)} skipped")
    return 0 if passed > 0 and not failed else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
