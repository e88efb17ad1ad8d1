#include "components/model/identify/file/processing_file.h"

#include <algorithm>

namespace sinew::identify {

ProcessingOptions ReadProcessing(const config::Section& root, types::JointKind kind) {
  ProcessingOptions out;
  const config::Section block = root.ChildOrEmpty("processing");
  out.state_cutoff_Hz = block.NumberOr("state_cutoff_Hz", out.state_cutoff_Hz, config::kPositive);
  out.state_order = static_cast<int>(block.IntegerOr("state_order", out.state_order, {1, 20}));
  out.parallel_cutoff_Hz =
      block.NumberOr("parallel_cutoff_Hz", out.parallel_cutoff_Hz, config::kPositive);
  out.parallel_order =
      static_cast<int>(block.IntegerOr("parallel_order", out.parallel_order, {1, 20}));
  out.rest_velocity = block.NumberOr(
      kind == types::JointKind::kRotary ? "rest_velocity_rad_s" : "rest_velocity_m_s",
      out.rest_velocity, config::kPositive);
  out.reversal_guard_s =
      block.NumberOr("reversal_guard_s", out.reversal_guard_s, config::kNotNegative);
  out.settle_distance = block.NumberOr(
      kind == types::JointKind::kRotary ? "settle_distance_rad" : "settle_distance_m",
      out.settle_distance, config::kNotNegative);
  out.border_s = block.NumberOr("border_s", out.border_s, config::kNotNegative);
  out.longest_gap_s = block.NumberOr("longest_gap_s", out.longest_gap_s, config::kPositive);
  block.RejectUnknownKeys();
  if (out.state_cutoff_Hz > 0.0 && out.parallel_cutoff_Hz > out.state_cutoff_Hz) {
    block.Fail("parallel_cutoff_Hz", "above state_cutoff_Hz, expected at most half of it");
  }
  return out;
}

std::optional<AsPublishedOptions> ReadAsPublished(const config::Section& root) {
  if (!root.Has("as_published")) return std::nullopt;
  const config::Section block = root.Child("as_published");
  AsPublishedOptions out;
  out.filter_order = static_cast<int>(block.Integer("filter_order", {1, 20}));
  out.cutoff_Hz = block.Number("cutoff_Hz", config::kPositive);
  out.border_samples = static_cast<int>(block.IntegerOr("border_samples", 0, {0, 100000}));
  out.decimate = static_cast<int>(block.IntegerOr("decimate", 1, {1, 1000}));
  out.added_effects = block.TextsOr("added_effects", {});
  const std::vector<std::string> known = effects::EffectNames();
  for (const std::string& name : out.added_effects) {
    if (std::find(known.begin(), known.end(), name) == known.end()) {
      block.Fail("added_effects", "no effect is called '" + name + "', see `sinew effects`");
    }
  }
  block.RejectUnknownKeys();
  return out;
}

}  // namespace sinew::identify
