#!/usr/bin/env python3
"""Starts in lockstep under load, and joins and kills beside an armed robot, by transport.

    bench/transport/run.py [--starts 500] [--kills 1000] [--transports both udp shm] [--budget SECONDS]

A start: `sinew launch` of the rig in lockstep, one second simulated, while one busy process a core runs. Classes: ended;
slow (more than 30 s); hung (stopped after --limit, with the last line of each process); failed (with its last lines). A
kill: a logger and a second controller join beside an armed rig in real time and are killed with SIGKILL after up to a
second; printed when the rig has ended, or its provider is not armed (then it is reset and armed). Transports in turn, as files of QoS
profiles (--qos). `--budget` ends each part in time.
"""
import argparse
import collections
import json
import os
import pathlib
import random
import signal
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
RIG = ROOT / "robots/rig"
PROFILES = ROOT / "components/topics/node/qos_profiles.xml"

UDP = ("<transport_descriptor><transport_id>udp</transport_id><type>UDPv4</type>"
       "<interfaceWhiteList><address>127.0.0.1</address></interfaceWhiteList></transport_descriptor>")
SHARED_MEMORY = ("<transport_descriptor><transport_id>shm</transport_id><type>SHM</type>"
                 "<maxMessageSize>65500</maxMessageSize></transport_descriptor>")
DESCRIPTORS = {"udp": UDP, "shm": SHARED_MEMORY}
USED = {"both": ["udp", "shm"], "udp": ["udp"], "shm": ["shm"]}


def profiles_of(transport, folder):
    """The built-in profiles with these transports, as a file."""
    used = USED[transport]
    text = PROFILES.read_text()
    descriptors = "".join(DESCRIPTORS[name] for name in used)
    text = text.replace("<profiles>", f"<profiles><transport_descriptors>{descriptors}</transport_descriptors>", 1)
    identifiers = "".join(f"<transport_id>{name}</transport_id>" for name in used)
    text = text.replace("<rtps>", f"<rtps><userTransports>{identifiers}</userTransports>"
                        "<useBuiltinTransports>false</useBuiltinTransports>")
    path = folder / f"{transport}.xml"
    path.write_text(text)
    return path


def launch_command(options, folder, profiles, extra):
    command = [options.bin / "sinew", "launch", RIG / "deploy_rig.yaml", "--domain", options.domain, *extra]
    if profiles:
        for name in ("surrogate", "pneumatics", "regime", "reference", "control", "esn", "rls"):
            command += ["--arg", f"{name}=--qos", "--arg", f"{name}={profiles}"]
    return [str(word) for word in command]


def end(child):
    """SIGINT to the launcher, which stops its own processes; SIGTERM and SIGKILL when it does not."""
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGKILL):
        if child.poll() is None:
            child.send_signal(number)
        try:
            return child.wait(15)
        except subprocess.TimeoutExpired:
            pass
    return child.wait()


def start_once(options, folder, profiles):
    log = folder / "launch.log"
    begin = time.monotonic()
    with log.open("w") as out:
        child = subprocess.Popen(launch_command(options, folder, profiles, ["--mode", "lockstep", "--duration", "1"]),
                                 stdout=out, stderr=subprocess.STDOUT)
        try:
            code = child.wait(options.limit)
        except subprocess.TimeoutExpired:
            end(child)
            code = None
    seconds = time.monotonic() - begin
    if code is None:
        return "hung", seconds, log.read_text()
    if code != 0:
        return "failed", seconds, log.read_text()
    return ("slow" if seconds > 30 else "ended"), seconds, ""


