#!/usr/bin/env python3
"""Latency of the chain state, reference, esn, control, command as ratios to relays of Fast DDS alone in the same run.

    bench/chain/run.py [--pairs 5] [--seconds 12] [--only A] [--bin build/release/bin]

A: the chain alone, four processes at 1 kHz, beside four relays. B: eight processes at 240 Hz beside eight relays in the
same graph. C: the chain in one process (as sinew-compose) beside one relay there and back. H: one relay there and back
with joint_state and joint_command alone; half of it is a message from process to process. S: the work of the provider's
cycle among the eight processes and a logger, undisturbed and while each of them is stopped in turn (SIGSTOP, SIGCONT after
half a second; control last, as the robot has a fault then). T: the bridge's cycle with topics, twelve joints on two
virtual buses, beside the sum of its work without topics and bare writes of the same payloads to as many readers. K: the chain of A with a
deployment's key beside the same without. D: the same with DDS security (certificates of `sinew security`) beside without.
Pairs ABAB: ours, relays,
ours, relays; the median of the ratios is printed. Both under SCHED_FIFO with the same priorities. The relays' payloads
are as large as ours were in a run before. Nothing else may run.
"""
import argparse
import json
import math
import os
import pathlib
import re
import signal
import statistics
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
RIG = ROOT / "robots/rig"
HERE = pathlib.Path(__file__).resolve().parent
QOS = ROOT / "components/topics/node/qos_profiles.xml"

# QoS profile of a topic (idl/README.md), where it is not "control".
PROFILES = {"joint_state": "state", "actuator_state": "state", "residual": "state"}
PRIORITIES = {"reference": 36, "regime": 34, "pneumatics": 31, "esn": 32, "rls": 30, "control": 40, "residual": 0}
SOURCE_PRIORITY = 44

# Name, program, configuration.
CHAIN = [("reference", "sinew-reference", HERE / "reference.yaml"), ("esn", "sinew-esn", RIG / "esn_model.yaml"),
         ("control", "sinew-control", HERE / "control.yaml")]
ALL = [("reference", "sinew-reference", HERE / "reference.yaml"), ("regime", "sinew-regime", RIG / "regime.yaml"),
       ("pneumatics", "sinew-pneumatics", RIG / "pneumatics.yaml"), ("esn", "sinew-esn", RIG / "esn_adaptive.yaml"),
       ("rls", "sinew-rls", RIG / "rls.yaml"), ("control", "sinew-control", RIG / "control_pid_esn.yaml"),
       ("residual", "sinew-residual", RIG / "residual.yaml")]

# A relay: the topics that it answers when all have come, those that it only reads, and those that it writes. As
# `sinew list` shows our participants: most of them read the topic that they write, to notice another owner.
STATE = ["joint_state", "actuator_state"]
SOURCE = {"awaits": ["joint_command"], "reads": [], "writes": ["actuator_state", "joint_state"]}
CHAIN_RELAYS = {
    "reference": {"awaits": ["joint_state"], "reads": ["reference"], "writes": ["reference"]},
    "esn": {"awaits": [*STATE, "reference"], "reads": ["torque_prediction"], "writes": ["torque_prediction"]},
    "control": {"awaits": [*STATE, "reference", "torque_prediction"], "reads": ["joint_command"],
                "writes": ["joint_command"]}}
ALL_SOURCE = {**SOURCE, "reads": ["valve_command"]}
ALL_RELAYS = {
    "reference": CHAIN_RELAYS["reference"],
    "regime": {"awaits": STATE, "reads": ["regime"], "writes": ["regime"]},
    "pneumatics": {"awaits": STATE, "reads": ["pneumatic_state"], "writes": ["valve_command", "pneumatic_state"]},
    "esn": {"awaits": [*STATE, "reference", "regime"], "reads": ["readout", "torque_prediction"],
            "writes": ["torque_prediction", "reservoir_state"]},
    "rls": {"awaits": [*STATE, "joint_command", "reservoir_state"], "reads": ["readout"],
            "writes": ["readout", "adaptation_state"]},
    "control": {"awaits": [*STATE, "reference", "regime", "torque_prediction"], "reads": ["joint_command"],
                "writes": ["joint_command"]},
    "residual": {"awaits": STATE, "reads": [], "writes": ["residual"]}}
