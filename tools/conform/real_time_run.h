// The program under test in real time, while the checks of check_start.cc, check_ticks.cc,
// check_inputs.cc and check_commands.cc look at it in turn.
#pragma once

#include <chrono>
#include <functional>
#include <string>
#include <vector>

#include "tools/conform/checks.h"
#include "tools/conform/report.h"
#include "tools/conform/role.h"
#include "tools/conform/stage.h"
#include "tools/launch/program.h"

namespace sinew::conform {

struct RealTimeRun {
  const Options& options;
  const Role& role;
  Stage& stage;
  launch::Program& program;
  Report& report;

  Moment Disarmed() const { return {.joints = options.joints}; }
  Moment Armed() const {
    return {.joints = options.joints, .robot_state = msg::RobotState::kArmed};
  }
};

using RealTimePart = Part<RealTimeRun&>;
// In the order in which they are made.
const std::vector<RealTimePart>& RealTimeParts();

void CheckStart(RealTimeRun& run);
void CheckOwnership(RealTimeRun& run);
void CheckTypes(RealTimeRun& run);
void CheckTicks(RealTimeRun& run);
void CheckJointCommands(RealTimeRun& run);
void CheckLostInputs(RealTimeRun& run);
void CheckOrigins(RealTimeRun& run);
void CheckSessions(RealTimeRun& run);
void CheckMalformed(RealTimeRun& run);
void CheckSigterm(RealTimeRun& run);

// Plays windows of ticks like the moment until one is good, those of kWindows at most; gives the
// last one.
Window PlayWindows(RealTimeRun& run, const Moment& like,
                   const std::function<bool(const Window&)>& is_good);
// "joint_command 30, readout 12 of 30"
std::string AnsweredText(const Role& role, const Window& window);
// Every topic that the role must write answered most of the ticks.
bool AnsweredMost(const Role& role, const Window& window);
// Outputs of the window for which the condition holds, as a share; 0 without outputs.
double ShareOf(const std::vector<const Output*>& outputs, bool (*condition)(const Facts&));
std::string Percent(double share);
// The end of a program, in words.
std::string EndText(int exit_code, std::chrono::milliseconds limit = kEnd);
// The last line of its output.
std::string LastLine(const launch::Program& program);

}  // namespace sinew::conform
