#!/usr/bin/env python3
"""Writes the robot's files from the lengths and motors below and the parts of shapes.csv. README.md derives each figure.

    generate.py                writes all of FILES beside this file
    generate.py --print NAME   writes one of them to the standard output
"""

import csv
import math
import pathlib
import re
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

# Rotors: stator diameter and height by the motor's name. The ML3510 behind a planetary gearbox of 100:1 is the rig's
# actuator, whose declared values (robots/rig/model.yaml, at the output) are taken over; others are scaled from it.
STATOR_M = {"ML3510": (0.035, 0.010), "ML5008": (0.050, 0.008)}
RIG_GEAR_RATIO = 100.0
RIG_ROTOR_INERTIA_KG_M2 = 0.115 / RIG_GEAR_RATIO**2
RIG_VISCOUS_NM_S_RAD = 0.31 / RIG_GEAR_RATIO**2
RIG_COULOMB_NM = 0.22 / RIG_GEAR_RATIO
BELL_BEYOND_STATOR_M = 0.0015  # from the stator's edge to the middle of the ring of magnets and iron
WAVE_GENERATOR_COULOMB_NM = 0.02
DECLARED_TOLERANCE, SCALED_TOLERANCE = 0.15, 0.3

# SEA-PEA actuators: the rig's free play, and an element that carries this share of the joint's static torque at the
# squat's lowest point under this pressure. The joint's limit at which it has no torque: lower or upper.
BACKLASH_RAD = 0.0464258
TEETH_COMPLIANCE_RAD_NM = 5.0e-5
ELEMENT_SHARE, ELEMENT_PRESSURE_BAR = 0.5, 4.0
ELEMENT_SLACK_AT = {"knee": "lower", "ankle_pitch": "upper"}
SQUAT_DEPTH_M = 0.4
GRAVITY_M_S2 = 9.81

# name, parent, child, origin, axis, lower, upper, drive. In the order of the joints.
LEG_JOINTS = [
    ("hip_yaw", None, "hip_yaw_link", None, "0 0 1", -0.6, 0.6, "planetary_50"),
    ("hip_roll", "hip_yaw_link", "hip_roll_link", (0.0, 0.0, 0.0), "1 0 0", -0.5, 0.5, "harmonic_80"),
    ("hip_pitch", "hip_roll_link", "thigh", (0.0, 0.0, 0.0), "0 1 0", -1.9, 0.6, "harmonic_80"),
    ("knee", "thigh", "shank", (0.0, 0.0, -L3), "0 1 0", 0.0, 2.75, "planetary_100"),
    ("ankle_pitch", "shank", "ankle", (0.0, 0.0, -L4), "0 1 0", -1.6, 0.8, "planetary_100"),
    ("ankle_roll", "ankle", "foot", (0.0, 0.0, -L5), "1 0 0", -0.5, 0.5, "planetary_50"),
]

# The elastic segment as a beam of TPU, as high as the plates that it joins: stiffness E w h^3 / (12 l). Its damping from
# the loss factor of TPU at room temperature: loss factor x stiffness / (2 pi f), f the frequency at which the robot rocks.
TPU_MODULUS_PA = 26e6
TPU_WIDTH_M, TPU_HEIGHT_M, TPU_LENGTH_M = 0.09, FOOT_THICKNESS_M, 0.02
TOE_STIFFNESS_NM_RAD = TPU_MODULUS_PA * TPU_WIDTH_M * TPU_HEIGHT_M**3 / (12.0 * TPU_LENGTH_M)
TPU_LOSS_FACTOR, ROCKING_HZ = 0.1, 2.0
TOE_DAMPING_NMS_RAD = TPU_LOSS_FACTOR * TOE_STIFFNESS_NM_RAD / (2.0 * math.pi * ROCKING_HZ)
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

