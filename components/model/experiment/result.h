// Result of an experiment: values with intervals, the published values beside them, and what
// figures are drawn from. Pure data.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "components/model/experiment/statistics.h"
#include "components/model/report/section.h"

namespace sinew::experiment {

// Declared values of the rig, before the experiment.
struct RigConstants {
  double gear_ratio = 100.0;
  double link_length_m = 0.3;
  double torque_constant_Nm_A = 0.0159155;  // 60 / (2 pi KV)
  int encoder_counts = 16384;               // a turn of the output's encoder
  double efficiency = 0.77;                 // of the gear, by its data sheet
  double gravity_torque_Nm = 0.58;          // (5.4) as published takes it from `breakaway`
};

struct Quantity {
  std::string id{};  // a key: backlash_deg
  std::string name{};
  std::string unit{};
  Estimate estimate{};
  std::string remark{};
  std::optional<double> published{};
  std::string source{};  // of the published value
  std::optional<double> truth{};
  // Target: |value - truth| at most this (or this share of the truth); nothing: no target.
  std::optional<double> target_absolute{};
  std::optional<double> target_share{};
  bool has_interval = true;  // false: listed for comparison, without a target

  // Nothing without truth or target.
  std::optional<bool> Met() const;

  // The same with further fields.
  Quantity Published(double value, std::string where) const;
  Quantity Within(double absolute) const;
  Quantity WithinShare(double share) const;
  Quantity WithoutInterval() const;
};

// Style of figures: pixels of a panel, and points of their own.
inline constexpr int kFigure_px = 244;
inline constexpr const char* kPoints = "points pt 7 ps 0.5";
inline constexpr const char* kBars = "yerrorbars pt 7 ps 0.6 lw 1.3";

struct Result {
  std::string experiment{};
  std::string title{};
  std::vector<Quantity> quantities{};
  std::vector<report::Picture> figures{};
  std::vector<report::Table> tables{};
  std::vector<std::string> remarks{};

  const Quantity* Find(const std::string& id) const;
};

// A number for people, with as many digits as intervals allow.
std::string FormatValue(double value);
std::string FormatInterval(const Quantity& quantity);  // empty: none
std::string FormatTarget(const Quantity& quantity);    // empty: no target

// A section of a page: comparisons, tables, pictures.
report::Section MakeSection(const Result& result);

}  // namespace sinew::experiment
