#include "components/model/trace/range.h"

namespace sinew::trace {

Range RangeOfAddition(const identify::Design& design, const actuator::JointModel& model,
                      const effects::Effect& effect, std::span<const double> psi,
                      std::size_t linear) {
  const effects::ParameterInfo& added = effect.info().linear[linear];
  if (added.dimension == effects::Dimension::kNone) return RangeOnAnyMachine(added);
  const Eigen::VectorXd column = design.Columns(effect, psi).col(static_cast<Eigen::Index>(linear));
  for (const actuator::Term& term : model.terms) {
    if (!term.declared || !model.Counts(term)) continue;
    const std::vector<effects::ParameterInfo>& infos = term.effect->info().linear;
    for (std::size_t i = 0; i < infos.size(); ++i) {
      if (infos[i].dimension != added.dimension) continue;
      const Eigen::MatrixXd phi = design.Columns(*term.effect, actuator::NonlinearValues(term));
      if (phi.col(static_cast<Eigen::Index>(i)) != column) continue;
      const Range sum = RangeOnAnyMachine(infos[i]);
      const double value = term.linear[i].value;
      return {sum.lower - value, sum.upper - value};
    }
  }
  return RangeOnAnyMachine(added);
}

}  // namespace sinew::trace
