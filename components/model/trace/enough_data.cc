#include "components/model/trace/enough_data.h"

#include <algorithm>

#include "components/base/types/text.h"
#include "components/model/identify/balance.h"
#include "components/model/trace/problem.h"

namespace sinew::trace {

namespace {

double MovingTime(const identify::Design& design) {
  return static_cast<double>(design.rows().UsedRows().size()) / design.rows_per_s();
}

std::string Sentence(const char* of, const identify::Design& design, double statistic,
                     const Rule& rule, const char* counted) {
  return types::Text(
      "the %s recordings hold %.3g s of motion away from rest, reversals and their ends: "
      "%.3g %s, expected at least %.3g",
      of, MovingTime(design), statistic, counted, rule.limit);
}

// Used rows over blocks of at least the length over which noise may be coloured (problem.h), and no
// more blocks than inference makes of them (used_rows.h).
int IndependentBlocks(const identify::Design& design) {
  const UsedRows used = MakeUsedRows(design, kFewestRowsPerBlock);
  const auto length = std::max<Eigen::Index>(kFewestRowsPerBlock, LongestOrder(design));
  return static_cast<int>(
      std::min<Eigen::Index>(used.size() / length, static_cast<Eigen::Index>(used.blocks.size())));
}

}  // namespace

std::optional<TooLittle> FindTooLittle(const identify::Design& train,
                                       const identify::Design& held_out,
                                       const actuator::JointModel& model, const InForce& in_force) {
  const auto too_few = [&](const Rule& rule, double statistic, const char* of,
                           const identify::Design& design,
                           const char* counted) -> std::optional<TooLittle> {
    if (statistic >= in_force.Limit(rule)) return std::nullopt;
    return TooLittle{rule.id, statistic, rule.limit,
                     Sentence(of, design, statistic, rule, counted)};
  };
  const auto parameters =
      std::max<Eigen::Index>(1, identify::MakeBalance(train, model).columns.cols());
  std::optional<TooLittle> found =
      too_few(rules::kBlocks, IndependentBlocks(train), "training", train, "independent blocks");
  if (!found) {
    found = too_few(
        rules::kRows,
        static_cast<double>(train.rows().UsedRows().size()) / static_cast<double>(parameters),
        "training", train, "rows for each fitted parameter");
  }
  if (!found) {
    found = too_few(rules::kHeldOutBlocks, IndependentBlocks(held_out), "held-out", held_out,
                    "independent blocks");
  }
  return found;
}

}  // namespace sinew::trace
