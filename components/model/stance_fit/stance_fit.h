// Undeclared payload or friction that a standing robot's recordings show, and how much better the
// corrected model predicts a held-out one.
//
// The balance is (1) of stance_model.h. Whitened with the noise of its richest model it has one
// likelihood, in which payloads, friction of the catalogue, torque constants, gains of the feet's
// sensors and free curves compete; sets, p-value, posterior and score are those of
// components/model/trace, with its rules (trace/rules.h). Sizes are those of plain least squares
// with the priors of the declared tolerances; their 95 % intervals come from the scores of long
// blocks (identify/block_regression.h), because what is left is correlated:
//
//     cov = A^-1 (sum_b s_b s_b' / f^2 + P) A^-1,   A = X'X / f + P,   P the priors' precision
//
// f, the dispersion, is explained in stance_sizes.h.
//
// A payload is its mass and its first moments about the middle of its group; of these, the one
// along the vertical only where the group turns against it (kLeastTurn_rad). A coordinate of its
// place whose interval is wider than kWidestPlace_m is reported as not excited: an upright torso
// does not show the height of what it carries. What the payload adds to the moments of inertia is
// left out: a point mass at the largest distance, 4 kg at 0.3 m, is 0.36 kg m^2, which the angular
// acceleration of a torso that stays upright does not excite.
//
// Pure; allocates; reads no clock. Throws std::invalid_argument for recordings that do not fit the
// model.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "components/model/stance_fit/stance_model.h"
#include "components/model/trace/posterior.h"
#include "components/model/trace/trace_result.h"

namespace sinew::stance_fit {

// Half width of the interval of a place up to which it is stated: the accuracy that the place of a
// payload is asked for.
inline constexpr double kWidestPlace_m = 0.02;

// Prior knowledge of the declared bodies and of the IMU: standard deviations. The defaults are
// those of a robot whose links were weighed on a kitchen scale and measured by ruler, of an IMU
// that was levelled with a spirit level, and of force sensors that were calibrated with a weight.
struct Tolerances {
  double mass_share = 0.01;   // of each rigid group's mass
  double com_m = 1e-3;        // of its centre of mass, per axis
  double tilt_rad = 1e-3;     // of the IMU against the base, about x and y
  double force_share = 3e-3;  // of the gain that the feet's sensors have in common
};

struct StanceOptions {
  trace::InForce in_force{};
  Tolerances tolerances;
  std::uint64_t seed = 1;
};

struct PlacedPayload {
  std::string link_name;
  std::vector<std::string> rigid_with;  // links of the group: no recorded joint moved between them
  double mass_kg = 0.0, mass_half_width_95 = 0.0;
  // In the link's frame; along an axis that does not show it is that of the link's centre of mass.
  Eigen::Vector3d place_m = Eigen::Vector3d::Zero();
  Eigen::Vector3d place_half_width_95 = Eigen::Vector3d::Zero();
  std::array<bool, 3> excited{};  // of x, y, z
};

struct StanceEffect {
  std::string name;   // "payload", or of the catalogue
  std::string place;  // link, joint or "feet"
  std::optional<PlacedPayload> payload;
  std::optional<actuator::Term> term;  // of a joint's effect, with half widths
  trace::Posterior posterior;          // of "effect of place"
  double gain_share = 0.0;
  double p = 1.0;
  trace::Confirmation confirmation;  // where something was held out
  bool in_model = false;
};

// Rms of what a model leaves, rows in use.
struct StanceError {
  double moment_x_Nm = 0.0, moment_y_Nm = 0.0, force_z_N = 0.0;  // rows that close alone
  double share = 0.0;  // of all channels, in units of the sensors' noise
  // Errors of StanceFitResult::moving_joints once the forces without a sensor took what fits them.
  std::vector<double> joints_Nm;
};

// Residual over time of the rows that close alone: m_x, m_y, f_z.
struct BalanceSeries {
  Eigen::VectorXd time_s;         // of the recordings, one after the other
  Eigen::MatrixXd before, after;  // rows x 3, Nm, Nm, N
};

// Smallest size found in 80 % of such recordings (trace/sensitivity.h).
struct SmallestSize {
  std::string effect;  // "effect of place"
  std::string parameter;
  double size = 0.0;
};

struct StanceFitResult {
  trace::Verdict verdict = trace::Verdict::kNone;
  std::string too_little;  // why nothing was fitted
  std::optional<double> p_global;
  std::vector<StanceEffect> effects;  // selected and not refuted
  std::vector<StanceEffect> refuted;  // selected, refuted on the held-out recordings
  std::string unexplained;  // variable of what a free curve explains beside them; empty: none
  std::vector<trace::NotExcited> not_excited;
  std::vector<SmallestSize> detectable;
  StanceError train_before, train_after;  // as declared; refitted with the effects in the model
  StanceError held_out_before, held_out_after;  // 0 without held-out recordings
  BalanceSeries held_out;                       // empty without
  std::vector<std::string> moving_joints;
  std::size_t rows = 0, blocks = 0;
  Eigen::Index channels = 0;
  double low_pass_Hz = 0.0;
  // With the terms and payloads that are in_model: a term that the joint has already is changed, a
  // payload is added to those that are declared.
  actuator::RobotModel corrected;
  std::vector<PlacedPayload> payloads;
};

// held_out may be empty: nothing is confirmed then, and every effect that was selected is in the
// model.
StanceFitResult FitStance(const StanceModel& model, const std::vector<StanceRecording>& train,
                          const std::vector<StanceRecording>& held_out,
                          const StanceOptions& options = {});

}  // namespace sinew::stance_fit
