#include "components/model/trace/reported.h"

#include "components/model/trace/noise_floor.h"

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
                Design* predicted_train, Design* predicted_held_out, TraceResult* result) {
  const Design &train = *predicted_train, &held_out = *predicted_held_out;
  const auto predict = [&](const actuator::JointModel& model) {
    predicted_train->PredictDrive(model);
    predicted_held_out->PredictDrive(model);
  };
  predict(result->nominal);
  result->nominal_train = identify::ErrorOf(train, result->nominal);
  result->nominal_held_out = identify::ErrorOf(held_out, result->nominal);
  predict(reported.fit.model);
  result->before_train = identify::ErrorOf(train, reported.fit.model, result->nominal);
  result->before_held_out = identify::ErrorOf(held_out, reported.fit.model, result->nominal);
  predict(drive);
  const double scale =
      reported.fit.balance.fits_scale ? reported.fit.balance.Scale(reported.fit.coefficients) : 1.0;
  const NoiseFloor floor = EstimateNoiseFloor(train, reported.fit.balance, scale);
  result->noise_floor_rms = floor.rms;
  result->noise_floor_source = floor.source;
  result->ceiling_rms = reported.richest_rms;
}

}  // namespace sinew::trace
