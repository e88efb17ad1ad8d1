// A model fitted to recordings by its whitened likelihood with the priors of its declared
// parameters, and intervals that hold for whatever correlation is left inside blocks. Pure;
// allocates.
#pragma once

#include <optional>

#include "components/model/identify/balance.h"
#include "components/model/trace/event_search.h"
#include "components/model/trace/evidence.h"
#include "components/model/trace/noise_model.h"
#include "components/model/trace/nuisances.h"
#include "components/model/trace/rules.h"
#include "components/model/trace/used_rows.h"

namespace sinew::trace {

// Priors of a balance's coefficients: declared tolerances as standard deviations, none = flat;
// terms that close-loop added are expected around 0 within kPlausibleShare of the measured side.
Prior PriorOf(const identify::Balance& balance, const actuator::JointModel& model,
              const UsedRows& used, const Nuisances& nuisances);

// Prior of an effect: its rms is of the order of this share of the measured side's rms, or less.
inline constexpr double kPlausibleShare = 0.5;

// Likelihood of a balance: rows, noise, and how the declared terms are fitted.
struct Likelihood {
  InForce in_force;
  UsedRows used;
  NoiseModel noise;
  // One over the noise's scale at each used row: reversals, impacts and fast motion are noisier
  // than a slow ramp. Empty: the same everywhere.
  Eigen::VectorXd weight;
  std::optional<bool> fits_scale;        // form of the balance (MakeBalance)
  bool predicted_rate = false;           // the drive's rate is that of the predicted one (Design)
  std::vector<std::string> no_nuisance;  // imperfections too large to be one (ImplausibleNuisances)
  std::optional<TimedEffect> event;      // the design's clocks are set by it
};

// Columns of the used rows, weighted and whitened; and the transposed operation.
Eigen::MatrixXd Whiten(const Likelihood& likelihood,
                       const Eigen::Ref<const Eigen::MatrixXd>& columns);
Eigen::VectorXd WhitenTransposed(const Likelihood& likelihood,
                                 const Eigen::Ref<const Eigen::VectorXd>& whitened);

// Noise of a residual at the used rows: its local scale over `window` rows either way, then its
// colour. Stretches and blocks stay.
void SetNoise(const Eigen::Ref<const Eigen::VectorXd>& residual, Eigen::Index window,
              int longest_order, Likelihood* likelihood);

// The same with one robust scale for each recording and a short memory.
void SetNoiseByRecording(const identify::Design& design,
                         const Eigen::Ref<const Eigen::VectorXd>& residual, Likelihood* likelihood);

// The same rows with one white noise for all of them, as loud as `residual` (of the used rows) is
// over whole blocks. For models that are reported, simulated and controlled with: their plain error
// counts, and what no model of the catalogue follows must not decide which rows do.
Likelihood Unweighted(Likelihood likelihood, const Eigen::Ref<const Eigen::VectorXd>& residual);

// Residual of a fit at the used rows, in units of the balance.
Eigen::VectorXd LeftOver(const identify::FitResult& fit, const UsedRows& used);

// Linear parameters at the present nonlinear ones; nuisances are fitted and forgotten.
identify::FitResult FitWhitened(const identify::Design& design, const Likelihood& likelihood,
                                const actuator::JointModel& model);

// The same with the continuous nonlinear parameters of added terms refined from where they are.
identify::FitResult RefineWhitened(const identify::Design& design, const Likelihood& likelihood,
                                   const actuator::JointModel& model);

// Nuisances whose fitted size is no small imperfection any more, beside those that the likelihood
// leaves out: what they stand for is asked for as an effect.
std::vector<std::string> ImplausibleNuisances(const identify::Design& design,
                                              const Likelihood& likelihood,
                                              const actuator::JointModel& model);

}  // namespace sinew::trace
