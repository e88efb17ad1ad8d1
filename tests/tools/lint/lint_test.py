"""tools/lint.py in a small tree, with stand-ins for cmake, clang-format and clang-tidy."""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROJECT = pathlib.Path(__file__).resolve().parents[3]
CLANG_TIDY = """#!/bin/bash
[ "$1" != --version ] || { echo "LLVM version ${VERSION:-14}"; exit 0; }
for source in $(sed -n 's/^#include "\\(.*\\.cc\\)"/\\1/p' "${@: -1}") "${@: -1}"; do
  ! grep -q CRASH "$source" || kill -KILL $$
  grep -q BAD "$source" && echo "$source:1:1: error: bad" && exit 1
done
exit 0
"""


class Lint(unittest.TestCase):
    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        self.root = pathlib.Path(folder.name)
        for name, text in (("clang-tidy", CLANG_TIDY), ("clang-format", "#!/bin/sh\n"), ("cmake", "#!/bin/sh\n")):
            self.write("bin/" + name, text).chmod(0o700)
        self.write(".clang-tidy", "Checks: all\n")
        self.write("components/a/a.h", '#include "components/a/deep.h"\nint a();\n')
        self.write("components/a/deep.h", "#include <sinew_idl/joint.h>\nint deep();\n")
        self.write("idl/joint.idl", "struct Joint {};\n")
        self.sources = [self.write("components/a/a.cc", '#include "components/a/a.h"\n\nint a() { return 1; }\n'),
                        self.write("components/a/b.cc", "int b;\n"), self.write("sim/c.cc", "int c;\n")]
        self.compile(self.sources)

    def write(self, name, text):
        path = self.root / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)
        return path

    def compile(self, sources):
        """The compile database: all but the last source in a unity file."""
        unity = self.write("build/lint/Unity/unity_0.cxx", "".join(f'#include "{path}"\n' for path in sources[:-1]))
        self.write("build/lint/compile_commands.json", json.dumps([{"file": str(unity)}, {"file": str(sources[-1])}]))

    def lint(self, *options, **environment):
        """The exit code, and the last line without the files that were formatted."""
        path = f"{self.root / 'bin'}:{os.environ['PATH']}"
        run = subprocess.run([sys.executable, PROJECT / "tools/lint.py", *options], cwd=self.root, text=True,
                                   stdout=subprocess.PIPE, stderr=subprocess.STDOUT,
                                   env={**os.environ, "PATH": path, **environment})
        self.output = run.stdout
        return run.returncode, run.stdout.splitlines()[-1].partition(", ")[2]

    def clean(self):
        return (self.root / "tools/lint_clean.txt").read_text().splitlines()

    def record(self):
        (self.root / "tools").mkdir(exist_ok=True)
        self.assertEqual(self.lint("--record"), (0, "2 units checked, 0 findings"), self.output)

    def test_WhatIsListedAsCleanIsReadOnRequestOnly(self):
        self.assertEqual(self.lint(), (0, "2 units checked, 0 findings"))
        self.record()
        self.assertEqual(len(self.clean()), 1 + len(self.sources))
        self.assertEqual(self.clean()[1:], sorted(self.clean()[1:]))
        self.write("bin/cmake", "#!/bin/sh\nexit 1\n")  # is not needed when nothing is to be read
        self.assertEqual(self.lint(), (0, "0 units checked, 0 findings"))
        self.assertEqual(self.lint("--all")[0], 1)
        self.write("bin/cmake", "#!/bin/sh\n")
        self.assertEqual(self.lint("--all"), (0, "2 units checked, 0 findings"))

    def test_WhatIsMovedStaysClean(self):
        self.record()
        before = self.clean()
        (self.root / "sim/deep").mkdir()
        (self.root / "components/a/deep.h").rename(self.root / "sim/deep/deeper.h")
        self.write("components/a/a.h", '#include "sim/deep/deeper.h"\n\nint a();\n')
        self.sources[0] = self.sources[0].rename(self.root / "sim/a.cc")
        self.assertEqual(self.lint(), (0, "0 units checked, 0 findings"))
        self.compile(self.sources)
        self.lint("--record")
        self.assertEqual(self.clean(), before)

    def test_WhatChangedIsRead(self):
        self.record()
        for name in ("components/a/a.cc", "components/a/deep.h", "idl/joint.idl"):
            text = (self.root / name).read_text()
            self.write(name, text + "// more\n")
            self.assertEqual(self.lint(), (0, "0 units checked, 0 findings"), name)
            for more in ("int more;\n", "// NOLINTNEXTLINE\n"):
                self.write(name, text + more)
                self.assertEqual(self.lint(), (0, "1 units checked, 0 findings"), name)
            self.write(name, text)
        self.assertEqual(self.lint(), (0, "0 units checked, 0 findings"))
        self.assertEqual(self.lint(VERSION="15"), (0, "2 units checked, 0 findings"))
        self.write(".clang-tidy", "Checks: none\n")
        self.assertEqual(self.lint(), (0, "2 units checked, 0 findings"))

    def test_AFindingIsNotRecordedWhatIsCleanIs(self):
        self.record()
        stale = self.clean()
        self.write("components/a/b.cc", "int BAD;\n")
        self.write("sim/c.cc", "int changed;\n")
        self.assertEqual(self.lint("--record"), (1, "2 units checked, 1 findings"))
        self.assertEqual(len(set(self.clean()) & set(stale)), 2)  # the title and a.cc
        self.assertEqual(len(self.clean()), 3)
        self.assertEqual(self.lint(), (1, "1 units checked, 1 findings"))

    def test_WhatCannotBeReadIsAFinding(self):
        self.write("sim/c.cc", "CRASH\n")
        self.assertEqual(self.lint(), (1, "2 units checked, 1 findings"))
        self.write("sim/c.cc", "int c;\n")
        self.write("sim/forgotten.cc", "int d;\n")
        self.assertEqual(self.lint(), (1, "2 units checked, 1 findings"))
        self.assertIn("sim/forgotten.cc: error: no unit of build/lint compiles it", self.output)
        self.write("bin/clang-format", "#!/bin/sh\nexit 3\n")
        self.assertEqual(self.lint("--format")[0], 1)

    def test_AnIncludeThatNothingIsKnownOfIsRefused(self):
        self.write("sim/c.cc", '#include "sim/gone.h"\n')
        self.assertEqual(self.lint()[0], 1)
        self.assertIn("sim/c.cc: error: includes sim/gone.h", self.output)

    def test_AnUnknownOptionIsRefused(self):
        run = subprocess.run([PROJECT / "tools/lint", "--changed"], capture_output=True, text=True)
        self.assertEqual((run.returncode, run.stdout), (2, ""))
        self.assertEqual(run.stderr, "tools/lint: unknown option '--changed'; see tools/lint --help\n")


if __name__ == "__main__":
    unittest.main()
