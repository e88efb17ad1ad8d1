// Small imperfections that every set-up has, as columns with priors: channels half a sample apart,
// valves that take some samples to open, teeth that give less than the encoder rounds. Without them
// every clean recording would be an alarm (effects::Smallest). On a joint of an arm a refit of the
// rigid bodies, as far as the other joints leave them open, is one, too. Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "components/model/actuator/model.h"
#include "components/model/identify/design.h"
#include "components/model/trace/used_rows.h"

namespace sinew::trace {

struct Likelihood;  // whitened_fit.h

struct Nuisances {
  Eigen::MatrixXd columns;       // used rows, with the sign of a balance's columns
  Eigen::VectorXd mean, spread;  // prior of each coefficient; spread 0: flat
  // The first columns have them; those behind are of the rigid bodies.
  std::vector<std::string> names;
  std::vector<double> most;  // spreads beyond which it is no small imperfection any more
};

// Declared friction that only knows the direction of motion, Nm or N; 0 without.
double DryFriction(const actuator::JointModel& model);

// Stroke over which every contact yields a little before it slides, some counts of the encoder, rad
// or m; 0 where the model declares no counts.
double GivingLength(const effects::JointConstants& constants);

// Leaves the rigid bodies out (MakeNuisances).
inline constexpr const char* kRigidBodies = "rigid_body";

// Nuisances of the model's balance; what the model holds as a term is none, nor is what is left out
// by name.
Nuisances MakeNuisances(const identify::Design& design, const Likelihood& likelihood,
                        const actuator::JointModel& model);

}  // namespace sinew::trace
