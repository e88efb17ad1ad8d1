#!/usr/bin/env python3
"""The topics: reads the first table of idl/README.md, a row per topic, and the structs of the idl files it names.

Usage: topics.py README.md subjects      prints the idl files (without .idl), those they include first
       topics.py README.md headers DIR   writes DIR/topic_list.h, DIR/all_messages.h, DIR/all_codecs.h,
                                         DIR/all_checks.h and DIR/topic_parties.h
       topics.py README.md types FILE    writes a header for C: the registered name of every topic's type
"""
import os
import re
import sys

import embed_idl

COLUMNS = ["topic", "type", "file", "writer", "readers", "rate", "QoS"]
PROFILES = ["state", "control", "event", "latched"]
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
    lines += [f"class {type_};" for type_ in types]
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


def all_codecs(files):
    lines = [GENERATED, "// The types that encode and decode every message. Internal to this module.",
             "#pragma once", ""]
    return "\n".join(lines + [f"#include <sinew_idl/{file}PubSubTypes.h>" for file in files] + [""])


FIELD = re.compile(r"^\s*(?:@key\s+)?(sequence<\s*\w+(?:\s+\w+)*\s*,\s*(?P<most>\d+)\s*>|string<\s*(?P<longest>\d+)\s*>|"
                   r"(?P<type>\w+(?:\s+\w+)*))\s+(?P<name>\w+)(?:\[(?P<size>\d+)\])?\s*;", re.M)


def without_comments(text):
    return re.sub(r"//.*", "", text)


def check_of(struct, body, enums, structs):
    """The function that says whether every number of a message has a meaning."""
    fields = [field.groupdict() for field in FIELD.finditer(body)]
    sizes = [int(field["size"]) for field in fields if field["size"]]
    conditions = []
    for field in fields:
        value = f"m.{field['name']}()"
        if field["most"] or field["longest"]:
            conditions.append(f"{value}.size() <= {field['most'] or field['longest']}")
        elif field["type"] in enums:
            conditions.append(f"Named({value}, {len(enums[field['type']])})")
        elif field["type"] in structs:
            conditions.append(f"HasMeaning({value})")
        elif field["type"] == "octet" and field["name"].endswith("_count") and sizes:
            conditions.append(f"{value} <= {min(sizes)}")
    unused = "" if conditions else "[[maybe_unused]] "
    body = " &&\n         ".join(conditions or ["true"])
    return f"inline bool HasMeaning({unused}const msg::{struct}& m) {{\n  return {body};\n}}\n"


def all_checks(readme, files):
    folder, enums, structs, functions = os.path.dirname(os.path.abspath(readme)), {}, [], []
    for file in files:
        text = without_comments(read(os.path.join(folder, file + ".idl")))
        for name, values in re.findall(r"\benum\s+(\w+)\s*{(.*?)}", text, re.S):
            enums[name] = [value for value in re.split(r"[\s,]+", values) if value]
        for name, body in re.findall(r"\bstruct\s+(\w+)\s*{(.*?)}", text, re.S):
            functions.append(check_of(name, body, enums, structs))
            structs.append(name)
    lines = [GENERATED, "// Whether a decoded message means something: its enumerators have names, its counts fit their arrays,",
             "// its texts and sequences their bounds. Internal to this module.", "#pragma once", "",
             "#include <algorithm>", "#include <array>", "#include <cstddef>", "#include <cstdint>", "",
             '#include "components/topics/node/all_messages.h"', "", "namespace sinew::node::internal {", "",
             "template <class Enum>", "bool Named(Enum value, std::uint32_t names) {",
             "  return static_cast<std::uint32_t>(value) < names;", "}",
             "template <class Enum, std::size_t n>",
             "bool Named(const std::array<Enum, n>& values, std::uint32_t names) {",
             "  return std::all_of(values.begin(), values.end(), [names](Enum value) { return Named(value, names); });",
             "}", ""]
    return "\n".join(lines + functions + ["", "}  // namespace sinew::node::internal", ""])


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
    write(os.path.join(folder, "topic_list.h"), topic_list(topics, commanding(readme, topics)))
    write(os.path.join(folder, "all_messages.h"), all_messages(files, topics))
    write(os.path.join(folder, "all_codecs.h"), all_codecs(files))
    write(os.path.join(folder, "all_checks.h"), all_checks(readme, files))
    write(os.path.join(folder, "topic_parties.h"), topic_parties(topics))


if __name__ == "__main__":
    main()
