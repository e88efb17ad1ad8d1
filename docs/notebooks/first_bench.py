# ---
# jupyter:
#   jupytext:
#     text_representation:
#       extension: .py
#       format_name: percent
#   kernelspec:
#     display_name: Python 3
#     language: python
#     name: python3
# ---

# %% [markdown]
# # A first bench: which effect does the model lack?
#
# The steps of [the tutorial](../tutorial.md) in Python, on a recording that comes with the project: a joint with a gear,
# a motor and a pneumatic element, whose maker declares a model. Something that the model does not have was added to the
# machine. We look for it.
#
# The program `sinew` has to be on `PATH`: `export PATH=$PWD/build/release/bin:$PATH` in the root of the project.

# %%
import json
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

PROJECT = next(folder for folder in (Path.cwd(), *Path.cwd().parents) if (folder / "tests/data/rig_examples").is_dir())
sys.path.append(str(PROJECT / "tools/python"))  # where python3-sinew is not installed
import sinew

EXAMPLE = PROJECT / "tests/data/rig_examples/one_effect"
MAP = PROJECT / "robots/rig/csv_map.yaml"
OUT = PROJECT / "build/first_bench"
OUT.mkdir(parents=True, exist_ok=True)

plt.rcParams.update({"figure.figsize": (8, 4), "figure.constrained_layout.use": True, "axes.grid": True, "axes.axisbelow": True,
                     "grid.alpha": 0.3, "axes.spines.top": False, "axes.spines.right": False, "savefig.dpi": 120})
GREY, BLUE, ORANGE = "#808080", "#1f5fa8", "#d9730d"


def save(figure, name):
    figure.savefig(OUT / f"{name}.png")


# %% [markdown]
# ## 1. What was recorded
#
# Three recordings to learn from, and one that no fit ever sees: it confirms or refutes. `sinew import` makes a recording
# of a CSV file and of the mapping that names its columns, units and signs.

# %%
train = [EXAMPLE / f"train_{number}.csv" for number in (1, 2, 3)]
held_out = EXAMPLE / "sealed.csv"
sinew.run("import", "--map", MAP, train[0], "--out", OUT / "train_1.mcap", "--overwrite")
run = sinew.Recording(OUT / "train_1.mcap")
print(run)

# %% [markdown]
# A topic is a dict of arrays, one row a message, the unit in the name of the field. The messages themselves are a loop.

# %%
joint, actuator = run["joint_state"], run["actuator_state"]
time_s = 1e-9 * joint["header.stamp_ns"]
figure, axes = plt.subplots(3, sharex=True, figsize=(8, 5.5))
for axis, label, values in zip(axes, ("angle, rad", "current, A", "pressure, bar"), (
        joint["position_rad"], actuator["motor_current_A"], actuator["chamber_pressure_bar"])):
    axis.plot(time_s, values[:, 0], color=BLUE, linewidth=0.8)
    axis.set_ylabel(label)
axes[-1].set_xlabel("time, s")
axes[0].set_title("Training recording 1", loc="left")
save(figure, "recording")

moving = sum(1 for message in run if message.topic == "joint_state" and abs(message.content["velocity_rad_s"][0]) > 0.1)
print(f"faster than 0.1 rad/s in {moving} of {run.counts['joint_state']} messages")

# %% [markdown]
# ## 2. What is declared
#
# The laboratory states constants and nominal values in `rig.json`; a model file says the same in terms of the catalogue,
# each value with what is known of it.

# %%
sinew.run("model", "from-rig", EXAMPLE / "rig.json", "--out", OUT / "declared.yaml")
declared = sinew.load_model(OUT / "declared.yaml")
print(declared)

# %% [markdown]
# ## 3. Are the data fit for a fit?
#
# Reversed signs, wrong units, frozen channels are faults and stop everything later. Findings are what one should know.

# %%
check = sinew.check_data(train, declared, map=MAP, out=OUT / "checked")
print(check)
assert check.ok

# %% [markdown]
# ## 4. Which effect is missing?

# %%
report = sinew.close_loop(declared, train, held_out, map=MAP, out=OUT / "found")
print(report)

# %% [markdown]
# The error of the torque on the recordings, of the model as declared, with its values refitted, and with the effect. The
# dashed line is the noise of the sensors: no model gets below it.

# %%
errors = report.errors[report.errors["balance"] == "M"]
errors = errors[errors["unit"] == "Nm"]
figure, axis = plt.subplots(figsize=(8, 3.5))
for offset, (column, color) in enumerate((("declared", GREY), ("refitted", BLUE), ("corrected", ORANGE))):
    bars = axis.bar(np.arange(len(errors)) + 0.27 * (offset - 1), errors[column], 0.25, color=color, label=column)
    axis.bar_label(bars, fmt="%.3f", fontsize=9)
