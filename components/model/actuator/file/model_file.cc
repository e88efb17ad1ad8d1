#include "components/model/actuator/file/model_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "components/base/config/yaml_text.h"
#include "components/base/types/json_text.h"

namespace sinew::actuator {

namespace {

using config::kNotNegative;
using config::kPositive;
using config::Section;

// "About 5-15 % off": the rms of what lies evenly between the two, sqrt((15^3 - 5^3) / 30) = 10.4
// %.
constexpr double kRigTolerance = 0.10;

// Shortest text that reads back as the same number.
std::string Number(double value) {
  char text[40];
  const auto result = std::to_chars(text, text + sizeof text, value);
  return std::string(text, result.ptr);
}

// A key of that name with another unit, or none.
[[noreturn]] void FailMissing(const Section& term, const effects::EffectInfo& effect,
                              const effects::ParameterInfo& info, types::JointKind kind) {
  const std::string key = effects::ParameterKey(info, kind);
  std::set<std::string> right_keys;
  for (const auto& other : effect.linear) right_keys.insert(effects::ParameterKey(other, kind));
  for (const auto& other : effect.nonlinear) right_keys.insert(effects::ParameterKey(other, kind));
  for (const std::string& other : term.Keys()) {
    const bool same_name = other == info.name || other.starts_with(info.name + "_");
    if (same_name && !right_keys.contains(other)) {
      term.Fail(other, "wrong unit, expected '" + key + "' (" + info.meaning + ")");
    }
  }
  term.Fail(key, "missing, expected a number or {value, tolerance, fixed} (" + info.meaning + ")");
}

ParameterValue DescribeParameter(config::Fields& f, const std::string& key,
                                 const effects::ParameterInfo& info, bool needed) {
  ParameterValue c{.value = info.default_value, .half_width_95 = std::nullopt};
  const auto body = [&c](config::Fields& g) {
    g.Need("value", c.value, "of the parameter");
    g.NumberOr(
        "tolerance", c.tolerance, {0.0, 10.0},
        "standard deviation before the fit: share of the value, or {absolute: in its unit}",
        [&c](config::Fields& h) {
          h.Need("absolute", c.tolerance_absolute, kPositive, "in the key's unit");
        },
        false);
    g("fixed", c.fixed, "known exactly, never refitted");
    g("half_width_95", c.half_width_95, kNotNegative, "of the last fit");
  };
  f.NumberOr(key, c.value, {}, info.meaning, body, needed);
  return c;
}

std::vector<ParameterValue> DescribeParameters(config::Fields& f, const effects::EffectInfo& effect,
                                               const std::vector<effects::ParameterInfo>& infos,
                                               types::JointKind kind) {
  std::vector<ParameterValue> values;
  for (const effects::ParameterInfo& info : infos) {
    const std::string key = effects::ParameterKey(info, kind);
    if (f.reads() && !info.optional && !f.section().Has(key)) {
      FailMissing(f.section(), effect, info, kind);
    }
    values.push_back(DescribeParameter(f, key, info, f.reads() && !info.optional));
  }
  return values;
}

// The effects of the catalogue, each with its parameters in the units of both kinds of joint.
void DescribeCatalogue(config::Fields& f, const JointModel& joint) {
  const auto effect = f.NeedWord("effect", effects::EffectNames(), "`sinew effects`");
  for (const effects::EffectForm& form : effects::EffectForms()) {
    const auto is = effect.Is({form.name});
    const auto made = effects::MakeEffect(form.name, joint.constants, form.balance);
    for (const auto kind : {types::JointKind::kRevolute, types::JointKind::kPrismatic}) {
      DescribeParameters(f, made->info(), made->info().linear, kind);
      DescribeParameters(f, made->info(), made->info().nonlinear, kind);
    }
  }
}

// The effect belongs to this joint.
void CheckTerm(const config::Fields& f, const JointModel& joint) {
  const Term& term = joint.terms.back();
  const effects::EffectInfo& info = term.effect->info();
  const bool repeatable = !term.nonlinear.empty();  // two orders of cogging, say
  if (!repeatable &&
      joint.Find(info.name, info.balance) != static_cast<int>(joint.terms.size()) - 1) {
    f.Fail("effect", "'" + info.name + "' is given twice");
  }
  if (info.name == "gas_compression" && !(joint.constants.gas_volume_m3 > 0.0)) {
    f.Fail("effect", "'gas_compression' needs constants.gas_volume_m3, more than 0");
  }
  if (info.name == "free_play" && std::abs(term.linear[0].value - joint.backlash_rad) > 1e-9) {
    f.Fail(effects::ParameterKey(info.linear[0], joint.kind),
           "expected the joint's backlash, " + Number(joint.backlash_rad));
  }
}

void DescribeTerm(config::Fields& f, JointModel* joint) {
  Term term;
  std::string name;
  std::optional<effects::Balance> balance;
  f.Word("balance", balance,
         {{"motion", effects::Balance::kMotion},
          {"kinematic", effects::Balance::kKinematic},
          {"gas", effects::Balance::kGas}},
         "of an effect that has several; left out: its first");
  f("declared", term.declared, "false: added by close-loop");
  if (!f.reads()) return DescribeCatalogue(f, *joint);
  f.Need("effect", name, "of the catalogue");
  try {
    term.effect = effects::MakeEffect(name, joint->constants, balance);
  } catch (const std::invalid_argument& error) {
    f.Fail("effect", error.what());
  }
  const effects::EffectInfo& info = term.effect->info();
  term.linear = DescribeParameters(f, info, info.linear, joint->kind);
  term.nonlinear = DescribeParameters(f, info, info.nonlinear, joint->kind);
  joint->terms.push_back(std::move(term));
  CheckTerm(f, *joint);
}

std::string GainKey(types::JointKind kind) {
  return kind == types::JointKind::kRevolute ? "gain_per_rad" : "gain_per_m";
}
std::string VelocityGainKey(types::JointKind kind) {
  return kind == types::JointKind::kRevolute ? "velocity_gain_s_rad" : "velocity_gain_s_m";
}

void DescribeServo(config::Fields& f, const JointModel& joint, Servo* c) {
  f.NeedWord("law", {"proportional"}, "clamp(gain (reference - q) - velocity_gain v)");
  f("~gain_per_rad", c->gain_per_rad, kPositive, "left out: differs between recordings");
  f("~velocity_gain_s_rad", c->velocity_gain_s_rad, kNotNegative, "with the gain");
  f("limit", c->limit, kPositive, "of the command; left out: none");
  f.Word("command", c->share_of_supply, {{"drive", false}, {"share_of_supply", true}},
         "the drive, or times supply_voltage");
  if (c->gain_per_rad == 0.0 && c->velocity_gain_s_rad > 0.0) {
    f.Fail("~velocity_gain_s_rad", "without '" + GainKey(joint.kind) + "', expected both or none");
  }
}

// A spring's preload and an offset are the same torque: no recording distinguishes them.
void RefuseSameTorque(const config::Fields& f, const JointModel& joint) {
  int free_terms = 0;
  for (const Term& term : joint.terms) {
    const std::string& name = term.effect->info().name;
    if (!term.declared || (name != "spring" && name != "offset")) continue;
    if (!term.linear.back().fixed) ++free_terms;  // the preload, the offset
  }
  if (free_terms < 2) return;
  f.Fail("terms",
         "the preload of 'spring' and 'offset' are the same torque, expected one of them with "
         "fixed: true");
}

// A force at a linear joint acts along its axis: its lever is 1. 0 is a lever that is not stated,
// as in files of rotary joints.
void DescribeConstants(config::Fields& f, effects::JointConstants* c) {
  f("gear_ratio", c->gear_ratio, kPositive, "motor turns per output turn");
  f("link_length_m", c->link_length_m, kNotNegative, "joint axis to load cell and payload");
  f("gravity_m_s2", c->gravity_m_s2, kNotNegative, "where the robot stands");
  f("torque_constant_Nm_A", c->torque_constant_Nm_A, kNotNegative, "motor side");
  f("force_constant_N_V", c->force_constant_N_V, kNotNegative, "drives commanded in volts");
  f("back_emf_V_s_rad", c->back_emf_V_s_rad, kNotNegative,
    "motor side; of drives whose voltage lies on the winding");
  f("encoder_counts_per_turn", c->encoder_counts_per_turn, kNotNegative,
    "of the coarser encoder at the output; 0: not stated");
  f("gas_volume_m3", c->gas_volume_m3, kNotNegative, "chamber and all it is joined to");
  f("atmosphere_bar", c->atmosphere_bar, kPositive, "absolute");
  f("valve_delay_s", c->valve_delay_s, kNotNegative, "from the command to the flow");
  const double stated_m = c->link_length_m;
  if (c->kind == types::JointKind::kRevolute) return;
  if (stated_m != 0.0 && stated_m != 1.0) {
    f.Fail("link_length_m", "is " + Number(stated_m) +
                                ", but a force at a linear joint has no lever, expected none");
  }
  c->link_length_m = 1.0;
}

void DescribeJoint(config::Fields& f, JointModel& joint) {
  f.Need("name", joint.name, "as in the topics");
  f.NeedWord("kind", joint.kind,
             {{"rotary", types::JointKind::kRevolute}, {"linear", types::JointKind::kPrismatic}},
             "units of the keys follow");
  joint.constants.kind = joint.kind;
  f.set_linear(joint.kind == types::JointKind::kPrismatic);
  f.Object("constants", "known of the machine",
           [&](config::Fields& g) { DescribeConstants(g, &joint.constants); });
  f("~backlash_rad", joint.backlash_rad, {0.0, 6.3}, "full width at the output");
  f("motor_torque_limit_Nm", joint.motor_torque_limit_Nm, kNotNegative, "at the motor shaft");
  f.NeedList("terms", {1}, "effects of the balance",
             [&](config::Fields& g) { DescribeTerm(g, &joint); });
  f.If("controller", "servo of the recordings, for simulating them",
       [&](config::Fields& g) { DescribeServo(g, joint, &joint.controller.emplace()); });
  f.List("history", {}, "what close-loop added", [&](config::Fields& g) {
    HistoryEntry& entry = joint.history.emplace_back();
    g("when", entry.when, "ISO 8601, UTC");
    g("effect", entry.effect, "that was added");
    g("recording", entry.recording, "from which data");
    g("note", entry.note, "for people");
  });
  if (!f.reads()) return;
  RefuseSameTorque(f, joint);
  RemakeEffects(&joint);
}

void Describe(config::Fields& f, Payload& c) {
  f.Need("link", c.link, "of the URDF");
  const auto with_width = [&c](config::Fields& g) {
    g.Need("value", c.mass_kg, kPositive, "as fitted");
    g("half_width_95", c.half_width_95, kNotNegative, "of the fit");
  };
  f.NumberOr("mass_kg", c.mass_kg, kPositive, "of a point", with_width);
  f.Need("position_m", c.position_m, "in the link's frame");
  f("declared", c.declared, "false: added by close-loop");
  f("position_half_width_95_m", c.position_half_width_95, kNotNegative, "of the fit");
}

void Describe(config::Fields& f, FloatingBase& c) {
  std::vector<std::string> links;
  f("foot_force", links, "eight links, in the order of the topic");
  f.Need("imu", c.imu_link, "its link");
  f("mass_tolerance", c.mass_tolerance, kNotNegative, "of links that move as one: share");
  f("com_tolerance_m", c.com_tolerance_m, kNotNegative, "of their centre of mass");
  f("tilt_tolerance_rad", c.tilt_tolerance_rad, kNotNegative, "of the IMU against the base");
  if (f.reads() && links.size() != c.force_links.size()) {
    f.Fail("foot_force", std::to_string(links.size()) + " links, expected " +
                             std::to_string(c.force_links.size()) +
                             ", those of the topic foot_force in its order");
  }
  std::copy(links.begin(), links.end(), c.force_links.begin());
}

std::string Quoted(const std::string& text) {
  YAML::Emitter out;
  out << YAML::DoubleQuoted << text;
  return out.c_str();
}

void WriteParameter(std::string& out, const effects::ParameterInfo& info,
                    const ParameterValue& parameter, types::JointKind kind) {
  out += "        " + effects::ParameterKey(info, kind) + ": {value: " + Number(parameter.value);
  if (parameter.tolerance > 0.0) out += ", tolerance: " + Number(parameter.tolerance);
  if (parameter.tolerance_absolute > 0.0) {
    out += ", tolerance: {absolute: " + Number(parameter.tolerance_absolute) + "}";
  }
  if (parameter.fixed) out += ", fixed: true";
  if (parameter.half_width_95) out += ", half_width_95: " + Number(*parameter.half_width_95);
  out += "}\n";
}

void WriteJoint(std::string& out, const JointModel& joint) {
  const bool rotary = joint.kind == types::JointKind::kRevolute;
  out += "  - name: " + Quoted(joint.name) + "\n";
  out += std::string("    kind: ") + (rotary ? "rotary" : "linear") + "\n";
  out += "    constants:\n";
  out += "      gear_ratio: " + Number(joint.constants.gear_ratio) + "\n";
  if (rotary) out += "      link_length_m: " + Number(joint.constants.link_length_m) + "\n";
  out += "      gravity_m_s2: " + Number(joint.constants.gravity_m_s2) + "\n";
  out += "      torque_constant_Nm_A: " + Number(joint.constants.torque_constant_Nm_A) + "\n";
  out += "      force_constant_N_V: " + Number(joint.constants.force_constant_N_V) + "\n";
  if (joint.constants.back_emf_V_s_rad > 0.0) {
    out += "      back_emf_V_s_rad: " + Number(joint.constants.back_emf_V_s_rad) + "\n";
  }
  if (joint.constants.encoder_counts_per_turn > 0.0) {
    out +=
        "      encoder_counts_per_turn: " + Number(joint.constants.encoder_counts_per_turn) + "\n";
  }
  if (joint.constants.gas_volume_m3 > 0.0) {
    out += "      gas_volume_m3: " + Number(joint.constants.gas_volume_m3) + "\n";
    out += "      atmosphere_bar: " + Number(joint.constants.atmosphere_bar) + "\n";
    out += "      valve_delay_s: " + Number(joint.constants.valve_delay_s) + "\n";
  }
  out += std::string("    ") + (rotary ? "backlash_rad: " : "backlash_m: ") +
         Number(joint.backlash_rad) + "\n";
  out += "    motor_torque_limit_Nm: " + Number(joint.motor_torque_limit_Nm) + "\n";
  if (joint.controller) {
    const Servo& servo = *joint.controller;
    out += "    controller: {law: proportional, command: ";
    out += servo.share_of_supply ? "share_of_supply" : "drive";
    const auto add = [&](const std::string& key, double value) {
      if (value > 0.0) out += ", " + key + ": " + Number(value);
    };
    add(GainKey(joint.kind), servo.gain_per_rad);
    add(VelocityGainKey(joint.kind), servo.velocity_gain_s_rad);
    add("limit", servo.limit);
    out += "}\n";
  }
  out += "    terms:\n";
  for (const Term& term : joint.terms) {
    const effects::EffectInfo& info = term.effect->info();
    out += "      - effect: " + info.name + "\n";
    if (info.balance != effects::Balance::kMotion) {
      out += "        balance: " + std::string(effects::BalanceName(info.balance)) + "\n";
    }
    if (!term.declared) out += "        declared: false\n";
    for (std::size_t i = 0; i < info.linear.size(); ++i) {
      WriteParameter(out, info.linear[i], term.linear[i], joint.kind);
    }
    for (std::size_t i = 0; i < info.nonlinear.size(); ++i) {
      WriteParameter(out, info.nonlinear[i], term.nonlinear[i], joint.kind);
    }
  }
  if (joint.history.empty()) {
    out += "    history: []\n";
    return;
  }
  out += "    history:\n";
  for (const HistoryEntry& entry : joint.history) {
    out += "      - when: " + Quoted(entry.when) + "\n";
    out += "        effect: " + Quoted(entry.effect) + "\n";
    out += "        recording: " + Quoted(entry.recording) + "\n";
    out += "        note: " + Quoted(entry.note) + "\n";
  }
}

std::string Triple(const std::array<double, 3>& values) {
  return "[" + Number(values[0]) + ", " + Number(values[1]) + ", " + Number(values[2]) + "]";
}

void WritePayloads(std::string& out, const std::vector<Payload>& payloads) {
  if (payloads.empty()) return;
  out += "payloads:\n";
  for (const Payload& payload : payloads) {
    out += "  - link: " + Quoted(payload.link) + "\n";
    if (!payload.declared) out += "    declared: false\n";
    out += "    mass_kg: {value: " + Number(payload.mass_kg);
    if (payload.half_width_95) out += ", half_width_95: " + Number(*payload.half_width_95);
    out += "}\n    position_m: " + Triple(payload.position_m) + "\n";
    if (payload.position_half_width_95) {
      out += "    position_half_width_95_m: " + Triple(*payload.position_half_width_95) + "\n";
    }
  }
}

void WriteFloatingBase(std::string& out, const FloatingBase& base) {
  out += "floating_base:\n  foot_force:\n";
  for (const std::string& link : base.force_links) out += "    - " + Quoted(link) + "\n";
  out += "  imu: " + Quoted(base.imu_link) + "\n";
  out += "  mass_tolerance: " + Number(base.mass_tolerance) + "\n";
  out += "  com_tolerance_m: " + Number(base.com_tolerance_m) + "\n";
  out += "  tilt_tolerance_rad: " + Number(base.tilt_tolerance_rad) + "\n";
}

// A rig's file: {value, unit, trust} by group and key.
struct RigJson {
  std::string where;
  nlohmann::json rig;

