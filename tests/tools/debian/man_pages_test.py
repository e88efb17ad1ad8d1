"""Manual pages of the command, against what its completion knows and by an independent reader (mandoc)."""
import gzip
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

SCRIPT = pathlib.Path(__file__).resolve().parents[3] / "tools/debian/man_pages.py"
SINEW = ""  # the program, from the command line
ODD = """Looks odd.
Usage: odd [OPTIONS]

Options:
  -h,--help                   Print this help message and exit
  --a-long-name-of-an-option VALUE
                              .dots and 'quotes' and \\\\ backslashes

.as first letters
'of lines

Examples:
  odd --name=\\\\n \\\\
    --more
"""


class ManPages(unittest.TestCase):
    def setUp(self):
        self.folder = pathlib.Path(tempfile.mkdtemp())
        self.addCleanup(shutil.rmtree, self.folder)

    def program(self, name, help_text, code=0):
        path = self.folder / name
        path.write_text(f"#!/bin/sh\ncat <<'HELP'\n{help_text}HELP\nexit {code}\n")
        path.chmod(0o700)
        return path

    def run_script(self, *arguments):
        return subprocess.run([sys.executable, SCRIPT, self.folder / "man", "1.2.3", *arguments], capture_output=True, text=True)

    def pages(self):
        return {path.name: gzip.decompress(path.read_bytes()).decode() for path in self.folder.glob("man/man*/*.gz")}

    def read(self, name):
        """The page as mandoc shows it; it must have nothing to say about it."""
        source = self.pages()[name]
        for words in (["-Tlint", "-Wwarning"], ["-Tascii"]):
            finished = subprocess.run(["mandoc", *words], input=source, capture_output=True, text=True)
            self.assertEqual((finished.returncode, finished.stderr), (0, ""), name + finished.stdout)
        return re.sub(".\b", "", finished.stdout)

    def completed(self, *words):
        """Candidates for the last word; commands and options have a description after a tab."""
        return subprocess.run([SINEW, "__complete", *words], capture_output=True, text=True, check=True).stdout.splitlines()

    def test_EveryCommandAndEachOfItsOptionsIsOnAPage(self):
        finished = self.run_script("1", SINEW)
        self.assertEqual(finished.returncode, 0, finished.stderr)
        names = {}
        todo = [[]]
        while todo:
            path = todo.pop()
            described = [line.split("\t")[0] for word in ("", "-") for line in self.completed(*path, word) if "\t" in line]
            names["-".join(["sinew", *path]) + ".1.gz"] = described
            todo += [[*path, word] for word in described if not word.startswith("-")]
        self.assertGreater(len(names), 40)
        self.assertEqual(set(names), set(self.pages()))
        for name, words in names.items():
            text = self.read(name)
            for word in words:
                self.assertRegex(text, rf"(^|[\s,]){re.escape(word)}([\s,:]|$)", name)
            self.assertIn("NAME\n", text)
            self.assertIn("SYNOPSIS\n", text)

    def test_TextIsShownAsItIs(self):
        finished = self.run_script("8", self.program("odd", ODD.replace("\\\\", "\\")))
        self.assertEqual(finished.returncode, 0, finished.stderr)
        text = self.read("odd.8.gz")
        for line in ("odd - Looks odd.", ".dots and 'quotes' and \\ backslashes", ".as first letters", "'of lines",
                     "odd --name=\\n \\\n", "sinew(1)"):
            self.assertIn(line, text)

    def test_AProgramWithoutHelpIsRefused(self):
        for text, code, why in (("Hello.\n", 0, "expected a summary and a line 'Usage: ...'"), (ODD, 3, "exit code 3")):
            finished = self.run_script("1", self.program("mute", text, code))
            self.assertEqual(finished.returncode, 1)
            self.assertIn(why, finished.stderr)
            self.assertIn("mute --help", finished.stderr)
            self.assertEqual(self.pages(), {})


if __name__ == "__main__":
    SINEW = sys.argv.pop(1)
    unittest.main()
