#include "components/model/identify/file/processing_file.h"

#include <algorithm>

namespace sinew::identify {

using config::kNotNegative;
using config::kPositive;

void Describe(config::Fields& f, ProcessingOptions& c) {
  f("state_cutoff_Hz", c.state_cutoff_Hz, kPositive,
    "position and pressure, before they are differentiated");
  f("state_order", c.state_order, {1, 20}, "of that low-pass");
  f("parallel_cutoff_Hz", c.parallel_cutoff_Hz, kPositive, "drive and every column of regressors");
  f("parallel_order", c.parallel_order, {1, 20}, "of that low-pass");
  f("~rest_velocity_rad_s", c.rest_velocity, kPositive, "slower is rest or reversal");
  f("reversal_guard_s", c.reversal_guard_s, kNotNegative, "left out on either side of them");
  f("~settle_distance_rad", c.settle_distance, kNotNegative, "left out after them until covered");
  f("border_s", c.border_s, kNotNegative, "left out at both ends");
  f("longest_gap_s", c.longest_gap_s, kPositive, "longer gaps cut a recording into pieces");
  f.Require(c.state_cutoff_Hz <= 0.0 || c.parallel_cutoff_Hz <= c.state_cutoff_Hz,
            "parallel_cutoff_Hz", "above state_cutoff_Hz, expected at most half of it");
}

void Describe(config::Fields& f, AsPublishedOptions& c) {
  f.Need("filter_order", c.filter_order, {1, 20}, "of the published low-pass");
  f.Need("cutoff_Hz", c.cutoff_Hz, kPositive, "of it");
  f("border_samples", c.border_samples, {0, 100000}, "left out at both ends");
  f("decimate", c.decimate, {1, 1000}, "every so many rows");
  f("added_effects", c.added_effects, "beside the declared ones");
  const std::vector<std::string> known = effects::EffectNames();
  for (const std::string& name : c.added_effects) {
    f.Require(std::find(known.begin(), known.end(), name) != known.end(), "added_effects",
              "no effect is called '" + name + "', see `sinew effects`");
  }
}

ProcessingOptions ReadProcessing(const config::Section& root, types::JointKind kind) {
  ProcessingOptions out;
  config::Fields fields(root.ChildOrEmpty("processing"));
  fields.set_linear(kind == types::JointKind::kPrismatic);
  Describe(fields, out);
  fields.section().RejectUnknownKeys();
  return out;
}

std::optional<AsPublishedOptions> ReadAsPublished(const config::Section& root) {
  if (!root.Has("as_published")) return std::nullopt;
  return config::Read<AsPublishedOptions>(root.Child("as_published"));
}

}  // namespace sinew::identify
