// The recordings of a case in another form; the result must not depend on it.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace sinew::rig_bank {

struct Variant {
  const char* name;
  double torque = 1.0;  // unit of torque, force and mass: a machine as many times as strong
  double time = 1.0;    // unit of time: the same motion as many times as slow
  double rate = 1.0;    // rows per row: 0.5 leaves every other one out, 2 puts one between two
};

// Units are powers of two: numbers change their exponents only, and nothing is rounded.
std::vector<Variant> Variants();

// Writes DIR/CASE-VARIANT beside truth.json of the case. False: the case has no such form (mass or
// force columns, whose scale is not in the model; rates beyond 50 to 2000 Hz). Throws
// std::runtime_error for files that cannot be read.
bool WriteVariant(const std::filesystem::path& folder, const Variant& variant,
                  const std::filesystem::path& out);

// How a variant's report differs from that of the case as it was recorded.
struct Difference {
  bool same_verdict = false;
  bool renamed = false;       // an effect came instead of another one
  bool weakened = false;      // a name was there, and none is left
  bool strengthened = false;  // none was there
  // Sizes of the first effect, if it is the same: apart by as many half widths of both intervals.
  std::optional<double> apart;
  // Largest relative difference of figures without unit: gains and slopes. Of the same names only.
  std::optional<double> figures;
};
Difference Compare(const nlohmann::json& report, const nlohmann::json& of_variant,
                   const Variant& variant);

// A line per variant over all cases that have reports in both folders.
std::string TableOfVariants(const std::filesystem::path& cases,
                            const std::filesystem::path& variants);

}  // namespace sinew::rig_bank
