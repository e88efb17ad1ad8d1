// Things that begin at an instant: a payload put on, a push from outside.
//
// When they begin differs from recording to recording and is no property of the robot. So the
// instant is looked for in every recording by itself, the recordings' clocks are set by it
// (identify::Design::SetClock), and from then on the effect is a candidate like every other.
//
// A lasting event (one nonlinear parameter: start) is a change point: for every instant the
// generalised likelihood ratio of the effect acting from there on, beside the model's own terms
// (Basseville, Nikiforov 1993, section 2.4). It has to exceed twice the 99th percentile of what the
// same search finds in the residual with random signs of whole blocks.
//
// A passing event (start and length) cannot be predicted from other parts of the data, and signs of
// blocks do not change its size. It is told by a matched filter: its peak has to exceed kLoudest
// times the filter's ordinary output (median absolute value) and it may not come often.
// Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "components/effects/effect.h"
#include "components/identify/block_regression.h"
#include "components/identify/design.h"

namespace sinew::trace {

// Robust standard deviations that a passing event must exceed.
inline constexpr double kLoudest = 8.0;

struct Event {
  std::shared_ptr<const effects::Effect> effect;
  std::vector<double> start_s;  // per recording, on its own stamps; NaN: it did not happen there
  double length_s = 0.0;        // passing events; 0: it lasts
  double clock_s = 0.0;         // where it begins once the clocks are set
  double explained = 0.0;       // squared error of the target, all recordings
  double statistic = 0.0;       // squared error explained by all changes, or robust sigmas
  double threshold = 0.0;       // that the statistic had to exceed
  bool significant = false;
  bool passing() const { return length_s > 0.0; }
};

// target: residual of the model; base: columns of its own terms. Clocks are not touched.
Event FindEvent(const identify::Design& design, std::shared_ptr<const effects::Effect> effect,
                const std::vector<identify::Block>& blocks,
                const Eigen::Ref<const Eigen::MatrixXd>& base,
                const Eigen::Ref<const Eigen::VectorXd>& target, int placebo_rounds,
                std::uint64_t seed);

// The same event in other recordings, its size known: where it explains most of `residual`
// (residual + theta * phi = noise), or nowhere. Returns start_s per recording.
std::vector<double> LocateEvent(const identify::Design& design, const Event& event, double theta,
                                const Eigen::Ref<const Eigen::VectorXd>& residual);

// Sets the clocks of a design so that the event begins at event.clock_s in every recording; where
// it did not happen it never begins.
void SetClocks(const std::vector<double>& start_s, double clock_s, identify::Design* design);

}  // namespace sinew::trace
