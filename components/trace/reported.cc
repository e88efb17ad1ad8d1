#include "components/trace/reported.h"

#include <algorithm>

#include "components/trace/noise_floor.h"

namespace sinew::trace {

using identify::Design;

LikelihoodFit Reported(const Design& train, const LikelihoodFit& base,
                       const actuator::JointModel& declared) {
  LikelihoodFit out = base;
  out.likelihood = Unweighted(base.likelihood, LeftOver(base.fit, base.likelihood.used));
  out.likelihood.no_nuisance.emplace_back(kRigidBodies);
  out.fit = FitWhitened(train, out.likelihood, declared);
  return out;
}

void NoteErrors(const LikelihoodFit& reported, const actuator::JointModel& drive,
                Design* predicted_train, Design* predicted_sealed, TraceResult* result) {
  const Design &train = *predicted_train, &sealed = *predicted_sealed;
  const auto predict = [&](const actuator::JointModel& model) {
    predicted_train->PredictDrive(model);
    predicted_sealed->PredictDrive(model);
  };
  predict(result->nominal);
  result->nominal_train = identify::ErrorOf(train, result->nominal);
  result->nominal_sealed = identify::ErrorOf(sealed, result->nominal);
  predict(reported.fit.model);
  result->before_train = identify::ErrorOf(train, reported.fit.model, result->nominal);
  result->before_sealed = identify::ErrorOf(sealed, reported.fit.model, result->nominal);
  predict(drive);
  const double scale =
      reported.fit.balance.fits_scale ? reported.fit.balance.Scale(reported.fit.coefficients) : 1.0;
  const NoiseFloor floor = EstimateNoiseFloor(train, reported.fit.balance, scale);
  result->noise_floor_rms = std::min(floor.rms, reported.fit.rms);
  result->noise_floor_source = floor.source;
  result->ceiling_rms = reported.richest_rms;
}

}  // namespace sinew::trace