floor_Nm = report.held_out["noise_floor_rms"]
axis.axhline(floor_Nm, color="black", linestyle="--", linewidth=0.8, label=f"noise, {floor_Nm:.3f}")
axis.set_yscale("log")
axis.set_ylim(0.02, 2)
axis.set_yticks([0.02, 0.05, 0.1, 0.2, 0.5, 1, 2], ["0.02", "0.05", "0.1", "0.2", "0.5", "1", "2"])
axis.minorticks_off()
axis.set_xticks(range(len(errors)), [what.replace("train", "training").replace("_", " ") for what in errors["what"]])
axis.set_ylabel("error, Nm rms")
axis.grid(axis="x", visible=False)
axis.legend(ncols=4, loc="upper center", frameon=False)
save(figure, "errors")

# %% [markdown]
# What else was tried, and how much of the misfit each candidate would have removed by itself. Few names explain what is
# there nearly as well as the one that was taken: the report gives each its probability.

# %%
candidates = np.sort(report.candidates[report.candidates["round"] == 1], order="gain")[-8:]
figure, axis = plt.subplots(figsize=(8, 3.2))
colors = [ORANGE if accepted else GREY for accepted in candidates["accepted"]]
axis.barh(candidates["name"], 100 * candidates["gain"], color=colors)
axis.set_xlabel("part of the training misfit that it removes, %")
axis.grid(axis="y", visible=False)
save(figure, "candidates")
for effect in report.effects:
    print(effect, *(f"  {one['name']}: {100 * one['probability']:.1f} %" for one in effect.posterior), sep="\n")

# %% [markdown]
# ## 5. What the corrected model says
#
# `model.yaml` is the declared model, refitted, with the effect. Its friction over the speed, with the 95 % interval of the
# added part, beside what was declared. (`sinew effects quadratic_viscous` has the formula.)

# %%
corrected = report.model
speed_rad_s = np.linspace(0, np.percentile(np.abs(joint["velocity_rad_s"][:, 0]), 99.5), 200)


def friction_Nm(model):
    one = model[0]
    torque = float(one["coulomb"]["coulomb"]) + float(one["motor_viscous"]["viscous"]) * speed_rad_s
    if "quadratic_viscous" in one:
        torque = torque + float(one["quadratic_viscous"]["quadratic"]) * speed_rad_s**2
    return torque


figure, axis = plt.subplots(figsize=(8, 3.5))
axis.plot(speed_rad_s, friction_Nm(declared), color=GREY, label="declared")
axis.plot(speed_rad_s, friction_Nm(corrected), color=ORANGE, label="corrected")
width = corrected[0]["quadratic_viscous"]["quadratic"].half_width_95 * speed_rad_s**2
axis.fill_between(speed_rad_s, friction_Nm(corrected) - width, friction_Nm(corrected) + width, color=ORANGE, alpha=0.25,
                  linewidth=0)
axis.set_xlabel("speed, rad/s")
axis.set_ylabel("friction, Nm")
axis.set_ylim(bottom=0)
axis.legend(frameon=False)
save(figure, "friction")
print(corrected[0]["quadratic_viscous"]["quadratic"])

# %% [markdown]
# `sinew verify` moves the simulated robot as the held-out recording was moved, with either model, and compares positions.

# %%
verified = json.loads(sinew.run("verify", "--model", corrected, "--before", declared, "--recording", held_out, "--map",
                                MAP, "--out", OUT / "verified", "--json"))["simulation"]
before, after = (1e3 * verified[key]["rms"] for key in ("before", "after"))
print(f"simulated less measured position: {before:.2f} -> {after:.2f} mrad rms")
assert after < before

# %% [markdown]
# ## 6. What had been hidden
#
# The example's maker wrote it down; no program reads that file.

# %%
hidden = json.loads((EXAMPLE / "truth.json").read_text())["effects"]
for effect in hidden:
    print(f"{effect['name']}: {effect['value']} {effect['unit']}")
assert [effect.name for effect in report.effects] == [effect["name"] for effect in hidden]

# %% [markdown]
# ## Your own joint
#
# `sinew new bench run.csv --out bench` writes mapping and model for a CSV file of yours; from there on it is step 3. The
# pictures of the report are in `report.page`, one by one in `report.pictures`:

# %%
for picture in report.pictures:
    print(picture)
report.pictures[0]