# Through CAN: a bus for each leg, axes 1 to 6 in the order of LEG_JOINTS. ODrive's rule for its torque constant is
# 8.27 / KV. Twice the reference's velocity limit is the joints' (reference_benchmark.yaml).
ODRIVE_TORQUE_CONSTANT_KV = 8.27
JOINT_VELOCITY_RAD_S = 4.0
# ms: the fuller bus carries what README.md computes from them.
ESTIMATES_EVERY_MS, BODY_SAMPLES_EVERY_MS, WATCHDOG_MS = 3, 4, 100
# Standard deviations of the simulated IMU: the bounds of components/robot/fall/imu_check.h.
IMU_FORCE_NOISE_M_S2, IMU_RATE_NOISE_RAD_S = 0.05, 1.7e-3
CAN_BUSES = """buses:
  - {name: left, transport: virtual, bus: biped_left, bitrate_bit_s: 1000000}
  - {name: right, transport: virtual, bus: biped_right, bitrate_bit_s: 1000000}
"""

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


def toe_joint(side, locked):
    origin = (TOE_AXIS_X_M, 0.0, -L6 + FOOT_THICKNESS_M / 2.0)
    if locked:
        return joint(f"{side}_toe_locked", "fixed", f"{side}_foot", f"{side}_toe", origin)
    out = joint(
        f"{side}_toe_passive",
        "revolute",
        f"{side}_foot",
        f"{side}_toe",
        origin,
        turning("0 1 0", TOE_LOWER_RAD, TOE_UPPER_RAD, "0", "20")
        + [f'<dynamics damping="{number(TOE_DAMPING_NMS_RAD)}" friction="0"/>'],
    )
    return out + [
        f'  <passive joint="{side}_toe_passive" stiffness_Nm_rad="{number(TOE_STIFFNESS_NM_RAD)}" '
        f'damping_Nms_rad="{number(TOE_DAMPING_NMS_RAD)}"/>'
    ]


def leg(side, parts, toes_locked):
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
    if not toes_locked:
        out += ["  <!-- Passive: the elastic segment of the foot. No drive, effort 0. -->"]
    out += link(f"{side}_toe", parts.pop(f"{side}_toe"))
    out += toe_joint(side, toes_locked)
    out += frame(f"{side}_sole", f"{side}_foot", (0.0, 0.0, -L6))
    for name, parent, at in FORCE_SENSORS:
        out += frame(f"{side}_{name}", f"{side}_{parent}", (at[0], sign * at[1], at[2]))
    return out


def frame(name, parent, at):
    return link(name, []) + joint(f"{name}_frame", "fixed", parent, name, at)


def urdf(toes_locked):
    parts = read_parts()
    mass = sum(p.mass for of_link in parts.values() for p in of_link)
    if abs(mass - TOTAL_MASS_KG) > 1e-9:
        raise ValueError(f"the parts weigh {mass} kg, expected {TOTAL_MASS_KG} kg")
    out = [
        '<?xml version="1.0"?>',
        "<!-- NU-Biped-4.7 as a model, written by generate.py from shapes.csv: change these, not this file.",
        "     README.md derives every figure. Frames are parallel with all joints at 0: x forward, y left, z up;",
        "     the base is midway between the hip centres. Driven joints have a transmission and an effort above 0. -->",
        f'<robot name="{"biped_stand" if toes_locked else "biped"}">',
    ]
    if toes_locked:
        out.insert(-1, "<!-- On the stand: the base is fixed, the toes do not move in their joints. -->")
    for name, rgba in MATERIALS.items():
        out += [f'  <material name="{name}"><color rgba="{rgba}"/></material>']
    out += link("base", [])
    out += link("pelvis", parts.pop("pelvis"))
    out += joint("pelvis_mount", "fixed", "base", "pelvis", (0.0, 0.0, 0.0))
    for side in ("left", "right"):
        out += leg(side, parts, toes_locked)
    out += link("torso", parts.pop("torso"))
    out += joint("torso_mount", "fixed", "pelvis", "torso", (0.0, 0.0, L1 - TORSO_HEIGHT_M))
    out += frame("imu", "torso", (0.0, 0.0, 0.06))
    if parts:
        raise ValueError(f"shapes.csv has links that the robot does not: {sorted(parts)}")
    return "\n".join(out + ["</robot>", ""])


