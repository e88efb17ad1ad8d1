"""What `sinew check-data` and `sinew close-loop` write, as objects. The keys are those of docs/formats.md, "Reports";
`data` of every object is the JSON that it was made from."""
import html
import json
import re
from pathlib import Path

import numpy as np

from . import text
from .model import load_model

__all__ = ["Check", "Effect", "Fault", "Finding", "Picture", "Report", "RobotReport", "read_check", "read_report"]


class _Read:
    """Something of a JSON file; attributes that are not listed are keys of data."""

    def __init__(self, data):
        self.data = data

    def __getattr__(self, name):
        if name.startswith("_") or name == "data" or name not in self.data:
            raise AttributeError(f"'{type(self).__name__}' has no '{name}'")
        return self.data[name]

    def __dir__(self):
        return sorted(set(super().__dir__()) | {key for key in self.data if key.isidentifier()})


class Fault(_Read):
    """rule, signal, recording, rows, time_s, statistic, limit, reason, remedy, accepted."""

    def __repr__(self):
        where = " of ".join(str(part) for part in (self.data.get("signal"), self.data.get("recording")) if part)
        head = f"<Fault {self.rule}" + (f", {where}" if where else "") + (", accepted" if self.accepted else "")
        return f"{head}: {self.reason.rstrip('.')}. {self.remedy}>"


class Finding(_Read):
    """name, text, value, unit."""

    def __repr__(self):
        return f"<Finding {self.name}: {self.text}>"


class Size(_Read):
    """A parameter of an effect: key, name, unit, value, half_width_95 and interval_95 (None: not known)."""

    def __init__(self, key, data):
        super().__init__(data)
        self.key = key
        self.name, self.unit = text.split_key(key)
        self.value = data["value"]
        self.half_width_95, self.interval_95 = data.get("half_width_95"), data.get("interval_95")

    def __float__(self):
        return self.value

    def __str__(self):
        width = "" if self.half_width_95 is None else f" +- {text.number(self.half_width_95)}"
        unit = f" {self.unit}" if self.unit else ""
        return f"{self.name} = {text.number(self.value)}{width}{unit}" + (" (95 %)" if width else "")

    def __repr__(self):
        return f"<Size {self}>"


class Effect(_Read):
    """An effect that was found, is open or was refuted.

    name; title; place (of a robot on two feet); sizes (key -> Size); probability of the name, rivals; confirmation
    (verdict, slope) on the held-out recordings; held_out (unit, before, after), gain (share of the training misfit
    that it removes), in_model; refused (rule, value, limit), None in the model."""

    def __init__(self, data):
        super().__init__(data)
        self.name = data.get("name") or data["effect"]
        self.title, self.place = data.get("title", ""), data.get("place", "")
        self.sizes = {key: Size(key, one) for key, one in data.get("parameters", {}).items()
                      if isinstance(one, dict) and "value" in one}
        if "payload" in data:
            mass = {"value": data["payload"]["mass_kg"], "half_width_95": data["payload"]["mass_half_width_95_kg"]}
            self.sizes["mass_kg"] = Size("mass_kg", mass)
        self.gain = data.get("gain", data.get("gain_share"))
        self.in_model, self.refused = data.get("in_model", False), data.get("refused")
        self.rivals, self.confirmation = data.get("rivals", []), data.get("confirmation") or {}
        self.held_out = data.get("held_out")
        names = {one.get("name", one.get("effect")): one["probability"] for one in data.get("posterior", [])}
        self.probability = names.get(self.name)

    @property
    def size(self):
        """The first of its sizes, or None."""
        return next(iter(self.sizes.values()), None)

    def __repr__(self):
        parts = [", ".join(map(str, self.sizes.values())), self.confirmation.get("verdict", "")]
        if self.refused:
            parts.append(f"refused by the rule {self.refused['rule']}")
        if self.held_out:
            parts.append(f"held-out error {text.number(self.held_out['before'])} -> "
                         f"{text.number(self.held_out['after'])} {self.held_out['unit']}")
        if self.probability is not None:
            parts.append(f"name {text.share(self.probability)} probable")
        if self.rivals:
            parts.append(f"or {', '.join(self.rivals)}")
        place = f" ({self.place})" if self.place else ""
        return f"<Effect {self.name}{place}: {'; '.join(filter(None, parts))}>"


class Picture:
    """A picture of a report: title, svg (text). A notebook shows it; save(path) writes the SVG file."""

    def __init__(self, title, svg):
        self.title, self.svg = title, svg

    def save(self, path):
        Path(path).write_text(self.svg, encoding="utf-8")
        return Path(path)

    def _repr_svg_(self):
        return self.svg

    def __repr__(self):
        return f"<Picture {self.title}>"


