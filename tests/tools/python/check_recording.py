#!/usr/bin/python3
"""The module sinew_recording beside `sinew echo` and `sinew export`. Exit code 77: skipped, with the reason."""
import csv
import json
import math
import struct
import subprocess
import sys
import warnings
import zlib

try:
    import numpy as np
except ImportError:
    print("SKIPPED: package: no numpy; apt-get install python3-numpy")
    sys.exit(77)

import one_check

# A measurement of a joint, as `sinew import` reads it: exact in binary, so that it must come back exactly.
ROWS = [(0.25 * i, 0.5 * i, 0.25 - i) for i in range(20)]
MAP = """schema: sinew-csv-map/1
kind: rotary
time: {column: time_s, unit: s}
signals:
  position: {column: q, unit: rad}
  motor_current: {column: i, unit: A}
"""
MODEL = """schema: sinew-model/1
name: leg
joints:
  - name: hip
    kind: rotary
    constants: {gear_ratio: 100, torque_constant_Nm_A: 0.01}
    terms: [{effect: drive_current, efficiency: 1}]
"""


def expect(condition, what):
    if not condition:
        sys.exit(f"failed: {what}")


def run(*command, code=0):
    done = subprocess.run([str(part) for part in command], capture_output=True, text=True, check=False)
    expect(done.returncode == code, f"{command}: code {done.returncode}, expected {code}\n{done.stdout}{done.stderr}")
    return done


def write_sample(arguments, folder):
    sample = folder / "sample.mcap"
    run(arguments.sample, sample, folder / "expected.jsonl")
    return sample


def flat(message, path=""):
    """(path without indices, indices, value) of every number and text of a message."""
    if isinstance(message, dict):
        for name, value in message.items():
            yield from flat(value, f"{path}.{name}" if path else name)
    elif isinstance(message, list):
        for index, value in enumerate(message):
            for inner, indices, leaf in flat(value, path):
                yield inner, (index,) + indices, leaf
    else:
        yield path, (), message


def compare_rows(recording, topic):
    """Arrays against messages decoded one by one; gives how many values were compared."""
    arrays, compared = recording[topic], 0
    for row, message in enumerate(recording.messages(topic)):
        counts = [value for path, _, value in flat(message) if path.endswith("_count") and "feature" not in path]
        used = counts[0] if counts else None
        for path, indices, value in flat(message):
            array = arrays[path]
            if isinstance(value, str) and array.dtype.kind == "u":
                value = recording.labels(topic, path).index(value)
            in_use = used is None or not indices or path in ("feature", "weight", "event_ids", "content") or indices[0] < used
            if not in_use:
                if indices[0] < array.shape[1]:
                    left = array[(row,) + indices]
                    expect(left != left or left == 0, f"{topic}.{path}{indices}: {left} in an entry not in use")
                continue
            found = array[(row,) + indices]
            found = found.decode() if isinstance(found, bytes) else found.item()
            expect(found == value, f"{topic}.{path}{indices} of message {row}: {found}, expected {value}")
            compared += 1
    return compared


MAX_JOINTS = 12


def same(printed, message):
    """Whether a message is what echo prints of it: of arrays of joints those that the message has."""
    if isinstance(message, dict):
        return printed.keys() == message.keys() and all(same(printed[name], message[name]) for name in message)
    if isinstance(message, list) and len(message) == MAX_JOINTS and len(printed) < MAX_JOINTS:
        return same(printed, message[: len(printed)])
    if isinstance(message, list):
        return len(printed) == len(message) and all(same(one, other) for one, other in zip(printed, message))
    return printed == message