def rotor_inertia(motor):
    """Of the motor alone, kg m2: a ring has the inertia 2 pi rho t h r^3, so that of another motor is as h r^3."""

    def size(name):
        diameter, height = STATOR_M[name]
        return height * (diameter / 2.0 + BELL_BEYOND_STATOR_M) ** 3

    return RIG_ROTOR_INERTIA_KG_M2 * size(motor) / size("ML3510")


def static_torques():
    """Joint -> torque of its drive, N m, that holds the squat's lowest point, one leg bearing half of the robot.

    In the plane of a leg, foot flat below the hip: the torque of the weights above the joint about it.
    """
    parts = read_parts()
    height = L3 + L4 - SQUAT_DEPTH_M
    knee = math.acos((height**2 - L3**2 - L4**2) / (2.0 * L3 * L4))
    hip = -math.atan2(L4 * math.sin(knee), L3 + L4 * math.cos(knee))

    def turned(angle, at):  # about y, positive moves what is below back
        return at[0] * math.cos(angle) + at[2] * math.sin(angle)

    def moment(link_name, origin_x, angle, share=1.0):  # mass and mass times x, x forward of the hip
        of_link = parts[link_name]
        mass = share * sum(p.mass for p in of_link)
        return mass, share * sum(p.mass * (origin_x + turned(angle, p.at)) for p in of_link)

    knee_x = turned(hip, (0.0, 0.0, -L3))
    above = [moment("pelvis", 0.0, 0.0, 0.5), moment("torso", 0.0, 0.0, 0.5)]
    above += [moment("left_hip_yaw_link", 0.0, 0.0), moment("left_hip_roll_link", 0.0, 0.0)]
    above += [moment("left_thigh", 0.0, hip)]
    torque = {"knee": GRAVITY_M_S2 * sum(mx - m * knee_x for m, mx in above)}
    above += [moment("left_shank", knee_x, hip + knee)]  # the ankle is below the hip
    torque["ankle_pitch"] = GRAVITY_M_S2 * sum(mx for _, mx in above)
    return torque, {"knee": knee, "ankle_pitch": -hip - knee}


def parameter(value, tolerance=0.0, fixed=False):
    more = f", tolerance: {tolerance:g}" if tolerance else ""
    return f"{{value: {value:.6g}{more}{', fixed: true' if fixed else ''}}}"


def term(effect, *parameters):
    return [f"      - effect: {effect}"] + [f"        {key}: {value}" for key, value in parameters]


def friction(drive):
    """Coulomb and viscous friction of motor and gearbox, both at the joint."""
    _, reduction = DRIVES[drive]
    motor_side = WAVE_GENERATOR_COULOMB_NM if drive.startswith("harmonic") else RIG_COULOMB_NM
    return motor_side * reduction, RIG_VISCOUS_NM_S_RAD * reduction**2


def sea_pea_terms(name, lower, upper):
    torque, lowest = static_torques()
    slope = ELEMENT_SHARE * torque[name] / ELEMENT_PRESSURE_BAR  # at the lowest point, N m/bar
    slack_at = lower if ELEMENT_SLACK_AT[name] == "lower" else upper
    stiffness = slope / (slack_at - lowest[name])  # so that slope - stiffness (slack - lowest) is 0
    return (
        term("pneumatic_torque", ("pneumatic_torque_Nm_bar", parameter(slope, SCALED_TOLERANCE)))
        + term(
            "pneumatic_stiffness",
            ("pneumatic_stiffness_Nm_rad_bar", parameter(stiffness, SCALED_TOLERANCE)),
            ("rest_angle_rad", parameter(lowest[name], fixed=True)),
        )
        + term("encoder_difference", ("balance", "kinematic"), ("share", parameter(1.0, fixed=True)))
        + term(
            "free_play",
            ("balance", "kinematic"),
            ("width_rad", parameter(BACKLASH_RAD, fixed=True)),
            ("compliance_rad_Nm", parameter(TEETH_COMPLIANCE_RAD_NM, fixed=True)),
        )
        + term("encoder_offset", ("balance", "kinematic"), ("offset_rad", parameter(0.0)))
    )