ONE_RELAY = {"control": {"awaits": STATE, "reads": [], "writes": ["joint_command"]}}
HOP_SOURCE = {"awaits": ["joint_command"], "reads": [], "writes": ["joint_state"]}
HOP_RELAY = {"control": {"awaits": ["joint_state"], "reads": [], "writes": ["joint_command"]}}


class Processes:
    """Children that are ended when the block ends."""

    def __init__(self):
        self.children = []

    def __enter__(self):
        return self

    def start(self, arguments):
        child = subprocess.Popen([str(word) for word in arguments], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                                 text=True)
        self.children.append(child)
        return child

    def __exit__(self, *_):
        for child in self.children:
            if child.poll() is None:
                child.send_signal(signal.SIGINT)
        for child in self.children:
            try:
                child.wait(10)
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()


def statuses(options):
    """Cycles and cycles with a stale input of each participant, from its component_status."""
    out = subprocess.run([str(options.bin / "sinew"), "list", "--domain", str(options.domain), "--json", "--wait", "1.5"],
                         capture_output=True, text=True, check=False).stdout
    participants = json.loads(out)["participants"]
    return {entry["name"]: (entry["cycles"], entry["stale_inputs"]) for entry in participants if "cycles" in entry}


def stale_share(before, after):
    """The largest share of cycles with a stale input of a participant whose answer control waits for."""
    shares = []
    for name in set(after) & {"reference", "regime", "esn", "control"}:
        cycles, stale = before.get(name, (0, 0))
        shares.append((after[name][1] - stale) / max(1, after[name][0] - cycles))
    return max(shares, default=math.nan)


def ours(options, rate, seconds, components, compose=False, sizes=False, disturb=None):
    common = ["--domain", options.domain] + (["--realtime", "--cpu", options.cpu] if options.realtime else [])
    provider = [options.bin / "chain_provider", *common, "--name", "provider", "--rate", rate, "--seconds", seconds,
                *(["--sizes"] if sizes else [])]
    with Processes() as processes:
        for name, program, config, *more in components:
            if compose:
                provider += ["--component", f"{name}={program}={config}"]
            else:
                words = ["--config", config] if config else more[0]
                processes.start([options.bin / program, *common, "--name", name, *words])
        if not compose:
            time.sleep(1.0)  # all wait for joint_state
        child = processes.start(provider)
        if child.stdout.readline() != "warm\n":
            sys.exit("chain_provider ended early")
        subprocess.run([str(options.bin / "sinew"), "arm", "--domain", str(options.domain)], capture_output=True, check=True)
        before = {} if compose else statuses(options)
        if disturb:
            disturb(processes.children[:-1], seconds)
        result = json.loads(child.stdout.readline())
        result["stale"] = 0.0 if compose else stale_share(before, statuses(options))
        if sizes:
            result["sizes"] = json.loads(child.stdout.read())
        return result


def relays(options, rate, seconds, source, graph, sizes):
    def ends(flag, topics):
        words = []
        for topic in topics:
            size = f":{sizes[topic]}" if flag == "--out" else ""
            words += [flag, f"{topic}:{PROFILES.get(topic, 'control')}{size}"]
        return words

    def command(kind, priority, ports):
        scheduling = ["--priority", priority, "--cpu", options.cpu] if options.realtime and priority else []
        return [options.bin / "chain_relay", kind, "--domain", options.domain, "--qos", QOS, *scheduling,
                "--transports", options.transports,
                *ends("--await", ports["awaits"]), *ends("--in", ports["reads"]), *ends("--out", ports["writes"])]

    with Processes() as processes:
        for name, ports in graph.items():
            processes.start(command("relay", PRIORITIES[name], ports))
        time.sleep(1.0)
        child = processes.start(command("source", SOURCE_PRIORITY, source) + ["--rate", rate, "--seconds", seconds])
        out, _ = child.communicate(timeout=seconds + 60)
        return json.loads(out.splitlines()[-1])


def text_of(result):
    return (f"p50 {result['p50_us']:.0f} us, p99.9 {result['p999_us']:.0f} us, late {result['late']} of "
            f"{result['cycles']}")


LATE_US = 20000  # what a late answer counts as, in both programs


def interval_of_median(values):
    """Of at least 95 %, by order statistics; the range where there are fewer than six."""
    values, n = sorted(values), len(values)
    k = 0
    while 2 * sum(math.comb(n, i) for i in range(k + 1)) <= 0.05 * 2**n:
        k += 1
    return values[max(k - 1, 0)], values[n - max(k, 1)]


