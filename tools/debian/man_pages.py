"""Manual pages from what programs print for --help.

    man_pages.py FOLDER VERSION SECTION PROGRAM [SECTION PROGRAM ...]

Writes FOLDER/manSECTION/NAME.SECTION.gz of each program. A program with subcommands has a page for each, and for theirs:
sinew-launch(1), sinew-model-show(1). (help2man runs lines of examples together and knows one level only.)
"""
import gzip
import os
import re
import subprocess
import sys
import time
from pathlib import Path

HEADING = re.compile(r"([A-Z][A-Za-z ]*):")
ENTRY = re.compile(r"  (\S.*?)(?: {2,}(\S.*))?")  # "  --seed NUMBER   Seed", or the explanation on the next line
CONTINUED = re.compile(r" {20,}(\S.*)")


def escaped(text):
    text = text.replace("\\", "\\e").replace("-", "\\-")
    return "\\&" + text if text.startswith((".", "'")) else text


class Help:
    """What --help prints: summary, usage, sections of entries (name -> [(term, explanation)]), other lines of text."""

    def __init__(self, text):
        self.summary, self.usage, self.sections, self.text = "", "", {}, []
        entries = None
        for line in text.splitlines():
            heading, entry, continued = HEADING.fullmatch(line), ENTRY.fullmatch(line), CONTINUED.fullmatch(line)
            if not self.summary:
                self.summary = line.strip()
            elif line.startswith("Usage: "):
                self.usage = line.removeprefix("Usage: ")
            elif heading and heading[1] != "Examples":
                entries = self.sections.setdefault(heading[1], [])
            elif entries and continued:
                term, explanation = entries[-1]
                entries[-1] = (term, f"{explanation} {continued[1]}".strip())
            elif entries is not None and entry:
                entries.append((entry[1], entry[2] or ""))
            else:
                entries = None
                self.text.append(line)
        if not self.summary or not self.usage:
            raise ValueError("expected a summary and a line 'Usage: ...'")

    def subcommands(self):
        lists = [entries for title, entries in self.sections.items() if "ommands" in title]
        return [term for entries in lists for term, _ in entries]


def page(name, section, version, text, see):
    """The source of one page; `see` are pages such as "sinew(1)"."""
    seconds = int(os.environ.get("SOURCE_DATE_EPOCH", time.time()))
    lines = [f'.TH {name.upper()} {section} {time.strftime("%Y-%m-%d", time.gmtime(seconds))} "sinew {version}"',
             ".ad l", ".SH NAME", f"{escaped(name)} \\- {escaped(text.summary)}",
             ".SH SYNOPSIS", escaped(text.usage), ".SH DESCRIPTION", escaped(text.summary)]
    for title, entries in text.sections.items():
        lines.append(f".SH {title.upper()}")
        for term, explanation in entries:
            # Long lists of allowed words may be broken after a comma.
            lines += [".TP", "\\fB" + escaped(term).replace(",", ",\\:") + "\\fR", escaped(explanation)]
    # Lines as they were laid out: tables and examples among them.
    body = "\n".join(text.text).strip("\n").splitlines()
    for index, line in enumerate(body):
        if index == 0 or line == "Examples:":
            lines += [".fi"] * (index != 0) + [".SH " + ("EXAMPLES" if line == "Examples:" else "NOTES"), ".nf"]
        if line != "Examples:":
            lines.append(escaped(line))
    lines += [".fi"] * bool(body) + ([".SH SEE ALSO", ",\n".join(map(escaped, see))] if see else [])
    return "\n".join(lines) + "\n"


def write_pages(folder, section, version, program, path=()):
    """The page of a program, or of the subcommand `path`, and of what is below it; returns how many."""
    command = [str(program), *path, "--help"]
    finished = subprocess.run(command, capture_output=True, text=True, timeout=60)
    try:
        if finished.returncode:
            raise ValueError(f"exit code {finished.returncode}: {finished.stderr.strip()}")
        text = Help(finished.stdout)
    except ValueError as error:
        sys.exit(f"man_pages.py: {' '.join(command)}: {error}")
    name = "-".join([program.name, *path])
    below = [f"{name}-{child}({section})" for child in text.subcommands()]
    above = ["-".join([program.name, *path[:-1]]) + f"({section})"] if path else ["sinew(1)"] * (program.name != "sinew")
    out = folder / f"man{section}" / f"{name}.{section}.gz"
    out.parent.mkdir(parents=True, exist_ok=True)
    out.write_bytes(gzip.compress(page(name, section, version, text, above + below).encode(), 9, mtime=0))
    return 1 + sum(write_pages(folder, section, version, program, (*path, child)) for child in text.subcommands())


def main(folder, version, *pairs):
    if not pairs or len(pairs) % 2:
        sys.exit(__doc__)
    count = sum(write_pages(Path(folder), section, version, Path(program))
                for section, program in zip(pairs[::2], pairs[1::2]))
    print(f"{count} manual pages in {folder}")


if __name__ == "__main__":
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    main(*sys.argv[1:])
