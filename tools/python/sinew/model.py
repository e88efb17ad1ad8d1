"""Model files of joints (sinew-model/1, docs/formats.md) as objects. What an effect means and which parameters it has
is known to the catalogue of the program: `sinew model show FILE` checks that."""
import math
import re
from pathlib import Path

import yaml

from . import text

__all__ = ["Joint", "Model", "ModelError", "Parameter", "Term", "load_model"]

SCHEMA = "sinew-model/1"
NUMBER = re.compile(r"[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)?")
LARGEST_FILE, MOST_VALUES = 16777216, 1048576  # bytes; values, aliases replaced; as docs/formats.md


class ModelError(ValueError):
    """A file that is no model: FILE:LINE, key and reason."""


class Parameter:
    """A value of a term. key: name and unit, as in the file; tolerance: share of the value, and tolerance_absolute:
    in its unit, standard deviations before a fit; fixed: never fitted; half_width_95: of the last fit, or None."""

    def __init__(self, key, value, tolerance=0.0, tolerance_absolute=0.0, fixed=False, half_width_95=None):
        self.key, self.value, self.fixed, self.half_width_95 = key, value, fixed, half_width_95
        self.tolerance, self.tolerance_absolute = tolerance, tolerance_absolute
        self.name, self.unit = text.split_key(key)

    @property
    def known(self):
        """How well the value is known, in words."""
        if self.fixed:
            return "fixed"
        if self.half_width_95 is not None:
            return f"fitted +- {text.number(self.half_width_95)}"
        if self.tolerance > 0:
            return f"within {100 * self.tolerance:.4g} %"
        if self.tolerance_absolute > 0:
            return "within " + text.quantity(self.tolerance_absolute, self.unit)
        return ""

    def __float__(self):
        return self.value

    def __repr__(self):
        return f"<Parameter {self.name} = {text.quantity(self.value, self.unit)} {self.known}".rstrip() + ">"


class Term:
    """An effect with its values; parameters: by key. declared: false for what close-loop added."""

    def __init__(self, effect, parameters, declared=True, balance=None):
        self.effect, self.parameters, self.declared, self.balance = effect, parameters, declared, balance

    def __getitem__(self, name):
        """A parameter by its key or by its name without the unit."""
        for key, parameter in self.parameters.items():
            if name in (key, parameter.name):
                return parameter
        raise KeyError(f"'{self.effect}' has no parameter '{name}', expected one of: {', '.join(self.parameters)}")

    def __repr__(self):
        values = ", ".join(f"{one.name} = {text.quantity(one.value, one.unit)}" for one in self.parameters.values())
        return f"<Term {self.effect}: {values}" + ("" if self.declared else "; added") + ">"


class Joint:
    """name, kind ("rotary" or "linear"), constants (key -> number), terms, history (dicts), data (all, as read)."""

    def __init__(self, data, terms):
        self.data, self.terms = data, terms
        self.name, self.kind = data["name"], data["kind"]
        self.constants, self.history = data["constants"], data["history"]

    def __getitem__(self, effect):
        """The first term of an effect."""
        for term in self.terms:
            if term.effect == effect:
                return term
        raise KeyError(f"joint '{self.name}' has no term '{effect}', expected one of: "
                       + ", ".join(dict.fromkeys(term.effect for term in self.terms)))

    def __contains__(self, effect):
        return any(term.effect == effect for term in self.terms)

    def __iter__(self):
        return iter(self.terms)

    def __repr__(self):
        rows = []
        limits = {key: value for key, value in self.data.items() if isinstance(value, (int, float))}
        for key, value in (self.constants | limits).items():
            name, unit = text.split_key(key)
            rows.append([name, value, unit, ""])
        for term in self.terms:
            for parameter in term.parameters.values():
                name = term.effect if parameter.name == term.effect else f"{term.effect}.{parameter.name}"
                known = parameter.known if term.declared else parameter.known.replace("fitted", "added")
                rows.append([name, parameter.value, parameter.unit, known])
            if not term.parameters:
                rows.append([term.effect, None, "", ""])
        return "\n".join([f"<Joint {self.name}, {self.kind}>"] + text.table(rows))


