#include "reproduction/module_tables/pressure_section.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "reproduction/module_tables/section_parts.h"

namespace sinew::reproduction {

using pneumatics::Fault;
using report::Text;

report::Section MakePressureSection(const acceptance::PressureCheck& check,
                                    const pneumatics::ManagerConfig& config) {
  report::Section section;
  section.id = "pneumatics";
  section.title = "Pressure and stiffness held by relays";
  section.paragraphs = {
      "The pressure manager with the rig's configuration (robots/rig/pneumatics.yaml) on the "
      "surrogate's air supply at 240 Hz: compressor, valve and vent behind relays with dead time, "
      "a "
      "10-bit sensor with noise, air that warms when it is pumped. Assessed by the chamber's true "
      "pressure from half a second after the manager first reports settled.",
      "A stiffness is asked for through the identified k(P), the secant of a push cycle through "
      "the "
      "play, (K P + T_dyn - T_g) / play. Only above 2.2 bar is there one: below, friction wins."};
  report::Table table;
  table.title = "Held";
  table.caption =
      "Margin: the shortest time a relay was on or off, less its least one; a dash: it did not "
      "switch twice.";
  table.header = {"held by",   "from, bar",        "asked for",    "target, bar",
                  "link",      "settled after, s", "worst, bar",   "switches a minute",
                  "reversals", "margin on, s",     "margin off, s"};
  double worst_bar = 0.0, most_switches = 0.0, most_reversals = 0.0;
  double least_margin_s = std::numeric_limits<double>::infinity();
  bool settled = true, false_alarm = false;
  const auto margin = [](double value_s) {
    return std::isfinite(value_s) ? Text("%.2f", value_s) : std::string("-");
  };
  for (const acceptance::HoldScore& s : check.holds) {
    settled = settled && s.settled;
    false_alarm = false_alarm || s.fault != Fault::kNone;
    worst_bar = std::max(worst_bar, s.worst_bar);
    most_switches = std::max(most_switches, s.switches_per_min);
    most_reversals = std::max(most_reversals, s.reversals_per_min());
    least_margin_s = std::min(least_margin_s, s.least_margin_s());
    table.rows.push_back(
        {s.at.hold_with == pneumatics::HoldWith::kReservoir ? "reservoir" : "shut chamber",
         Text("%g", s.at.from_bar),
         s.at.target_stiffness_Nm_rad > 0.0 ? Text("%g Nm/rad", s.at.target_stiffness_Nm_rad)
                                            : Text("%g bar", s.at.target_bar),
         Text("%.3f", s.target_bar), s.at.moving ? "30 degrees, 0.4 Hz" : "at rest",
         s.settled ? Text("%.1f", s.reached_s) : "never", Text("%.3f", s.worst_bar),
         Text("%.1f", s.switches_per_min), std::to_string(s.reversals), margin(s.shortest_on_s),
         margin(s.shortest_off_s)});
  }
  section.tables.push_back(table);
  report::Table faults;
  faults.title = "Faults reported, and the safe state";
  faults.caption = config.vent_when_safe
                       ? "Safe: compressor off, valve and vent open, latched until reset."
                       : "Safe: all relays off, latched until reset.";
  faults.header = {"what breaks", "reported as", "after, s", "highest pressure then, bar",
                   "safe state"};
  bool all_reported = true;
  for (const acceptance::FaultScore& s : check.faults) {
    all_reported = all_reported && acceptance::IsRight(s);
    faults.rows.push_back({acceptance::BreakageTitle(s.breakage), pneumatics::FaultText(s.fault),
                           s.fault == Fault::kNone ? "-" : Text("%.2f", s.reported_after_s),
                           Text("%.2f", s.highest_bar),
                           s.fault == Fault::kNone ? "-"
                           : s.safe                ? "yes"
                                                   : "NO"});
  }
  section.tables.push_back(faults);

  Compare(&section, "worst pressure error while held", "bar", Text("%.3f", worst_bar),
          "within 0.05", settled && worst_bar <= acceptance::kBand_bar);
  Compare(&section, "fillings that follow a venting and the other way, a minute", "",
          Text("%.1f", most_reversals), "no hunting: at most 1",
          most_reversals <= acceptance::kMostReversals_per_min,
          Text("at most %.0f switches of relays a minute, while the air cools after filling",
               most_switches));
  Compare(&section, "least margin to the relays' least times", "s", margin(least_margin_s),
          "not below 0", least_margin_s >= acceptance::kLeastMargin_s);
  Compare(&section, "false alarms", "", false_alarm ? "some" : "none", "none", !false_alarm);
  Compare(&section, "breakages reported as what they are, and safe", "",
          all_reported ? "all" : "not all", "all", all_reported);
  return section;
}

}  // namespace sinew::reproduction
