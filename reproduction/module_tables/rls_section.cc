#include "reproduction/module_tables/rls_section.h"

#include <algorithm>
#include <optional>

#include "reproduction/module_tables/section_parts.h"

namespace sinew::reproduction {

using report::Text;

report::Section MakeRlsSection(const acceptance::BatchScore& batch,
                               const acceptance::SoakScore& soak,
                               const std::vector<acceptance::TimeScore>& times) {
  report::Section section;
  section.id = "rls";
  section.title = "Recursive least squares that runs for ever";
  section.paragraphs = {
      "The covariance is kept as U D U', innovations are clipped, and one pseudo-observation a "
      "step "
      "leaks toward the offline readout. The soak moves for 4000 samples and stands still for 10 "
      "000, again and again, while the truth changes and changes back."};
  Compare(&section, "difference to batch least squares, readout", "relative",
          Text("%.1e", batch.readout_difference), "below 1e-9",
          batch.readout_difference < acceptance::kSameAsBatch,
          "76 x 12, " + std::to_string(batch.updates) + " updates without forgetting and leak");
  Compare(&section, "difference to batch least squares, covariance", "relative",
          Text("%.1e", batch.covariance_difference), "below 1e-9",
          batch.covariance_difference < acceptance::kSameAsBatch);
  Compare(&section, "updates, most of them without excitation, bounded", "",
          Text("%.1e", static_cast<double>(soak.updates)),
          "largest eigenvalue of P below 2 priors, error below the noise", soak.bounded(),
          Text("%.0f %% at rest; ", 100.0 * static_cast<double>(soak.at_rest) /
                                        static_cast<double>(std::max(soak.updates, 1L))) +
              Text("largest eigenvalue %.2f priors, ", soak.largest_eigenvalue) +
              Text("smallest %.1e; ", soak.smallest_eigenvalue) +
              Text("settled error %.4f Nm ", soak.settled_Nm) +
              Text("(noise of a sample %.3f)", soak.noise_Nm));
  Compare(&section, "the plain recursion on the same samples", "",
          soak.plain_lost_after > 0
              ? "out of bounds after " + std::to_string(soak.plain_lost_after) + " updates"
              : "in bounds as long as it ran",
          "", std::nullopt);
  report::Table table;
  table.title = "Time of an update";
  table.caption =
      "Least of 200 batches of 200 updates: what an idle core does. Textbook: the plain recursion "
      "with a full covariance.";
  table.header = {"features x outputs", "update, us", "median, us", "textbook, us", "ratio"};
  for (const acceptance::TimeScore& t : times) {
    table.rows.push_back({std::to_string(t.features) + " x " + std::to_string(t.outputs),
                          Text("%.2f", t.update_us), Text("%.2f", t.median_us),
                          Text("%.2f", t.textbook_us), Text("%.2f", t.update_us / t.textbook_us)});
    if (t.features == 76 && t.outputs == 12) {
      Compare(&section, "update of 76 x 12", "us", Text("%.2f", t.update_us), "at most 1.8",
              t.update_us <= acceptance::kUpdate_us,
              Text("textbook recursion %.2f us", t.textbook_us));
    }
  }
  section.tables.push_back(table);
  return section;
}

}  // namespace sinew::reproduction
