#include "bench/rigs/files.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <optional>
#include <stdexcept>

namespace sinew::rig_bank {
namespace {

using nlohmann::json;
using namespace rigs;

std::string Number(double x, int digits = 9) {
  char text[40];
  std::snprintf(text, sizeof text, "%.*g", digits, x);
  return text;
}

struct Column {
  std::string header, signal, unit;
  double Reading::*value;
};

std::vector<Column> ColumnsOf(const Rig& rig) {
  std::vector<Column> out;
  const std::string q = rig.linear ? "m" : "rad";
  const bool one = !rig.output_encoder && rig.motor_encoder && rig.gear_ratio == 1.0;
  out.push_back({"output_position_" + q, "position", q, &Reading::position});
  if (rig.velocities) {
    out.push_back({"output_velocity_" + q + "_s", "velocity", q + "/s", &Reading::velocity});
  }
  if (rig.motor_encoder) {
    if (!one) out.push_back({"motor_angle_rad", "motor_position", "rad", &Reading::motor_rad});
    if (rig.velocities) {
      out.push_back(
          {"motor_velocity_rad_s", "motor_velocity", "rad/s", &Reading::motor_velocity_rad_s});
    }
  }
  switch (rig.drive) {
    case Drive::kCurrent:
      out.push_back({"motor_current_A", "motor_current", "A", &Reading::drive});
      break;
    case Drive::kCommand:
      out.push_back({"command_V", "drive_voltage", "V", &Reading::drive});
      break;
    case Drive::kWinding:
      out.push_back({"winding_V", "drive_voltage", "V", &Reading::drive});
      out.push_back({"supply_V", "supply_voltage", "V", &Reading::supply_V});
      break;
    case Drive::kSensor:
      out.push_back({rig.linear ? "rod_force_N" : "joint_torque_Nm", "torque",
                     rig.linear ? "N" : "Nm", &Reading::drive});
      break;
  }
  if (rig.pressure) {
    out.push_back({"chamber_pressure_bar", "chamber_pressure", "bar", &Reading::pressure_bar});
  }
  if (rig.load_cell) out.push_back({"load_force_N", "load_force", "N", &Reading::load_force_N});
  if (rig.payloads) out.push_back({"payload_kg", "payload", "kg", &Reading::payload_kg});
  if (rig.temperature) {
    out.push_back({"motor_temperature_degC", "temperature", "degC", &Reading::temperature_degC});
  }
  return out;
}

bool OneEncoder(const Rig& rig) {
  return !rig.output_encoder && rig.motor_encoder && rig.gear_ratio == 1.0;
}

json EffectJson(const Rig& rig, const Made& made, Excitation excitation) {
  const EffectInfo& info = FindEffect(made.sized.effect.name);
  std::string balance = info.shows == Shows::kKinematic ? "K"
                        : info.shows == Shows::kGas     ? "Q"
                                                        : "M";
  if (excitation == Excitation::kLocked) balance = "S";
  return {{"name", info.name},
          {"value", made.sized.effect.size},
          {"unit", info.unit},
          {"shape", made.sized.effect.shape},
          {"of_largest", std::abs(made.sized.effect.size) / LargestSize(rig, info.name)},
          {"balance", balance},
          {"variable", info.variable},
          {"outside_catalogue", info.kind != Kind::kCatalogue},
          {"absorbed_by_refit", info.absorbed},
          {"share_raw", made.sized.measured.share},
          {"lambda", made.sized.measured.lambda},
          {"size_reached", made.sized.reached},
          {"identifiable", made.sized.measured.lambda >= kIdentifiableLambda},
          {"class", made.same_class}};
}

void Write(const std::filesystem::path& path, const std::string& text) {
  std::ofstream out(path, std::ios::binary);
  out << text;
  out.close();
  if (!out) throw std::runtime_error(path.string() + ": writing failed");
}

// The first candidate that can be as large as asked, else the most visible.
Sizer::Sized MostVisible(const Rig& rig, const Case& what, const Sizer& sizer,
                         std::vector<std::string>* too_small) {
  std::optional<Sizer::Sized> best;
  for (const std::string& name : what.effects) {
    const Sizer::Sized sized = sizer.Size(DrawEffect(rig, name), what.share);
    if (!best || sized.reached || sized.measured.share > best->measured.share) {
      if (best) too_small->push_back(best->effect.name);
      best = sized;
    } else {
      too_small->push_back(name);
    }
    if (sized.reached) break;
  }
  return *best;
}

// An effect that would be as large as asked in designed motion and is not identifiable in this one.
Sizer::Sized Hidden(const Rig& rig, const Case& what, const Sizer& sizer) {
  const Sizer designed(rig, Excitation::kDesigned);
  for (const std::string& name : what.effects) {
    Sizer::Sized sized = designed.Size(DrawEffect(rig, name), what.share);
    if (!sized.reached) continue;
    const EffectInfo& info = FindEffect(name);
    sized.measured =
        sizer.Measure(Play(rig, {sized.effect}, what.excitation), info.shows, info.absorbed);
    if (sized.measured.lambda < kIdentifiableLambda) return sized;
  }
  throw std::runtime_error(what.name + ": no effect hides");
}

}  // namespace

std::string CsvOf(const Rig& rig, const std::vector<Reading>& rows) {
  const std::vector<Column> columns = ColumnsOf(rig);
  std::string out = "time_s";
  for (const Column& column : columns) out += "," + column.header;
  if (rig.valve) out += ",valve_open";
  out += '\n';
  char text[40];
  for (const Reading& row : rows) {
    std::snprintf(text, sizeof text, "%.6f", row.time_s);
    out += text;
    for (const Column& column : columns) out += "," + Number(row.*column.value, 10);
    if (rig.valve) out += row.valve_open ? ",1" : ",0";
    out += '\n';
  }
  return out;
}

std::string MapOf(const Rig& rig) {
  std::string out =
      "schema: sinew-csv-map/1\nkind: " + std::string(rig.linear ? "linear" : "rotary") +
      "\ntime: {column: time_s, unit: s}\nsignals:\n";
  for (const Column& column : ColumnsOf(rig)) {
    out += "  " + column.signal + ": {column: " + column.header + ", unit: " + column.unit + "}\n";
    if (column.signal == "position" && OneEncoder(rig)) {
      out += "  motor_position: {column: " + column.header + ", unit: rad}\n";
    }
  }
  if (rig.valve) out += "  valve_open: {column: valve_open, unit: 1}\n";
  return out;
}

std::string ModelOf(const Rig& rig, const std::string& fault) {
  std::string constants;
  auto add = [&constants](const std::string& key, double value) {
    constants += (constants.empty() ? "" : ", ") + key + ": " + Number(value);
  };
  if (fault != "missing_gear_ratio") add("gear_ratio", rig.gear_ratio);
  if (rig.drive == Drive::kCurrent) add("torque_constant_Nm_A", rig.torque_constant_Nm_A);
  if (rig.drive == Drive::kCommand) add("force_constant_N_V", rig.command_gain);
  if (rig.drive == Drive::kWinding) {
    add("force_constant_N_V", rig.winding_gain);
    add("back_emf_V_s_rad", rig.back_emf_V_s_rad);
  }
  if (!rig.linear) {
    add("link_length_m", rig.link_length_m);
    add("gravity_m_s2", 9.81);
  }
  if (rig.gas_balance) {
    // The share of gas_compression is stated volume / volume, and the model states 1.
    for (const Term& term : Declare(rig)) {
      if (term.effect == "gas_compression")
        add("gas_volume_m3", rig.gas_volume_m3 * term.parameters[0].truth);
    }
    add("atmosphere_bar", 1.01325);
    add("valve_delay_s", 0.0);
  }
  if (rig.kinematic) add("encoder_counts_per_turn", std::exp2(rig.output_bits));
  std::string out = "schema: sinew-model/1\nname: rig\njoints:\n  - name: joint\n    kind: " +
                    std::string(rig.linear ? "linear" : "rotary") + "\n    constants: {" +
                    constants + "}\n";
  if (rig.play > 0.0) out += "    backlash_rad: " + Number(rig.play) + "\n";
  if (rig.drive == Drive::kCurrent && !rig.linear) {
    out += "    motor_torque_limit_Nm: " + Number(rig.current_limit_A * rig.torque_constant_Nm_A) +
           "\n";
  }
  out += "    terms:\n";
  for (const Term& term : Declare(rig)) {
    out += "      - effect: " + term.effect + "\n";
    if (!term.balance.empty()) out += "        balance: " + term.balance + "\n";
    for (const Parameter& p : term.parameters) {
      out += "        " + p.key + ": {value: " + Number(p.nominal);
      if (p.tolerance > 0.0) out += ", tolerance: " + Number(p.tolerance);
      if (p.fixed) out += ", fixed: true";
      out += "}\n";
    }
  }
  return out + "    history: []\n";
}

json TruthOf(const Rig& rig, const CaseFiles& files) {
  json effects = json::array();
  for (const Made& made : files.effects)
    effects.push_back(EffectJson(rig, made, files.what.excitation));
  json rows = json::array();
  for (const FaultRows& spoilt : files.fault_rows) {
    rows.push_back(
        {{"recording", spoilt.recording}, {"first_row", spoilt.first}, {"last_row", spoilt.last}});
  }
  json parameters = json::object();
  for (const Term& term : Declare(rig)) {
    for (const Parameter& p : term.parameters) {
      if (!p.fixed)
        parameters[term.effect][p.key] = {
            {"true", p.truth}, {"nominal", p.nominal}, {"tolerance", p.tolerance}};
    }
  }
  const double share = files.what.share;
  return {{"schema", "sinew-rig-truth/1"},
          {"case", files.what.name},
          {"rig", rig.number},
          {"family", WordOf(rig.family)},
          {"kind", WordOf(files.what.kind)},
          {"excitation", WordOf(files.what.excitation)},
          {"strength", share == 0.0  ? "none"
                       : share > 0.2 ? "strong"
                                     : "weak"},
          {"share_requested", share},
          {"share_raw", files.together.share},
          {"residual_rms", files.together.residual_rms},
          {"twin_rms", files.together.twin_rms},
          {"effects", effects},
          {"too_small", files.too_small},
          {"fault", files.what.fault},
          {"fault_rows", rows},
          {"coloured_noise", rig.current.correlation > 0.0},
          {"rate_Hz", rig.rate_Hz},
          {"rows", rig.rows},
          {"pole_pairs", rig.pole_pairs},
          {"gear_ratio", rig.gear_ratio},
          {"true_parameters", parameters}};
}

void WriteCase(const std::filesystem::path& folder, const Rig& rig, const CaseFiles& files) {
  std::filesystem::create_directories(folder);
  for (std::size_t i = 0; i < files.recordings.size(); ++i) {
    Write(folder / (std::string(RecordingName(static_cast<int>(i))) + ".csv"),
          CsvOf(rig, files.recordings[i]));
  }
  Write(folder / "csv_map.yaml", MapOf(rig));
  Write(folder / "model.yaml", ModelOf(rig, files.what.fault));
  Write(folder / "truth.json", TruthOf(rig, files).dump(1) + "\n");
}

std::vector<std::vector<Reading>> ReadRecordings(const Rig& rig, const Run& run,
                                                 const std::string& name) {
  std::vector<std::vector<Reading>> out;
  for (int i = 0; i < kRecordings; ++i) {
    out.push_back(ReadWithNoise(rig, run.rows[static_cast<std::size_t>(i)], i));
    for (const Reading& reading : out.back()) {
      if (!std::isfinite(reading.position + reading.drive + reading.pressure_bar)) {
        throw std::runtime_error(name + ": the simulation diverged");
      }
    }
  }
  return out;
}

CaseFiles MakeCase(const Rig& rig, const Case& what, const Sizer& sizer, double noise_share) {
  CaseFiles out;
  out.what = what;
  const auto add = [&](const Sizer::Sized& sized) {
    out.effects.push_back({sized, sizer.ClassOf(sized.effect)});
  };
  if (what.kind == CaseKind::kPair) {
    for (const std::string& name : what.effects) {
      add(sizer.Size(DrawEffect(rig, name), what.share));
    }
  } else if (what.kind == CaseKind::kHidden) {
    add(Hidden(rig, what, sizer));
  } else if (!what.effects.empty()) {
    add(MostVisible(rig, what, sizer, &out.too_small));
  }
  std::vector<Effect> effects;
  Shows shows = Shows::kTorque;
  for (const Made& made : out.effects) {
    effects.push_back(made.sized.effect);
    shows = FindEffect(made.sized.effect.name).shows;
  }
  const Run run = Play(rig, effects, what.excitation);
  out.together = sizer.Measure(run, shows);
  Rig logged = rig;
  logged.noise_share = noise_share;
  out.recordings = ReadRecordings(logged, run, what.name);
  if (!what.fault.empty()) out.fault_rows = PlantFault(rig, what.fault, out.recordings);
  return out;
}

}  // namespace sinew::rig_bank
