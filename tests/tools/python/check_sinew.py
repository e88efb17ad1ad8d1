#!/usr/bin/python3
"""The package sinew beside the program and the files that it writes. Exit code 77: skipped, with the reason."""
import gc
import json
import os
import pathlib
import sys

try:
    import numpy as np
    import yaml
except ImportError as error:
    print(f"SKIPPED: package: {error}; apt-get install python3-numpy python3-yaml")
    sys.exit(77)

import one_check

PROJECT = pathlib.Path(__file__).resolve().parents[3]
EXAMPLE = PROJECT / "tests/data/rig_examples/one_effect"
MAP = PROJECT / "robots/rig/csv_map.yaml"
MODEL = """schema: sinew-model/1
name: leg
joints:
  - name: hip
    kind: rotary
    constants: {gear_ratio: 100, torque_constant_Nm_A: 1.5e-2}
    backlash_rad: 0.05
    terms:
      - effect: drive_current
        efficiency: {value: 0.75, tolerance: 0.15}
      - {effect: coulomb, coulomb_Nm: {value: 1e-1, fixed: true}}
      - effect: viscous
        viscous_Nm_s_rad: {value: 0, tolerance: {absolute: 0.05}}
      - effect: stribeck
        declared: false
        stribeck_Nm: {value: 0.1, half_width_95: 0.02}
        stribeck_velocity_rad_s: .05
"""


def expect(condition, what):
    if not condition:
        sys.exit(f"failed: {what}")


def fits(thing):
    """What the object prints, which has to fit a terminal."""
    shown = repr(thing)
    expect(max(map(len, shown.splitlines())) < 80, f"wider than a terminal:\n{shown}")
    return shown


def written(folder, content, name="model.yaml"):
    path = folder / name
    path.write_text(content, encoding="utf-8")
    return path


def check_model(arguments, folder):
    model = sinew.load_model(written(folder, MODEL))
    expect(model.name == "leg" and len(model) == 1 and model.urdf is None, repr(model))
    hip = model["hip"]
    expect(hip is model[0] and list(model) == [hip] and hip.kind == "rotary", repr(hip))
    expect(hip.constants == {"gear_ratio": 100, "torque_constant_Nm_A": 0.015}, f"{hip.constants}")
    expect([term.effect for term in hip] == ["drive_current", "coulomb", "viscous", "stribeck"], repr(hip))
    coulomb, viscous, stribeck = hip["coulomb"], hip["viscous"]["viscous"], hip["stribeck"]
    expect(float(coulomb["coulomb"]) == 0.1 and coulomb["coulomb_Nm"].fixed, repr(coulomb))
    expect(viscous.unit == "Nm s/rad" and viscous.tolerance_absolute == 0.05, repr(viscous))
    expect(not stribeck.declared and stribeck["stribeck"].half_width_95 == 0.02, repr(stribeck))
    expect(stribeck["stribeck_velocity"].value == 0.05 and "viscous" in hip and "cogging" not in hip, repr(stribeck))
    shown = " ".join(fits(model).split())
    for part in ("<Model leg of model.yaml: 1 joint>", "<Joint hip, rotary>", "torque_constant 0.015 Nm/A",
                 "backlash 0.05 rad", "drive_current.efficiency 0.75 within 15 %", "coulomb 0.1 Nm fixed",
                 "viscous 0 Nm s/rad within 0.05 Nm s/rad", "stribeck 0.1 Nm added +- 0.02"):
        expect(part in shown, f"'{part}' is not in:\n{model!r}")
    units = {"kg_m2": "kg m^2", "m_s2": "m/s^2", "Nm_s2_rad2": "Nm s^2/rad^2", "Nm_rad_bar": "Nm/(rad bar)",
             "per_A2": "1/A^2", "1_s": "1/s", "V_s_rad": "V s/rad", "rad_Nm": "rad/Nm"}
    for suffix, unit in units.items():
        found = sinew.Parameter(f"name_{suffix}", 1.0).unit
        expect(found == unit, f"{suffix}: {found}, expected {unit}")
    # Every model of the project, each parameter that the program finds.
    files = sorted((PROJECT / "robots").glob("*/*model*.yaml"))
    files = [path for path in files if "sinew-model/1" in path.read_text(encoding="utf-8")]
    expect(len(files) > 10, f"{files}")
    values = 0
    for path in files:
        model = sinew.load_model(path)
        fits(model)
        if path.parent.name == "rig":
            values += compare_with_program(arguments, model)
    expect(values > 20, f"{values} values were compared")
    print(f"{len(files)} model files; {values} values are those of sinew model show")