  static RigJson Load(const std::filesystem::path& path) {
    const std::string text = config::ReadFile(path);
    try {
      return {path.string(), types::ParseJson<nlohmann::json>(text, path.string())};
    } catch (const std::invalid_argument& error) {
      throw UsageError(error.what());
    }
  }

  static std::string TextOf(const nlohmann::json& entry, const char* key) {
    return entry.contains(key) && entry[key].is_string() ? entry[key].get<std::string>() : "";
  }

  const nlohmann::json& Entry(const char* group, const char* key, const char* unit) const {
    const std::string name = std::string(group) + "." + key;
    if (!rig.is_object() || !rig.contains(group) || !rig[group].is_object() ||
        !rig[group].contains(key)) {
      throw UsageError(where + ": key '" + name + "': missing, expected {value, unit, trust}");
    }
    const nlohmann::json& found = rig[group][key];
    if (!found.is_object() || !found.contains("value") || !found["value"].is_number()) {
      throw UsageError(where + ": key '" + name + ".value': expected a number");
    }
    const std::string given = TextOf(found, "unit");
    if (given != unit && !given.starts_with(std::string(unit) + " (")) {
      throw UsageError(where + ": key '" + name + ".unit': '" + given + "', expected '" + unit +
                       "'");
    }
    return found;
  }

