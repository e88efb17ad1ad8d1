#include "components/model/trace/set_model.h"

#include <optional>
#include <utility>

namespace sinew::trace {

actuator::JointModel ModelWith(const actuator::JointModel& declared, const Problem& problem,
                               const EffectSet& set, std::vector<std::vector<int>>* terms) {
  actuator::JointModel model = declared;
  terms->clear();
  Eigen::Index k = 0;
  for (const std::size_t member : set.members) {
    const Hypothesis& h = problem.hypotheses()[member];
    terms->emplace_back();
    for (const TermSetting& setting : h.settings) {
      actuator::Term term;
      term.effect = h.effect;
      term.declared = false;
      for (std::size_t i = 0; i < setting.columns.size(); ++i, ++k) {
        term.linear.push_back({.value = problem.scale * set.c[k], .half_width_95 = std::nullopt});
      }
      const auto& infos = h.effect->info().nonlinear;
      for (std::size_t i = 0; i < setting.psi.size(); ++i) {
        actuator::ParameterValue value{.value = setting.psi[i], .half_width_95 = std::nullopt};
        // Counts stay whole, instants and spans were searched.
        value.fixed = infos[i].dimension == effects::Dimension::kNone || h.effect->info().event ||
                      h.effect->info().follows_record;
        term.nonlinear.push_back(value);
      }
      terms->back().push_back(static_cast<int>(model.terms.size()));
      model.terms.push_back(std::move(term));
    }
  }
  return model;
}

}  // namespace sinew::trace