def starts(options, folder):
    busy = 0 if options.no_load else os.cpu_count()
    load = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(busy)]
    results = {transport: collections.Counter() for transport in options.transports}
    times = {transport: [] for transport in options.transports}
    limit = time.monotonic() + options.budget
    try:
        for _ in range(options.starts):
            for transport in options.transports:
                outcome, seconds, log = start_once(options, folder, profiles_of(transport, folder))
                results[transport][outcome] += 1
                times[transport].append(seconds)
                if log:
                    print(f"{transport}: {outcome} after {seconds:.0f} s\n" + "\n".join(log.splitlines()[-25:]), flush=True)
            if time.monotonic() > limit:
                break
    finally:
        for child in load:
            child.kill()
            child.wait()
    for transport, counts in results.items():
        ordered = sorted(times[transport])
        print(f"starts, {transport}: {sum(counts.values())}: {dict(counts)}; median {ordered[len(ordered) // 2]:.1f} s, longest "
              f"{ordered[-1]:.1f} s", flush=True)


def provider_state(options, profiles):
    command = [str(options.bin / "sinew"), "list", "--domain", str(options.domain), "--json", "--wait", "1"]
    out = subprocess.run(command + (["--qos", str(profiles)] if profiles else []), capture_output=True, text=True, check=False)
    for entry in json.loads(out.stdout)["participants"]:
        if entry["name"] == "surrogate" and "state" in entry:
            return entry.get("message") or entry["state"]
    return "not heard"


def kills_of(options, folder, transport, seed):
    profiles = profiles_of(transport, folder)
    qos = ["--qos", profiles] if profiles else []
    chooser = random.Random(seed)
    log = folder / "kills.log"
    done, problems = 0, []
    limit = time.monotonic() + options.budget / len(options.transports)
    with log.open("w") as out:
        rig = subprocess.Popen(launch_command(options, folder, profiles, ["--duration", "0", "--set", "realtime_priority=true"]),
                               stdout=out,
                               stderr=subprocess.STDOUT)
        try:
            time.sleep(4)
            common = ["--domain", options.domain, *qos]
            joiners = [[options.bin / "sinew-logger", *common, "--name", "joiner_logger", "--overwrite", "--out", folder / "kills.mcap"],
                       [options.bin / "sinew-control", *common, "--name", "joiner_control", "--config", RIG / "control_pid_model.yaml"]]
            while done < options.kills and time.monotonic() < limit and rig.poll() is None:
                children = [subprocess.Popen([str(word) for word in joiner], stdout=subprocess.DEVNULL,
                                             stderr=subprocess.DEVNULL) for joiner in joiners]
                for child in children:
                    time.sleep(chooser.uniform(0.05, 0.5))
                    child.send_signal(signal.SIGKILL)
                    child.wait()
                    done += 1
                if done % 20 == 0:
                    state = provider_state(options, profiles)
                    if state not in ("armed", "damped"):
                        problems.append(f"after {done} kills {state}")
                        for word in ("reset", "arm"):
                            subprocess.run([str(part) for part in (options.bin / "sinew", word, "--domain", options.domain, *qos)],
                                           capture_output=True, check=False)
            if rig.poll() is not None:
                problems.append(f"after {done} kills: the rig ended with {rig.returncode}")
        finally:
            end(rig)
    print(f"kills, {transport}: {done}, {'; '.join(problems) or 'the provider stayed armed'}", flush=True)
    if problems:
        print("\n".join(log.read_text().splitlines()[-25:]), flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--starts", type=int, default=500, help="of each transport")
    parser.add_argument("--kills", type=int, default=1000, help="of each transport")
    parser.add_argument("--transports", nargs="+", default=["both", "udp", "shm"], choices=["both", "udp", "shm"])
    parser.add_argument("--no-load", action="store_true", help="starts: the machine is busy with something else")
    parser.add_argument("--limit", type=float, default=120.0, help="seconds until a start counts as hung")
    parser.add_argument("--budget", type=float, default=1e9, help="seconds for the starts, and for the kills")
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/release/bin")
    parser.add_argument("--domain", type=int, default=201)
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as text:
        folder = pathlib.Path(text)
        if options.starts:
            starts(options, folder)
        if options.kills:
            for transport in options.transports:
                kills_of(options, folder, transport, seed=1)


if __name__ == "__main__":
    main()