class Model:
    """path, name, joints, urdf (Path, or None), data (the whole file as dicts, lists, numbers and texts)."""

    def __init__(self, path, data, joints):
        self.path, self.data, self.joints = path, data, joints
        self.name = str(data["name"])
        self.urdf = path.parent / data["urdf"] if "urdf" in data else None

    def __getitem__(self, joint):
        """A joint by its name or number."""
        if isinstance(joint, int):
            return self.joints[joint]
        for one in self.joints:
            if one.name == joint:
                return one
        raise KeyError(f"{self.path}: no joint '{joint}', expected one of: {', '.join(j.name for j in self.joints)}")

    def __iter__(self):
        return iter(self.joints)

    def __len__(self):
        return len(self.joints)

    def __fspath__(self):
        return str(self.path)

    def __repr__(self):
        head = f"<Model {self.name} of {self.path.name}: {len(self)} joint" + ("s>" if len(self) != 1 else ">")
        if len(self) == 1:
            return f"{head}\n{self.joints[0]!r}"
        rows = []
        for joint in self.joints:
            added = ", ".join(term.effect for term in joint.terms if not term.declared)
            rows.append([joint.name, joint.kind, f"{len(joint.terms)} terms" + (f", added: {added}" if added else "")])
        effects = dict.fromkeys(term.effect for joint in self.joints for term in joint.terms)
        return "\n".join([head] + text.table(rows) + text.paragraph("terms: " + ", ".join(effects), "  "))


# ---- the file


class _File:
    """YAML nodes with their lines. Numbers as the programs read them: PyYAML takes 1e-4 for a text."""

    def __init__(self, path):
        self.path, self.values = path, 0

    def fail(self, node, reason):
        raise ModelError(f"{self.path}:{node.start_mark.line + 1 if node else 1}: {reason}")

    def root(self):
        if self.path.stat().st_size > LARGEST_FILE:
            self.fail(None, f"larger than {LARGEST_FILE} bytes")
        try:
            root = yaml.compose(self.path.read_text(encoding="utf-8"), yaml.SafeLoader)
        except yaml.YAMLError as error:
            mark = getattr(error, "problem_mark", None)
            reason = getattr(error, "problem", None) or str(error).splitlines()[0]
            raise ModelError(f"{self.path}:{mark.line + 1 if mark else 1}: is no YAML: {reason}") from None
        except UnicodeDecodeError:
            raise ModelError(f"{self.path}:1: is no text in UTF-8") from None
        return root

    def plain(self, node, key="", inside=()):
        if any(node is one for one in inside):
            self.fail(node, f"key '{key}': refers to itself")
        self.values += 1
        if self.values > MOST_VALUES:
            self.fail(node, f"more than {MOST_VALUES} values, aliases replaced")
        inside += (node,)
        if isinstance(node, yaml.MappingNode):
            return {name: self.plain(value, f"{key}.{name}" if key else name, inside)
                    for name, value in self.members(node, key).items()}
        if isinstance(node, yaml.SequenceNode):
            return [self.plain(value, f"{key}[{i}]", inside) for i, value in enumerate(node.value)]
        if node.style:  # quoted
            return node.value
        if node.value in ("true", "false"):
            return node.value == "true"
        if node.value in ("", "~", "null"):
            return None
        if not NUMBER.fullmatch(node.value):
            return node.value
        return int(node.value) if node.value.lstrip("+-").isdigit() else float(node.value)

    def members(self, node, key):
        members = {}
        for name, value in node.value:
            if not isinstance(name, yaml.ScalarNode):
                self.fail(name, f"key '{key}': expected a text as the key")
            if name.value in members:
                self.fail(name, f"key '{key + '.' if key else ''}{name.value}': given twice")
            members[name.value] = value
        return members

    def mapping(self, node, key, expected):
        if not isinstance(node, yaml.MappingNode):
            self.fail(node, f"{key}: expected {expected}")
        return self.members(node, key.split("'")[1] if "'" in key else "")

    def need(self, members, name, node, prefix, expected):
        if name not in members:
            self.fail(node, f"key '{prefix}{name}': missing, expected {expected}")
        return members[name]

    def number(self, node, key, expected="a number"):
        if not isinstance(node, yaml.ScalarNode):
            self.fail(node, f"key '{key}': expected {expected}")
        value = self.plain(node)
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            self.fail(node, f"key '{key}': '{node.value}', expected {expected}")
        return value