def compare_with_program(arguments, model):
    compared = 0
    for line in sinew.run("model", "show", model, sinew=arguments.sinew).splitlines():
        words = line.split()
        if len(words) < 2:
            continue
        if words[0] == "joint":
            joint = model[words[1]]
        elif words[0].endswith(":") and words[0][:-1] in joint:
            term = joint[words[0].removesuffix(":")]
        elif words[1] == "=":
            value = float(words[2].removesuffix(","))
            expect(abs(term[words[0]].value - value) <= 1e-5 * abs(value), f"{model.path}: {line}: {term}")
            compared += 1
    return compared


def check_no_model(arguments, folder):
    """Content, line, part of the reason; the program refuses the same at the same line where it has one."""
    lines = MODEL.splitlines(keepends=True)

    def without(number):
        return "".join(lines[:number - 1] + lines[number:])

    wrong = [
        ("a: [b", 1, "is no YAML"), ("\n\nname: [a, b}\n", 3, "is no YAML"), ("hello\n", 1, "expected a mapping"),
        ("", 1, "expected a mapping"), (MODEL.replace("sinew-model/1", "sinew-world/1"), 1, "'sinew-world/1', expected"),
        (without(1), 1, "key 'schema': missing"), (without(2), 1, "key 'name': missing"),
        ("".join(lines[:2]), 1, "key 'joints': missing"), (without(5), 4, "key 'joints[0].kind': missing"),
        ("".join(lines[:6]), 4, "key 'joints[0].terms': missing"),
        (MODEL.replace("rotary", "rotari"), 5, "'rotari', expected one of rotary, linear"),
        (MODEL.replace("1.5e-2", "small"), 6, "torque_constant_Nm_A': 'small', expected a number"),
        (MODEL.replace("0.15}", "0.15, width: 1}"), 10, "efficiency.width': unknown"),
        (MODEL.replace(": .05", ": fast"), 17, "stribeck_velocity_rad_s': 'fast', expected a number"),
        (MODEL.replace(": .05", ": 1e999"), 17, "'1e999', expected a number"),
        (MODEL.replace("    kind", "    name: knee\n    kind"), 5, "key 'joints[0].name': given twice"),
        (MODEL.replace("joints:", "joints: &a").replace("0.05\n    terms", "*a\n    terms"), 4, "refers to itself"),
        ("[" * 3000 + "]" * 3000, 1, "more levels")]
    for content, line, reason in wrong:
        path = written(folder, content)
        try:
            sinew.load_model(path)
        except sinew.ModelError as error:
            expect(str(error).startswith(f"{path}:{line}: ") and reason in str(error),
                   f"'{error}', expected line {line}: {reason}")
            continue
        sys.exit(f"failed: a model of:\n{content}")
    path = written(folder, "\xff\n", "latin.yaml")
    path.write_bytes(b"name: \xff\n")
    for path, reason in ((path, ":1: is no text in UTF-8"), (EXAMPLE / "rig.json", "sinew model from-rig")):
        try:
            sinew.load_model(path)
            sys.exit(f"failed: a model of {path}")
        except sinew.ModelError as error:
            expect(reason in str(error), str(error))
    print(f"{len(wrong)} files are no models, each with its line")


def from_rig(arguments, folder):
    """The declared model of the example."""
    sinew.run("model", "from-rig", EXAMPLE / "rig.json", "--out", folder / "declared.yaml", sinew=arguments.sinew)
    return sinew.load_model(folder / "declared.yaml")


