"""Recordings of Sinew as NumPy arrays.

    from sinew_recording import Recording

    run = Recording("run.mcap")
    state = run["joint_state"]                     # dict: field -> array, one row a message
    time_s = 1e-9 * state["header.stamp_ns"]
    position_rad = state["position_rad"][:, 0]
    run.labels("joint_state", "robot_state")       # names of the numbers of an enum
    for topic, log_time_ns, publish_time_ns, content in run:
        ...                                        # every message, as a dict

Reads MCAP files (https://mcap.dev/spec) whose messages are CDR with an embedded schema: omgidl as Sinew records it,
and ros2msg as bags of ROS 2 have it. Needs NumPy; python3-zstandard or python3-lz4 for chunks that are compressed so.

Arrays have the names, shapes and types of `sinew export --format npz` (docs/interchange.md): of the entries of an array
those in use (joint_count), rows that use fewer are filled with NaN, 0 or nothing; enums are numbers; texts are bytes
(UTF-8). Units stand in the names of the fields.
"""
import heapq
import itertools
import re
import struct
import warnings
import zlib
from pathlib import Path
from typing import NamedTuple

import numpy as np

__all__ = ["Message", "Recording", "RecordingError"]

MAGIC = b"\x89MCAP0\r\n"
HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, METADATA, DATA_END = 0x01, 0x02, 0x03, 0x04, 0x05, 0x06, 0x0C, 0x0F
RECORD_HEAD = struct.Struct("<BQ")
MESSAGE_HEAD = struct.Struct("<HIQQ")
LEAST_EPOCH_NS = 10**18  # earlier stamps are simulated time


class RecordingError(ValueError):
    """A file that is no recording, is broken, or has messages that cannot be read; names the file."""


# ---- types of messages


class Number:
    """A number of the wire; labels: of an enum."""

    def __init__(self, code, labels=None):
        self.dtype, self.labels = np.dtype("<" + code), labels
        self.size = self.dtype.itemsize
        self.fixed = True
        self.is_bool, self.is_octet = code == "?", code == "u1"
        self.char = self.dtype.char if self.size < 8 else {"f8": "d", "i8": "q", "u8": "Q"}[code]  # of struct


COUNT = Number("u4")  # of a sequence, of the bytes of a text


class Text:
    fixed = False


class List:
    """count: of a fixed array; None: a sequence."""

    def __init__(self, element, count):
        self.element, self.count = element, count
        self.fixed = count is not None and element.fixed


class Struct:
    def __init__(self, members):
        self.members = members  # (name, type) in order
        self.fixed = all(kind.fixed for _, kind in members)


IDL_NUMBERS = {
    "boolean": "?", "octet": "u1", "char": "i1", "short": "i2", "unsigned short": "u2", "long": "i4",
    "unsigned long": "u4", "long long": "i8", "unsigned long long": "u8", "float": "f4", "double": "f8",
    "int8": "i1", "uint8": "u1", "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "int64": "i8",
    "uint64": "u8"}


