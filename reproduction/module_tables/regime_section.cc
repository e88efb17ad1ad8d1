#include "reproduction/module_tables/regime_section.h"

#include <algorithm>
#include <cmath>

#include "reproduction/module_tables/section_parts.h"

namespace sinew::reproduction {

using report::Text;

report::Section MakeRegimeSection(const acceptance::RegimeGrid& grid) {
  report::Section section;
  section.id = "regime";
  section.title = "Inside or outside the backlash (Fig 7.1)";
  section.paragraphs = {
      "The detector on the surrogate's encoders (14 bits, 240 Hz), assessed by the surrogate's "
      "truth "
      "about its teeth. A sample is wrong unless it is right, within one sample of a true "
      "transition, or the teeth are apart by less than two encoder counts. Contacts that are over "
      "before they had to be found (bounces) are no transitions that 240 Hz can show.",
      "Noise is that of the output encoder, its standard deviation in counts; the rig's is 0.39. "
      "Every sample carries the rounding of a count besides."};
  long unknown = 0;
  report::Table table;
  table.title = "Right samples, by motion and pressure";
  table.caption = "Worst over the noise levels of the output encoder; transitions found in time.";
  table.header = {"motion",           "pressure, bar",     "right, worst",
                  "wrong of samples", "transitions found", "false changes"};
  struct Row {
    std::string motion;
    double pressure_bar = 0.0;
    acceptance::RegimeScore sum;
    double worst = 1.0;
  };
  std::vector<Row> rows;
  for (const acceptance::RegimeScore& score : grid.scores) {
    unknown += score.unknown;
    const std::string motion = score.at.motion == acceptance::Motion::kHand
                                   ? Text("hand, %g Hz", score.at.speed_rad_s)
                                   : Text("motor, %g rad/s", score.at.speed_rad_s);
    auto row = std::find_if(rows.begin(), rows.end(), [&](const Row& r) {
      return r.motion == motion && r.pressure_bar == score.at.pressure_bar;
    });
    if (row == rows.end()) row = rows.insert(rows.end(), {motion, score.at.pressure_bar, {}, 1.0});
    row->worst = std::min(row->worst, score.right_share());
    row->sum.samples += score.samples;
    row->sum.wrong += score.wrong;
    row->sum.transitions += score.transitions;
    row->sum.found += score.found;
    row->sum.false_changes += score.false_changes;
  }
  std::stable_sort(rows.begin(), rows.end(),
                   [](const Row& a, const Row& b) { return a.motion < b.motion; });
  for (const Row& row : rows) {
    table.rows.push_back(
        {row.motion, Text("%g", row.pressure_bar), Text("%.3f %%", 100.0 * row.worst),
         std::to_string(row.sum.wrong) + " of " + std::to_string(row.sum.samples),
         std::to_string(row.sum.found) + " of " + std::to_string(row.sum.transitions),
         std::to_string(row.sum.false_changes)});
  }
  section.tables.push_back(table);

  for (const acceptance::NoiseLevel& level : acceptance::ByNoise(grid)) {
    const acceptance::RegimeScore& sum = level.sum;
    const std::string noise = Text(", noise %.2f counts", level.noise_rad / acceptance::kCount_rad);
    Compare(&section, "right samples, worst case" + noise, "%",
            Text("%.3f", 100.0 * level.worst_share), "at least 99.5",
            level.worst_share >= acceptance::kRightShare,
            std::to_string(level.cases) + " cases, " + std::to_string(sum.samples) +
                " samples; all together " + Text("%.4f %%", 100.0 * sum.right_share()));
    const double found = static_cast<double>(sum.found);
    const double transitions = static_cast<double>(std::max(sum.transitions, 1L));
    Compare(&section, "transitions found in time" + noise, "%",
            Text("%.2f", 100.0 * found / transitions), "all", sum.found == sum.transitions,
            std::to_string(sum.found) + " of " + std::to_string(sum.transitions) +
                " within one sample or two counts; of the others the latest came " +
                std::to_string(sum.latest) + " samples after its time, " +
                std::to_string(sum.never) + " ended before");
    Compare(&section, "false changes (chatter)" + noise, "", std::to_string(sum.false_changes), "0",
            sum.false_changes == 0);
  }
  Compare(&section, "unknown while the setup is right", "samples", std::to_string(unknown), "0",
          unknown == 0);
  if (!grid.setups.empty()) {
    double largest_rad = 0.0;
    bool done = true;
    report::Table setups;
    setups.title = "Setup: the contact found by turning the motor against the chamber";
    setups.header = {"pressure, bar",
                     "noise, mrad",
                     "encoder offset, mrad",
                     "error, counts",
                     "reported standard error, counts",
                     "after, s"};
    for (const acceptance::SetupScore& s : grid.setups) {
      done = done && s.done;
      largest_rad = std::max(largest_rad, std::abs(s.error_rad));
      setups.rows.push_back({Text("%g", s.at.pressure_bar), Text("%g", 1e3 * s.at.noise_rad),
                             Text("%g", 1e3 * s.at.offset_rad),
                             s.done ? Text("%.2f", s.error_rad / acceptance::kCount_rad)
                                    : regime::TroubleText(s.trouble),
                             Text("%.2f", s.reported_error_rad / acceptance::kCount_rad),
                             Text("%.1f", s.seconds)});
    }
    section.tables.push_back(setups);
    Compare(&section, "encoder offset, largest error", "counts",
            Text("%.2f", largest_rad / acceptance::kCount_rad), "one count",
            done && largest_rad <= acceptance::kCount_rad,
            std::to_string(grid.setups.size()) + " setups");
  }
  if (!grid.unknowns.empty()) {
    bool all_reported = true;
    report::Table unknowns;
    unknowns.title = "Reported as unknown, never guessed";
    unknowns.header = {"case", "unknown from then on", "reported after, s"};
    for (const acceptance::UnknownCase& u : grid.unknowns) {
      all_reported = all_reported && u.unknown_share == 1.0;
      unknowns.rows.push_back(
          {u.name, Text("%.2f %%", 100.0 * u.unknown_share), Text("%.2f", u.reported_after_s)});
    }
    unknowns.caption =
        "A wrong setup shows when the play angle leaves the backlash: until then nothing shows it.";
    section.tables.push_back(unknowns);
    Compare(&section, "wrong or missing setup reported as unknown", "",
            all_reported ? "all" : "not all", "all", all_reported,
            std::to_string(grid.unknowns.size()) + " cases");
  }
  return section;
}

}  // namespace sinew::reproduction