class _Result(_Read):
    """A folder that a command wrote; `kept` lives as long as this does."""

    def __init__(self, data, folder, page, kept):
        super().__init__(data)
        self.folder, self.page, self._kept = folder, folder / page, kept
        self.recordings = data.get("recordings", [])
        self.faults = [Fault(one) for one in data.get("faults", [])]
        self.findings = [Finding(one) for one in data.get("findings", [])]

    @property
    def pictures(self):
        """Those of the page, in its order."""
        page = self.page.read_text(encoding="utf-8") if self.page.exists() else ""
        found = re.findall(r"<figure><h3>(.*?)</h3>(<svg.*?</svg>)", page, re.S)
        return [Picture(html.unescape(title), svg) for title, svg in found]

    def _lines_of_faults(self):
        lines = []
        for fault in self.faults:
            lines += text.paragraph(repr(fault)[1:-1], "  ")
        return lines


class Check(_Result):
    """What `sinew check-data` found: verdict ("ok" or "data_fault"), sentence, faults, findings, rules (an array of
    rule, statistic, limit, signal, recording), recordings, pictures; folder, page (check.html)."""

    def __init__(self, data, folder, kept=None):
        super().__init__(data, folder, "check.html", kept)
        self.rules = _array(data.get("rules", []), [("rule", "U"), ("statistic", "f"), ("limit", "f"), ("signal", "U"),
                                                    ("recording", "U")])

    @property
    def ok(self):
        return self.verdict == "ok"

    def __repr__(self):
        lines = [f"<Check {self.verdict}: {_counted(self.recordings, 'recording')}, {_counted(self.faults, 'fault')}, "
                 f"{_counted(self.findings, 'finding')}>"]
        lines += self._lines_of_faults()
        for finding in self.findings:
            lines += text.paragraph(f"{finding.name}: {finding.text}", "  ")
        return "\n".join(lines)


class _Found(_Result):
    """What `sinew close-loop` found: report.html, and model.yaml unless there was no fit."""

    def __init__(self, data, folder, kept=None):
        super().__init__(data, folder, "report.html", kept)

    @property
    def model(self):
        path = self.folder / "model.yaml"
        return load_model(path) if path.exists() else None


ERROR_NAMES = {"train": "training", "held_out": "held out", "simulated": "simulated, held out"}
BALANCE_NAMES = {"K": ", encoders", "Q": ", gas"}


class Report(_Found):
    """What `sinew close-loop` found of a joint, or of a robot on two feet.

    verdict, outcome, sentence; effects (in the model), open (supported, neither confirmed nor refuted) and refuted:
    lists of Effect; unexplained: the variable that the rest follows, or None; not_excited: effect -> why it could not
    be seen; next_experiment; model: model.yaml as a Model, None without a fit; faults, findings, recordings, pictures;
    folder, page (report.html).

    Arrays: errors (what, balance, unit, declared, refitted, corrected), parameters (name, unit, declared, refitted,
    corrected, half_width_95), shifts (name, nominal, refit, tolerance, sigma), detectable (effect, parameter, unit,
    size), candidates (round, name, gain, accepted, refused)."""

    def __init__(self, data, folder, kept=None):
        super().__init__(data, folder, kept)
        self.outcome = data.get("outcome", data["verdict"])
        self.effects, self.open, self.refuted = ([Effect(one) for one in data.get(key, [])]
                                                 for key in ("effects", "open", "refuted"))
        rest = data.get("unexplained") or {}
        self.unexplained = (rest.get("variable") if isinstance(rest, dict) else rest) or None
        why = data.get("not_excited_why", {})
        self.not_excited = dict((one["effect"], one["reason"]) if isinstance(one, dict) else (one, why.get(one, ""))
                                for one in data.get("not_excited", []))
        self.next_experiment = data.get("next_experiment")

    @property
    def joints(self):
        return {self.data.get("joint", self.data.get("robot", "")): self}

    @property
    def errors(self):
        rows = self.data.get("errors") or []
        if isinstance(rows, dict):  # of a robot on two feet: by recordings and channel
            rows = [{"what": f"{what} {channel}", **one} for what, channels in rows.items()
                    for channel, one in channels.items()]
        return _array(rows, [("what", "U"), ("balance", "U"), ("unit", "U"), ("declared", "f"), ("refitted", "f"),
                             ("corrected", "f")])

    @property
    def parameters(self):
        base = self.data.get("base_parameters") or {}
        nominal, before, after = (base.get(key, {}) for key in ("nominal", "before", "after"))
        rows = []
        for key in after or nominal:
            name, unit = text.split_key(key)
            values = [one.get(key, {}).get("value") for one in (nominal, before, after)]
            rows.append({"name": name, "unit": unit, "declared": values[0], "refitted": values[1],
                         "corrected": values[2], "half_width_95": after.get(key, {}).get("half_width_95")})
        return _array(rows, [("name", "U"), ("unit", "U"), ("declared", "f"), ("refitted", "f"), ("corrected", "f"),
                             ("half_width_95", "f")])

    @property
    def shifts(self):
        return _array(self.data.get("parameter_shift", []), [("name", "U"), ("nominal", "f"), ("refit", "f"),
                                                             ("tolerance", "f"), ("sigma", "f")])

    @property
    def detectable(self):
        found = self.data.get("detectable") or []
        rows = [{**one, "unit": text.unit_text([part for part in one.get("unit", "").split("_") if part])}
                for one in (found.get("sizes", []) if isinstance(found, dict) else found)]
        return _array(rows, [("effect", "U"), ("balance", "U"), ("parameter", "U"), ("unit", "U"), ("size", "f"),
                             ("share_of_measured_side", "f")])

    @property
    def candidates(self):
        rows = [{"round": number, **one} for number, rounds in enumerate(self.data.get("rounds", []), 1)
                for one in rounds.get("candidates", [])]
        return _array(rows, [("round", "i"), ("name", "U"), ("gain", "f"), ("accepted", "?"), ("refused", "U")])

    def __repr__(self):
        name = ", joint ".join(filter(None, (self.data.get("robot"), self.data.get("joint"))))
        outcome = "" if self.outcome == self.verdict else f" ({self.outcome})"
        lines = [f"<Report of {name}: {self.verdict}{outcome}>"] + text.paragraph(self.sentence)
        lines += self._lines_of_faults()
        found = [(word, effect) for word, effects in (
            ("in the model", self.effects), ("open", self.open), ("refuted", self.refuted)) for effect in effects]
        lines += [""] if found else []
        for word, effect in found:
            lines += text.paragraph(f"{word}: {repr(effect)[len('<Effect '):-1]}", "  ")
        errors = [[ERROR_NAMES.get(row["what"], row["what"]) + BALANCE_NAMES.get(row["balance"], ""), row["declared"],
                   row["refitted"], row["corrected"], row["unit"]] for row in self.errors]
        if errors:
            lines += [""] + text.table(errors, ["error, rms", "declared", "refitted", "corrected", "unit"])
        tail = []
        if self.unexplained:
            tail.append(f"unexplained: over {self.unexplained}")
        if len(self.shifts):
            tail.append("shifted by more than their tolerance: " + ", ".join(self.shifts["name"]))
        if self.not_excited:
            tail.append("not excited: " + ", ".join(self.not_excited))
        if self.next_experiment:
            tail.append(f"next experiment: {self.next_experiment}")
        if tail:
            lines.append("")
        for line in tail:
            lines += text.paragraph(line, "  ")
        return "\n".join(lines)


