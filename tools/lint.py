"""Runs clang-format and clang-tidy for tools/lint, in the folder of the project.

  lint.py [--all | --record | --format]

tools/lint_clean.txt lists the hashes of the sources that clang-tidy found clean. The hash of a source covers the version
of clang-tidy, .clang-tidy, and the texts of the source and of all project files that it includes, also through others.
Include lines of project files, lines of comment, blank lines and the names of files do not count: what is moved or only
worded anew stays clean. Not covered: compile flags, the system's headers, and findings that depend on other sources of
the unit; `--all` reads these too.
"""
import hashlib
import json
import multiprocessing.pool
import os
import pathlib
import re
import subprocess
import sys

PRODUCT = ("components", "bridge", "sim", "tools", "reproduction")
FORMATTED = PRODUCT + ("bench", "tests")
CLEAN = pathlib.Path("tools/lint_clean.txt")
TITLE = "# Hashes of the sources that clang-tidy found clean (tools/lint.py); written by tools/lint --record.\n"
INCLUDE = re.compile(r'\s*#\s*include\s*(["<])([^">]+)')
COMMENT = re.compile(r"\s*//(?!.*NOLINT)")
FINDING = re.compile("(error|warning): ")
GENERATED = (  # an include that the tree does not have, and what the build makes it from
    (r"sinew_idl/(\w+)\.h", r"idl/\1.idl"),
    (r"components/topics/node/(all|topic)_\w+\.h", "idl/README.md", "idl/*.idl", "tools/idl/topics.py"),
    (r"components/topics/node/version\.h", "components/topics/node/version.h.in"),
    (r"effect_list\.inc", "components/model/effects/CMakeLists.txt"),
)


def files(folders, *suffixes):
    return sorted(str(path) for folder in folders for path in pathlib.Path(folder).rglob("*") if path.suffix in suffixes)


def project_files(name):
    """The files of the project that an include stands for; none when it is a header of the system."""
    for path in (name, "idl/" + name):
        if os.path.isfile(path):
            return [path]
    for pattern, *sources in GENERATED:
        if match := re.fullmatch(pattern, name):
            return [str(path) for source in sources for path in pathlib.Path().glob(match.expand(source))]
    return []


def read(path):
    """The digest of a file's text, and the files that it includes. Of a README the tables count, which code is made from."""
    text, included = [], []
    for line in pathlib.Path(path).read_text(encoding="utf-8").splitlines():
        match = INCLUDE.match(line)
        reached = project_files(match[2]) if match else []
        if match and match[1] == '"' and not reached:
            sys.exit(f"{path}: error: includes {match[2]}, which neither the tree nor GENERATED of tools/lint.py has")
        included += reached
        counts = line.startswith("|") if path.endswith(".md") else not COMMENT.match(line)
        if line.strip() and not reached and counts:
            text.append(line)
    return hashlib.sha256("\n".join(text).encode()).digest(), included


def hashes(version, sources):
    texts, found = {}, {}
    settings = hashlib.sha256(version.encode() + pathlib.Path(".clang-tidy").read_bytes())
    for source in sources:
        reached, new = set(), [source]
        while new:
            path = new.pop()
            if path not in reached:
                reached.add(path)
                texts[path] = texts.get(path) or read(path)
                new += texts[path][1]
        whole = settings.copy()
        for digest in sorted(texts[path][0] for path in reached):
            whole.update(digest)
        found[source] = whole.hexdigest()[:16]
    return found


def database():
    """Configures build/lint; the units of its compile database, each with its sources: itself, or those of a unity file."""
    for command in (["cmake", "--preset", "lint"], ["cmake", "--build", "--preset", "lint"]):
        done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        if done.returncode != 0:
            print(*done.stdout.splitlines()[-20:], sep="\n")
            sys.exit(f"error: {' '.join(command)} failed; its last lines stand above")
    units = {}
    for unit in (entry["file"] for entry in json.loads(pathlib.Path("build/lint/compile_commands.json").read_text())):
        paths = re.findall(r'#include "([^"]+)"', pathlib.Path(unit).read_text()) if "/Unity/" in unit else [unit]
        sources = {os.path.relpath(path) for path in paths}
        units[unit] = {source for source in sources if source.split("/")[0] in PRODUCT}
    return units


def run(command):
    """The last argument, and what the check found; empty when nothing. A check that could not run has found that."""
    done = subprocess.run(command, capture_output=True, text=True, errors="replace")
    if done.returncode == 0 and not done.stdout:
        return command[-1], ""
    text = done.stdout or done.stderr
    if not FINDING.search(text):
        text += f"{command[-1]}: error: {command[0]}: exit code {done.returncode}\n"
    return command[-1], text


class Checks:
    """Runs checks on all cores; prints each line found once, and counts the findings."""

    def __init__(self):
        self.cores = len(os.sched_getaffinity(0))
        self.seen = set()

    def print(self, text):
        for line in text.splitlines():
            if line not in self.seen:
                self.seen.add(line)
                print(line, flush=True)

    def run(self, commands):
        """Yields the last argument of each command and what it found, as they end."""
        with multiprocessing.pool.ThreadPool(self.cores) as pool:
            for last, text in pool.imap_unordered(run, commands):
                self.print(text)
                yield last, text

    @property
    def findings(self):
        return sum(1 for line in self.seen if FINDING.search(line))


def write_list(values):
    new = CLEAN.with_suffix(".new")
    new.write_text(TITLE + "".join(value + "\n" for value in sorted(values)))
    new.replace(CLEAN)


def tidy(option, checks):
    """clang-tidy on the units with a source that is not known to be clean. Returns how many were read."""
    version = re.search("version .*", subprocess.check_output(["clang-tidy", "--version"], text=True))[0]
    before = hashes(version, files(PRODUCT, ".cc"))
    known = set(CLEAN.read_text().splitlines()) if CLEAN.exists() else set()
    wanted = {source for source, value in before.items() if option == "--all" or value not in known}
    units = database() if wanted else {}
    for source in sorted(wanted.difference(*units.values())):
        checks.print(f"{source}: error: no unit of build/lint compiles it\n")
    # The longest first, so that no core waits for it at the end.
    reading = sorted((unit for unit in units if units[unit] & wanted), key=lambda unit: -len(units[unit]))
    print(f"\n== clang-tidy on {len(reading)} units; {len(wanted)} of {len(before)} sources are to be read", flush=True)
    known &= set(before.values())
    if option == "--record":
        write_list(known)
    for unit, text in checks.run(["clang-tidy", "-p", "build/lint", "--quiet", unit] for unit in reading):
        if not text and option == "--record":
            clean = units.pop(unit).difference(*units.values())
            # What was edited meanwhile is not recorded. Each time, so that a run that is stopped has recorded what it read.
            known |= set(hashes(version, clean).values()) & {before[source] for source in clean}
            write_list(known)
    return len(reading)


def main(option=""):
    checks = Checks()
    formatted = files(FORMATTED, ".cc", ".h")
    print(f"\n== clang-format on {len(formatted)} files", flush=True)
    parts = [formatted[first :: checks.cores] for first in range(checks.cores)]
    list(checks.run(["clang-format", "--dry-run", "-Werror", *part] for part in parts if part))
    units = 0 if option == "--format" else tidy(option, checks)
    print(f"\n== Summary\n{len(formatted)} files formatted, {units} units checked, {checks.findings} findings")
    return 1 if checks.findings else 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
