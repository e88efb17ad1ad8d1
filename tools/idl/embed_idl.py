#!/usr/bin/env python3
"""Flattens idl/*.idl and writes them as a C++ source, one entry per top-level struct.

Usage: embed_idl.py OUTPUT.cc FILE.idl...
The hash is over the text without comments and white space, so that a comment may change and a field not.
"""
import os
import re
import sys


def flatten(path, seen):
    """Text of a file after the text of what it includes, each file once."""
    if path in seen:
        return ""
    seen.add(path)
    parts = []
    with open(path, encoding="utf-8") as source:
        for line in source:
            include = re.match(r'\s*#include\s+"([^"]+)"', line)
            if include:
                parts.append(flatten(os.path.join(os.path.dirname(path), include.group(1)), seen))
            else:
                parts.append(line)
    return "".join(parts)


def fnv1a(text):
    value = 0x811C9DC5
    for byte in text.encode():
        value = ((value ^ byte) * 0x01000193) & 0xFFFFFFFF
    return f"{value:08x}"


def entries_of(path):
    """(struct, flattened text, hash) of every struct of a file."""
    with open(path, encoding="utf-8") as source:
        structs = re.findall(r"^struct\s+(\w+)", source.read(), re.M)
    text = flatten(path, set())
    bare = re.sub(r"\s+", "", re.sub(r"//[^\n]*", "", text))
    return [(name, text, fnv1a(name + bare)) for name in structs]


def main():
    output, files = sys.argv[1], sys.argv[2:]
    entries = [entry for path in files for entry in entries_of(path)]
    with open(output, "w", encoding="utf-8") as out:
        out.write('// Generated from idl/ by tools/idl/embed_idl.py.\n#include "idl/embedded_idl.h"\n\n')
        out.write("namespace sinew::idl {\n\nconst std::vector<EmbeddedType>& EmbeddedTypes() {\n")
        out.write("  static const std::vector<EmbeddedType> kTypes = {\n")
        for name, text, digest in entries:
            out.write(f'      {{"sinew::msg::{name}",\n       R"idl({text})idl",\n       "{digest}"}},\n')
        out.write("  };\n  return kTypes;\n}\n\n}  // namespace sinew::idl\n")


if __name__ == "__main__":
    main()
