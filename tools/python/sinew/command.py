"""The program `sinew`, run for its results."""
import os
import shlex
import shutil
import subprocess
import tempfile
from pathlib import Path

from sinew_recording import Recording

from .report import read_check, read_report

__all__ = ["SinewError", "check_data", "close_loop", "run"]


class SinewError(RuntimeError):
    """A command that failed. command: its words; code: its exit code, None when it could not be started; text: what
    it printed about the reason."""

    def __init__(self, command, code, text):
        self.command, self.code, self.text = command, code, text
        name = " ".join(["sinew"] + command[1:2])
        reason = text.removeprefix(f"{name}: ") or f"exit code {code}; command: {shlex.join(command)}"
        super().__init__(f"{name}: {reason}")


def run(*arguments, sinew=None, results=(0,)):
    """Runs `sinew ARGUMENT...` and gives what it printed; raises SinewError when it fails.

    Arguments are texts, numbers, paths, models or recordings. sinew: the program, else the one on PATH. results: exit
    codes that are no failure."""
    command = [_word(sinew or "sinew")] + [_word(argument) for argument in arguments]
    if shutil.which(command[0]) is None:
        raise SinewError(command, None, f"no program '{command[0]}'" + (
            "" if sinew else " on PATH: install sinew-core, or give sinew=PATH"))
    try:
        done = subprocess.run(command, stdin=subprocess.DEVNULL, capture_output=True, check=False)
    except OSError as error:
        raise SinewError(command, None, f"'{command[0]}' cannot be run: {error.strerror}") from error
    if done.returncode not in results:
        text = done.stderr.decode(errors="replace").strip() or done.stdout.decode(errors="replace").strip()
        if done.returncode < 0:
            text = f"ended by signal {-done.returncode}; {text}".removesuffix("; ")
        raise SinewError(command, done.returncode, text)
    return done.stdout.decode(errors="replace")


def check_data(recordings, model=None, *, map=None, joint=None, accept_faults=(), out=None, sinew=None):
    """`sinew check-data`: faults and findings of recordings (paths of CSV, MCAP or bags, FILE@START:END), as a Check.

    Without a model the rig's is taken; map: columns of CSV files. out: folder for check.html and check.json; without
    it a temporary one that is gone with the result. A fault is a result; an error raises SinewError."""
    folder, kept = _folder(out)
    run("check-data", *_words(recordings), *_options(model=model, map=map, joint=joint, out=folder,
                                                     accept_fault=accept_faults), sinew=sinew, results=(0, 1))
    return read_check(folder, kept)


def close_loop(model, train, held_out=(), *, map=None, held_out_map=None, joint=None, urdf=None, by=None, seed=None,
               effects=None, accept_faults=(), keep_unconfirmed=False, without_rules=(), without_effects=(), out=None,
               sinew=None):
    """`sinew close-loop`: which effect a model lacks, from recordings, as a Report (RobotReport of several joints).

    model: a Model, a path, or None for the rig's. train, held_out: one recording or several; without held_out each
    one is held out once. effects: fit these instead of searching, [] for the declared terms alone. The other arguments
    are the options of the command. out: folder for report.html, report.json and model.yaml; without it a temporary one
    that is gone with the result. Every verdict is a result; an error raises SinewError."""
    folder, kept = _folder(out)
    given = None if effects is None else _words(effects) or ["none"]
    run("close-loop", *_options(
        model=model, map=map, held_out_map=held_out_map, train=[_words(train)], held_out=[_words(held_out)],
        joint=joint, urdf=urdf, by=by, seed=seed, effect=given, accept_fault=accept_faults,
        keep_unconfirmed=keep_unconfirmed, without_rule=without_rules, without_effect=without_effects, out=folder),
        sinew=sinew)
    return read_report(folder, kept)


def _word(value):
    if isinstance(value, Recording):
        return str(value.path)
    return os.fspath(value) if hasattr(value, "__fspath__") else str(value)


def _words(values):
    """One recording or several."""
    several = isinstance(values, (list, tuple))
    return [_word(value) for value in (values if several else [values])]


def _options(**options):
    """held_out_map=X -> --held-out-map X; a list repeats the option, a list of lists is several words behind it."""
    words = []
    for name, value in options.items():
        option = "--" + name.replace("_", "-")
        if value is True:
            words.append(option)
        elif value is None or value is False:
            continue
        else:
            for one in value if isinstance(value, (list, tuple)) else [value]:
                inner = one if isinstance(one, list) else [_word(one)]
                words += [option, *inner] if inner else []
    return words


def _folder(out):
    if out is not None:
        return Path(out), None
    kept = tempfile.TemporaryDirectory(prefix="sinew-")
    return Path(kept.name), kept
