#include "bench/rigs/variants.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include "components/model/actuator/file/model_file.h"
#include "components/model/effects/effect.h"

namespace sinew::rig_bank {
namespace {

namespace fs = std::filesystem;
using effects::Dimension;
using nlohmann::json;

constexpr double kLowestRate_Hz = 50.0, kHighestRate_Hz = 2000.0;

// Powers of the units of torque and time in a dimension.
struct Powers {
  double torque = 0.0, time = 0.0;
};
Powers PowersOf(Dimension dimension) {
  switch (dimension) {
    case Dimension::kTorque:
    case Dimension::kTorquePerBar:
    case Dimension::kStiffness:
    case Dimension::kStiffnessPerBar:
    case Dimension::kTorquePerKelvin:
    case Dimension::kTorquePerAmpere:
    case Dimension::kTorquePerVolt:
      return {1.0, 0.0};
    case Dimension::kViscous:
    case Dimension::kViscousPerKelvin:
      return {1.0, 1.0};
    case Dimension::kQuadraticViscous:
    case Dimension::kInertia:
      return {1.0, 2.0};
    case Dimension::kInertiaTime:
      return {1.0, 3.0};
    case Dimension::kInertiaTimeSquared:
      return {1.0, 4.0};
    case Dimension::kVelocity:
    case Dimension::kFrequency:
    case Dimension::kRate:
      return {0.0, -1.0};
    case Dimension::kTime:
      return {0.0, 1.0};
    case Dimension::kPerTorque:
    case Dimension::kAnglePerTorque:
      return {-1.0, 0.0};
    case Dimension::kMass:
      throw std::logic_error("masses have no scale of their own in a balance of torques");
    default:
      return {};
  }
}
double FactorOf(Dimension dimension, const Variant& variant) {
  if (variant.torque == 1.0 && variant.time == 1.0) return 1.0;
  const Powers powers = PowersOf(dimension);
  return std::pow(variant.torque, powers.torque) * std::pow(variant.time, powers.time);
}

actuator::ModelFile Scaled(actuator::ModelFile file, const Variant& variant) {
  for (actuator::JointModel& joint : file.robot.joints) {
    effects::JointConstants& constants = joint.constants;
    constants.torque_constant_Nm_A *= variant.torque;
    constants.force_constant_N_V *= variant.torque;
    constants.back_emf_V_s_rad *= variant.time;
    constants.valve_delay_s *= variant.time;
    joint.motor_torque_limit_Nm *= variant.torque;
    for (actuator::Term& term : joint.terms) {
      const effects::EffectInfo info = term.effect->info();
      const auto scale = [&](const effects::ParameterInfo& of, actuator::ParameterValue* value) {
        const double factor = FactorOf(of.dimension, variant);
        value->value *= factor;
        value->tolerance_absolute *= factor;
      };
      for (std::size_t i = 0; i < term.linear.size(); ++i) scale(info.linear[i], &term.linear[i]);
      for (std::size_t i = 0; i < term.nonlinear.size(); ++i) {
        scale(info.nonlinear[i], &term.nonlinear[i]);
      }
    }
  }
  return file;
}

// A CSV file as this program writes it: a header, then numbers; the time comes first.
struct Table {
  std::string header;
  std::vector<std::vector<double>> rows;
};
Table ReadTable(const fs::path& path) {
  std::ifstream in(path);
  Table out;
  if (!std::getline(in, out.header)) throw std::runtime_error(path.string() + ": cannot be read");
  for (std::string line; std::getline(in, line);) {
    std::vector<double> row;
    std::stringstream cells(line);
    for (std::string cell; std::getline(cells, cell, ',');) row.push_back(std::stod(cell));
    out.rows.push_back(std::move(row));
  }
  return out;
}

// Every second row, or a row between two that are neighbours.
std::vector<std::vector<double>> AtRate(const std::vector<std::vector<double>>& rows, double rate) {
  std::vector<std::vector<double>> out;
  const auto step = rate < 1.0 ? static_cast<std::size_t>(std::lround(1.0 / rate)) : 1;
  for (std::size_t i = 0; i < rows.size(); i += step) {
    out.push_back(rows[i]);
    if (rate <= 1.0 || i + 1 >= rows.size()) continue;
    std::vector<double> between(rows[i].size());
    for (std::size_t k = 0; k < between.size(); ++k) {
      between[k] = 0.5 * (rows[i][k] + rows[i + 1][k]);
    }
    out.push_back(std::move(between));
  }
  return out;
}

void WriteTable(const fs::path& path, const Table& table) {
  std::ofstream out(path);
  out << table.header << '\n';
  char text[40];
  for (const std::vector<double>& row : table.rows) {
    for (std::size_t k = 0; k < row.size(); ++k) {
      std::snprintf(text, sizeof text, "%s%.17g", k > 0 ? "," : "", row[k]);
      out << text;
    }
    out << '\n';
  }
}

json Read(const fs::path& path) {
  std::ifstream in(path);
  return in ? json::parse(in) : json();
}

std::vector<std::string> NamesOf(const json& report) {
  std::vector<std::string> out;
  for (const json& effect : report.value("effects", json::array())) out.push_back(effect["name"]);
  return out;
}

// Rivals predict the same: one of them instead is no other name.
bool Holds(const json& report, const std::string& name) {
  for (const json& effect : report.value("effects", json::array())) {
    if (effect["name"] == name) return true;
    for (const json& rival : effect["rivals"]) {
      if (rival == name) return true;
    }
  }
  return false;
}

}  // namespace

std::vector<Variant> Variants() {
  return {{.name = "strong", .torque = 1024.0},
          {.name = "slow", .time = 8.0},
          {.name = "half", .rate = 0.5},
          {.name = "double", .rate = 2.0}};
}

bool WriteVariant(const fs::path& folder, const Variant& variant, const fs::path& out) {
  actuator::ModelFile model = actuator::LoadModelFile(folder / "model.yaml");
  const Table first = ReadTable(folder / "train_1.csv");
  const bool units = variant.torque != 1.0 || variant.time != 1.0;
  if (units) {
    for (const char* column : {"load_force", "payload", "pressure", "joint_torque", "force_N"}) {
      if (first.header.find(column) != std::string::npos) return false;
    }
    model = Scaled(std::move(model), variant);
  }
  const double rate_Hz = static_cast<double>(first.rows.size() - 1) /
                         (first.rows.back()[0] - first.rows.front()[0]) * variant.rate;
  if (variant.rate != 1.0 && (rate_Hz < kLowestRate_Hz || rate_Hz > kHighestRate_Hz)) return false;
  fs::create_directories(out);
  for (const char* name : {"train_1.csv", "train_2.csv", "train_3.csv", "sealed.csv"}) {
    Table table = ReadTable(folder / name);
    table.rows = AtRate(table.rows, variant.rate);
    for (std::vector<double>& row : table.rows) row[0] *= variant.time;
    WriteTable(out / name, table);
  }
  const auto keep = fs::copy_options::overwrite_existing;
  fs::copy_file(folder / "csv_map.yaml", out / "csv_map.yaml", keep);
  actuator::SaveModelFile(out / "model.yaml", model);
  fs::copy_file(folder / "truth.json", out / "truth.json", keep);
  return true;
}

Difference Compare(const json& report, const json& of_variant, const Variant& variant) {
  Difference out;
  out.same_verdict = report["verdict"] == of_variant["verdict"];
  const std::vector<std::string> names = NamesOf(report), others = NamesOf(of_variant);
  out.weakened = !names.empty() && others.empty();
  out.strengthened = names.empty() && !others.empty();
  for (const std::string& name : others) {
    out.renamed = out.renamed || (!names.empty() && !Holds(report, name));
  }
  if (names.empty() || names != others) return out;
  double figures = 0.0;
  for (std::size_t k = 0; k < names.size(); ++k) {
    const json &a = report["effects"][k], &b = of_variant["effects"][k];
    const auto differs = [&](double x, double y) {
      figures = std::max(figures, std::abs(x - y) / std::max(std::abs(x), 1e-9));
    };
    differs(a["gain"], b["gain"]);
    differs(a["confirmation"]["slope"], b["confirmation"]["slope"]);
  }
  out.figures = figures;
  const auto effect = effects::MakeEffect(names.front(), {});
  for (const auto& [key, value] : report["effects"][0]["parameters"].items()) {
    const json& parameters = of_variant["effects"][0]["parameters"];
    if (!parameters.contains(key) || !value.contains("half_width_95")) continue;
    for (const effects::ParameterInfo& info : effect->info().linear) {
      if (key.rfind(info.name, 0) != 0 || value["half_width_95"].is_null()) continue;
      const double factor = FactorOf(info.dimension, variant);
      const double size = parameters[key]["value"].get<double>() / factor;
      const double width = parameters[key]["half_width_95"].get<double>() / factor;
      const double apart = std::abs(size - value["value"].get<double>()) /
                           (width + value["half_width_95"].get<double>());
      out.apart = std::max(out.apart.value_or(0.0), apart);
    }
  }
  return out;
}

std::string TableOfVariants(const fs::path& cases, const fs::path& variants) {
  std::string out =
      "variant   cases  verdict differs  another name  weakened  named now  sizes apart  figures "
      "differ "
      "by (median, largest)\n";
  std::string changes;
  for (const Variant& variant : Variants()) {
    int count = 0, verdicts = 0, renamed = 0, weakened = 0, strengthened = 0, apart = 0, sizes = 0;
    std::vector<double> figures;
    std::vector<fs::path> reports;
    for (const auto& entry : fs::directory_iterator(variants)) reports.push_back(entry.path());
    std::sort(reports.begin(), reports.end());
    for (const fs::path& path : reports) {
      const std::string name = path.filename().string(), end = std::string("-") + variant.name;
      if (name.size() <= end.size() || name.substr(name.size() - end.size()) != end) continue;
      const std::string own = name.substr(0, name.size() - end.size());
      const json before = Read(cases / own / "report.json"), after = Read(path / "report.json");
      if (before.is_null() || after.is_null()) continue;
      const Difference d = Compare(before, after, variant);
      ++count;
      verdicts += d.same_verdict ? 0 : 1;
      renamed += d.renamed ? 1 : 0;
      weakened += d.weakened ? 1 : 0;
      strengthened += d.strengthened ? 1 : 0;
      sizes += d.apart ? 1 : 0;
      apart += d.apart && *d.apart > 1.0 ? 1 : 0;
      if (d.figures) figures.push_back(*d.figures);
      if (!d.same_verdict || d.renamed) {
        const auto said = [](const json& report) {
          std::string text = report["verdict"];
          for (const std::string& effect : NamesOf(report)) text += " " + effect;
          return text;
        };
        changes += name + ": " + said(before) + " -> " + said(after) + "\n";
      }
    }
    std::sort(figures.begin(), figures.end());
    char line[200];
    std::snprintf(line, sizeof line, "%-9s %5d  %15d  %12d  %8d  %9d  %4d of %4d  %.2g, %.2g\n",
                  variant.name, count, verdicts, renamed, weakened, strengthened, apart, sizes,
                  figures.empty() ? 0.0 : figures[figures.size() / 2],
                  figures.empty() ? 0.0 : figures.back());
    out += line;
  }
  return out + changes;
}

}  // namespace sinew::rig_bank
