"""Validates the shipped configurations against their JSON schemas, and that broken ones are refused.

    check_schemas.py ROOT      77: python3-jsonschema or python3-yaml is not there
"""

import json
import pathlib
import re
import sys

try:
    import jsonschema
    import yaml
except ImportError as error:
    print(error)
    sys.exit(77)


class Yaml12(yaml.SafeLoader):
    """YAML 1.2, as yaml-cpp and editors read it: `off` is a text, 1e-4 a number."""


Yaml12.yaml_implicit_resolvers = {}
for tag, pattern, first in (
    ("bool", r"true|false", "tf"),
    ("int", r"[-+]?[0-9]+", "-+0123456789"),
    ("float", r"[-+]?(\.[0-9]+|[0-9]+(\.[0-9]*)?)([eE][-+]?[0-9]+)?|\.nan|[-+]?\.inf", "-+0123456789."),
    ("null", r"null|~|", "n~"),
):
    Yaml12.add_implicit_resolver("tag:yaml.org,2002:" + tag, re.compile("^(%s)$" % pattern), list(first))
Yaml12.add_constructor("tag:yaml.org,2002:int", lambda loader, node: int(node.value))
Yaml12.add_constructor("tag:yaml.org,2002:float", lambda loader, node: float(node.value))


def load_schemas(root):
    schemas = {}
    for path in sorted((root / "schemas").glob("*.json")):
        schema = json.loads(path.read_text())
        jsonschema.Draft7Validator.check_schema(schema)
        schemas[schema["title"]] = (path, jsonschema.Draft7Validator(schema))
    return schemas


def complaints_of(path, schemas):
    """Of a file with a schema; None: it has no described one."""
    content = yaml.load(path.read_text(), Yaml12)
    if not isinstance(content, dict) or content.get("schema") not in schemas:
        return None
    file, validator = schemas[content["schema"]]
    found = ["%s: %s: %s" % (path, ".".join(map(str, e.absolute_path)), e.message[:200]) for e in validator.iter_errors(content)]
    first = path.read_text().split("\n", 1)[0]
    if "robots" in path.parts:
        mode = "# yaml-language-server: $schema="
        if not first.startswith(mode):
            found.append("%s: does not begin with '%s'" % (path, mode))
        elif (path.parent / first[len(mode):]).resolve() != file.resolve():
            found.append("%s: names another schema than %s" % (path, file))
    return found


def main():
    root = pathlib.Path(sys.argv[1])
    schemas = load_schemas(root)
    faults, seen = [], 0
    for folder in ("robots", "bench"):
        for path in sorted((root / folder).rglob("*.yaml")):
            found = complaints_of(path, schemas)
            seen += found is not None
            faults += found or []
    broken = sorted((root / "tests/tools/schema/broken").glob("*.yaml"))
    faults += ["%s: accepted" % path for path in broken if not complaints_of(path, schemas)]
    print("\n".join(faults))
    print("%d schemas, %d files, %d broken ones, %d faults" % (len(schemas), seen, len(broken), len(faults)))
    return 1 if faults or not seen or not broken else 0


if __name__ == "__main__":
    sys.exit(main())