def joint_model(side, row, sea_pea):
    name, _, _, _, _, lower, upper, drive = row
    motor, reduction = DRIVES[drive]
    known = drive == "planetary_100"
    tolerance = DECLARED_TOLERANCE if known else SCALED_TOLERANCE
    coulomb, viscous = friction(drive)
    has_play = sea_pea and name in ELEMENT_SLACK_AT
    out = [
        f"  - name: {side}_{name}",
        "    kind: rotary",
        f"    constants: {{gear_ratio: {reduction:g}, torque_constant_Nm_A: {torque_constant(motor):.6g}}}",
    ]
    if has_play:
        out += [f"    backlash_rad: {BACKLASH_RAD}"]
    out += [
        f"    motor_torque_limit_Nm: {torque_constant(motor) * CURRENT_LIMIT_A:.6g}",
        "    terms:",
    ]
    out += term("drive_current", ("efficiency", parameter(EFFICIENCY, DECLARED_TOLERANCE)))
    inertia = rotor_inertia(motor) * reduction**2
    out += term("rotor_inertia", ("rotor_inertia_kg_m2", parameter(inertia, tolerance)))
    out += term("motor_viscous", ("viscous_Nm_s_rad", parameter(viscous, tolerance)))
    out += term("coulomb", ("coulomb_Nm", parameter(coulomb, tolerance)))
    if has_play:
        out += sea_pea_terms(name, lower, upper)
    return out + ["    history: []"]


def model(sea_pea):
    what = "SEA-PEA actuators in knees and ankle pitch, rigid ones elsewhere" if sea_pea else "rigid actuators"
    out = [
        f"# The biped's joints, {what}. Written by generate.py: change that, not this file.",
        "# Inertia and weight of the links are the URDF's; README.md derives the values.",
        "schema: sinew-model/1",
        f"name: {'biped_sea_pea' if sea_pea else 'biped'}",
        "urdf: biped.urdf",
        "joints:",
    ]
    for side in ("left", "right"):
        for row in LEG_JOINTS:
            out += joint_model(side, row, sea_pea)
    out += ["floating_base:", "  foot_force:          # in the order of the topic"]
    for side in ("right", "left"):
        for place in ("rear_outer", "rear_inner", "front_outer", "front_inner"):
            out.append(f"    - {side}_force_{place}")
    out.append("  imu: imu")
    return "\n".join(out + [""])


def constants(drive):
    """Of an axis, as bridge and virtual axes name them."""
    motor, reduction = DRIVES[drive]
    return (
        f"gear_ratio: {reduction:g}, torque_constant_Nm_A: {torque_constant(motor):.6g}, "
        f"controller_torque_constant_Nm_A: {ODRIVE_TORQUE_CONSTANT_KV / KV_RPM_V[motor]:.6g}"
    )


def can_bridge():
    out = [
        "# The biped behind CAN: who is where on the two buses, and the limits. Keys: docs/participants/can_bridge.md.",
        "# Written by generate.py: change that, not this file. As it stands it joins the virtual buses biped_left and",
        "# biped_right; for the robot: origin: live, transport: socketcan, interface; firmware, serial_number, direction and",
        "# zero_rev of each axis, mounting_rpy_rad of the IMU.",
        "schema: sinew-can-bridge/1",
        "origin: sim",
        CAN_BUSES.rstrip(),
        "joints:  # no limits.braking: on the ground a leg stops the whole robot, which is no inertia of one joint",
    ]
    for side in ("left", "right"):
        for node, (name, *_, lower, upper, drive) in enumerate(LEG_JOINTS, 1):
            motor_torque = torque_constant(DRIVES[drive][0]) * CURRENT_LIMIT_A
            out += [
                f"  - {{name: {side}_{name}, bus: {side}, node: {node}, torque_efficiency: {EFFICIENCY},",
                f"     {constants(drive)},",
                f"     limits: {{motor_torque_Nm: {motor_torque:.6g}, current_A: {CURRENT_LIMIT_A:g}, "
                f"velocity_rad_s: {JOINT_VELOCITY_RAD_S:g}, lower_rad: {lower:g}, upper_rad: {upper:g}}}}}",
            ]
    return (
        "\n".join(out)
        + """
body_nodes:
  - {bus: left, node: 40, sensor: left_foot}
  - {bus: right, node: 40, sensor: right_foot}
  - {bus: left, node: 42, sensor: imu}
timing:
  estimates: cyclic
  iq_every_cycles: 4
  estimate_timeout_ms: 20    # older: not valid
  lost_after_ms: 60          # older: fault of the joint; of a foot or the IMU: it counts as lost
  heartbeat_timeout_ms: 350
  start_timeout_ms: 10000
guard:
  missed_periods: 3
  fault_after_ms: 60
  bridging: hold             # a robot that is damped falls
  on_joint_fault: hold
  fall: {urdf: biped.urdf, on_fall: idle}   # a fall, or the loss of IMU, feet or leg positions: motors off
"""
    )


