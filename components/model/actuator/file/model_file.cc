#include "components/model/actuator/file/model_file.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "components/base/config/yaml_text.h"

namespace sinew::actuator {

namespace {

using config::Section;

constexpr std::string_view kSchema = "sinew-model/1";

// "About 5-15 % off": the rms of what lies evenly between the two, sqrt((15^3 - 5^3) / 30) = 10.4
// %.
constexpr double kRigTolerance = 0.10;

// Shortest text that reads back as the same number.
std::string Number(double value) {
  char text[40];
  const auto result = std::to_chars(text, text + sizeof text, value);
  return std::string(text, result.ptr);
}

ParameterValue ReadParameter(const Section& term, const effects::EffectInfo& effect,
                             const effects::ParameterInfo& info, types::JointKind kind) {
  const std::string key = effects::ParameterKey(info, kind);
  if (!term.Has(key) && info.optional) {
    return {.value = info.default_value, .half_width_95 = std::nullopt};
  }
  if (!term.Has(key)) {
    std::set<std::string> right_keys;
    for (const auto& other : effect.linear) right_keys.insert(effects::ParameterKey(other, kind));
    for (const auto& other : effect.nonlinear)
      right_keys.insert(effects::ParameterKey(other, kind));
    for (const std::string& other : term.Keys()) {
      const bool same_name = other == info.name || other.starts_with(info.name + "_");
      if (same_name && !right_keys.contains(other)) {
        term.Fail(other, "wrong unit, expected '" + key + "' (" + info.meaning + ")");
      }
    }
    term.Fail(key,
              "missing, expected a number or {value, tolerance, fixed} (" + info.meaning + ")");
  }
  ParameterValue parameter;
  if (term.IsScalar(key)) {
    parameter.value = term.Number(key);
    return parameter;
  }
  const Section child = term.Child(key);
  parameter.value = child.Number("value");
  if (child.Has("tolerance") && !child.IsScalar("tolerance")) {
    parameter.tolerance_absolute = child.Child("tolerance").Number("absolute", config::kPositive);
  } else {
    parameter.tolerance = child.NumberOr("tolerance", 0.0, {0.0, 10.0});
  }
  parameter.fixed = child.BoolOr("fixed", false);
  if (child.Has("half_width_95")) {
    parameter.half_width_95 = child.Number("half_width_95", config::kNotNegative);
  }
  return parameter;
}

Term ReadTerm(const Section& section, const JointModel& joint) {
  const std::string name = section.Text("effect");
  Term term;
  std::optional<effects::Balance> balance;
  if (section.Has("balance")) {
    const std::string given = section.Choice("balance", {"motion", "kinematic", "gas"});
    for (const effects::Balance known :
         {effects::Balance::kMotion, effects::Balance::kKinematic, effects::Balance::kGas}) {
      if (given == effects::BalanceName(known)) balance = known;
    }
  }
  try {
    term.effect = effects::MakeEffect(name, joint.constants, balance);
  } catch (const std::invalid_argument& error) {
    section.Fail("effect", error.what());
  }
  term.declared = section.BoolOr("declared", true);
  for (const auto& info : term.effect->info().linear) {
    term.linear.push_back(ReadParameter(section, term.effect->info(), info, joint.kind));
  }
  for (const auto& info : term.effect->info().nonlinear) {
    term.nonlinear.push_back(ReadParameter(section, term.effect->info(), info, joint.kind));
  }
  return term;
}

std::string GainKey(types::JointKind kind) {
  return kind == types::JointKind::kRotary ? "gain_per_rad" : "gain_per_m";
}
std::string VelocityGainKey(types::JointKind kind) {
  return kind == types::JointKind::kRotary ? "velocity_gain_s_rad" : "velocity_gain_s_m";
}

Servo ReadServo(const Section& section, const JointModel& joint) {
  Servo servo;
  section.Choice("law", {"proportional"});
  servo.gain_per_rad = section.NumberOr(GainKey(joint.kind), 0.0, config::kPositive);
  servo.velocity_gain_s_rad =
      section.NumberOr(VelocityGainKey(joint.kind), 0.0, config::kNotNegative);
  servo.limit = section.NumberOr("limit", 0.0, config::kPositive);
  servo.share_of_supply =
      section.ChoiceOr("command", "drive", {"drive", "share_of_supply"}) == "share_of_supply";
  if (servo.gain_per_rad == 0.0 && servo.velocity_gain_s_rad > 0.0) {
    section.Fail(VelocityGainKey(joint.kind),
                 "without '" + GainKey(joint.kind) + "', expected both or none");
  }
  return servo;
}

// A spring's preload and an offset are the same torque: no recording distinguishes them.
void RefuseSameTorque(const Section& section, const JointModel& joint) {
  int free_terms = 0;
  for (const Term& term : joint.terms) {
    const std::string& name = term.effect->info().name;
    if (!term.declared || (name != "spring" && name != "offset")) continue;
    if (!term.linear.back().fixed) ++free_terms;  // the preload, the offset
  }
  if (free_terms < 2) return;
  section.Fail(
      "terms",
      "the preload of 'spring' and 'offset' are the same torque, expected one of them with "
      "fixed: true");
}

// A force at a linear joint acts along its axis: its lever is 1. 0 is a lever that is not stated,
// as in files of rotary joints.
double ReadLever(const Section& constants, types::JointKind kind) {
  const double stated_m = constants.NumberOr("link_length_m", 0.0, config::kNotNegative);
  if (kind == types::JointKind::kRotary) return stated_m;
  if (stated_m != 0.0 && stated_m != 1.0) {
    constants.Fail("link_length_m", "is " + Number(stated_m) +
                                        ", but a force at a linear joint has no lever, expected "
                                        "none");
  }
  return 1.0;
}

JointModel ReadJoint(const Section& section) {
  JointModel joint;
  joint.name = section.Text("name");
  joint.kind = section.Choice("kind", {"rotary", "linear"}) == "rotary" ? types::JointKind::kRotary
                                                                        : types::JointKind::kLinear;
  const Section constants = section.ChildOrEmpty("constants");
  joint.constants.gear_ratio = constants.NumberOr("gear_ratio", 1.0, config::kPositive);
  joint.constants.kind = joint.kind;
  joint.constants.link_length_m = ReadLever(constants, joint.kind);
  joint.constants.gravity_m_s2 = constants.NumberOr("gravity_m_s2", 9.81, config::kNotNegative);
  joint.constants.torque_constant_Nm_A =
      constants.NumberOr("torque_constant_Nm_A", 0.0, config::kNotNegative);
  joint.constants.force_constant_N_V =
      constants.NumberOr("force_constant_N_V", 0.0, config::kNotNegative);
  joint.constants.back_emf_V_s_rad =
      constants.NumberOr("back_emf_V_s_rad", 0.0, config::kNotNegative);
  joint.constants.encoder_counts_per_turn =
      constants.NumberOr("encoder_counts_per_turn", 0.0, config::kNotNegative);
  joint.constants.gas_volume_m3 = constants.NumberOr("gas_volume_m3", 0.0, config::kNotNegative);
  joint.constants.atmosphere_bar =
      constants.NumberOr("atmosphere_bar", joint.constants.atmosphere_bar, config::kPositive);
  joint.constants.valve_delay_s = constants.NumberOr("valve_delay_s", 0.0, config::kNotNegative);
  joint.backlash_rad = section.NumberOr(
      joint.kind == types::JointKind::kRotary ? "backlash_rad" : "backlash_m", 0.0, {0.0, 6.3});
  joint.motor_torque_limit_Nm =
      section.NumberOr("motor_torque_limit_Nm", 0.0, config::kNotNegative);
  for (const Section& term : section.List("terms")) {
    joint.terms.push_back(ReadTerm(term, joint));
    const effects::EffectInfo& info = joint.terms.back().effect->info();
    const bool repeatable = !joint.terms.back().nonlinear.empty();  // two orders of cogging, say
    if (!repeatable &&
        joint.Find(info.name, info.balance) != static_cast<int>(joint.terms.size()) - 1) {
      term.Fail("effect", "'" + info.name + "' is given twice");
    }
    if (info.name == "gas_compression" && !(joint.constants.gas_volume_m3 > 0.0)) {
      term.Fail("effect", "'gas_compression' needs constants.gas_volume_m3, more than 0");
    }
    if (info.name == "free_play" &&
        std::abs(joint.terms.back().linear[0].value - joint.backlash_rad) > 1e-9) {
      term.Fail(effects::ParameterKey(info.linear[0], joint.kind),
                "expected the joint's backlash, " + Number(joint.backlash_rad));
    }
  }
  RefuseSameTorque(section, joint);
  if (joint.terms.empty()) section.Fail("terms", "empty, expected at least one effect");
  if (section.Has("controller")) joint.controller = ReadServo(section.Child("controller"), joint);
  for (const Section& entry : section.ListOrEmpty("history")) {
    joint.history.push_back({entry.TextOr("when", ""), entry.TextOr("effect", ""),
                             entry.TextOr("recording", ""), entry.TextOr("note", "")});
  }
  RemakeEffects(&joint);
  return joint;
}

Payload ReadPayload(const Section& section) {
  const auto place = [&](const char* key, config::Range range) {
    const std::vector<double> numbers = section.Numbers(key, range);
    if (numbers.size() != 3) section.Fail(key, "expected x, y and z");
    return std::array<double, 3>{numbers[0], numbers[1], numbers[2]};
  };
  Payload payload;
  payload.link = section.Text("link");
  if (section.IsScalar("mass_kg")) {
    payload.mass_kg = section.Number("mass_kg", config::kPositive);
  } else {
    const Section mass = section.Child("mass_kg");
    payload.mass_kg = mass.Number("value", config::kPositive);
    if (mass.Has("half_width_95")) {
      payload.half_width_95 = mass.Number("half_width_95", config::kNotNegative);
    }
  }
  payload.position_m = place("position_m", {});
  payload.declared = section.BoolOr("declared", true);
  if (section.Has("position_half_width_95_m")) {
    payload.position_half_width_95 = place("position_half_width_95_m", config::kNotNegative);
  }
  return payload;
}

FloatingBase ReadFloatingBase(const Section& section) {
  FloatingBase base;
  const std::vector<std::string> links = section.TextsOr("foot_force", {});
  if (links.size() != base.force_links.size()) {
    section.Fail("foot_force", std::to_string(links.size()) + " links, expected " +
                                   std::to_string(base.force_links.size()) +
                                   ", those of the topic foot_force in its order");
  }
  std::copy(links.begin(), links.end(), base.force_links.begin());
  base.imu_link = section.Text("imu");
  base.mass_tolerance =
      section.NumberOr("mass_tolerance", base.mass_tolerance, config::kNotNegative);
  base.com_tolerance_m =
      section.NumberOr("com_tolerance_m", base.com_tolerance_m, config::kNotNegative);
  base.tilt_tolerance_rad =
      section.NumberOr("tilt_tolerance_rad", base.tilt_tolerance_rad, config::kNotNegative);
  return base;
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
  const bool rotary = joint.kind == types::JointKind::kRotary;
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

}  // namespace

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
  const Section& root = file.root;
  file.robot.name = root.Text("name");
  if (root.Has("urdf")) {
    file.robot.urdf_path = std::filesystem::absolute(root.ExistingPath("urdf")).lexically_normal();
  }
  std::set<std::string> names;
  for (const Section& joint : root.List("joints")) {
    file.robot.joints.push_back(ReadJoint(joint));
    if (!names.insert(file.robot.joints.back().name).second) {
      joint.Fail("name", "'" + file.robot.joints.back().name + "' is given twice");
    }
  }
  for (const Section& payload : root.ListOrEmpty("payloads")) {
    file.robot.payloads.push_back(ReadPayload(payload));
  }
  if (root.Has("floating_base")) {
    file.robot.floating_base = ReadFloatingBase(root.Child("floating_base"));
  }
  if (file.robot.joints.empty()) root.Fail("joints", "empty, expected at least one joint");
  const YAML::Node document = config::ParseYaml(text, path.string());
  for (const std::string_view block : kForeignBlocks) {
    if (!root.Has(block)) continue;  // Has() also marks the key as known
    YAML::Emitter out;
    out << document[std::string(block)];
    file.foreign_text[std::string(block)] = out.c_str();
  }
  root.RejectUnknownKeys();
  return file;
}

RobotModel LoadRobotModel(const std::filesystem::path& path) { return LoadModelFile(path).robot; }

RobotModel LoadRigJson(const std::filesystem::path& path) {
  const std::string text = config::ReadFile(path);
  const std::string where = path.string();
  nlohmann::json rig;
  try {
    rig = nlohmann::json::parse(text);
  } catch (const nlohmann::json::parse_error& error) {
    const auto line =
        1 +
        std::count(text.begin(),
                   text.begin() + static_cast<std::ptrdiff_t>(std::min(error.byte, text.size())),
                   '\n');
    throw UsageError(where + ":" + std::to_string(line) + ": no valid JSON");
  }
  const auto entry = [&](const char* group, const char* key,
                         const char* unit) -> const nlohmann::json& {
    const std::string name = std::string(group) + "." + key;
    if (!rig.is_object() || !rig.contains(group) || !rig[group].is_object() ||
        !rig[group].contains(key)) {
      throw UsageError(where + ": key '" + name + "': missing, expected {value, unit, trust}");
    }
    const nlohmann::json& found = rig[group][key];
    if (!found.is_object() || !found.contains("value") || !found["value"].is_number()) {
      throw UsageError(where + ": key '" + name + ".value': expected a number");
    }
    const std::string given =
        found.contains("unit") && found["unit"].is_string() ? found["unit"].get<std::string>() : "";
    if (given != unit && !given.starts_with(std::string(unit) + " (")) {
      throw UsageError(where + ": key '" + name + ".unit': '" + given + "', expected '" + unit +
                       "'");
    }
    return found;
  };
  const auto constant = [&](const char* key, const char* unit) {
    return entry("constants", key, unit)["value"].get<double>();
  };
  const auto nominal = [&](const char* key, const char* unit) {
    const nlohmann::json& found = entry("nominal_parameters", key, unit);
    const std::string trust = found.contains("trust") && found["trust"].is_string()
                                  ? found["trust"].get<std::string>()
                                  : "";
    ParameterValue value;
    value.value = found["value"].get<double>();
    value.fixed = trust.find("exact") != std::string::npos;
    value.tolerance = value.fixed ? 0.0 : kRigTolerance;
    return value;
  };

  JointModel joint;
  joint.name = "joint";
  joint.constants.gear_ratio = constant("gear_ratio", "1");
  joint.constants.link_length_m = constant("link_length", "m");
  joint.constants.gravity_m_s2 = constant("gravity", "m/s^2");
  joint.constants.torque_constant_Nm_A = constant("torque_constant", "N m/A");
  joint.constants.encoder_counts_per_turn = constant("encoder_counts_per_turn", "1");
  joint.backlash_rad = constant("free_play_full_width", "rad");
  joint.motor_torque_limit_Nm =
      constant("current_limit", "A") * joint.constants.torque_constant_Nm_A;
  const auto add = [&](const char* effect, std::vector<ParameterValue> linear,
                       std::vector<ParameterValue> nonlinear = {}) {
    Term term = MakeTerm(effect, joint.constants);
    term.linear = std::move(linear);
    term.nonlinear = std::move(nonlinear);
    joint.terms.push_back(std::move(term));
  };
  const ParameterValue exactly_one{
      .value = 1.0, .tolerance = 0.0, .fixed = true, .half_width_95 = std::nullopt};
  add("drive_current", {nominal("efficiency", "1")});
  add("rotor_inertia", {nominal("rotor_inertia_at_output", "kg m^2")});
  add("link_inertia", {nominal("link_inertia", "kg m^2")});
  add("declared_payload", {exactly_one});
  add("motor_viscous", {nominal("viscous_friction", "N m s/rad")});
  add("coulomb", {nominal("coulomb_friction", "N m")});
  add("gravity", {nominal("gravity_torque", "N m")});
  add("pneumatic_torque", {nominal("pneumatic_torque_slope", "N m/bar")});
  add("pneumatic_stiffness", {nominal("pneumatic_stiffness_slope", "N m/(rad bar)")},
      {nominal("pneumatic_rest_angle", "rad")});
  add("load_force", {exactly_one});
  // Both encoders: their difference is half of the play where the teeth touch.
  const auto exactly = [](double value) {
    return ParameterValue{
        .value = value, .tolerance = 0.0, .fixed = true, .half_width_95 = std::nullopt};
  };
  add("encoder_difference", {exactly(1.0)});
  add("free_play", {exactly(joint.backlash_rad), exactly(0.0)});
  add("encoder_offset", {{.value = 0.0, .half_width_95 = std::nullopt}});
  // Pressure: the gas is compressed while the valve is shut. Rigs without a stated volume have
  // none.
  const bool has_gas =
      rig.contains("nominal_parameters") && rig["nominal_parameters"].contains("gas_volume");
  if (has_gas) {
    const ParameterValue volume = nominal("gas_volume", "m^3");
    if (!(volume.value > 0.0)) {
      throw UsageError(where + ": key 'nominal_parameters.gas_volume.value': expected more than 0");
    }
    joint.constants.gas_volume_m3 = volume.value;
    ParameterValue share = exactly(1.0);
    share.tolerance = volume.tolerance;
    share.fixed = volume.fixed;
    add("chamber_pressure", {exactly(1.0)});
    add("gas_compression", {share});
    add("valve_flow", {exactly(1.0)});
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