def check_close_loop(arguments, folder):
    model, out = from_rig(arguments, folder), folder / "found"
    report = sinew.close_loop(model, EXAMPLE / "train_1.csv", EXAMPLE / "sealed.csv", map=MAP, out=out, sinew=arguments.sinew)
    with open(out / "report.json", encoding="utf-8") as file:
        data = json.load(file)
    with open(EXAMPLE / "truth.json", encoding="utf-8") as file:
        hidden = [effect["name"] for effect in json.load(file)["effects"]]
    expect(report.data == data and report.verdict == data["verdict"] == "effect", report.verdict)
    expect([effect.name for effect in report.effects] == hidden, f"{report.effects}, hidden was {hidden}")
    effect, of = report.effects[0], data["effects"][0]
    (key, size), = of["parameters"].items()
    expect(effect.size.key == key and effect.size.value == float(effect.size) == size["value"], repr(effect))
    expect(effect.size.unit == "Nm s^2/rad^2" and effect.size.interval_95 == size["interval_95"], repr(effect))
    expect(effect.in_model and effect.confirmation["verdict"] == "confirmed", repr(effect))
    expect(effect.probability == of["posterior"][0]["probability"] and effect.held_out == of["held_out"], repr(effect))
    errors = report.errors[report.errors["what"] == "held_out"][0]
    for column in ("declared", "refitted", "corrected"):
        expect(errors[column] == data["held_out"][f"{column}_rms"], f"{column}: {errors}")
    expect(set(report.not_excited) == set(data["not_excited"]) and all(report.not_excited.values()), "not excited")
    expect([(one.name, one.text) for one in report.findings] ==
           [(one["name"], one["text"]) for one in data["findings"]], f"{report.findings}")
    rows = report.parameters
    added = rows[rows["name"] == f"{effect.name}.{effect.size.name}"][0]
    expect(np.isnan(added["declared"]) and added["corrected"] == data["base_parameters"]["after"][f"{effect.name}.{key}"][
        "value"], f"{added}")
    expect(added["corrected"] == report.model["joint"][effect.name][key].value, repr(report.model))
    expect(len(report.candidates) and report.candidates["accepted"].sum() == 1, f"{report.candidates}")
    expect(len(report.detectable) == len(data["detectable"]["sizes"]), "detectable sizes")
    titles = [picture.title for picture in report.pictures]
    expect("Candidates" in titles and all(one.svg.startswith("<svg") for one in report.pictures), f"{titles}")
    shown = fits(report)
    for part in ("<Report of rig, joint joint: effect>", f"in the model: {hidden[0]}", "held out  ", "not excited: "):
        expect(part in shown, f"'{part}' is not in:\n{shown}")
    expect(repr(sinew.read_report(out)) == shown, "read again")
    print(shown)


def check_several(arguments, folder):
    """What the report of a robot of several joints and others look like, of files that are written here."""
    of_joint = {"verdict": "none", "outcome": "not_detectable", "sentence": "Nothing.", "effects": [], "open": [
        {"name": "stribeck", "parameters": {"stribeck_Nm": {"value": 0.1}}, "refused": {"rule": "score", "value": 0.4,
                                                                                       "limit": 0.6}}],
        "held_out": {"unit": "Nm", "declared_rms": 0.5, "refitted_rms": 0.25, "corrected_rms": None},
        "unexplained": {"variable": "time_s"}}
    error = {"relative_percent": 3.5}
    data = {"robot": "arm", "verdict": "none", "joints": [{"joint": "a", **of_joint}, {"joint": "b", **of_joint}],
            "arm": {"held_out": {"nominal": error, "before": error, "after": error}}}
    written(folder, json.dumps(data), "report.json")
    arm = sinew.read_report(folder)
    expect(isinstance(arm, sinew.RobotReport) and list(arm.joints) == ["a", "b"] and len(list(arm)) == 2, repr(arm))
    expect(arm["a"].open[0].refused["rule"] == "score" and arm["b"].unexplained == "time_s", repr(arm["a"]))
    expect("open: stribeck: stribeck = 0.1 Nm; refused by the rule score" in fits(arm["a"]), repr(arm["a"]))
    expect("3.5 -> 3.5 -> 3.5 %" in fits(arm) and arm["a"].model is None, repr(arm))
    fault = {"rule": "units", "signal": "motor_current", "recording": "a.csv", "accepted": False, "reason": "mA",
             "remedy": "the mapping"}
    stopped = {"robot": "rig", "joint": "joint", "verdict": "data_fault", "sentence": "Stopped.", "faults": [fault]}
    written(folder, json.dumps(stopped), "report.json")
    report = sinew.read_report(folder)
    expect(report.faults[0].rule == "units" and not report.effects and len(report.errors) == 0, repr(report))
    expect("Fault units, motor_current of a.csv: mA. the mapping" in fits(report), repr(report))
    feet = {"robot": "biped", "verdict": "effect", "sentence": "A payload.", "effects": [
        {"effect": "payload", "place": "base", "in_model": True, "payload": {"mass_kg": 4.0, "mass_half_width_95_kg": 0.2},
         "posterior": [{"effect": "payload", "probability": 0.9}], "confirmation": {"verdict": "confirmed"}}],
        "errors": {"held_out": {"force_z_N": {"declared": 9.0, "corrected": 3.0, "unit": "N"}}}, "unexplained": "",
        "not_excited": [{"effect": "coulomb left_knee", "reason": "it stands"}], "detectable": []}
    written(folder, json.dumps(feet), "report.json")
    report = sinew.read_report(folder)
    expect("payload (base): mass = 4 +- 0.2 kg (95 %); confirmed" in fits(report), repr(report))
    expect(report.errors["corrected"][0] == 3.0 and report.unexplained is None, repr(report))
    expect(report.not_excited == {"coulomb left_knee": "it stands"}, f"{report.not_excited}")
    for content, reason in (("{", "is no JSON"), ("{}", "no key 'verdict'"), ("[]", "no key 'verdict'")):
        written(folder, content, "report.json")
        try:
            sinew.read_report(folder)
            sys.exit(f"failed: a report of {content}")
        except ValueError as error:
            expect("report.json: " + reason in str(error), str(error))
    print("arms, robots on two feet and reports of faulty data print themselves")


