// States of the gas balance: the chamber's pressure while the valve is shut, and how it starts when
// the valve is opened.
//
// Differentiated pressure of ten bits is noise, so the balance is its integral: pressure against
// integrals of what the effects say of its rate, within windows, each with a level of its own
// (Design takes the mean from every window). A window is a spell with the valve shut, cut into
// pieces of at most kLongestWindow_s; the last kBeforeOpening_s of a spell and the first
// kAfterOpening_s of flow are one, too. There the declared model says that the flow begins with the
// command and the stated delay; the flow's curve F is a parabola fitted to that opening, the
// instant of its beginning with it, and then played from the command on. A command falls anywhere
// between two rows: openings may differ by up to a sample either way from what they have in
// common, and what they have in common is the rig's own way to open up to kOpeningSamples. Windows
// are what cross-validation leaves out together. Nothing is filtered: the noise of the pressure is
// white.
//
// The volume follows from the model of motion: dV/dq is the pneumatic torque per pressure (virtual
// work), 1e-5 m3/rad per Nm/bar. Pure; allocates; throws std::invalid_argument as MakeStates.
#pragma once

#include <vector>

#include "components/base/types/run.h"
#include "components/model/actuator/model.h"
#include "components/model/identify/processing.h"

namespace sinew::identify {

inline constexpr double kLongestWindow_s = 10.0;
inline constexpr double kShortestWindow_s = 1.0;
inline constexpr double kBeforeOpening_s = 0.5;
inline constexpr double kAfterOpening_s = 0.15;  // of flow
inline constexpr double kLongestDeadTime_s = 0.3;
inline constexpr double kAfterShutting_s = 0.1;  // the valve travels
// A flow that begins late by fewer rows than this has no dead time: relays, ports that open
// gradually and the commands' own instants take that long in every rig.
inline constexpr double kOpeningSamples = 3.2;

struct GasWindows {
  StateSet states;
  int shut = 0;      // windows with the valve shut
  int openings = 0;  // windows around an opening that moved the pressure
};

// motion: options of the motion balance, resolved. fitted: the model fitted in it.
GasWindows MakeGasStates(const std::vector<types::Run>& runs, const actuator::JointModel& fitted,
                         const ProcessingOptions& motion);

// dV/dq at an angle, m3/rad, as the model's pneumatic terms say.
double ChamberSlope_m3_rad(const actuator::JointModel& model, double position_rad);

}  // namespace sinew::identify
