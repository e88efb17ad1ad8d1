// The rows of a standing robot's recordings as a linear regression, whitened, with everything that
// may explain what the declared model leaves:
//
//     target = declared b + columns c + noise
//
// declared: free parameters of the joints' terms (as changes of their values), bodies, gain of the
// feet's sensors and tilt of the IMU within their tolerances. columns: a payload on each rigid
// group (mass at its middle, first moments about that along the axes that show); friction of each
// moving joint, by effect of the catalogue; its torque constant; the gain of the feet's sensors
// (`load_cell_gain`); free curves over each moving joint's angle and velocity. The noise of each
// channel has a colour of its own (trace/noise_model.h). Pure; allocates.
#pragma once

#include <vector>

#include "components/model/identify/block_regression.h"
#include "components/model/stance_fit/stance_fit.h"
#include "components/model/stance_fit/stance_model.h"
#include "components/model/trace/noise_model.h"
#include "components/model/trace/problem.h"

namespace sinew::stance_fit {

// Subject of a hypothesis.
struct Subject {
  enum class Kind { kPayload, kJoint, kForces, kCurve } kind = Kind::kCurve;
  std::size_t index = 0;  // of the layout's groups, or of the model's joints
};

// Recordings of one analysis, stacked.
struct Regression {
  trace::Bank bank;
  std::vector<Subject> subjects;  // of the hypotheses
  // Parameters of the declared columns: joint, term, parameter; -1: a tolerance.
  struct Parameter {
    int joint = -1, term = -1, linear = -1;
  };
  std::vector<Parameter> parameters;
  Eigen::Index channels = 0;
  std::vector<trace::Stretch> stretches;     // of samples, a sample being `channels` rows
  std::vector<identify::Block> blocks;       // of rows, for tests on whitened rows
  std::vector<identify::Block> long_blocks;  // for intervals of plain least squares
  Eigen::VectorXd time_s;                    // of each sample, -1 to 1 in its recording
  std::vector<std::size_t> recording;        // of each sample
};

Regression MakeRegression(const StanceModel& model, const StanceLayout& layout,
                          const std::vector<StanceRows>& recordings, const Tolerances& tolerances);

// Noise of each channel.
using ChannelNoise = std::vector<trace::NoiseModel>;
ChannelNoise NoiseOf(const Regression& regression,
                     const Eigen::Ref<const Eigen::VectorXd>& residual, int longest_order);
Eigen::MatrixXd Whiten(const Regression& regression, const ChannelNoise& noise,
                       const Eigen::Ref<const Eigen::MatrixXd>& columns);

trace::Problem MakeProblem(const Regression& regression, const ChannelNoise& noise);

// Noise of what the declared columns and the best set of effects leave. Not of the richest model:
// its hundred slow columns would take most of the slow part of a minute's noise with them, and
// whitening would then magnify what is left of it.
ChannelNoise EstimateNoise(const Regression& regression, int longest_order);

}  // namespace sinew::stance_fit
