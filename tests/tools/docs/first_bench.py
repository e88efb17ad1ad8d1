"""docs/first-bench.md as a reader follows it: its files, its commands, and what it says that they print.

The recordings are those of the shared folder, in the form in which their makers publish them."""
import csv
import pathlib
import re
import subprocess
import sys
import tempfile

SKIPPED = 77


def as_published(source, target):
    """Seven columns between tabs without a header: ms, three voltages that nobody reads, mm, bar, N."""
    with open(source, encoding="utf-8") as rows, open(target, "w", encoding="utf-8") as out:
        for t, x, p, f in list(csv.reader(rows))[1:]:
            out.write("\t".join([f"{float(t) * 1000:.3f}", "0.000", "0.000", "0.000", x, p, f]) + "\n")


def steps(text):
    """(what, argument, block) of the fenced blocks: "file" with its name, "sh", or "prints"."""
    block = re.compile(r"(?:<!-- (file|prints):? ?(\S*) -->\n)?```(\w*)\n(.*?)```", re.S)
    return [(mark or language, name, body) for mark, name, language, body in block.findall(text)]


def main():
    document, shared, program = (pathlib.Path(word) for word in sys.argv[1:])
    recordings = sorted((shared / "data/pneumatic_cylinder_3dprinted").glob("O-ring_?bar.csv"))
    if not recordings:
        print(f"no recordings in {shared}: skipped")
        return SKIPPED
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "data").mkdir()
        for recording in recordings:
            as_published(recording, folder / "data" / recording.name)
        printed, ran = "", 0
        for what, argument, body in steps(document.read_text(encoding="utf-8")):
            if what == "file":
                (folder / argument).write_text(body, encoding="utf-8")
            elif what == "prints":
                for line in body.splitlines():
                    assert line.strip() in printed, f"expected '{line}' in:\n{printed}"
            elif what == "sh" and "git clone" not in body:
                done = subprocess.run(["bash", "-ec", f'PATH="{program.parent}:$PATH"\n{body}'], cwd=folder, text=True,
                                      stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False)
                assert done.returncode == 0, f"{body}{done.stdout}"
                printed, ran = done.stdout, ran + 1
        assert ran >= 4, f"{ran} commands"
        assert (folder / "found/report.html").stat().st_size < 5_000_000
    return 0


if __name__ == "__main__":
    sys.exit(main())
