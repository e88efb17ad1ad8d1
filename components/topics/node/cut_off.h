// The time that a cycle of a participant waits for its inputs in real time, by the kind of
// participant: a share of the nominal period, from the moment when its trigger is taken.
//
// One chain ends in a tick: the state provider publishes, reference and regime answer, esn waits
// for them, control for all three, and the provider waits for control's command until half of the
// period (run_provider.cc, PassRealTime) before it commands the motors. So that a participant that
// is gone costs the robot that input and not the command, each gives up before those that wait
// for it:
//
//   share of the period   0.2                0.3   0.4        0.5
//                         reference, regime  esn   control    provider
//
// The step of 0.1 is for computing and sending the answer: 200 us at 500 Hz, 420 us at 240 Hz.
// Measured: a step of the largest network takes 6 us and a controller's less. A message from
// process to process under SCHED_FIFO, Fast DDS alone (bench/chain, H), on a virtual machine with
// two cores: 180 us at the median and 0.8 ms at 99.9 %, and within one core 27 us and 0.15 ms. So a
// machine like that keeps to the steps at 240 Hz at the median, and not at 99.9 % or at 500 Hz. At
// 240 Hz control gives up after 1.7 ms. rls answers for the next tick and is the only one that
// waits for control and the provider's part: 0.7, which leaves it 1.2 ms at 240 Hz.
#pragma once

#include <string_view>
#include <vector>

namespace sinew::node {

struct CutOffRule {
  std::string_view component;
  double share;  // of the nominal period
  std::string_view waits_for;
};

// The last rule, without a name, is for kinds that are not in the table: another controller.
const std::vector<CutOffRule>& CutOffRules();
const CutOffRule& CutOffOf(std::string_view component);

// Share of the period after which a state provider no longer waits for the command of its tick.
inline constexpr double kProviderCutOff = 0.5;

}  // namespace sinew::node