def check_echo(arguments, folder):
    sample = write_sample(arguments, folder)
    recording = Recording(sample)
    expect(len(recording.topics) >= 27 and recording.metadata["sinew.recording"] == {"seed": "7"}, "topics, metadata")
    values = 0
    for topic in recording.topics:
        printed = run(arguments.sinew, "echo", topic, "--from", sample, "--json").stdout.splitlines()
        messages = list(recording.messages(topic))
        expect(len(printed) == len(messages) == 20, f"{topic}: {len(printed)} lines of {len(messages)} messages")
        for line, message in zip(printed, messages):
            expect(same(json.loads(line), message), f"{topic}: another message")
        values += compare_rows(recording, topic)
    expect(values > 20000, f"only {values} values were compared")
    only = Recording(sample, topics=["imu"])
    expect(only.topics == ["imu"] and len(only["imu"]["log_time_ns"]) == 20, "one topic")
    print(f"{values} values are those of sinew echo")


def check_npz(arguments, folder):
    sample, out = write_sample(arguments, folder), folder / "run.npz"
    run(arguments.sinew, "export", sample, "--format", "npz", "--out", out)
    recording, seen = Recording(sample), 0
    with np.load(out) as exported:
        names = set(exported.files)
        for topic in recording.topics:
            for field, array in recording[topic].items():
                name = f"{topic}.{field}"
                names.discard(name)
                other = exported[name]
                expect(other.dtype == array.dtype and other.shape == array.shape,
                       f"{name}: {other.dtype}{other.shape}, the module has {array.dtype}{array.shape}")
                expect(np.array_equal(other, array, equal_nan=array.dtype.kind == "f"), f"{name}: other values")
                seen += 1
                if f"{name}.labels" in exported.files:
                    names.discard(f"{name}.labels")
                    labels = [label.decode() for label in exported[f"{name}.labels"]]
                    expect(labels == recording.labels(topic, field), f"{name}: labels {labels}")
    expect(not names, f"arrays that the module lacks: {names}")
    again = run(arguments.sinew, "export", sample, "--format", "npz", "--out", out, code=2)
    expect("is there already" in again.stderr, again.stderr)
    print(f"{seen} arrays are equal")


def check_csv(arguments, folder):
    sample, out = write_sample(arguments, folder), folder / "csv"
    run(arguments.sinew, "export", sample, "--format", "csv", "--out", out)
    recording, cells = Recording(sample), 0
    for topic in recording.topics:
        arrays = recording[topic]
        with open(out / f"{topic}.csv", encoding="utf-8", newline="") as file:
            rows = list(csv.DictReader(file))
        columns = sum(int(np.prod(array.shape[1:])) for array in arrays.values())
        expect(len(rows) == 20 and len(rows[0]) == columns, f"{topic}: {len(rows[0])} columns, expected {columns}")
        for row, cells_of_row in enumerate(rows):
            for name, cell in cells_of_row.items():
                path, *indices = name.replace("]", "").split("[")
                value = arrays[path][(row,) + tuple(int(index) for index in indices)]
                cells += 1
                if cell == "":  # not in use
                    expect(value != value or value == 0 or value == b"", f"{topic}: {name} is empty, not {value}")
                elif value.dtype.kind == "S":
                    expect(cell == value.decode(), f"{topic}: {name} is {cell}, expected {value}")
                elif cell[0].isalpha():
                    expect(recording.labels(topic, path)[value] == cell, f"{topic}: {name} is {cell}")
                elif value.dtype.kind == "f":
                    expect(float(cell) == value, f"{topic}: {name} is {cell}, expected {value}")
                else:
                    expect(int(cell) == value, f"{topic}: {name} is {cell}, expected {value}")
    one = run(arguments.sinew, "export", sample, "--format", "csv", "--out", folder / "one", "--topic", "imu", "--json")
    expect([topic["topic"] for topic in json.loads(one.stdout)["topics"]] == ["imu"], one.stdout)
    expect([file.name for file in (folder / "one").iterdir()] == ["imu.csv"], "one topic")
    wrong = run(arguments.sinew, "export", sample, "--format", "csv", "--out", folder / "no", "--topic", "imus", code=2)
    expect("no topic 'imus', expected one of: actuator_state" in wrong.stderr, wrong.stderr)
    expect(not list(folder.glob("no*")), "a folder is left behind")
    print(f"{cells} cells are those of the arrays")


