// A recorded reference as a trajectory: the recorded points themselves, at their times.
//
// Between two samples position, velocity and acceleration lie on straight lines of their own, so
// that a session of the recorded period gets the recorded values bit for bit. Outside the
// samples it goes on in a straight line, as reference::Samples does: the generator's soft start and
// soft stop blend from and to it.
#pragma once

#include <vector>

#include "components/robot/reference/trajectory.h"

namespace sinew::stand_ins {

class Recorded final : public reference::Trajectory {
 public:
  // Times strictly increasing, s; the first becomes 0. Throws std::invalid_argument: fewer than two
  // samples, times that do not increase, a value that is not finite.
  Recorded(std::vector<double> time_s, std::vector<reference::Point> points);
  reference::Point At(double time_s) const noexcept override;
  double duration_s() const noexcept override { return time_s_.back(); }

 private:
  std::vector<double> time_s_;
  std::vector<reference::Point> points_;
};

}  // namespace sinew::stand_ins
