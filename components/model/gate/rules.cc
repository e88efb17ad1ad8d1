#include "components/model/gate/rules.h"

#include <stdexcept>

#include "components/base/types/text.h"

namespace sinew::gate {

namespace {

constexpr std::string_view kCount = "a single one is a fault";

constexpr Rule kRules[] = {
    {"missing_constant", "constants that a declared term needs and the model lacks", 0.0, kCount},
    {"stamps", "rows whose stamp is not later than the one before", 0.0, kCount},
    {"non_finite", "values of a channel that are no numbers", 0.0, kCount},
    {"constant", "steps of resolution that the others move while a channel of motion never changes",
     100.0, "a moving joint passes hundreds of steps, rest and locked motors a few"},
    {"duplicated", "share of rows in which two channels are equal to the bit", 0.99,
     "no two sensors round alike"},
    {"wrapped",
     "jump that stays, over the channel's range; 1 for whole turns above 20 times the 99 % "
     "quantile of the other jumps; of a channel without negative values the empty part of its "
     "range between two groups of values, one for each direction of motion",
     0.8,
     "a wrapped channel jumps by all of its range, a moving joint by a small part in one row; a "
     "sign bit leaves nearly all of it empty"},
    {"spike",
     "distance of one row from a parabola through four rows on either side (eight on one side at "
     "an end), and from the two rows beside it, over the larger of the others' distance and of "
     "its own 99 % quantile, where neither the motion nor another channel changes in that row and "
     "more than five rows of a channel are so",
     12.0, "gate_bench: above everything without fault, below spikes of a third of the range"},
    {"frozen",
     "disagreement with a second channel while one is equal to the bit, over the larger of that "
     "elsewhere and of play and resolution; or equal rows while the joint moves, or the jump at "
     "their end, over what is usual",
     2.0, "gate_bench: above everything without fault, below frozen spans of half a second"},
    {"units_speed", "measured speed over the derivative of its angle, or the inverse", 1.41,
     "the middle, as a ratio, between 1 and the smallest error of units, 2"},
    {"units_gear", "speed of the motor over gear ratio and speed of the output, or the inverse",
     1.41, "the middle, as a ratio, between 1 and the smallest error of units, 2"},
    {"sign_speed", "correlation of measured speed and derivative of its angle, negated", 0.7,
     "half of the variance"},
    {"sign_gear", "correlation of the speeds of motor and output, negated", 0.7,
     "half of the variance"},
    {"drive_sign",
     "share of the drive that the declared model leaves with parameters within half an order of "
     "magnitude, over the share it leaves with the drive reversed, or never negative and read "
     "with the sign of the speed (if below half) plus a tenth",
     3.0, "gate_bench: recordings with effects of the catalogue stay below half of it"},
    {"units", "the same, over the share left with one channel in another unit plus a tenth", 3.0,
     "gate_bench, as drive_sign"},
    {"zero",
     "the same, over the share left with the zero of a rotary joint's angle a quarter or half a "
     "turn away plus a tenth, where gravity is declared",
     3.0, "as units"},
    {"recording_differs",
     "resolution and range of a channel in one recording over those in the others, or the "
     "inverse: the smaller of the two, where the resolutions stand as units of one kind do within "
     "2 %",
     5.0,
     "between another motion with the same converter, 1, and 2 pi; recordings of measured arms "
     "stay at 1"},
};

}  // namespace

std::span<const Rule> Rules() { return kRules; }

const Rule& FindRule(std::string_view id) {
  std::string known;
  for (const Rule& rule : kRules) {
    if (rule.id == id) return rule;
    known += (known.empty() ? "" : ", ") + std::string(rule.id);
  }
  throw std::invalid_argument("no fault is called '" + std::string(id) + "', expected one of " +
                              known);
}

std::string FormatRules() {
  std::string out =
      "| rule | statistic | limit | where the limit comes from |\n| --- | --- | --- | --- |\n";
  for (const Rule& rule : kRules) {
    out += "| `" + std::string(rule.id) + "` | " + std::string(rule.statistic) + " | " +
           types::Text("%.3g", rule.limit) + " | " + std::string(rule.limit_source) + " |\n";
  }
  return out;
}

}  // namespace sinew::gate
