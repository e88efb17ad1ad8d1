#!/usr/bin/env python3
"""The topics: reads the first table of idl/README.md, a row per topic, and the structs of the idl files it names.

Usage: topics.py README.md subjects      prints the idl files (without .idl), those they include first
       topics.py README.md messages DIR  writes DIR/FILE.h of each idl file: its enumerations and plain structs
       topics.py README.md headers DIR   writes DIR/topic_list.h, DIR/all_messages.h and DIR/topic_parties.h
       topics.py README.md types FILE    writes a header for C: the registered name of every topic's type
"""
import os
import re
import sys

import embed_idl

COLUMNS = ["topic", "type", "file", "writer", "readers", "rate", "QoS"]
PROFILES = ["state", "control", "event", "latched", "lockstep"]
GENERATED = "// Generated from idl/README.md by tools/idl/topics.py."


def camel(name):
    return "k" + "".join(word.capitalize() for word in name.split("_"))


def parties(cell):
    """(party, always) of a cell: "regime (set-up), experiments" is regime, not always, and experiments."""
    found = []
    for word in re.split(r",\s*", cell.replace("`", "")):
        name, condition = re.fullmatch(r"(.*?)\s*(\(.*\))?", word).groups()
        if name != "-":
            found.append((name, condition is None))
    return found


class Topic:
    def __init__(self, cells):
        self.name, self.type, self.file, self.profile = cells[0], cells[1], cells[2], cells[6]
        self.writers, self.readers = parties(cells[3]), parties(cells[4])

    @property
    def constant(self):
        return camel(self.name)


def read(path):
    with open(path, encoding="utf-8") as source:
        return source.read()


def includes(path):
    return re.findall(r'^\s*#include\s+"(\w+)\.idl"', read(path), re.M)


def read_table(readme):
    """Topics in the order of the table. Exits with one line, FILE:LINE: reason, where the table is wrong."""
    folder, topics, in_table = os.path.dirname(os.path.abspath(readme)), [], False
    for number, line in enumerate(read(readme).splitlines(), 1):
        cells = [cell.strip() for cell in line.strip().strip("|").split("|")]
        if not in_table:
            in_table = cells == COLUMNS
            continue
        if not line.startswith("|"):
            break
        if set(line) <= set("|- "):
            continue

        def check(condition, reason):
            if not condition:
                sys.exit(f"{readme}:{number}: {reason}")

        check(len(cells) == len(COLUMNS), f"{len(cells)} cells, expected {len(COLUMNS)}: {', '.join(COLUMNS)}")
        topic = Topic(cells)
        check(re.fullmatch(r"[a-z][a-z0-9]*(_[a-z0-9]+)*", topic.name), f"topic '{topic.name}', expected lower_case")
        check(topic.name not in [known.name for known in topics], f"topic '{topic.name}' is there twice")
        check(topic.profile in PROFILES, f"QoS '{topic.profile}', expected one of: {', '.join(PROFILES)}")
        path = os.path.join(folder, topic.file + ".idl")
        check(os.path.exists(path), f"topic '{topic.name}': no file {topic.file}.idl")
        body = re.search(rf"^struct\s+{topic.type}\s*{{(.*?)}}", read(path), re.M | re.S)
        check(body, f"topic '{topic.name}': {topic.file}.idl has no struct {topic.type}")
        topic.begins_with_header = re.match(r"\s*Header\s+header\s*;", body.group(1)) is not None
        topics.append(topic)
    if not topics:
        sys.exit(f"{readme}: no table with the columns {', '.join(COLUMNS)}")
    return topics


def subjects(readme, topics):
    """Idl files in the order in which they are needed."""
    folder, files = os.path.dirname(os.path.abspath(readme)), []

    def add(file):
        if file in files:
            return
        for inner in includes(os.path.join(folder, file + ".idl")):
            add(inner)
        files.append(file)

    for topic in topics:
        add(topic.file)
    return files


def commanding(readme, topics):
    """The names of the paragraph `Commanding topics:`, each one a topic."""
    paragraph = re.search(r"^Commanding topics:(.*?)\.", read(readme), re.M | re.S)
    if not paragraph:
        sys.exit(f"{readme}: no paragraph that begins with 'Commanding topics:'")
    names = re.findall(r"`(\w+)`", paragraph.group(1))
    for name in names:
        if name not in [topic.name for topic in topics]:
            sys.exit(f"{readme}: commanding topic '{name}' is not in the table")
    return names


def unique(items):
    return list(dict.fromkeys(items))


def list_macro(name, what, items):
    lines = "".join(f" \\\n  X({item})" for item in items)
    return f"// {what}\n#define {name}(X){lines}\n"