def spread(ratios, pairs, other):
    """Median of the ratios with its interval; None stands for a quantile among the late answers."""
    known = [ratio for ratio in ratios if ratio is not None]
    low, high = interval_of_median(known) if known else (math.nan, math.nan)
    text = "no ratio" if not known else f"{statistics.median(known):.3f} x {other} ({low:.3f} to {high:.3f})"
    return text + (f", late answers in {pairs - len(known)} of {pairs} pairs" if len(known) < pairs else "")


def with_key(run):
    """The result of a run with a deployment's key."""
    with tempfile.NamedTemporaryFile("w", suffix=".key") as file:  # mode 0600
        file.write("5a" * 32)
        file.flush()
        os.environ["SINEW_KEY"] = file.name
        try:
            return run()
        finally:
            del os.environ["SINEW_KEY"]


def with_security(options, run):
    """The result of a run with DDS security, every process with a certificate of all roles."""
    with tempfile.TemporaryDirectory() as folder:
        deployment = pathlib.Path(folder) / "chain.yaml"
        deployment.write_text(f"schema: sinew-deployment/1\nname: chain\ndomain_id: {options.domain}\nprocesses:\n"
                              "  - {name: reference, program: sinew-reference}\n")
        roles = "provider,reference,regime,pneumatics,esn,rls,control,residual,operator"
        subprocess.run([str(options.bin / "sinew"), "security", "init", str(deployment), "--role", f"reference={roles}"],
                       capture_output=True, check=True)
        os.environ["SINEW_QOS"] = str(deployment.with_suffix(".security") / "reference" / "qos.xml")
        try:
            return run()
        finally:
            del os.environ["SINEW_QOS"]


def compare(options, letter, what, goal, run_ours, run_relays, other="relays"):
    """The medians of the ratios; a quantile that falls among the late answers of either side has none."""
    ratios = {"p50_us": [], "p999_us": []}
    for pair in range(options.pairs):
        a, b = run_ours(), run_relays()
        for key, values in ratios.items():
            values.append(a[key] / b[key] if max(a[key], b[key]) < LATE_US else None)
        print(f"{letter} {pair + 1}: ours {text_of(a)}, stale {100 * a['stale']:.2f} %; {other} {text_of(b)}", flush=True)
    print(f"{letter}: {what}: p50 {spread(ratios['p50_us'], options.pairs, other)}; p99.9 "
          f"{spread(ratios['p999_us'], options.pairs, other)}; {goal}", flush=True)


def stop_in_turn(children, seconds):
    """SIGSTOP for half a second to each child but the last, round and round; the last one for a second at the end."""
    end = time.monotonic() + seconds
    while True:
        for child in children[:-1]:
            if time.monotonic() > end - 2.0:
                children[-1].send_signal(signal.SIGSTOP)
                time.sleep(1.0)
                children[-1].send_signal(signal.SIGCONT)
                return
            child.send_signal(signal.SIGSTOP)
            time.sleep(0.5)
            child.send_signal(signal.SIGCONT)
            time.sleep(0.1)


def stopped_peers(options):
    """Undisturbed, disturbed, undisturbed: quantiles of the work of the provider's cycle."""
    with tempfile.TemporaryDirectory() as folder:
        logger = ("logger", "sinew-logger", None, ["--out", pathlib.Path(folder) / "run.mcap", "--overwrite"])
        last = [part for part in ALL if part[0] == "control"]
        graph = [*(part for part in ALL if part[0] != "control"), logger, *last]
        names = ["undisturbed", "stopped", "undisturbed"]
        for pair in range(options.pairs):
            for name in names:
                disturb = stop_in_turn if name == "stopped" else None
                result = ours(options, 240, options.seconds, graph, disturb=disturb)
                print(f"S {pair + 1}, {name}: work of a cycle p50 {result['work_p50_us']:.0f} us, p99.9 "
                      f"{result['work_p999_us']:.0f} us; answers {text_of(result)}", flush=True)


def hop(options, sizes):
    halves50, halves999 = [], []
    for _ in range(options.pairs):
        result = relays(options, 240, options.seconds, HOP_SOURCE, HOP_RELAY, sizes)
        halves50.append(result["p50_us"] / 2)
        halves999.append(result["p999_us"] / 2)
    print(f"H: process to process, half of there and back: p50 {statistics.median(halves50):.0f} us "
          f"({min(halves50):.0f} to {max(halves50):.0f}), p99.9 {statistics.median(halves999):.0f} us "
          f"({min(halves999):.0f} to {max(halves999):.0f})", flush=True)


