#!/usr/bin/env python3
"""Writes biped.urdf from the lengths and motors below and the parts of shapes.csv. README.md derives each figure.

    generate.py            writes biped.urdf beside this file
    generate.py --print    writes it to the standard output
"""

import csv
import math
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent

# Table 3.1, m.
L1 = 0.243  # hip axes to the top of the torso
L2 = 0.150  # between the hip centres
L3 = 0.278  # thigh
L4 = 0.260  # shank
L5 = 0.104  # ankle pitch axis to ankle roll axis
L6 = 0.134  # ankle roll axis to the sole

TOTAL_MASS_KG = 17.1

TORSO_HEIGHT_M = 0.143  # of the torso's frame; it ends L1 above the hip axes
FOOT_THICKNESS_M = 0.02
TOE_AXIS_X_M = 0.085

# Motors: (KV in rpm/V); drives: motor and reduction. Section 3.2.2.
KV_RPM_V = {"ML3510": 600.0, "ML5008": 400.0}
CURRENT_LIMIT_A = 25.0
EFFICIENCY = 0.75
SUPPLY_V = 24.0
DRIVES = {
    "planetary_50": ("ML3510", 50.0),
    "planetary_100": ("ML3510", 100.0),
    "harmonic_80": ("ML5008", 80.0),
}

# name, parent, child, origin, axis, lower, upper, drive. In the order of the joints.
LEG_JOINTS = [
    ("hip_yaw", None, "hip_yaw_link", None, "0 0 1", -0.6, 0.6, "planetary_50"),
    ("hip_roll", "hip_yaw_link", "hip_roll_link", (0.0, 0.0, 0.0), "1 0 0", -0.5, 0.5, "harmonic_80"),
    ("hip_pitch", "hip_roll_link", "thigh", (0.0, 0.0, 0.0), "0 1 0", -1.9, 0.6, "harmonic_80"),
    ("knee", "thigh", "shank", (0.0, 0.0, -L3), "0 1 0", 0.0, 2.75, "planetary_100"),
    ("ankle_pitch", "shank", "ankle", (0.0, 0.0, -L4), "0 1 0", -1.6, 0.8, "planetary_100"),
    ("ankle_roll", "ankle", "foot", (0.0, 0.0, -L5), "1 0 0", -0.5, 0.5, "planetary_50"),
]

# The elastic segment as a beam of TPU: stiffness E w h^3 / (12 l).
TPU_MODULUS_PA = 26e6
TPU_WIDTH_M, TPU_HEIGHT_M, TPU_LENGTH_M = 0.09, 0.01, 0.02
TOE_STIFFNESS_NM_RAD = TPU_MODULUS_PA * TPU_WIDTH_M * TPU_HEIGHT_M**3 / (12.0 * TPU_LENGTH_M)
TOE_DAMPING_NMS_RAD = 0.02
TOE_LOWER_RAD, TOE_UPPER_RAD = -0.7, 0.2

# Force sensors: name, link, position in that link's frame (left foot), at the height of the sole.
REAR_Z = -L6
FRONT_Z = -FOOT_THICKNESS_M / 2.0
FORCE_SENSORS = [
    ("force_rear_outer", "foot", (-0.055, 0.03, REAR_Z)),
    ("force_rear_inner", "foot", (-0.055, -0.03, REAR_Z)),
    ("force_front_outer", "toe", (0.05, 0.03, FRONT_Z)),
    ("force_front_inner", "toe", (0.05, -0.03, FRONT_Z)),
]

# Parts that touch the ground.
CONTACT_PARTS = {"rear_segment", "front_segment"}

# Colours of the parts, red green blue alpha: what a viewer draws. The legs differ, so that left and right do.
MATERIALS = {
    "body": "0.80 0.82 0.85 1",
    "left": "0.22 0.45 0.80 1",
    "right": "0.92 0.52 0.18 1",
    "actuator": "0.25 0.27 0.30 1",
    "sole": "0.38 0.38 0.40 1",
}

ALONG = {"x": "0 1.570796327 0", "y": "1.570796327 0 0", "z": "0 0 0"}


def number(value):
    return "0" if abs(value) < 1e-12 else f"{value:.9g}"  # less is rounding of sums


def triple(values):
    return " ".join(number(v) for v in values)


def torque_constant(motor):
    """(3.1): N m/A."""
    return 60.0 / (2.0 * math.pi * KV_RPM_V[motor])