def _parameter(file, node, key, at):
    if isinstance(node, yaml.ScalarNode):
        return Parameter(key, float(file.number(node, at, "a number or {value, tolerance, fixed}")))
    members = file.mapping(node, f"key '{at}'", "a number or {value, tolerance, fixed}")
    out = Parameter(key, float(file.number(file.need(members, "value", node, at + ".", "a number"), at + ".value")))
    for name, value in members.items():
        where = f"{at}.{name}"
        if name == "tolerance" and isinstance(value, yaml.MappingNode):
            absolute = file.need(file.mapping(value, f"key '{where}'", "{absolute}"), "absolute", value, where + ".",
                                 "a number")
            out.tolerance_absolute = float(file.number(absolute, where + ".absolute"))
        elif name == "fixed":
            out.fixed = file.plain(value)
            if not isinstance(out.fixed, bool):
                file.fail(value, f"key '{where}': '{out.fixed}', expected true or false")
        elif name in ("tolerance", "half_width_95"):
            setattr(out, name, float(file.number(value, where)))
        elif name != "value":
            file.fail(value, f"key '{where}': unknown, expected value, tolerance, fixed or half_width_95")
    return out


def _term(file, node, at):
    members = file.mapping(node, f"key '{at}'", "an effect with its parameters")
    effect = file.plain(file.need(members, "effect", node, at + ".", "the name of an effect"))
    declared = file.plain(members["declared"]) if "declared" in members else True
    balance = file.plain(members["balance"]) if "balance" in members else None
    if not isinstance(declared, bool):
        file.fail(members["declared"], f"key '{at}.declared': '{declared}', expected true or false")
    parameters = {key: _parameter(file, value, key, f"{at}.{key}") for key, value in members.items()
                  if key not in ("effect", "declared", "balance")}
    return Term(effect, parameters, declared, balance)


def _joint(file, node, at):
    members = file.mapping(node, f"key '{at}'", "a joint with name, kind and terms")
    name = file.need(members, "name", node, at + ".", "the joint's name")
    if not isinstance(name, yaml.ScalarNode):
        file.fail(name, f"key '{at}.name': expected the joint's name")
    kind = file.need(members, "kind", node, at + ".", "rotary or linear")
    if file.plain(kind) not in ("rotary", "linear"):
        file.fail(kind, f"key '{at}.kind': '{kind.value}', expected one of rotary, linear")
    terms = file.need(members, "terms", node, at + ".", "a list of effects")
    if not isinstance(terms, yaml.SequenceNode) or not terms.value:
        file.fail(terms, f"key '{at}.terms': expected a list of effects")
    if "constants" in members:
        constants = file.mapping(members["constants"], f"key '{at}.constants'", "constants of the machine")
        for key, value in constants.items():
            file.number(value, f"{at}.constants.{key}")
    data = {"constants": {}, "history": []} | file.plain(node, at)
    data["name"] = name.value  # also of a joint that is called 1
    return Joint(data, [_term(file, term, f"{at}.terms[{i}]") for i, term in enumerate(terms.value)])


def load_model(path):
    """The model of a file. Raises OSError, and ModelError (FILE:LINE) for what is no model."""
    file = _File(Path(path))
    try:
        root = file.root()
        if not isinstance(root, yaml.MappingNode):
            file.fail(root, f"expected a mapping with 'schema: {SCHEMA}'")
        members = file.members(root, "")
        if "schema" not in members and "nominal_parameters" in members:
            file.fail(root, "is a laboratory's rig.json; `sinew model from-rig FILE --out model.yaml` makes a model of it")
        schema = file.need(members, "schema", root, "", f"'{SCHEMA}'")
        if file.plain(schema) != SCHEMA:
            file.fail(schema, f"key 'schema': '{file.plain(schema)}', expected '{SCHEMA}'")
        file.need(members, "name", root, "", "a text")
        joints = file.need(members, "joints", root, "", "a list of joints")
        if not isinstance(joints, yaml.SequenceNode) or not joints.value:
            file.fail(joints, "key 'joints': expected a list of joints")
        made = [_joint(file, node, f"joints[{i}]") for i, node in enumerate(joints.value)]
        return Model(file.path, file.plain(root), made)
    except RecursionError:
        raise ModelError(f"{path}:1: more levels than a model has") from None