def write_measurement(arguments, folder):
    table = ["time_s,q,i"] + [",".join(repr(float(value)) for value in row) for row in ROWS]
    (folder / "run.csv").write_text("\n".join(table) + "\n", encoding="utf-8")
    (folder / "map.yaml").write_text(MAP, encoding="utf-8")
    (folder / "model.yaml").write_text(MODEL, encoding="utf-8")
    run(arguments.sinew, "import", folder / "run.csv", "--map", folder / "map.yaml", "--out", folder / "run.mcap")
    return folder / "run.mcap"


def check_ros2bag(arguments, folder):
    mcap, model = write_measurement(arguments, folder), folder / "model.yaml"
    run(arguments.sinew, "export", mcap, "--format", "ros2bag", "--model", model, "--out", folder / "bag")
    bag = Recording(folder / "bag" / "recording_0.mcap")
    expect(bag.profile == "ros2" and bag.topics == ["/joint_states"] and not bag.cut_off, f"{bag.profile} {bag.topics}")
    states, original = list(bag.messages("/joint_states")), Recording(mcap)["joint_state"]
    expect(len(states) == len(ROWS), f"{len(states)} messages")
    for row, message in zip(ROWS, states):
        stamp = message["header"]["stamp"]
        expect((stamp["sec"], stamp["nanosec"]) == (int(row[0]), int(1e9 * (row[0] % 1))), f"stamp {stamp}")
        expect(message["name"] == ["hip"] and message["position"] == [row[1]], f"{message}")
        expect(len(message["velocity"]) == len(message["effort"]) == 1, f"{message}")
    arrays = bag["/joint_states"]
    expect(np.array_equal(arrays["velocity"], original["velocity_rad_s"]), "velocities")
    expect(np.array_equal(arrays["effort"], original["torque_Nm"]), "torques")
    expect(np.array_equal(arrays["log_time_ns"], original["log_time_ns"]), "times of reception")
    metadata = (folder / "bag" / "metadata.yaml").read_text(encoding="utf-8")
    for part in ("version: 5", "storage_identifier: mcap", "message_count: 20", "name: /joint_states",
                 "type: sensor_msgs/msg/JointState", "- recording_0.mcap", "nanoseconds: 4750000000"):
        expect(part in metadata, f"metadata.yaml without '{part}':\n{metadata}")
    part = run(arguments.sinew, "export", f"{mcap}@1:2", "--format", "ros2bag", "--out", folder / "part", "--json")
    expect(json.loads(part.stdout)["topics"] == [{"topic": "/joint_states", "messages": 4}], part.stdout)
    named = Recording(folder / "part" / "recording_0.mcap")
    expect(next(named.messages("/joint_states"))["name"] == ["joint_0"], "names without a model")
    wrong = run(arguments.sinew, "export", mcap, "--format", "ros2bag", "--topic", "imu", "--out", folder / "no", code=2)
    expect("--topic is not for ros2bag" in wrong.stderr, wrong.stderr)
    nothing = run(arguments.sinew, "export", f"{mcap}@50:60", "--format", "ros2bag", "--out", folder / "no", code=2)
    expect("run.mcap: no message that a bag can have in 50:60" in nothing.stderr, nothing.stderr)
    expect(not list(folder.glob("no*")), "a folder is left behind")
    print(f"{len(states)} messages of ROS 2 are those of the recording")


# ---- files written here, byte by byte


def record(opcode, body):
    return struct.pack("<BQ", opcode, len(body)) + body


def text(value):
    return struct.pack("<I", len(value)) + value.encode()


# Channels that are no CDR: text, and a schema of bytes that are no UTF-8.
OTHERS = (record(0x03, struct.pack("<H", 7) + text("Note") + text("jsonschema") + text("{}")) +
          record(0x04, struct.pack("<HH", 7, 7) + text("/note") + text("json") + struct.pack("<I", 0)) +
          record(0x05, struct.pack("<HIQQ", 7, 0, 1000, 0) + b"{}") +
          record(0x03, struct.pack("<H", 8) + text("Log") + text("protobuf") + struct.pack("<I", 2) + b"\n\xb4") +
          record(0x04, struct.pack("<HH", 8, 8) + text("/log") + text("protobuf") + struct.pack("<I", 0)) +
          record(0x05, struct.pack("<HIQQ", 8, 0, 1000, 0) + b"\xff"))