def effort(drive):
    """(3.3)-(3.5): N m at the joint."""
    motor, reduction = DRIVES[drive]
    return torque_constant(motor) * CURRENT_LIMIT_A * reduction * EFFICIENCY


def speed(drive):
    """Of the unloaded motor at the supply's voltage, rad/s at the joint."""
    motor, reduction = DRIVES[drive]
    return KV_RPM_V[motor] * SUPPLY_V / reduction * 2.0 * math.pi / 60.0


class Part:
    def __init__(self, row, side):
        self.name = row["part"]
        self.shape = row["shape"]
        self.axis = row["axis"]
        self.mass = float(row["mass_kg"])
        self.size = [float(v) for v in row["size_m"].split()]
        self.at = [float(v) for v in row["at_m"].split()]
        if side == "right":
            self.at[1] = -self.at[1]
        self.material = side or "body"
        if self.shape == "cylinder":
            self.material = "actuator"
        elif self.name in CONTACT_PARTS:
            self.material = "sole"
        wanted = {"box": 3, "cylinder": 2}[self.shape]
        if len(self.size) != wanted or len(self.at) != 3 or not self.mass > 0.0:
            raise ValueError(f"part {self.name}: {row}")

    def moments(self):
        """Principal moments about the part's own centre, in the link's axes."""
        m = self.mass
        if self.shape == "box":
            x, y, z = self.size
            return [m * (y * y + z * z) / 12.0, m * (x * x + z * z) / 12.0, m * (x * x + y * y) / 12.0]
        radius, length = self.size
        across = m * (3.0 * radius * radius + length * length) / 12.0
        return [m * radius * radius / 2.0 if a == self.axis else across for a in "xyz"]

    def geometry(self, tag):
        rpy = f' rpy="{ALONG[self.axis]}"' if self.shape == "cylinder" else ""
        if self.shape == "box":
            form = f'<box size="{triple(self.size)}"/>'
        else:
            form = f'<cylinder radius="{number(self.size[0])}" length="{number(self.size[1])}"/>'
        return [
            f'    <{tag} name="{self.name}">',
            f'      <origin xyz="{triple(self.at)}"{rpy}/>',
            f"      <geometry>{form}</geometry>",
            *([f'      <material name="{self.material}"/>'] if tag == "visual" else []),
            f"    </{tag}>",
        ]


def read_parts():
    """Link -> its parts, both legs."""
    with open(HERE / "shapes.csv", newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(line for line in file if not line.startswith("#")))
    parts = {}
    for row in rows:
        for side in ("left", "right") if "{side}" in row["link"] else ("",):
            parts.setdefault(row["link"].format(side=side), []).append(Part(row, side))
    return parts


def inertial(parts):
    """Mass, centre and inertia about it: parallel axes of all parts."""
    mass = sum(p.mass for p in parts)
    centre = [sum(p.mass * p.at[i] for p in parts) / mass for i in range(3)]
    inertia = [[0.0] * 3 for _ in range(3)]
    for p in parts:
        r = [p.at[i] - centre[i] for i in range(3)]
        square = sum(v * v for v in r)
        for i, moment in enumerate(p.moments()):
            inertia[i][i] += moment + p.mass * square
            for k in range(3):
                inertia[i][k] -= p.mass * r[i] * r[k]
    return mass, centre, inertia


def link(name, parts):
    if not parts:
        return [f'  <link name="{name}"/>']
    mass, centre, inertia = inertial(parts)
    (xx, xy, xz), (_, yy, yz), (_, _, zz) = inertia
    out = [
        f'  <link name="{name}">',
        "    <inertial>",
        f'      <origin xyz="{triple(centre)}"/>',
        f'      <mass value="{number(mass)}"/>',
        f'      <inertia ixx="{number(xx)}" ixy="{number(xy)}" ixz="{number(xz)}" '
        f'iyy="{number(yy)}" iyz="{number(yz)}" izz="{number(zz)}"/>',
        "    </inertial>",
    ]
    for p in parts:
        out += p.geometry("visual")
        if p.name in CONTACT_PARTS:
            out += p.geometry("collision")
    return out + ["  </link>"]


def joint(name, kind, parent, child, origin, more=()):
    return [
        f'  <joint name="{name}" type="{kind}">',
        f'    <parent link="{parent}"/>',
        f'    <child link="{child}"/>',
        f'    <origin xyz="{triple(origin)}"/>',
        *(f"    {line}" for line in more),
        "  </joint>",
    ]


