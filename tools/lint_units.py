"""Prints the units of a compile database that clang-tidy has to read, one a line.

  lint_units.py COMPILE_COMMANDS [CHANGED]

Without CHANGED (a file that names files, one a line) these are all units of the product: not tests, bench and generated
code. With it, those that contain a changed .cc, and for a changed .h those that contain the .cc of the same name or, when
there is none, any file of its folder.
"""
import json
import os
import re
import sys

FOLDERS = ("components/", "bridge/", "sim/", "tools/", "reproduction/")


def sources_of(path, root):
    """The project's files that a unit compiles: itself, or what CMake's unity file includes."""
    if "/Unity/" in path:
        with open(path, encoding="utf-8") as unity:
            paths = re.findall(r'#include "([^"]+)"', unity.read())
    else:
        paths = [path]
    return [name for name in (os.path.relpath(path, root) for path in paths) if name.startswith(FOLDERS)]


def main(arguments):
    root = os.getcwd()
    with open(arguments[0], encoding="utf-8") as file:
        units = {entry["file"]: sources_of(entry["file"], root) for entry in json.load(file)}
    units = {unit: sources for unit, sources in units.items() if sources}
    if len(arguments) > 1:
        with open(arguments[1], encoding="utf-8") as file:
            changed = [line.strip() for line in file if line.startswith(FOLDERS)]
        known = {source for sources in units.values() for source in sources}
        wanted = {name for name in changed if name.endswith(".cc")}
        for name in (name for name in changed if name.endswith(".h")):
            same = name[:-2] + ".cc"
            folder = os.path.dirname(name)
            wanted |= {same} if same in known else {other for other in known if os.path.dirname(other) == folder}
        units = {unit: sources for unit, sources in units.items() if wanted & set(sources)}
    # The longest first, so that no core waits for it at the end.
    for unit in sorted(units, key=lambda unit: -len(units[unit])):
        print(unit)
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