def container(schema, payloads, compression="", compress=bytes, damage=False, others=b""):
    """A file with one channel 'x' of struct 'X' in one chunk, and others beside it."""
    body = others + record(0x03, struct.pack("<H", 1) + text("X") + text("omgidl") + text(schema))
    body += record(0x04, struct.pack("<HH", 1, 1) + text("x") + text("cdr") + struct.pack("<I", 0))
    for i, payload in enumerate(payloads):
        body += record(0x05, struct.pack("<HIQQ", 1, i, 1000 + i, i) + payload)
    crc = zlib.crc32(body) ^ (1 if damage else 0)
    packed = compress(body)
    chunk = struct.pack("<QQQI", 0, 0, len(body), crc) + text(compression) + struct.pack("<Q", len(packed)) + packed
    magic = b"\x89MCAP0\r\n"
    return (magic + record(0x01, text("") + text("test")) + record(0x06, chunk) + record(0x0F, bytes(4)) +
            record(0x02, bytes(20)) + magic)


def read(folder, content):
    path = folder / "made.mcap"
    path.write_bytes(content)
    return Recording(path)


def check_compression(arguments, folder):
    import lz4.frame
    import zstandard
    schema = "@final struct X { double a; };"
    payloads = [b"\0\1\0\0" + struct.pack("<d", value) for value in (1.5, -2.25)]
    for name, compress in (("", bytes), ("zstd", zstandard.ZstdCompressor().compress), ("lz4", lz4.frame.compress)):
        found = read(folder, container(schema, payloads, name, compress))["x"]["a"]
        expect(found.tolist() == [1.5, -2.25], f"compression '{name}': {found}")
    for module, name in (("zstandard", "zstd"), ("lz4.frame", "lz4")):
        kept, sys.modules[module] = sys.modules[module], None
        refused(folder, container(schema, payloads, name, bytes), f"apt-get install python3-{module.split('.')[0]}")
        sys.modules[module] = kept
    refused(folder, container(schema, payloads, "brotli", bytes), "'brotli', expected zstd, lz4 or nothing")
    print("three compressions are read, a missing package is named")


def refused(folder, content, reason, use=lambda recording: recording["x"]):
    try:
        use(read(folder, content))
    except RecordingError as error:
        expect(reason in str(error) and "made.mcap: " in str(error), f"'{error}', expected: {reason}")
        return
    sys.exit(f"failed: a file that should be refused with: {reason}")


