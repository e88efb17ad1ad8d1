#!/usr/bin/env python3
"""The robot's cycle beside sinew-view and a client of it, against two runs without.

    bench/view/run.py [--seconds 60] [--rounds 1] [--no-realtime] [--bin build/release/bin]

The rig's processes in real time with a recorder: without the server, with it and a Node client that reads every topic,
and without it again. Of each run, from its recording, leaving out the first SKIP_S: the 99.9 % quantiles of the deviation
of the provider's measured period from the nominal one, and of the time from joint_state to joint_command at the recorder;
and the ticks without a command. Required: with the server not greater than the greater of the two runs without. Needs
node and python3-numpy; nothing else may run.
"""
import argparse
import json
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import threading

import numpy as np

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools/python"))
from sinew_recording import Recording  # noqa: E402

SKIP_S = 3.0  # participants join, and become real-time ones after their first second
DOMAIN = "231"
QUANTILE = 0.999


class Viewer:
    """sinew-view and a client that reads every topic; `served` is what the client counted."""

    def __init__(self, folder):
        self.folder = folder

    def __enter__(self):
        self.server = subprocess.Popen([str(self.folder / "sinew"), "view", "--domain", DOMAIN, "--port", "0"],
                                       stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
        port = None
        for line in self.server.stdout:
            found = re.search(r"http://127\.0\.0\.1:(\d+)/", line)
            if found:
                port = found[1]
                break
        if port is None:
            raise SystemExit("sinew view ended before it had an address")
        threading.Thread(target=self.server.stdout.read, daemon=True).start()
        self.client = subprocess.Popen(["node", str(ROOT / "bench/view/client.mjs"), port], stdin=subprocess.PIPE,
                                       stdout=subprocess.PIPE, text=True)
        return self

    def __exit__(self, *_):
        out, _ = self.client.communicate("", 20)
        self.served = json.loads(out or "{}")
        self.server.send_signal(signal.SIGINT)
        self.server.wait(20)


def record(options, file):
    command = [str(options.bin / "sinew"), "launch", str(ROOT / "robots/rig/deploy_rig.yaml"), "--duration",
               str(options.seconds + SKIP_S), "--domain", DOMAIN, "--record", str(file)]
    done = subprocess.run(command + ([] if options.no_realtime else ["--set", "realtime_priority=true"]), capture_output=True, text=True,
                          check=False)
    if done.returncode != 0:
        raise SystemExit(done.stdout + done.stderr)


def figures(file):
    run = Recording(str(file), topics=["joint_state", "joint_command"])
    state, command = run["joint_state"], run["joint_command"]
    period_s = state["period_s"][0]
    first = int(SKIP_S / period_s)
    late_us = 1e6 * np.abs(state["measured_period_s"][first:] - period_s)
    sent = dict(zip(state["header.tick"], state["log_time_ns"]))
    answers_us = [1e-3 * (at - sent[tick]) for tick, at in zip(command["header.tick"], command["log_time_ns"])
                  if tick >= first and tick in sent]
    answered = set(command["header.tick"])
    missing = sum(tick not in answered for tick in state["header.tick"][first:-1])
    return {"period_us": float(np.quantile(late_us, QUANTILE)), "answer_us": float(np.quantile(answers_us, QUANTILE)),
            "missing": missing, "ticks": len(late_us)}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--rounds", type=int, default=1)
    parser.add_argument("--no-realtime", action="store_true")
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/release/bin")
    options = parser.parse_args()
    inside = True
    with tempfile.TemporaryDirectory() as folder:
        for number in range(options.rounds):
            rows = {}
            for name in ("without", "with", "without again"):
                file = pathlib.Path(folder) / (name.replace(" ", "_") + ".mcap")
                if name == "with":
                    with Viewer(options.bin) as viewer:
                        record(options, file)
                    print("client:", json.dumps(viewer.served))
                else:
                    record(options, file)
                rows[name] = figures(file)
                os.remove(file)
                print("round %d, %-13s p99.9 of the period's deviation %7.0f us, of the answer %7.0f us; no command in "
                      "%d of %d ticks" % (number + 1, name, rows[name]["period_us"], rows[name]["answer_us"],
                                          rows[name]["missing"], rows[name]["ticks"]), flush=True)
            for key in ("period_us", "answer_us"):
                inside &= rows["with"][key] <= max(rows["without"][key], rows["without again"][key])
    print("with the server inside the spread of the runs without: %s" % ("yes" if inside else "no"))
    return 0 if inside else 1


if __name__ == "__main__":
    sys.exit(main())
