"""The check that a command line names, for scripts whose functions check_NAME(arguments, folder) are checks."""
import argparse
import pathlib
import sys
import tempfile


def run(description, load, functions):
    """load: imports what is checked, once its folder is among the paths; functions: the globals of the script."""
    parser = argparse.ArgumentParser(description=description)
    for name in ("--module", "--sinew", "--sample"):
        parser.add_argument(name, type=pathlib.Path, required=True)
    parser.add_argument("check")
    arguments = parser.parse_args()
    sys.path.insert(0, str(arguments.module))
    load()
    with tempfile.TemporaryDirectory() as folder:
        functions["check_" + arguments.check](arguments, pathlib.Path(folder))
