// Ways of the link through the play in a recording of pushes (push.h), and means over their rows.
//
// Means are weighted with a Hann window w: w and dw/dt vanish at its ends, so that the mean of
// d2q/dt2 is that of q with d2w/dt2, and nothing is differentiated (modulating functions: Shinbrot,
// Trans. ASME 79 (1957) 547). Angles in rad of the output, forces in N at the load cell. Pure.
#pragma once

#include <cstddef>
#include <vector>

#include "components/model/experiment/protocol.h"

namespace sinew::experiment {

// A link that moves faster than this is on its way.
inline constexpr double kMovedSpeed_rad_s = 0.03;

// Means under a Hann window over some rows.
struct WindowMean {
  double time_s = 0.0;
  double force_N = 0.0;
  double pressure_bar = 0.0;
  double cosine = 1.0;
  double angle_rad = 0.0;
  // From every second row, and from the others: their noises are independent.
  double acceleration_a_rad_s2 = 0.0, acceleration_b_rad_s2 = 0.0;
  double acceleration_rad_s2() const {
    return 0.5 * (acceleration_a_rad_s2 + acceleration_b_rad_s2);
  }
};
// rows first to last, both included; at least three.
WindowMean HannMean(const Recording& rows, std::size_t first, std::size_t last);

// One way through the play.
struct Stroke {
  int direction = 0;  // -1 down, +1 up
  std::size_t first = 0, last = 0;
  double start_s = 0.0;
  bool valve_open = true;
  WindowMean mean{};
};
struct Play {
  double lower_rad = 0.0, upper_rad = 0.0;
  double lower_rad2 = 0.0, upper_rad2 = 0.0;        // variance of the rows at each contact
  std::vector<std::size_t> lower_rows, upper_rows;  // in which the link rests on a contact
  std::vector<Stroke> strokes;
  struct Push {
    double start_s = 0.0;
    double pressure_bar = 0.0;
    bool passed = false;  // the link went through the play
    bool valve_open = true;
    WindowMean mean{};  // of the stroke down, if it passed
  };
  std::vector<Push> pushes;
};
// Throws std::invalid_argument: too few rows, or a link that did not move.
Play FindStrokes(const Recording& rows);

// Half-overlapping parts of a stroke; none where it is too short.
inline constexpr int kStrokeWindows = 4;
struct Window {
  std::size_t first = 0, last = 0;
};
std::vector<Window> WindowsOf(const Stroke& stroke);

}  // namespace sinew::experiment