class IdlParser:
    """The subset of OMG IDL that Sinew's topics use: modules, final structs, enums, strings, sequences, arrays."""

    def __init__(self, text):
        text = re.sub(r"/\*.*?\*/|//[^\n]*", " ", text, flags=re.S)
        self.tokens = re.findall(r"::|@\w+|\w+|\S", text)
        self.at, self.scope, self.types = 0, [], {}
        while self.at < len(self.tokens):
            self.definition()

    def next(self, *expected):
        if self.at == len(self.tokens):
            raise ValueError(f"the schema ends early, expected {' or '.join(expected) or 'more'}")
        token = self.tokens[self.at]
        if expected and token not in expected:
            raise ValueError(f"the schema has '{token}', expected {' or '.join(expected)}")
        self.at += 1
        return token

    def peek(self):
        return self.tokens[self.at] if self.at < len(self.tokens) else ""

    def annotations(self):
        while self.peek().startswith("@"):
            name = self.next()
            if name in ("@appendable", "@mutable", "@optional"):
                raise ValueError(f"the schema has {name}, expected final types")
            if self.peek() == "(":
                while self.next() != ")":
                    pass

    def definition(self):
        self.annotations()
        kind = self.next("module", "struct", "enum", ";")
        if kind == ";":
            return
        name = self.next()
        self.next("{")
        if kind == "module":
            self.scope.append(name)
            while self.peek() != "}":
                self.definition()
            self.scope.pop()
        elif kind == "enum":
            labels = []
            while self.peek() != "}":
                self.annotations()
                labels.append(self.next())
                if self.peek() == ",":
                    self.next()
            self.types["::".join(self.scope + [name])] = Number("u4", labels)
        else:
            members = []
            while self.peek() != "}":
                self.member(members)
            self.types["::".join(self.scope + [name])] = Struct(members)
        self.next("}")
        self.next(";")

    def member(self, members):
        self.annotations()
        base = self.type()
        while True:
            name, kind = self.next(), base
            if self.peek() == "[":
                self.next()
                kind = List(base, int(self.next()))
                self.next("]")
            members.append((name, kind))
            if self.next(",", ";") == ";":
                return

    def type(self):
        word = self.next()
        if word == "string":
            if self.peek() == "<":
                self.next(), self.next(), self.next(">")
            return Text()
        if word == "sequence":
            self.next("<")
            element = self.type()
            if self.next(",", ">") == ",":
                self.next(), self.next(">")
            return List(element, None)
        while word + " " + self.peek() in IDL_NUMBERS or word == "unsigned":
            word += " " + self.next()
        if word in IDL_NUMBERS:
            return Number(IDL_NUMBERS[word])
        while self.peek() == "::":
            word += self.next() + self.next()
        for depth in range(len(self.scope), -1, -1):
            found = self.types.get("::".join(self.scope[:depth] + [word]))
            if found is not None:
                return found
        raise ValueError(f"the schema has the type '{word}', which it does not define")


ROS_NUMBERS = {"bool": "?", "byte": "u1", "char": "u1", "float32": "f4", "float64": "f8", "int8": "i1", "uint8": "u1",
               "int16": "i2", "uint16": "u2", "int32": "i4", "uint32": "u4", "int64": "i8", "uint64": "u8"}


def parse_ros2msg(name, text):
    """Definitions of ROS 2, those referred to after lines of '='; gives the struct of `name`."""
    main = current = name.replace("/msg/", "/")
    texts = {main: ""}
    for line in text.splitlines():
        if re.fullmatch(r"=+", line):
            current = None
        elif current is None:
            current = line.removeprefix("MSG:").strip().replace("/msg/", "/")
            texts[current] = ""
        else:
            texts[current] += line.split("#")[0].strip() + "\n"

    def kind_of(word, package):
        array = re.fullmatch(r"(.*)\[(<=)?(\d*)\]", word)
        if array:
            fixed = array[3] and not array[2]
            return List(kind_of(array[1], package), int(array[3]) if fixed else None)
        if re.fullmatch(r"string(<=\d+)?", word):
            return Text()
        if word in ROS_NUMBERS:
            return Number(ROS_NUMBERS[word])
        for full in (word.replace("/msg/", "/"), package + "/" + word, "std_msgs/" + word):
            if full in texts:
                return struct_of(full)
        raise ValueError(f"the schema has the type '{word}', which it does not define")

    def struct_of(full):
        members = []
        for line in texts[full].splitlines():
            words = line.split()
            if len(words) >= 2 and "=" not in words[1] and not (len(words) > 2 and words[2].startswith("=")):
                members.append((words[1], kind_of(words[0], full.split("/")[0])))
        return Struct(members)

    return struct_of(main)


def parse_schema(name, encoding, data):
    text = data.decode(errors="replace")
    if encoding == "ros2msg":
        return parse_ros2msg(name, text)
    if encoding == "omgidl":
        types = IdlParser(text).types
        if not isinstance(types.get(name), Struct):
            raise ValueError(f"the schema does not define the struct '{name}'")
        return types[name]
    raise ValueError(f"the schema is '{encoding}', expected omgidl or ros2msg")