def check_data(arguments, folder):
    model = from_rig(arguments, folder)
    check = sinew.check_data([EXAMPLE / "train_1.csv"], model, map=MAP, sinew=arguments.sinew)
    kept = check.folder
    with open(kept / "check.json", encoding="utf-8") as file:
        data = json.load(file)
    expect(check.ok and check.data == data and len(check.pictures) == 1 and len(check.rules) == len(data["rules"]),
           repr(check))
    expect(check.recordings[0]["rows"] == data["recordings"][0]["rows"] and "<Check ok: 1 recording, 0 faults, " in
           fits(check), repr(check))
    del check
    gc.collect()
    expect(not kept.exists(), f"{kept} is left behind")
    # The current negated: a fault is a result.
    turned = written(folder, MAP.read_text(encoding="utf-8").replace("motor_current_A, unit: A, sign: 1",
                                                                     "motor_current_A, unit: A, sign: -1"), "map.yaml")
    check = sinew.check_data(EXAMPLE / "train_1.csv", model, map=turned, out=folder / "checked", sinew=arguments.sinew)
    expect(check.verdict == "data_fault" and not check.ok, repr(check))
    expect([fault.rule for fault in check.faults] == ["drive_sign"] and check.faults[0].remedy, repr(check))
    expect("Fault drive_sign" in fits(check) and check.page.exists(), repr(check))
    accepted = sinew.check_data(EXAMPLE / "train_1.csv", model, map=turned, accept_faults=["drive_sign"],
                                sinew=arguments.sinew)
    expect(accepted.ok and accepted.faults[0].accepted, repr(accepted))
    print(repr(check))


def check_failures(arguments, folder):
    model = sinew.load_model(written(folder, MODEL))

    def failed(what, *parts, code, **more):
        try:
            what(model, [folder / "absent.csv", "d.csv"], **more)
            sys.exit(f"failed: {what} did not")
        except sinew.SinewError as error:
            expect(error.code == code, f"code {error.code}: {error}")
            for part in parts:
                expect(part in str(error) and part in error.text, f"'{error}', expected {part}")
            return error

    def check(of, recordings, **more):
        return sinew.check_data(recordings, of, **more)

    for what, name in ((sinew.close_loop, "close-loop"), (check, "check-data")):
        error = failed(what, "absent.csv", code=2, sinew=arguments.sinew)
        expect(str(error).startswith(f"sinew {name}: ") and error.command[1] == name, str(error))
        failed(what, "no program '/nowhere/sinew'", code=None, sinew="/nowhere/sinew")
    error = failed(sinew.close_loop, "nothing_such", code=2, sinew=arguments.sinew, effects=["nothing_such"])
    expect(str(error).count("sinew close-loop: ") == 1, str(error))
    silent = written(folder, "#!/bin/sh\nkill -9 $$\n", "silent")
    silent.chmod(0o755)
    failed(sinew.close_loop, "ended by signal 9", code=-9, sinew=silent)
    # By PATH, with every argument at its place.
    fake = written(folder, "#!/bin/sh\nfor word; do echo \"$word\" >&2; done; exit 1\n", "sinew")
    fake.chmod(0o755)
    path, os.environ["PATH"] = os.environ["PATH"], f"{folder}:{os.environ['PATH']}"
    error = failed(sinew.close_loop, code=1, held_out=["b.csv", "c.csv"], effects=[], joint=0, keep_unconfirmed=True,
                   accept_faults=["spike", "zero"], held_out_map="other.yaml", out="found")
    expected = ["close-loop", "--model", str(model.path), "--held-out-map", "other.yaml", "--train",
                str(folder / "absent.csv"), "d.csv", "--held-out", "b.csv", "c.csv", "--joint", "0", "--effect", "none",
                "--accept-fault", "spike", "--accept-fault", "zero", "--keep-unconfirmed", "--out", "found"]
    expect(error.text.splitlines() == expected, f"{error.text.splitlines()}\nexpected {expected}")
    os.environ["PATH"] = "/nowhere"
    failed(sinew.close_loop, "no program 'sinew' on PATH: install sinew-core", code=None)
    os.environ["PATH"] = path
    print("failures carry the text of the command")


def load():
    global sinew
    import sinew


one_check.run(__doc__, load, globals())