  double Constant(const char* key, const char* unit) const {
    return Entry("constants", key, unit)["value"].get<double>();
  }

  ParameterValue Nominal(const char* key, const char* unit) const {
    const nlohmann::json& found = Entry("nominal_parameters", key, unit);
    const bool exact = TextOf(found, "trust").find("exact") != std::string::npos;
    return {.value = found["value"].get<double>(),
            .tolerance = exact ? 0.0 : kRigTolerance,
            .fixed = exact,
            .half_width_95 = std::nullopt};
  }
};

ParameterValue Exactly(double value) {
  return {.value = value, .tolerance = 0.0, .fixed = true, .half_width_95 = std::nullopt};
}

}  // namespace

void Describe(config::Fields& f, RobotModel& c) {
  std::optional<std::filesystem::path> urdf;
  f.Need("name", c.name, "of the robot");
  f("urdf", urdf, "of the robot, relative to this file");
  if (urdf) c.urdf_path = std::filesystem::absolute(*urdf).lexically_normal();
  f.NeedList("joints", {1}, "in the order of the topics", [&](config::Fields& g) {
    JointModel joint;
    DescribeJoint(g, joint);
    for (const JointModel& other : c.joints) {
      g.Require(other.name != joint.name, "name", "'" + joint.name + "' is given twice");
    }
    c.joints.push_back(std::move(joint));
  });
  f.List("payloads", {}, "point masses that the URDF lacks",
         [&](config::Fields& g) { Describe(g, c.payloads.emplace_back()); });
  f.If("floating_base", "the robot stands on two feet",
       [&](config::Fields& g) { Describe(g, c.floating_base.emplace()); });
  f.Others({"processing", "as_published", "data_gate"});
}

ModelFile LoadModelFile(const std::filesystem::path& path) {
  if (path.extension() == ".json") {
    ModelFile file;
    file.robot = LoadRigJson(path);
    file.root = Section::Empty(path.string());
    return file;
  }
  const std::string text = config::ReadFile(path);
  ModelFile file;
  file.root = Section::Parse(text, path.string(), kSchema);
  file.robot = config::Read<RobotModel>(file.root);
  const YAML::Node document = config::ParseYaml(text, path.string());
  for (const std::string_view block : kForeignBlocks) {
    if (!file.root.Has(block)) continue;
    YAML::Emitter out;
    out << document[std::string(block)];
    file.foreign_text[std::string(block)] = out.c_str();
  }
  return file;
}

RobotModel LoadRobotModel(const std::filesystem::path& path) { return LoadModelFile(path).robot; }

RobotModel LoadRigJson(const std::filesystem::path& path) {
  const RigJson rig = RigJson::Load(path);
  JointModel joint;
  joint.name = "joint";
  joint.constants.gear_ratio = rig.Constant("gear_ratio", "1");
  joint.constants.link_length_m = rig.Constant("link_length", "m");
  joint.constants.gravity_m_s2 = rig.Constant("gravity", "m/s^2");
  joint.constants.torque_constant_Nm_A = rig.Constant("torque_constant", "N m/A");
  joint.constants.encoder_counts_per_turn = rig.Constant("encoder_counts_per_turn", "1");
  joint.backlash_rad = rig.Constant("free_play_full_width", "rad");
  joint.motor_torque_limit_Nm =
      rig.Constant("current_limit", "A") * joint.constants.torque_constant_Nm_A;
  const auto add = [&](const char* effect, std::vector<ParameterValue> linear,
                       std::vector<ParameterValue> nonlinear = {}) {
    Term term = MakeTerm(effect, joint.constants);
    term.linear = std::move(linear);
    term.nonlinear = std::move(nonlinear);
    joint.terms.push_back(std::move(term));
  };
  add("drive_current", {rig.Nominal("efficiency", "1")});
  add("rotor_inertia", {rig.Nominal("rotor_inertia_at_output", "kg m^2")});
  add("link_inertia", {rig.Nominal("link_inertia", "kg m^2")});
  add("declared_payload", {Exactly(1.0)});
  add("motor_viscous", {rig.Nominal("viscous_friction", "N m s/rad")});
  add("coulomb", {rig.Nominal("coulomb_friction", "N m")});
  add("gravity", {rig.Nominal("gravity_torque", "N m")});
  add("pneumatic_torque", {rig.Nominal("pneumatic_torque_slope", "N m/bar")});
  add("pneumatic_stiffness", {rig.Nominal("pneumatic_stiffness_slope", "N m/(rad bar)")},
      {rig.Nominal("pneumatic_rest_angle", "rad")});
  add("load_force", {Exactly(1.0)});
  // Both encoders: their difference is half of the play where the teeth touch.
  add("encoder_difference", {Exactly(1.0)});
  add("free_play", {Exactly(joint.backlash_rad), Exactly(0.0)});
  add("encoder_offset", {{.value = 0.0, .half_width_95 = std::nullopt}});
  // Pressure: gas is compressed while the valve is shut; a rig without a stated volume has none.
  if (rig.rig["nominal_parameters"].contains("gas_volume")) {
    const ParameterValue volume = rig.Nominal("gas_volume", "m^3");
    if (!(volume.value > 0.0)) {
      throw UsageError(rig.where +
                       ": key 'nominal_parameters.gas_volume.value': expected more than 0");
    }
    joint.constants.gas_volume_m3 = volume.value;
    ParameterValue share = volume;
    share.value = 1.0;
    add("chamber_pressure", {Exactly(1.0)});
    add("gas_compression", {share});
    add("valve_flow", {Exactly(1.0)});
  }
  RemakeEffects(&joint);

  RobotModel robot;
  robot.name = "rig";
  robot.joints.push_back(std::move(joint));
  return robot;
}

std::string FormatModel(const RobotModel& robot,
                        const std::map<std::string, std::string>& foreign_text,
                        const std::filesystem::path& folder) {
  std::string out = "schema: " + std::string(kSchema) + "\n";
  out += "name: " + Quoted(robot.name) + "\n";
  if (!robot.urdf_path.empty()) {
    const std::filesystem::path urdf = robot.urdf_path;
    const std::filesystem::path from = std::filesystem::absolute(folder).lexically_normal();
    const std::filesystem::path shown = urdf.is_absolute() ? urdf.lexically_relative(from) : urdf;
    out += "urdf: " + Quoted((shown.empty() ? urdf : shown).string()) + "\n";
  }
  out += "joints:\n";
  for (const JointModel& joint : robot.joints) WriteJoint(out, joint);
  WritePayloads(out, robot.payloads);
  if (robot.floating_base) WriteFloatingBase(out, *robot.floating_base);
  for (const auto& [key, text] : foreign_text) {
    YAML::Emitter emitter;
    emitter << YAML::BeginMap << YAML::Key << key << YAML::Value << config::ParseYaml(text, key)
            << YAML::EndMap;
    out += std::string(emitter.c_str()) + "\n";
  }
  return out;
}

void SaveModelFile(const std::filesystem::path& path, const ModelFile& file) {
  config::WriteFileAtomically(path, FormatModel(file.robot, file.foreign_text, path.parent_path()));
}

void SaveRobotModel(const std::filesystem::path& path, const RobotModel& robot) {
  SaveModelFile(path, ModelFile{.robot = robot, .foreign_text = {}});
}

}  // namespace sinew::actuator
