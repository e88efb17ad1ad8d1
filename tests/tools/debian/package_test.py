"""What tools/package refuses, before it installs or builds anything."""
import pathlib
import subprocess
import tempfile
import unittest

PACKAGE = pathlib.Path(__file__).resolve().parents[3] / "tools/package"


class Package(unittest.TestCase):
    def refused(self, *arguments):
        finished = subprocess.run([PACKAGE, *arguments], capture_output=True, text=True, timeout=30)
        self.assertEqual((finished.returncode, finished.stdout), (2, ""))
        return finished.stderr

    def test_AnUnknownOptionIsRefused(self):
        self.assertEqual(self.refused("--rot"), "tools/package: unknown option '--rot'; see tools/package --help\n")

    def test_AFolderThatIsThereIsLeftAlone(self):
        with tempfile.TemporaryDirectory() as folder:
            self.assertEqual(self.refused("--root", folder),
                             f"tools/package: {folder} is there already, expected the name of a new folder\n")


if __name__ == "__main__":
    unittest.main()