def virtual_axes():
    out = [
        "# The biped's motor controllers, feet and IMU as nodes on two buses, with the robot of world.yaml behind them.",
        "# docs/participants/virtual_axes.md has the keys. Written by generate.py: change that, not this file.",
        "schema: sinew-virtual-axes/1",
        CAN_BUSES.rstrip(),
        "world: world.yaml",
        "step_ms: 1",
        "hold_start_s: 2.5            # it hangs until its drives can carry it and the fall detector has started (2 s)",
        "axes:",
    ]
    for side_index, side in enumerate(("left", "right")):
        for index, (*_, drive) in enumerate(LEG_JOINTS):
            motor, _ = DRIVES[drive]
            out += [
                f"  - {{bus: {side}, node: {index + 1}, joint: {len(LEG_JOINTS) * side_index + index},",
                f"     {constants(drive)},",
                f"     velocity_limit_rev_s: {KV_RPM_V[motor] * SUPPLY_V / 60.0:g}, current_limit_A: {CURRENT_LIMIT_A:g}, "
                f"watchdog_ms: {WATCHDOG_MS}, encoder_ms: {ESTIMATES_EVERY_MS}}}",
            ]
    body = f"sample_ms: {BODY_SAMPLES_EVERY_MS}"
    noise = f"force_noise_m_s2: {IMU_FORCE_NOISE_M_S2}, rate_noise_rad_s: {IMU_RATE_NOISE_RAD_S}"
    out += [
        "body_nodes:",
        f"  - {{bus: left, node: 40, sensor: left_foot, {body}}}",
        f"  - {{bus: right, node: 40, sensor: right_foot, {body}}}",
        f"  - {{bus: left, node: 42, sensor: imu, {body}, {noise}}}",
    ]
    return "\n".join(out + [""])


FILES = {
    "biped.urdf": lambda: urdf(toes_locked=False),
    "biped_stand.urdf": lambda: urdf(toes_locked=True),
    "model.yaml": lambda: model(sea_pea=False),
    "model_sea_pea.yaml": lambda: model(sea_pea=True),
    "can_bridge.yaml": can_bridge,
    "virtual_axes.yaml": virtual_axes,
}


def content(name):
    """The file, with the line by which editors find its schema."""
    text = FILES[name]()
    schema = re.search(r"^schema: sinew-([a-z-]+)/(\d+)$", text, re.MULTILINE)
    return f"# yaml-language-server: $schema=../../schemas/{schema[1]}-{schema[2]}.json\n{text}" if schema else text


def main():
    arguments = sys.argv[1:]
    if len(arguments) == 2 and arguments[0] == "--print" and arguments[1] in FILES:
        sys.stdout.write(content(arguments[1]))
    elif not arguments:
        for name in FILES:
            (HERE / name).write_text(content(name), encoding="utf-8")
    else:
        sys.exit(__doc__ + "\nFILES: " + ", ".join(FILES))


if __name__ == "__main__":
    main()