def topic_list(topics, commands):
    types = unique(topic.type for topic in topics)
    without = unique(topic.type for topic in topics if not topic.begins_with_header)
    lines = [GENERATED, "// Included by components/topics/node/topics.h: a constant per topic.", "#pragma once", "",
             "#include <array>", "#include <string_view>", "",
             '#include "components/topics/node/topic.h"', "", "namespace sinew::msg {"]
    lines += [f"struct {type_};" for type_ in types]
    lines += ["}  // namespace sinew::msg", "", "namespace sinew::node {", ""]
    lines += [f"inline constexpr Topic<msg::{topic.type}> {topic.constant}{{\"{topic.name}\", "
              f"Profile::{camel(topic.profile)}}};" for topic in topics]
    lines += [""] + [f"template <>\ninline constexpr bool kBeginsWithHeader<msg::{type_}> = false;"
                     for type_ in without]
    names = "".join(f'\n    "{name}",' for name in commands)
    lines += ["", "// What they say can move the robot; a player sends them only when they are named.",
              f"inline constexpr std::array<std::string_view, {len(commands)}> kCommandingTopics = {{{names}}};"]
    lines += ["", "}  // namespace sinew::node", ""]
    lines += [list_macro("SINEW_FOR_EACH_TOPIC", "Every topic, in the order of the table.",
                         [topic.constant for topic in topics])]
    return "\n".join(lines)


def all_messages(files, topics):
    lines = [GENERATED, "// Every message, for explicit instantiation. Internal to this module.", "#pragma once", ""]
    lines += [f"#include <sinew_idl/{file}.h>" for file in files] + [""]
    lines += [list_macro("SINEW_FOR_EACH_MESSAGE", "Every message type.", unique(topic.type for topic in topics))]
    lines += [list_macro("SINEW_FOR_EACH_HEADED_MESSAGE", "Those that begin with their header.",
                         unique(topic.type for topic in topics if topic.begins_with_header))]
    return "\n".join(lines)


def topic_parties(topics):
    rows = [f'    {{"{topic.name}", "{party}", {access}, {str(always).lower()}}},'
            for topic in topics for parties_, access in ((topic.writers, "Access::kWrites"), (topic.readers, "Access::kReads"))
            for party, always in parties_]
    lines = [GENERATED, "// Who writes and reads a topic, in the words of the table: a role, a kind of program, \"all\".",
             "#pragma once", "", "#include <array>", "#include <string_view>", "", "namespace sinew::node {", "",
             "enum class Access { kWrites, kReads };", "",
             "struct TopicParty {", "  std::string_view topic, party;", "  Access access;",
             "  bool always;  // false: only under the condition in parentheses", "};", "",
             f"inline constexpr std::array<TopicParty, {len(rows)}> kTopicParties = {{{{"] + rows + ["}};", ""]
    return "\n".join(lines + ["}  // namespace sinew::node", ""])


SCALARS = {"boolean": "bool", "octet": "std::uint8_t", "short": "std::int16_t", "unsigned short": "std::uint16_t",
           "long": "std::int32_t", "unsigned long": "std::uint32_t", "long long": "std::int64_t",
           "unsigned long long": "std::uint64_t", "float": "float", "double": "double"}
FIELD = re.compile(r"(?P<key>@key\s+)?(?:sequence<\s*(?P<element>\w[\w\s]*?)\s*,\s*(?P<most>\d+)\s*>|string<\s*(?P<longest>\d+)\s*>|"
                   r"(?P<type>\w[\w\s]*?))\s+(?P<name>\w+)(?:\[(?P<size>\d+)\])?")


def without_comments(text):
    return re.sub(r"//.*", "", text)


def fields_of(path, struct, body, types):
    """(name, C++ type, most, key) of every field; most: of a count, a sequence or a text, 0: not bounded."""
    fields, sizes = [], []
    for member in filter(None, (" ".join(member.split()) for member in body.split(";"))):
        field = FIELD.fullmatch(member)
        if not field:
            sys.exit(f"{path}: struct {struct}: '{member}', expected a type and a name")
        element = field["element"] or field["type"]
        if element and element not in types:
            sys.exit(f"{path}: struct {struct}: no type '{element}'")
        kind, most = types.get(element), 0
        if field["element"]:
            kind, most = f"std::vector<{kind}>", int(field["most"])
        elif field["longest"]:
            kind, most = "std::string", int(field["longest"])
        elif field["size"]:
            kind = f"std::array<{kind}, {field['size']}>"
            sizes.append(int(field["size"]))
        fields.append([field["name"], kind, most, field["key"] is not None])
    for field in fields:
        if field[1] == "std::uint8_t" and field[0].endswith("_count") and sizes:
            field[2] = min(sizes)
    return fields