class RobotReport(_Found):
    """What `sinew close-loop` found of a robot of several joints: verdict; joints (name -> Report), also by
    report["NAME"] and in a loop; arm (dict of an arm's errors, loads and base parameters, else None); model; folder,
    page."""

    def __init__(self, data, folder, kept=None):
        super().__init__(data, folder, kept)
        self.joints = {one["joint"]: Report(one, folder / one["joint"], kept) for one in data["joints"]}
        self.arm = data.get("arm")
        self.faults = [fault for joint in self for fault in joint.faults]

    def __getitem__(self, joint):
        return self.joints[joint]

    def __iter__(self):
        return iter(self.joints.values())

    def __len__(self):
        return len(self.joints)

    def __repr__(self):
        lines = [f"<Report of {self.robot}, {len(self)} joints: {self.verdict}; held-out errors, rms>"]
        rows = []
        for name, joint in self.joints.items():
            held = joint.data.get("held_out") or {}
            found = ", ".join(effect.name for effect in joint.effects)
            rows.append([name, joint.verdict, found, *(held.get(key) for key in ("declared_rms", "refitted_rms",
                                                                                "corrected_rms")), held.get("unit", "")])
        lines += text.table(rows, ["joint", "verdict", "in the model", "declared", "refitted", "corrected", ""])
        if self.arm:
            held = self.arm["held_out"]
            errors = [held[key]["relative_percent"] for key in ("nominal", "before", "after")]
            lines += text.paragraph("the arm's torques, held out: " + " -> ".join(map(text.number, errors)) +
                                    " % (declared, refitted, with the effects)", "  ")
        return "\n".join(lines)


def _counted(things, word):
    return f"{len(things)} {word}" + ("" if len(things) == 1 else "s")


def _array(rows, fields):
    """A structured array of dicts: what is absent is NaN or an empty text."""
    columns, types = [], []
    for name, kind in fields:
        values = [row.get(name) for row in rows]
        if kind == "U":
            columns.append(["" if value is None else str(value) for value in values])
            types.append((name, f"U{max([1] + [len(value) for value in columns[-1]])}"))
        else:
            columns.append([np.nan if value is None and kind == "f" else value for value in values])
            types.append((name, {"f": float, "i": int, "?": bool}[kind]))
    return np.array(list(zip(*columns)), dtype=types)


def _read(path, schema):
    try:
        data = json.loads(Path(path).read_text(encoding="utf-8"))
    except ValueError as error:
        raise ValueError(f"{path}: is no JSON: {error}") from None
    if not isinstance(data, dict) or "verdict" not in data:
        raise ValueError(f"{path}: no key 'verdict', expected a file of {schema}")
    return data


def read_check(folder, kept=None):
    """The Check of a folder that `sinew check-data --out` wrote."""
    folder = Path(folder)
    return Check(_read(folder / "check.json", "sinew check-data"), folder, kept)


def read_report(folder, kept=None):
    """The Report (RobotReport of several joints) of a folder that `sinew close-loop --out` wrote."""
    folder = Path(folder)
    data = _read(folder / "report.json", "sinew close-loop")
    return (RobotReport if "joints" in data else Report)(data, folder, kept)