def turning(axis, lower, upper, effort_nm, velocity):
    return [
        f'<axis xyz="{axis}"/>',
        f'<limit lower="{number(lower)}" upper="{number(upper)}" effort="{effort_nm}" velocity="{velocity}"/>',
    ]


def transmission(name, drive):
    motor, reduction = DRIVES[drive]
    return [
        f'  <transmission name="{name}_{drive}">',
        "    <type>transmission_interface/SimpleTransmission</type>",
        f'    <joint name="{name}"><hardwareInterface>EffortJointInterface</hardwareInterface></joint>',
        f'    <actuator name="{name}_{motor}"><mechanicalReduction>{number(reduction)}</mechanicalReduction></actuator>',
        "  </transmission>",
    ]


def leg(side, parts):
    sign = 1.0 if side == "left" else -1.0
    out = []
    for name, parent, child, origin, axis, lower, upper, drive in LEG_JOINTS:
        out += link(f"{side}_{child}", parts.pop(f"{side}_{child}"))
        out += joint(
            f"{side}_{name}",
            "revolute",
            f"{side}_{parent}" if parent else "pelvis",
            f"{side}_{child}",
            origin or (0.0, sign * L2 / 2.0, 0.0),
            turning(axis, lower, upper, f"{effort(drive):.2f}", f"{speed(drive):.2f}"),
        )
        out += transmission(f"{side}_{name}", drive)
    out += ["  <!-- Passive: the elastic segment of the foot. No drive, effort 0. -->"]
    out += link(f"{side}_toe", parts.pop(f"{side}_toe"))
    out += joint(
        f"{side}_toe_passive",
        "revolute",
        f"{side}_foot",
        f"{side}_toe",
        (TOE_AXIS_X_M, 0.0, -L6 + FOOT_THICKNESS_M / 2.0),
        turning("0 1 0", TOE_LOWER_RAD, TOE_UPPER_RAD, "0", "20")
        + [f'<dynamics damping="{number(TOE_DAMPING_NMS_RAD)}" friction="0"/>'],
    )
    out += [
        f'  <passive joint="{side}_toe_passive" stiffness_Nm_rad="{number(TOE_STIFFNESS_NM_RAD)}" '
        f'damping_Nms_rad="{number(TOE_DAMPING_NMS_RAD)}"/>'
    ]
    out += frame(f"{side}_sole", f"{side}_foot", (0.0, 0.0, -L6))
    for name, parent, at in FORCE_SENSORS:
        out += frame(f"{side}_{name}", f"{side}_{parent}", (at[0], sign * at[1], at[2]))
    return out


def frame(name, parent, at):
    return link(name, []) + joint(f"{name}_frame", "fixed", parent, name, at)


def robot():
    parts = read_parts()
    mass = sum(p.mass for of_link in parts.values() for p in of_link)
    if abs(mass - TOTAL_MASS_KG) > 1e-9:
        raise ValueError(f"the parts weigh {mass} kg, expected {TOTAL_MASS_KG} kg")
    out = [
        '<?xml version="1.0"?>',
        "<!-- NU-Biped-4.7 as a model, written by generate.py from shapes.csv: change these, not this file.",
        "     README.md derives every figure. Frames are parallel with all joints at 0: x forward, y left, z up;",
        "     the base is midway between the hip centres. Driven joints have a transmission and an effort above 0. -->",
        '<robot name="biped">',
    ]
    for name, rgba in MATERIALS.items():
        out += [f'  <material name="{name}"><color rgba="{rgba}"/></material>']
    out += link("base", [])
    out += link("pelvis", parts.pop("pelvis"))
    out += joint("pelvis_mount", "fixed", "base", "pelvis", (0.0, 0.0, 0.0))
    for side in ("left", "right"):
        out += leg(side, parts)
    out += link("torso", parts.pop("torso"))
    out += joint("torso_mount", "fixed", "pelvis", "torso", (0.0, 0.0, L1 - TORSO_HEIGHT_M))
    out += frame("imu", "torso", (0.0, 0.0, 0.06))
    if parts:
        raise ValueError(f"shapes.csv has links that the robot does not: {sorted(parts)}")
    return "\n".join(out + ["</robot>", ""])


def main():
    if sys.argv[1:] == ["--print"]:
        sys.stdout.write(robot())
    elif not sys.argv[1:]:
        (HERE / "biped.urdf").write_text(robot(), encoding="utf-8")
    else:
        sys.exit(__doc__)


if __name__ == "__main__":
    main()