def enum_of(name, values):
    """Its names are those of the idl without the words that all begin with: ROBOT_ARMED is kArmed, for people "armed"."""
    words = [value.split("_") for value in values]
    shared = len(os.path.commonprefix([each[:-1] for each in words]))
    names = ["_".join(each[shared:]) for each in words]
    texts = ", ".join(f'"{each.lower()}"' for each in names)
    return [f"enum class {name} : std::uint32_t {{ {', '.join(map(camel, names))} }};",
            f"constexpr std::uint32_t CountOf({name}) noexcept {{ return {len(values)}; }}  // enumerators",
            f"constexpr const char* NameOf({name} value) noexcept {{",
            f"  constexpr const char* kNames[] = {{{texts}}};",
            f'  return value < {name}{{{len(values)}}} ? kNames[static_cast<std::size_t>(value)] : "unknown";', "}", ""]


def struct_of(name, fields):
    lines = [f"struct {name} {{"] + [f"  {kind} {field}{{}};" for field, kind, _, _ in fields]
    keys = [field for field, _, _, key in fields if key]
    lines += ["", f'  static constexpr std::string_view kIdlName = "sinew::msg::{name}";',
              f'  static constexpr std::string_view kKey = "{"".join(keys)}";  // the field that is the key; empty: none',
              f"  bool operator==(const {name}&) const = default;", "  template <class Message, class Visit>",
              "  static void Fields(Message& message, Visit&& visit) {"]
    lines += [f'    visit("{field}", message.{field}, {most});' for field, _, most, _ in fields]
    return "\n".join(lines + ["  }", "};", ""])


def messages(readme, files):
    """For each idl file its header: enumerations and plain structs, whose Fields calls a visitor for every field."""
    folder, types, headers = os.path.dirname(os.path.abspath(readme)), dict(SCALARS), {}
    for file in files:
        path = os.path.join(folder, file + ".idl")
        text = without_comments(read(path))
        lines = [f"// Generated from idl/{file}.idl, which has meaning and units, by tools/idl/topics.py.",
                 "// NameOf: an enumerator as people read it; \"unknown\": a number without a name.",
                 "// Fields calls visit(name, field, most) for every field in turn. most: the largest value of a count, the most",
                 "// elements of a sequence or bytes of a text; 0: not bounded.", "#pragma once", "", "#include <array>",
                 "#include <cstddef>", "#include <cstdint>", "#include <string>", "#include <string_view>", "#include <vector>", ""]
        lines += [f"#include <sinew_idl/{inner}.h>" for inner in includes(path)] + ["", "namespace sinew::msg {", ""]
        for kind, name, body in re.findall(r"\b(enum|struct)\s+(\w+)\s*{(.*?)}", text, re.S):
            types[name] = name
            if kind == "enum":
                lines += enum_of(name, re.findall(r"\w+", body))
            else:
                lines += [struct_of(name, fields_of(path, name, body, types))]
        headers[file] = "\n".join(lines + ["}  // namespace sinew::msg", ""])
    return headers


def topic_types(readme, topics):
    folder, hashes = os.path.dirname(os.path.abspath(readme)), {}
    for topic in topics:
        entries = embed_idl.entries_of(os.path.join(folder, topic.file + ".idl"))
        hashes[topic.name] = next(digest for name, _, digest in entries if name == topic.type)
    lines = [GENERATED, "// For programs of other DDS implementations: registered names of types, which end with the hash of",
             "// their IDL, and idl_hash of component_status.", "#pragma once", "",
             f'#define SINEW_TOPICS_HASH "{embed_idl.fnv1a("".join(t.name + hashes[t.name] for t in topics))}"']
    lines += [f'#define SINEW_TYPE_{topic.name.upper()} "sinew::msg::{topic.type}_{hashes[topic.name]}"' for topic in topics]
    return "\n".join(lines + [""])


def write(path, text):
    """Leaves a file that is right alone, so that nothing is compiled again."""
    if not os.path.exists(path) or read(path) != text:
        with open(path, "w", encoding="utf-8") as out:
            out.write(text)


def main():
    readme, what = sys.argv[1:3]
    topics = read_table(readme)
    files = subjects(readme, topics)
    if what == "subjects":
        print(";".join(files), end="")
        return
    if what == "types":
        write(sys.argv[3], topic_types(readme, topics))
        return
    folder = sys.argv[3]
    os.makedirs(folder, exist_ok=True)
    if what == "messages":
        for file, header in messages(readme, files).items():
            write(os.path.join(folder, file + ".h"), header)
        return
    write(os.path.join(folder, "topic_list.h"), topic_list(topics, commanding(readme, topics)))
    write(os.path.join(folder, "all_messages.h"), all_messages(files, topics))
    write(os.path.join(folder, "topic_parties.h"), topic_parties(topics))


if __name__ == "__main__":
    main()