# The controller of bench/can reads joint_state alone.
BRIDGE_SOURCE = {"awaits": ["joint_command"], "reads": [], "writes": ["actuator_state", "joint_state"]}


def work_of_bridge(options, *more):
    """Median of the work of a cycle, us."""
    command = [options.bin / "can_cycle", "--seconds", options.seconds, "--domain", options.domain,
               *(["--realtime"] if options.realtime else []), *more]
    out = subprocess.run([str(word) for word in command], capture_output=True, text=True, check=True).stdout
    return float(re.search(r"work of a cycle.*: median (\d+) us", out).group(1))


def bridge_cycle(options, sizes):
    ratios = []
    for pair in range(options.pairs):
        whole = work_of_bridge(options)
        work = work_of_bridge(options, "--without-topics")
        writes = relays(options, 240, options.seconds, BRIDGE_SOURCE, HOP_RELAY, sizes)["writes_p50_us"]
        ratios.append(whole / (work + writes))
        print(f"T {pair + 1}: with topics {whole:.0f} us; without {work:.0f} us, bare writes {writes:.0f} us", flush=True)
    print(f"T: the bridge's cycle at 240 Hz: p50 {statistics.median(ratios):.2f} x work and bare writes ({min(ratios):.2f} "
          f"to {max(ratios):.2f}); goal 1.2", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=12.0, help="measured in each run")
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/release/bin")
    parser.add_argument("--domain", type=int, default=200)
    parser.add_argument("--rate", type=int, default=1000, help="of comparison A, Hz")
    parser.add_argument("--cpu", type=int, default=max(os.sched_getaffinity(0)), help="core of both sides")
    parser.add_argument("--no-realtime", dest="realtime", action="store_false")
    parser.add_argument("--transports", default="udp", choices=["both", "udp", "shm"], help="of the relays")
    parser.add_argument("--only", default="ABCDHKST", help="letters of the comparisons")
    parser.add_argument("--sizes", type=pathlib.Path, help="payload sizes: read from this file, or written to it")
    options = parser.parse_args()
    if options.sizes and options.sizes.exists():
        sizes = json.loads(options.sizes.read_text())
    else:
        sizes = ours(options, 240, 3, ALL, sizes=True)["sizes"]
        print("payloads in bytes:", ", ".join(f"{topic} {size}" for topic, size in sizes.items()), flush=True)
        if options.sizes:
            options.sizes.write_text(json.dumps(sizes))
    seconds = options.seconds
    comparisons = {
        "A": (f"chain of four processes, {options.rate} Hz", "goal p50 1.3, p99.9 1.5",
              lambda: ours(options, options.rate, seconds, CHAIN),
              lambda: relays(options, options.rate, seconds, SOURCE, CHAIN_RELAYS, sizes)),
        "B": ("eight processes, 240 Hz", "goal p50 1.5",
              lambda: ours(options, 240, seconds, ALL),
              lambda: relays(options, 240, seconds, ALL_SOURCE, ALL_RELAYS, sizes)),
        "C": ("the chain in one process, 1 kHz", "goal p50 1.3",
              lambda: ours(options, 1000, seconds, CHAIN, compose=True),
              lambda: relays(options, 1000, seconds, SOURCE, ONE_RELAY, sizes)),
        "K": (f"chain of four processes with a key, {options.rate} Hz", "goal p50 1.05",
              lambda: with_key(lambda: ours(options, options.rate, seconds, CHAIN)),
              lambda: ours(options, options.rate, seconds, CHAIN), "without"),
        "D": (f"chain of four processes with DDS security, {options.rate} Hz", "no goal yet",
              lambda: with_security(options, lambda: ours(options, options.rate, seconds, CHAIN)),
              lambda: ours(options, options.rate, seconds, CHAIN), "without")}
    for letter in options.only:
        if letter == "H":
            hop(options, sizes)
        elif letter == "T":
            bridge_cycle(options, sizes)
        elif letter == "S":
            stopped_peers(options)
        else:
            compare(options, letter, *comparisons[letter])


if __name__ == "__main__":
    main()