# ---- messages


class Column:
    """A field as an array: where its values are in messages of one layout, and what limits its entries."""

    def __init__(self, path, kind, lists):
        self.path, self.kind, self.lists = path, kind, lists
        self.limited_by = None  # path of the count, and the axis that it limits


def columns_of(kind, path="", lists=0, out=None):
    out = [] if out is None else out
    if isinstance(kind, Struct):
        count = None
        for name, member in kind.members:
            inner = f"{path}.{name}" if path else name
            first = len(out)
            columns_of(member, inner, lists, out)
            if count and isinstance(member, List) and member.count is not None:
                for column in out[first:]:
                    column.limited_by = column.limited_by or (count, lists + 1)
            if count is None and isinstance(member, Number) and member.is_octet and name.endswith("_count"):
                count = inner
    elif isinstance(kind, List):
        columns_of(kind.element, path, lists + 1, out)
    else:
        out.append(Column(path, kind, lists))
    return out


def check_encoding(payload):
    if payload[:2] not in (b"\0\0", b"\0\1"):
        raise ValueError(f"a message has encoding {int.from_bytes(payload[:2], 'big')}, expected plain CDR")


class Layout:
    """Where the values of a message are: segments (path, indices, offset, count, kind), equal for equal keys."""

    def __init__(self, kind, payload):
        self.payload, self.order = payload, "<" if payload[1] & 1 else ">"
        self.at, self.key, self.segments = 4, [self.order], []
        self.walk(kind, "", ())
        self.key, self.size = tuple(self.key), self.at
        if self.at > len(payload):
            raise ValueError(f"a message of {len(payload)} bytes ends early")

    def align(self, size):
        self.at = 4 + -(-(self.at - 4) // size) * size

    def count(self):
        self.align(4)
        if self.at + 4 > len(self.payload):
            raise ValueError(f"a message of {len(self.payload)} bytes ends early")
        (value,) = struct.unpack_from(self.order + "I", self.payload, self.at)
        self.at += 4
        if self.at + value > len(self.payload):
            raise ValueError(f"a message has a list of {value} entries, more than its bytes")
        self.key.append(value)
        return value

    def walk(self, kind, path, indices):
        if isinstance(kind, Struct):
            for name, member in kind.members:
                self.walk(member, f"{path}.{name}" if path else name, indices)
        elif isinstance(kind, List):
            count = self.count() if kind.count is None else kind.count
            if isinstance(kind.element, Number):
                if count:
                    self.number(kind.element, path, indices, count)
                return
            for index in range(count):
                self.walk(kind.element, path, indices + (index,))
        elif isinstance(kind, Text):
            size = self.count()
            self.segments.append((path, indices, self.at, max(size - 1, 0), kind))  # without its NUL
            self.at += size
        else:
            self.number(kind, path, indices, None)

    def number(self, kind, path, indices, count):
        self.align(kind.size)
        self.segments.append((path, indices, self.at, count, kind))
        self.at += kind.size * (1 if count is None else count)


def shapes_of(columns, layouts):
    """For each field the most entries that a layout has, and the bytes of the longest text."""
    shapes = {column.path: [0] * column.lists for column in columns}
    sizes = {column.path: 1 for column in columns}
    for layout in layouts:
        for path, indices, _, count, kind in layout.segments:
            lengths = [index + 1 for index in indices]
            if isinstance(kind, Text):
                sizes[path] = max(sizes[path], count)
            elif count is not None:
                lengths.append(count)
            shapes[path] = [max(pair) for pair in zip(shapes[path], lengths)]
    return shapes, sizes


def decode(kind, payloads):
    """Arrays by field path."""
    groups = {}  # key of a layout -> (layout, numbers of its messages)
    known = {}
    for row, payload in enumerate(payloads):
        check_encoding(payload)
        if kind.fixed and payload[1:2] in known and len(payload) >= known[payload[1:2]].size:
            layout = known[payload[1:2]]
        else:
            layout = known[payload[1:2]] = Layout(kind, payload)
        groups.setdefault(layout.key, (layout, []))[1].append(row)
    columns = columns_of(kind)
    shapes, sizes = shapes_of(columns, [layout for layout, _ in groups.values()])
    arrays = {}
    for column in columns:
        text = isinstance(column.kind, Text)
        dtype = np.dtype(f"S{sizes[column.path]}") if text else column.kind.dtype
        empty = np.nan if dtype.kind == "f" else b"" if text else 0
        arrays[column.path] = np.full([len(payloads)] + shapes[column.path], empty, dtype)
    for layout, rows in groups.values():
        size, all_rows = layout.size, np.asarray(rows)
        table = np.frombuffer(b"".join([payloads[row][:size] for row in rows]), np.uint8).reshape(len(rows), size)
        for path, indices, offset, count, of in layout.segments:
            entries = 1 if count is None else count
            if isinstance(of, Text):
                if count == 0:
                    continue
                values = np.ascontiguousarray(table[:, offset:offset + count]).view(f"S{count}")[:, 0]
                arrays[path][(all_rows,) + indices] = values
                continue
            raw = np.ascontiguousarray(table[:, offset:offset + entries * of.size])
            values = raw != 0 if of.is_bool else raw.view(of.dtype.newbyteorder(layout.order))
            if count is None:
                arrays[path][(all_rows,) + indices] = values[:, 0]
            else:
                arrays[path][(all_rows,) + indices + (slice(count),)] = values
    for column in columns:
        if column.limited_by:
            path, axis = column.limited_by
            arrays[column.path] = cut(arrays[column.path], arrays[path], axis)
    return arrays


def cut(array, counts, axis):
    """The entries in use: `counts` of them along the axis; what a row uses less is emptied."""
    if len(counts) == 0:
        return array
    unused = np.arange(array.shape[axis]) >= counts[..., np.newaxis]
    array[unused] = np.nan if array.dtype.kind == "f" else b"" if array.dtype.kind == "S" else 0
    return array.take(range(min(int(counts.max()), array.shape[axis])), axis)


def decode_one(kind, payload):
    """A message as a dict, enums by their labels: what `sinew echo --json` prints."""
    check_encoding(payload)
    order, at = "<" if payload[1] & 1 else ">", 4

    def numbers(of, count):
        nonlocal at
        begin = 4 + -(-(at - 4) // of.size) * of.size if count else at
        at = begin + count * of.size
        if at > len(payload):
            raise ValueError(f"a message of {len(payload)} bytes ends early")
        values = struct.unpack_from(f"{order}{count}{of.char}", payload, begin)
        if of.labels:
            return [of.labels[value] if value < len(of.labels) else value for value in values]
        return list(values)

    def build(of):
        nonlocal at
        if isinstance(of, Struct):
            return {name: build(member) for name, member in of.members}
        if isinstance(of, List):
            count = numbers(COUNT, 1)[0] if of.count is None else of.count
            if isinstance(of.element, Number):
                return numbers(of.element, count)
            return [build(of.element) for _ in range(count)]
        if isinstance(of, Text):
            size = numbers(COUNT, 1)[0]
            at += size
            return payload[at - size:at - 1].decode(errors="replace")
        return numbers(of, 1)[0]

    return build(kind)


# ---- the container


def decompress(compression, data, size):
    if compression == "":
        return data
    if compression == "zstd":
        try:
            import zstandard
        except ImportError:
            raise ValueError("chunks are compressed with zstd: apt-get install python3-zstandard") from None
        return zstandard.ZstdDecompressor().decompress(data, max_output_size=size)
    if compression == "lz4":
        try:
            import lz4.frame
        except ImportError:
            raise ValueError("chunks are compressed with lz4: apt-get install python3-lz4") from None
        return lz4.frame.decompress(data)
    raise ValueError(f"chunks are compressed with '{compression}', expected zstd, lz4 or nothing")


def bytes_at(data, at):
    (size,) = struct.unpack_from("<I", data, at)
    if at + 4 + size > len(data):
        raise ValueError("a record ends inside a text")
    return data[at + 4:at + 4 + size], at + 4 + size


def text_at(data, at):
    text, end = bytes_at(data, at)
    return text.decode(errors="replace"), end


def map_at(data, at):
    (size,) = struct.unpack_from("<I", data, at)
    end, values = at + 4 + size, {}
    at += 4
    while at < end:
        key, at = text_at(data, at)
        values[key], at = text_at(data, at)
    return values, at


# ---- ticks of joint_state: (log time, session, tick, stamp)


def grow(ticks):
    """Whether no session has an earlier tick after a later one."""
    last = {}
    for _, session, tick, _ in ticks:
        if tick < last.get(session, 0):
            return False
        last[session] = tick
    return True


def span_of(ticks):
    """Nanoseconds from the first stamp to the last: sessions follow one another, and each goes on by the step before
    where its clock was set back (components/record/recording/session_clock.h)."""
    sessions = {}
    for _, session, tick, stamp in ticks:
        sessions.setdefault(session, {}).setdefault(tick, stamp)
    start = end = None
    for stamps in sessions.values():
        first_tick, *later = sorted(stamps)
        tick_before, time, step, shift = first_tick, stamps[first_tick], 0, 0
        for tick in later:
            if stamps[tick] + shift < time:
                shift = time + (tick - tick_before) * step - stamps[tick]
            else:
                step = (stamps[tick] + shift - time) // (tick - tick_before)
            tick_before, time = tick, stamps[tick] + shift
        start = stamps[first_tick] if start is None else start
        end = time + max(0, (stamps[first_tick] if end is None else end) - stamps[first_tick])
    return end - start


class Message(NamedTuple):
    """A message of any topic: what iterating over a Recording gives."""

    topic: str
    log_time_ns: int
    publish_time_ns: int
    content: dict

    def __repr__(self):
        """The values on a line of 79 columns; as a whole: content."""
        values = ", ".join(f"{name}={value!r}" for name, value in self.content.items() if name != "header")
        text = f"<Message {self.topic}, stamp {1e-9 * self.publish_time_ns:.6f} s: {values}"
        return (text if len(text) < 79 else text[:74] + " ...") + ">"


class Recording:
    """A recording, read as a whole into memory; topics: only these.

    Attributes: path; profile; metadata (record name -> dict); cut_off (the file lacks its end, as after a power cut:
    what is whole is here); left_out (topic -> why: other encodings than CDR). Raises OSError, and RecordingError for a
    file that is broken; warns once of topics that are left out.

    Iterating gives every Message in the order of log_time, or, where the clock of the robot was set back, in that of
    the file, in which ticks grow; len() is their number; `in` asks for a topic.
    """

    def __init__(self, path, topics=None):
        self.path = Path(path)
        self.profile, self.metadata, self.cut_off, self.left_out = "", {}, False, {}
        self._wanted = None if topics is None else set(topics)
        self._schemas, self._channels, self._messages, self._types = {}, {}, {}, {}
        self._places = itertools.count()
        self._states, self._ticks = set(), []  # channels of joint_state; (log time, session, tick, stamp) of its messages
        data = self.path.read_bytes()
        try:
            self._read(data)
        except (ValueError, struct.error) as error:
            raise RecordingError(f"{self.path}: {error}") from error
        for topic in sorted((self._wanted or set()) - set(self.topics)):
            raise RecordingError(f"{self.path}: {self._absence(topic)}")
        if self._wanted is None and self.left_out:
            topics = "; ".join(f"'{topic}' has {why}" for topic, why in sorted(self.left_out.items()))
            warnings.warn(f"{self.path}: topics are left out: {topics}", stacklevel=2)
        in_time = sorted(self._ticks, key=lambda one: one[0])
        self._set_back = not grow(in_time)
        self._ticks = self._ticks if self._set_back else in_time
        mode = self.metadata.get("sinew.recording", {}).get("mode")
        self._simulated = mode == "lockstep" or mode is None and any(
            stamp < LEAST_EPOCH_NS <= log_time for log_time, _, _, stamp in self._ticks)

    @property
    def topics(self):
        """Names, each once, whatever number of writers it had."""
        return sorted({topic for topic, _ in self._channels.values()})

    @property
    def counts(self):
        """Topic -> number of its messages."""
        counts = dict.fromkeys(self.topics, 0)
        for channel, (topic, _) in self._channels.items():
            counts[topic] += len(self._messages[channel])
        return counts

    @property
    def duration_s(self):
        """As `sinew list` prints it: from the first log_time to the last; of a recording in lockstep, and where the
        clock was set back, by the stamps of joint_state, sessions one after the other."""
        if self._ticks and (self._simulated or self._set_back):
            return 1e-9 * span_of(self._ticks)
        return self._span_s(0)

    @property
    def stamps_s(self):
        """From the first publish_time to the last."""
        return self._span_s(1)

    def _span_s(self, column):
        times = [message[column] for messages in self._messages.values() for message in messages]
        return 1e-9 * (max(times) - min(times)) if times else 0.0

    def __len__(self):
        return sum(map(len, self._messages.values()))

    def __bool__(self):
        return True  # a recording without messages is one, too

    def __repr__(self):
        counts = self.counts
        length = f"{self.duration_s:.4g} s" + (" simulated" if self._simulated else "")
        lines = [f"<Recording {self.path.name}: {length}, {len(self)} messages, {len(counts)} topics"
                 + (", cut off" if self.cut_off else "") + ">"]
        width, digits = max(map(len, counts), default=0), len(str(max(counts.values(), default=0)))
        for topic, count in counts.items():
            lines.append(f"  {topic:<{width}}  {count:>{digits}}  {self._type_name(topic).split('::')[-1]}")
        lines += [f"  left out: {topic} has {why}" for topic, why in sorted(self.left_out.items())]
        return "\n".join(lines)

    def _type_name(self, topic):
        """The type of its first writer; empty without a schema."""
        schema = next(schema for name, schema in self._channels.values() if name == topic)
        return self._schemas.get(schema, ("",))[0]

    def __iter__(self):
        """Topics whose schema cannot be read are left out, with a warning that names them."""
        readable, unreadable = [], []
        for topic in self.topics:
            try:
                self._of(topic)
                readable.append(topic)
            except RecordingError as error:
                unreadable.append(str(error))
        if unreadable:
            warnings.warn("topics are left out: " + "; ".join(unreadable), stacklevel=2)
        merged = heapq.merge(*map(self._placed, readable), key=lambda one: one[0])
        return (message for _, message in merged)

    def __contains__(self, topic):
        return topic in self.topics

    def __getitem__(self, topic):
        """Arrays of a topic by field path, and "log_time_ns", "publish_time_ns"; rows in the order of iterating."""
        kind, messages = self._of(topic)
        try:
            arrays = {"log_time_ns": np.array([message[0] for message in messages], np.int64),
                      "publish_time_ns": np.array([message[1] for message in messages], np.int64)}
            return arrays | decode(kind, [message[2] for message in messages])
        except (ValueError, IndexError) as error:
            raise RecordingError(f"{self.path}: topic '{topic}': {error}") from error

    def messages(self, topic):
        """One message after the other as dicts, enums by their labels, all entries of fixed arrays."""
        for _, message in self._placed(topic):
            yield message.content

    def _place(self, message):
        """What messages are ordered by: log time, then place in the file."""
        return (0 if self._set_back else message[0], message[3])

    def _placed(self, topic):
        """(place, Message) one after the other."""
        kind, messages = self._of(topic)
        for message in messages:
            log_time, publish_time, payload, _ = message
            try:
                yield self._place(message), Message(topic, log_time, publish_time, decode_one(kind, payload))
            except (ValueError, IndexError) as error:
                raise RecordingError(f"{self.path}: topic '{topic}': {error}") from error

    def labels(self, topic, field):
        """Names of the numbers of an enum, from 0 on; raises KeyError for a field that is none."""
        for column in columns_of(self._of(topic)[0]):
            if column.path == field and isinstance(column.kind, Number) and column.kind.labels:
                return list(column.kind.labels)
        raise KeyError(f"topic '{topic}' has no enum '{field}'")

    def _absence(self, topic):
        if topic in self.left_out:
            return f"topic '{topic}' has {self.left_out[topic]}"
        return f"no topic '{topic}', expected one of: {', '.join(self.topics)}"

    def _of(self, topic):
        ids = [channel for channel, (name, _) in self._channels.items() if name == topic]
        if not ids:
            raise KeyError(f"{self.path}: {self._absence(topic)}")
        messages = [message for channel in ids for message in self._messages.get(channel, [])]
        messages.sort(key=self._place)
        if topic not in self._types:
            schema = self._schemas.get(self._channels[ids[0]][1])
            try:
                if schema is None:
                    raise ValueError("it has no schema")
                self._types[topic] = parse_schema(*schema)
            except ValueError as error:
                raise RecordingError(f"{self.path}: topic '{topic}': {error}") from error
        return self._types[topic], messages

    def _read(self, data):
        if not data.startswith(MAGIC):
            raise ValueError("is no MCAP file, expected its magic bytes at the beginning")
        at, ended = len(MAGIC), False
        while at + RECORD_HEAD.size <= len(data) and not ended:
            opcode, size = RECORD_HEAD.unpack_from(data, at)
            at += RECORD_HEAD.size
            if at + size > len(data):
                break
            self._record(opcode, data[at:at + size])
            at += size
            ended = opcode in (DATA_END, FOOTER)  # what follows repeats schemas and channels
        self.cut_off = not ended

    def _record(self, opcode, body):
        if opcode == HEADER:
            self.profile = text_at(body, 0)[0]
        elif opcode == SCHEMA:
            (number,) = struct.unpack_from("<H", body, 0)
            name, at = text_at(body, 2)
            encoding, at = text_at(body, at)
            self._schemas[number] = (name, encoding, bytes_at(body, at)[0])
        elif opcode == CHANNEL:
            number, schema = struct.unpack_from("<HH", body, 0)
            topic, at = text_at(body, 4)
            encoding, _ = text_at(body, at)
            if topic == "joint_state" and self._schemas.get(schema, ("",))[0] == "sinew::msg::JointState":
                self._states.add(number)
            if encoding != "cdr":
                self.left_out[topic] = f"messages '{encoding}', expected cdr"
            elif self._wanted is None or topic in self._wanted:
                self._channels[number] = (topic, schema)
                self._messages.setdefault(number, [])
        elif opcode == MESSAGE:
            self._message(body, 0, len(body))
        elif opcode == CHUNK:
            self._chunk(body)
        elif opcode == METADATA:
            name, at = text_at(body, 0)
            self.metadata[name] = map_at(body, at)[0]

    def _message(self, data, at, end):
        channel, _, log_time, publish_time = MESSAGE_HEAD.unpack_from(data, at)
        start = at + MESSAGE_HEAD.size
        if channel in self._states and end - start >= 20:  # the header is its first member
            session, tick = struct.unpack_from("<QQ" if data[start + 1] & 1 else ">QQ", data, start + 4)
            self._ticks.append((log_time, session, tick, publish_time))
        if channel in self._messages:
            self._messages[channel].append((log_time, publish_time, data[start:end], next(self._places)))

    def _chunk(self, body):
        _, _, size, crc = struct.unpack_from("<QQQI", body, 0)
        compression, at = text_at(body, 28)
        records = decompress(compression, body[at + 8:], size)
        if len(records) != size or (crc != 0 and zlib.crc32(records) != crc):
            raise ValueError("a chunk is damaged: its checksum is another one")
        at = 0
        while at < size:
            opcode, length = RECORD_HEAD.unpack_from(records, at)
            at += RECORD_HEAD.size
            if at + length > size:
                raise ValueError("a chunk ends inside a record")
            if opcode == MESSAGE:
                self._message(records, at, at + length)
            else:
                self._record(opcode, records[at:at + length])
            at += length
