#!/usr/bin/env python3
"""Feeds every flattened idl file to other people's parsers. Exit code 77: skipped, with the reason."""
import argparse
import base64
import hashlib
import importlib.util
import io
import json
import pathlib
import re
import shutil
import subprocess
import sys
import tarfile
import urllib.error
import urllib.request

REGISTRY = "https://registry.npmjs.org"


def skip(reason):
    """The reason begins with what is missing, as those of tests/support/skip.h."""
    print(f"SKIPPED: {reason}")
    sys.exit(77)


def flattened(idl, work):
    """One self-contained file per idl file, as embed_idl.py makes them; gives their paths."""
    path = idl.parent / "tools" / "idl" / "embed_idl.py"
    spec = importlib.util.spec_from_file_location("embed_idl", path)
    embed = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(embed)
    work.mkdir(parents=True, exist_ok=True)
    files = []
    for file in sorted(idl.glob("*.idl")):
        out = work / file.name
        out.write_text(embed.flatten(str(file), set()), encoding="utf-8")
        files.append(out)
    assert len(files) >= 13, f"only {len(files)} idl files in {idl}"
    return files


def fresh(folder):
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    return folder


def run(command, **options):
    return subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False,
                          **options)


def check_cyclone(arguments):
    program = shutil.which("idlc")
    if program is None:
        skip("package: no idlc; apt-get install cyclonedds-tools")
    work = fresh(arguments.work / "cyclone")
    files = flattened(arguments.idl, work / "idl")
    out = fresh(work / "out")
    for file in files:
        done = run([program, "-l", "c", "-o", str(out), str(file)])
        if done.returncode != 0 or "rror" in done.stdout or not (out / (file.stem + ".h")).exists():
            print(done.stdout)
            sys.exit(f"idlc refuses {file.name}")
    print(f"idlc accepts {len(files)} files")


FORBIDDEN = ["@optional", "union", "bitmask", "bitset", "map<", "wstring", "wchar", "const", "typedef", "@mutable",
             "@appendable", "long double"]


def check_subset(arguments):
    files = flattened(arguments.idl, fresh(arguments.work / "subset"))
    problems = []
    for file in files:
        text = re.sub(r"//[^\n]*", "", file.read_text(encoding="utf-8"))
        for word in FORBIDDEN:
            if re.search(rf"(?<![\w@]){re.escape(word)}", text):
                problems.append(f"{file.name}: {word}")
        for body in re.findall(r"struct\s+\w+\s*{(.*?)}", text, re.S):
            names = re.findall(r"(\w+)\s*(?:\[\d+\])?\s*;", body)
            lower = [name.lower() for name in names]
            if len(set(lower)) != len(lower):
                problems.append(f"{file.name}: names that differ only by case: {names}")
        for struct in re.finditer(r"(\S+)\s+struct\s+(\w+)", text):
            if struct.group(1) != "@final":
                problems.append(f"{file.name}: struct {struct.group(2)} is not @final")
        for member in re.finditer(r"\bstring\s+\w|sequence<[^,>]*>", text):
            problems.append(f"{file.name}: unbounded {member.group(0)}")
        if re.search(r"\]\s*\[", text):
            problems.append(f"{file.name}: array of two dimensions")
    if problems:
        sys.exit("\n".join(problems))
    print(f"{len(files)} files keep to the subset")


# What is wrong with a table of topics, and what topics.py says of it. Rows: topic, type, file, QoS.
WRONG_TABLES = [
    ([("imu", "Imu", "sensors", "state"), ("imu", "Imu", "sensors", "state")], "topic 'imu' is there twice"),
    ([("Imu", "Imu", "sensors", "state")], "topic 'Imu', expected lower_case"),
    ([("imu", "Imu", "sensors", "fast")], "QoS 'fast', expected one of: state, control, event, latched, lockstep"),
    ([("imu", "Imu", "sensor", "state")], "topic 'imu': no file sensor.idl"),
    ([("imu", "Imus", "sensors", "state")], "topic 'imu': sensors.idl has no struct Imus"),
    ([], "no table with the columns"),
]


