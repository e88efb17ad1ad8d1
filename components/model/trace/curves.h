// Alternatives to the catalogue that need no physics: free curves over one signal, over time, and
// over an angle. They compete with the effects in one likelihood; where one of them explains
// clearly more than the best physical set, the honest answer is "unexplained: depends on X"
// (design.md, "Closing the loop", steps 6 and 8).
//
// A curve is a sum of hat functions over knots at quantiles of its signal, alone or times another
// signal (friction follows the direction of motion, a tilting base the cosine of the angle).
// Pure; allocates.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "components/model/identify/design.h"

namespace sinew::trace {

struct Curve {
  std::string variable;     // field of JointSample it depends on
  std::string description;  // "curve over position_rad times the direction"
  Eigen::MatrixXd columns;  // every row of the design
};

// Every curve whose signals the design's recordings provide, but for those that hold the noise of
// the balance's own target: over them a curve explains the target by itself. The design's drive
// must be predicted (Design::PredictDrive).
std::vector<Curve> FreeCurves(const identify::Design& design, effects::Balance balance);

}  // namespace sinew::trace