def check_broken(arguments, folder):
    schema = "@final struct X { double a; };"
    good = b"\0\1\0\0" + struct.pack("<d", 1.5)
    refused(folder, b"time_s,q\n0,1\n", "is no MCAP file")
    refused(folder, container(schema, [good], damage=True), "its checksum is another one")
    refused(folder, container(schema, [good[:-1]]), "ends early")
    refused(folder, container(schema, [good[:-1]]), "ends early", lambda recording: list(recording.messages("x")))
    refused(folder, container("@mutable struct X { double a; };", [good]), "@mutable")
    refused(folder, container("@final struct X { Y a; };", [good]), "type 'Y'")
    refused(folder, container("@final struct Y { double a; };", [good]), "struct 'X'")
    refused(folder, container("@final struct X { double a", [good]), "ends early")
    refused(folder, container("@final struct X { sequence<double, 3> a; };", [b"\0\1\0\0\xff\xff\xff\xff"]),
            "more than its bytes")
    # A cut file is read up to its last whole record, whatever byte it ends at.
    sample = write_sample(arguments, folder).read_bytes()
    path, before = folder / "cut.mcap", 0
    for size in range(2000, len(sample) - 2000, len(sample) // 40):
        path.write_bytes(sample[:size])
        recording = Recording(path)
        messages = sum(len(recording[topic]["log_time_ns"]) for topic in recording.topics)
        expect(messages >= before, f"{messages} messages in {size} bytes, fewer than in less")
        before = messages
    path.write_bytes(sample[:len(sample) // 2])
    expect(Recording(path).cut_off, "a cut file counts as whole")
    done = run(arguments.sinew, "export", path, "--format", "npz", "--out", folder / "cut.npz")
    expect("cut off (" in done.stderr, done.stderr)
    with np.load(folder / "cut.npz") as exported:
        for topic in exported.files:
            if topic.endswith(".log_time_ns"):
                whole = Recording(path)[topic.removesuffix(".log_time_ns")]["log_time_ns"]
                expect(np.array_equal(exported[topic], whole), f"{topic} of a cut file")
    refused_by_command = run(arguments.sinew, "export", folder / "absent.mcap", "--format", "npz", "--out",
                             folder / "no.npz", code=2)
    expect("absent.mcap: cannot be read" in refused_by_command.stderr, refused_by_command.stderr)
    print("broken files are refused by their reason, cut ones are read")


def check_others(arguments, folder):
    schema, payload = "@final struct X { double a; };", b"\0\1\0\0" + struct.pack("<d", 1.5)
    content = container(schema, [payload], others=OTHERS)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        recording = read(folder, content)
    expect(recording.topics == ["x"] and recording["x"]["a"].tolist() == [1.5], f"{recording.topics}")
    expect(set(recording.left_out) == {"/note", "/log"}, f"{recording.left_out}")
    expect(len(caught) == 1 and "'/note' has messages 'json'" in str(caught[0].message), f"{caught}")
    path = folder / "made.mcap"
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        expect(Recording(path, topics=["x"])["x"]["a"].tolist() == [1.5], "the topic that is wanted")
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        refused(folder, content, "topic '/log' has messages 'protobuf'",
                lambda recording: Recording(path, topics=["/log"]))
    # XCDR2 with a delimiter header: not the same bytes.
    refused(folder, container(schema, [b"\0\x09" + payload[2:]]), "encoding 9, expected plain CDR")
    refused(folder, container(schema, [b"\0\x09" + payload[2:]]), "encoding 9",
            lambda recording: list(recording.messages("x")))
    path.write_bytes(content)
    done = run(arguments.sinew, "export", path, "--format", "csv", "--out", folder / "beside")
    expect("left out: topic '/log' has messages 'protobuf'" in done.stderr and "; topic '/note' has" in done.stderr, done.stderr)
    expect([file.name for file in (folder / "beside").iterdir()] == ["x.csv"], "the others are exported")
    named = run(arguments.sinew, "export", path, "--format", "npz", "--out", folder / "no.npz", "--topic", "/log", code=2)
    expect("topic '/log' has messages 'protobuf'" in named.stderr, named.stderr)
    print("topics of other encodings are left out and named")


def check_objects(arguments, folder):
    sample = write_sample(arguments, folder)
    recording = Recording(sample)
    listed = json.loads(run(arguments.sinew, "list", sample, "--json").stdout)
    expect(abs(recording.duration_s - listed["duration_s"]) < 1e-9, f"{recording.duration_s} s, {listed['duration_s']}")
    expect(recording.counts == {topic["name"]: topic["messages"] for topic in listed["topics"]}, f"{recording.counts}")
    shown = repr(recording).splitlines()
    expect(shown[0].startswith("<Recording sample.mcap: ") and f"{listed['messages']} messages" in shown[0], shown[0])
    expect([line.split()[0] for line in shown[1:]] == recording.topics, f"{shown}")
    expect(any(line.split() == ["imu", "20", "Imu"] for line in shown), f"{shown}")
    messages = list(recording)
    expect(len(messages) == len(recording) == listed["messages"], f"{len(messages)} messages")
    times = [message.log_time_ns for message in messages]
    expect(times == sorted(times), "messages in another order than that of log_time")
    for topic in recording.topics:
        of_topic = [message.content for message in messages if message.topic == topic]
        expect(of_topic == list(recording.messages(topic)), f"{topic}: other messages")
    expect(max(map(len, map(repr, messages))) < 80 and repr(messages[0]).startswith("<Message "), repr(messages[0]))
    # Two writers of a topic are one topic; one without a schema that is understood is left out of the loop.
    payload = b"\0\1\0\0" + struct.pack("<d", 1.5)
    others = (record(0x04, struct.pack("<HH", 2, 1) + text("x") + text("cdr") + struct.pack("<I", 0)) +
              record(0x05, struct.pack("<HIQQ", 2, 0, 999, 0) + payload) +
              record(0x03, struct.pack("<H", 9) + text("Y") + text("omgidl") + text("@mutable struct Y {};")) +
              record(0x04, struct.pack("<HH", 9, 9) + text("y") + text("cdr") + struct.pack("<I", 0)))
    two = read(folder, container("@final struct X { double a; };", [payload] * 2, others=others))
    expect(two.topics == ["x", "y"] and two.counts == {"x": 3, "y": 0}, f"{two.topics}, {two.counts}")
    expect(repr(two).count("\n  x ") == 1 and "2 topics" in repr(two), repr(two))
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        found = [(topic, log_time_ns, content["a"]) for topic, log_time_ns, _, content in two]
    expect(found == [("x", 999, 1.5), ("x", 1000, 1.5), ("x", 1001, 1.5)], f"{found}")
    expect(len(caught) == 1 and "topic 'y'" in str(caught[0].message) and "@mutable" in str(caught[0].message), f"{caught}")
    empty = read(folder, b"\x89MCAP0\r\n" + record(0x0F, bytes(4)))
    expect(list(empty) == [] and empty and repr(empty) == "<Recording made.mcap: 0 s, 0 messages, 0 topics>", repr(empty))
    print(f"{len(messages)} messages in the order of their times, {len(recording.topics)} topics once each")


HEADER_IDL = """module sinew { module msg { enum Origin { ORIGIN_LIVE, ORIGIN_SIM };
  @final struct Header { unsigned long long session_id; unsigned long long tick; long long stamp_ns; Origin origin; };
  @final struct JointState { sinew::msg::Header header; double angle; }; }; };"""


def states(rows, metadata=b""):
    """A file without chunks; rows: (log time, session, tick, stamp) of a joint_state, in their order."""
    magic = b"\x89MCAP0\r\n"
    body = record(0x01, text("") + text("test")) + metadata
    body += record(0x03, struct.pack("<H", 1) + text("sinew::msg::JointState") + text("omgidl") + text(HEADER_IDL))
    body += record(0x04, struct.pack("<HH", 1, 1) + text("joint_state") + text("cdr") + struct.pack("<I", 0))
    for log_time, session, tick, stamp in rows:
        payload = b"\0\1\0\0" + struct.pack("<QQqI4xd", session, tick, stamp, 0, tick)
        body += record(0x05, struct.pack("<HIQQ", 1, tick, log_time, stamp) + payload)
    return magic + body + record(0x0F, bytes(4)) + record(0x02, bytes(20)) + magic


def check_clocks(arguments, folder):
    start, step = 1_700_000_000 * 10**9, 10**7
    rows = []
    for tick in range(100):  # set back by 0.25 s
        stamp = start + step * tick - (0 if tick < 50 else 25 * step)
        rows.append((stamp + 1000, 1, tick, stamp))
    recording = read(folder, states(rows))
    expect(recording["joint_state"]["angle"].tolist() == list(range(100)), "rows in another order than that of ticks")
    found = [message.content["header"]["tick"] for message in recording]
    expect(found == list(range(100)), f"{found}")
    expect([message["angle"] for message in recording.messages("joint_state")] == found, "messages of the topic")
    expect(abs(recording.duration_s - 0.99) < 1e-9, f"{recording.duration_s} s")
    later = read(folder, states(rows[50:] + rows[:25]))  # an ordinary file: by log time
    expect(later["joint_state"]["angle"].tolist() == list(range(25)) + list(range(50, 100)), "order of log times")
    lockstep = [(start + 1000 * (100 * session + tick), session, tick, step * tick)
                for session in (1, 2) for tick in range(100)]
    mode = record(0x0C, text("sinew.recording") + struct.pack("<I", 20) + text("mode") + text("lockstep"))
    for metadata in (b"", mode):  # dropped by `mcap filter`
        recording = read(folder, states(lockstep, metadata))
        listed = json.loads(run(arguments.sinew, "list", folder / "made.mcap", "--json").stdout)
        expect(abs(recording.duration_s - 1.98) < 1e-9, f"{recording.duration_s} s")
        expect(abs(listed["duration_s"] - 1.98) < 1e-9, f"sinew list: {listed['duration_s']} s")
        expect("1.98 s simulated, 200 messages" in repr(recording), repr(recording))
    print("order and time are those of sessions and ticks")


def check_layouts(arguments, folder):
    schema = """module m { enum Kind { KIND_A, KIND_B };
      @final struct Part { octet part_count; float value[2]; string<8> name; }; };
      @final struct X { boolean on; m::Kind kind; sequence<m::Part, 4> part; long long last; };"""

    def message(order, parts, last):
        out = b"\0" + (b"\1" if order == "<" else b"\0") + b"\0\0"

        def put(code, *values):
            nonlocal out
            size = struct.calcsize(code)
            out += bytes(-(len(out) - 4) % size)
            for value in values:
                out += struct.pack(order + code, value)

        put("?", True), put("I", 1), put("I", len(parts))
        for count, values, name in parts:
            put("B", count), put("f", *values), put("I", len(name) + 1)
            out += name.encode() + b"\0"
        put("q", last)
        return out

    parts = [(2, (1.5, 2.5), "one"), (1, (3.5, 4.5), "")]
    recording = read(folder, container(schema, [message("<", parts, 7), message(">", parts[:1], -7), message("<", [], 0)]))
    arrays = recording["x"]
    nan = math.nan
    expect(arrays["last"].tolist() == [7, -7, 0] and arrays["on"].all(), "numbers after what varies")
    expect(arrays["part.name"].tolist() == [[b"one", b""], [b"one", b""], [b"", b""]], f"{arrays['part.name']}")
    values = [[[1.5, 2.5], [3.5, nan]], [[1.5, 2.5], [nan, nan]], [[nan, nan], [nan, nan]]]
    expect(np.array_equal(arrays["part.value"], np.array(values, np.float32), equal_nan=True), f"{arrays['part.value']}")
    expect(recording.labels("x", "kind") == ["KIND_A", "KIND_B"], "labels")
    second = list(recording.messages("x"))[1]
    expect(second == {"on": True, "kind": "KIND_B", "part": [{"part_count": 2, "value": [1.5, 2.5], "name": "one"}],
                      "last": -7}, f"{second}")
    path = folder / "made.mcap"
    run(arguments.sinew, "export", path, "--format", "npz", "--out", folder / "made.npz")
    with np.load(folder / "made.npz") as exported:
        for field, array in arrays.items():
            expect(np.array_equal(exported[f"x.{field}"], array, equal_nan=array.dtype.kind == "f"), f"npz: {field}")
    run(arguments.sinew, "export", path, "--format", "csv", "--out", folder / "made")
    lines = (folder / "made" / "x.csv").read_text(encoding="utf-8").splitlines()
    expect(lines[0] == "log_time_ns,publish_time_ns,on,kind,part.part_count[0],part.part_count[1],part.value[0][0],"
           "part.value[0][1],part.value[1][0],part.value[1][1],part.name[0],part.name[1],last", lines[0])
    expect(lines[1] == "1000,0,1,KIND_B,2,1,1.5,2.5,3.5,,one,,7", lines[1])
    expect(lines[3] == "1002,2,1,KIND_B,,,,,,,,,0", lines[3])
    print("both byte orders and lists in lists are read, by module and export alike")


def load():
    global Recording, RecordingError
    from sinew_recording import Recording, RecordingError


one_check.run(__doc__, load, globals())
