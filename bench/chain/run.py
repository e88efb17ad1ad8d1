#!/usr/bin/env python3
"""Latency of the chain state, reference, esn, control, command as ratios to relays of Fast DDS alone in the same run.

    bench/chain/run.py [--pairs 5] [--seconds 60] [--bin build/release/bin]

A: the chain alone, four processes at 1 kHz, beside four relays. B: eight processes at 240 Hz beside eight relays in the
same graph. C: the chain in one process (sinew-compose's chain) beside one relay there and back. Pairs ABAB: ours, relays,
ours, relays; the median of the ratios is printed. Both under SCHED_FIFO where that is allowed. Nothing else may run.
"""
import argparse
import json
import pathlib
import signal
import statistics
import subprocess
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
RIG = ROOT / "robots/rig"

# Payloads in bytes, as measured by `sinew echo --raw` on the rig; the relays carry as many.
SIZES = {"joint_state": 453, "actuator_state": 1148, "sim_truth": 300, "reference": 335, "torque_prediction": 372,
         "reservoir_state": 872, "joint_command": 360, "regime": 404, "valve_command": 68, "pneumatic_state": 380,
         "readout": 700, "adaptation_state": 168}


class Processes:
    def __init__(self, realtime):
        self.realtime, self.children = realtime, []

    def start(self, arguments):
        child = subprocess.Popen([str(word) for word in arguments], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL,
                                 text=True)
        self.children.append(child)
        return child

    def stop(self):
        for child in self.children:
            if child.poll() is None:
                child.send_signal(signal.SIGINT)
        for child in self.children:
            try:
                child.wait(10)
            except subprocess.TimeoutExpired:
                child.kill()
                child.wait()


def result_of(child, seconds):
    out, _ = child.communicate(timeout=seconds + 60)
    return json.loads(out.splitlines()[-1])


def ours(options, rate, seconds, components, compose=False):
    processes = Processes(options.realtime)
    common = ["--domain", options.domain] + (["--realtime"] if options.realtime else [])
    provider = [options.bin / "chain_provider", *common, "--name", "provider", "--rate", rate, "--duration", seconds + 3,
                "--arm"]
    try:
        for name, program, config in components:
            if compose:
                provider += ["--component", f"{name}={program}={RIG / config}"]
            else:
                processes.start([options.bin / program, *common, "--name", name, "--config", RIG / config])
        if not compose:
            time.sleep(2.0)  # all wait for joint_state
        return result_of(processes.start(provider), seconds)
    finally:
        processes.stop()


def relays(options, rate, seconds, graph):
    """graph: the source's outputs and input, then (inputs, outputs) of each relay; the last input triggers."""
    processes = Processes(options.realtime)
    relay = options.bin / "chain_relay"

    def ends(flag, names):
        return [word for name in names for word in (flag, f"{name}:{SIZES[name]}" if flag == "--out" else name)]

    def common(priority):
        return ["--domain", options.domain] + (["--priority", priority] if options.realtime else [])

    (outs, answer), others = graph[0], graph[1:]
    try:
        for inputs, outputs, priority in others:
            processes.start([relay, "relay", *common(priority), *ends("--in", inputs), *ends("--out", outputs)])
        source = processes.start([relay, "source", *common(44), *ends("--out", outs), "--in", answer, "--rate", rate,
                                  "--seconds", seconds])
        return result_of(source, seconds)
    finally:
        processes.stop()


CHAIN = [("reference", "sinew-reference", "reference_benchmark.yaml"), ("esn", "sinew-esn", "esn_model.yaml"),
         ("control", "sinew-control", ROOT / "bench/chain/control.yaml")]
CHAIN_RELAYS = [((["actuator_state", "joint_state"], "joint_command")),
                (["joint_state"], ["reference"], 36),
                (["joint_state", "actuator_state", "reference"], ["torque_prediction"], 32),
                (["joint_state", "actuator_state", "reference", "torque_prediction"], ["joint_command"], 40)]
ALL = [("reference", "sinew-reference", "reference_benchmark.yaml"), ("regime", "sinew-regime", "regime.yaml"),
       ("pneumatics", "sinew-pneumatics", "pneumatics.yaml"), ("esn", "sinew-esn", "esn_adaptive.yaml"),
       ("rls", "sinew-rls", "rls.yaml"), ("control", "sinew-control", "control_pid_esn.yaml"),
       ("residual", "sinew-residual", "residual.yaml")]
ALL_RELAYS = [((["actuator_state", "joint_state"], "joint_command")),
              (["joint_state"], ["reference"], 36),
              (["joint_state", "actuator_state"], ["regime"], 34),
              (["joint_state", "actuator_state"], ["valve_command", "pneumatic_state"], 38),
              (["joint_state", "actuator_state", "readout", "regime", "reference"],
               ["torque_prediction", "reservoir_state"], 32),
              (["joint_state", "actuator_state", "joint_command", "reservoir_state"], ["readout", "adaptation_state"], 30),
              (["joint_state", "actuator_state", "reference", "regime", "torque_prediction"], ["joint_command"], 40),
              (["joint_state", "actuator_state"], ["adaptation_state"], 1)]
ONE_RELAY = [((["actuator_state", "joint_state"], "joint_command")),
             (["actuator_state", "joint_state"], ["joint_command"], 40)]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--pairs", type=int, default=5)
    parser.add_argument("--seconds", type=float, default=60.0)
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/release/bin")
    parser.add_argument("--domain", type=int, default=229)
    parser.add_argument("--no-realtime", dest="realtime", action="store_false")
    parser.add_argument("--only", default="ABC", help="letters of the comparisons")
    options = parser.parse_args()
    comparisons = {
        "A": ("chain of four processes, 1 kHz", 1000, lambda: ours(options, 1000, options.seconds, CHAIN), CHAIN_RELAYS,
              "goal p50 1.3, p99.9 1.5"),
        "B": ("eight processes, 240 Hz", 240, lambda: ours(options, 240, options.seconds, ALL), ALL_RELAYS, "goal p50 1.5"),
        "C": ("the chain in one process, 1 kHz", 1000, lambda: ours(options, 1000, options.seconds, CHAIN, True), ONE_RELAY,
              "goal p50 1.3"),
    }
    for letter in options.only:
        what, rate, run, graph, goal = comparisons[letter]
        ratios50, ratios999 = [], []
        for pair in range(options.pairs):
            a, b = run(), relays(options, rate, options.seconds, graph)
            if not a["cycles"] or not b["cycles"]:
                sys.exit(f"{letter}: no command came back ({a}, {b})")
            ratios50.append(a["p50_us"] / b["p50_us"])
            ratios999.append(a["p999_us"] / b["p999_us"])
            print(f"{letter} {pair + 1}: ours p50 {a['p50_us']:.0f} us, p99.9 {a['p999_us']:.0f} us ({a['cycles']} cycles); "
                  f"relays {b['p50_us']:.0f} us, {b['p999_us']:.0f} us ({b['cycles']} cycles)", flush=True)
        print(f"{letter}: {what}: p50 {statistics.median(ratios50):.2f} x relays "
              f"({min(ratios50):.2f} to {max(ratios50):.2f}), p99.9 {statistics.median(ratios999):.2f} x "
              f"({min(ratios999):.2f} to {max(ratios999):.2f}); {goal}", flush=True)


if __name__ == "__main__":
    main()
