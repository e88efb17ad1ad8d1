// The effects a model lacks, as columns beside it.
// Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "components/model/actuator/model.h"
#include "components/model/identify/design.h"
#include "components/model/trace/rules.h"

namespace sinew::trace {

struct GridPoint {
  std::vector<double> psi;
  Eigen::MatrixXd columns;  // phi, every row of the design
};

struct Candidate {
  std::shared_ptr<const effects::Effect> effect;
  std::vector<GridPoint> grid;
  bool stated = false;  // a declared term says it already: no cause
  const std::string& name() const { return effect->info().name; }
};

// An effect that cannot be asked for.
struct Untestable {
  std::string effect;
  std::string why;  // for the report
};

struct CandidateSet {
  std::vector<Candidate> candidates;
  std::vector<Untestable> untestable;
};

// Every passive or inertia effect of the model's balance that the model does not hold (effects with
// nonlinear parameters may come again with another setting). Drive terms are no candidates; events
// are none before their instants are known (event_search.h).
CandidateSet MakeCandidates(const identify::Design& design, const actuator::JointModel& model,
                            const InForce& in_force);

// Does a temperature_degC or payload_kg differ between recordings only, and between too few of them
// to distinguish it from everything else that was not the same?
bool DiffersBetweenFewRecordings(const identify::Design& design, std::string_view variable);

// The effects of the motion's balance that begin at an instant, without a grid.
std::vector<Candidate> EventCandidates(const actuator::JointModel& model, const InForce& in_force);

// All combinations of the grids of an effect's nonlinear parameters; one empty setting without any.
std::vector<std::vector<double>> GridOf(const effects::EffectInfo& info);

// The same with lengths, speeds and frequencies of the motion's size, inside their ranges.
std::vector<std::vector<double>> GridFor(const identify::Design& design,
                                         const effects::JointConstants& constants,
                                         const effects::EffectInfo& info);

}  // namespace sinew::trace