def check_topics(arguments):
    work = fresh(arguments.work / "topics")
    for file in arguments.idl.glob("*.idl"):
        shutil.copy(file, work)
    readme = work / "README.md"

    def generate(rows, what):
        table = ["| topic | type | file | writer | readers | rate | QoS |", "| --- | --- | --- | --- | --- | --- | --- |"]
        table += [f"| {topic} | {type_} | {file} | - | - | - | {qos} |" for topic, type_, file, qos in rows]
        after = ["", "Commanding topics: `imu`,", "`component_status`. No row.", ""]
        readme.write_text("\n".join(["Topics.", ""] + table + after), encoding="utf-8")
        return run([sys.executable, str(arguments.idl.parent / "tools" / "idl" / "topics.py"), str(readme)] + what)

    for rows, reason in WRONG_TABLES:
        done = generate(rows, ["subjects"])
        if done.returncode == 0 or reason not in done.stdout or done.stdout.count("\n") != 1:
            sys.exit(f"{rows}: {done.stdout} (code {done.returncode}), expected one line with: {reason}")
    done = generate([("imu", "Imu", "sensors", "state")], ["headers", str(work)])
    if done.returncode == 0 or "commanding topic 'component_status' is not in the table" not in done.stdout:
        sys.exit(f"a commanding topic that is none: {done.stdout} (code {done.returncode})")
    done = generate([("imu", "Imu", "sensors", "state"), ("body_imu", "Imu", "sensors", "event"),
                     ("component_status", "ComponentStatus", "status", "latched")], ["headers", str(work)])
    written = {name: (work / name).read_text(encoding="utf-8") if done.returncode == 0 else ""
               for name in ("topic_list.h", "all_messages.h")}
    done = generate([("imu", "Imu", "sensors", "state"), ("component_status", "ComponentStatus", "status", "latched")],
                    ["messages", str(work)])
    written |= {name: (work / name).read_text(encoding="utf-8") if done.returncode == 0 else ""
                for name in ("status.h", "header.h", "sensors.h", "fault.h")}
    expected = [("topic_list.h", 'Topic<msg::Imu> kBodyImu{"body_imu", Profile::kEvent};', 1),
                ("topic_list.h", "kBeginsWithHeader<msg::ComponentStatus> = false", 1),
                ("topic_list.h", "kBeginsWithHeader<msg::Imu>", 0),
                ("topic_list.h", "X(kBodyImu)", 1),
                ("topic_list.h", 'string_view, 2> kCommandingTopics', 1),
                ("all_messages.h", "X(Imu)", 2),  # once in each list, although two topics carry it
                ("all_messages.h", "X(ComponentStatus)", 1),
                ("all_messages.h", "#include <sinew_idl/sensors.h>", 1),
                ("status.h", "#include <sinew_idl/header.h>", 1),
                ("status.h", "constexpr std::uint32_t CountOf(ComponentState) noexcept { return 4; }", 1),
                ("status.h", "enum class ComponentState : std::uint32_t { kConfigured, kActive, kFault, kStopped };", 1),
                ("status.h", 'kNames[] = {"configured", "active", "fault", "stopped"};', 1),
                ("status.h", 'kKey = "name"', 1),
                ("status.h", 'visit("name", message.name, 64);', 1),
                ("fault.h", 'visit("cause", message.cause, 0);', 1),
                ("sensors.h", "std::array<double, 8> force_N{};", 1),
                ("header.h", "Origin origin{};", 1)]
    for name, text, count in expected:
        if written[name].count(text) != count:
            sys.exit(f"{name}: {written[name].count(text)} times '{text}', expected {count}\n{done.stdout}")
    print(f"{len(WRONG_TABLES)} wrong tables are refused, a right one is generated from")


def fetch_package(place, package):
    """The archive of one package of package-lock.json, checked."""
    name = place.split("node_modules/")[-1]
    url = f"{REGISTRY}/{name}/-/{name.split('/')[-1]}-{package['version']}.tgz"
    with urllib.request.urlopen(url, timeout=60) as answer:
        content = answer.read()
    algorithm, digest = package["integrity"].split("-", 1)
    if hashlib.new(algorithm, content).digest() != base64.b64decode(digest):
        sys.exit(f"{url} is not what package-lock.json names")
    return tarfile.open(fileobj=io.BytesIO(content), mode="r:gz")


def fetch_packages(lock, work):
    """Into work/node_modules, once for a lock file: `npm ci` without npm, which is 400 packages of Debian."""
    modules, complete = work / "node_modules", work / "node_modules" / "complete"
    if complete.exists() and complete.read_bytes() == lock.read_bytes():
        return
    fresh(modules)
    for place, package in json.loads(lock.read_text(encoding="utf-8"))["packages"].items():
        if not place:
            continue  # ourselves
        with fetch_package(place, package) as archive:
            for member in archive.getmembers():
                inner = pathlib.PurePosixPath(member.name).parts[1:]  # without "package/"
                if member.isfile() and ".." not in inner:
                    target = work.joinpath(place, *inner)
                    target.parent.mkdir(parents=True, exist_ok=True)
                    target.write_bytes(archive.extractfile(member).read())
    shutil.copy(lock, complete)


def check_viewer(arguments):
    node = shutil.which("node")
    if node is None:
        skip("package: no node; apt-get install nodejs")
    work = arguments.work / "viewer"
    work.mkdir(parents=True, exist_ok=True)
    for name in ("package.json", "check.mjs"):
        shutil.copy(arguments.package / name, work / name)
    files = flattened(arguments.idl, fresh(work / "idl"))
    sample, expected = work / "sample.mcap", work / "expected.jsonl"
    done = run([str(arguments.sample), str(sample), str(expected)])
    if done.returncode != 0:
        sys.exit(done.stdout)
    try:
        fetch_packages(arguments.package / "package-lock.json", work)
    except (urllib.error.URLError, OSError) as error:
        skip(f"package: {REGISTRY} gave nothing: {error}")
    done = run([node, str(work / "check.mjs"), str(sample), str(expected)] + [str(file) for file in files], cwd=work)
    print(done.stdout)
    sys.exit(done.returncode)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--idl", type=pathlib.Path, required=True)
    parser.add_argument("--work", type=pathlib.Path, required=True)
    checks = parser.add_subparsers(dest="check", required=True)
    checks.add_parser("cyclone")
    checks.add_parser("subset")
    checks.add_parser("topics")
    viewer = checks.add_parser("viewer")
    viewer.add_argument("--sample", type=pathlib.Path, required=True)
    viewer.add_argument("--package", type=pathlib.Path, required=True)
    arguments = parser.parse_args()
    globals()["check_" + arguments.check](arguments)


main()
