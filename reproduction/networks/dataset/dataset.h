// The three regression tasks as sequences: which column is what, which samples train.
//
// sea (5.1.2), inside the backlash. Set: from the first push (force above 1 N) until the link no
//     longer comes back. Inputs (3): play angle motor / N - output, its velocity, chamber pressure.
//     Target: torque of the load T = F l (5.3), Nm. Gravity is neither in the inputs nor in the
//     target: it is a known torque that whoever uses the network adds.
// pea (5.1.3), outside. Inputs (6): link position, link velocity, chamber pressure, load force,
//     acceleration (of the motor / N, which moves as one with the link here and has the finer
//     encoder; smoothed without phase), motor velocity. Target: motor torque, Nm at the shaft,
//     from the measured current. So neither the current nor a multiple of it is an input. The
//     linear block reads three: acceleration, link velocity, load force, the linear part of (4.12)
//     solved for the motor torque.
// force: a cylinder. Inputs (3): position, velocity (of the position, smoothed without phase),
//     pressure. Target: force, N.
//
// Split: ten consecutive blocks of each recording (one split for all tasks; the source describes it
// for sea and gives none for pea), each starts with its share of training samples, the rest tests.
// Pure; throws std::invalid_argument naming the signal that is missing.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "components/base/types/run.h"
#include "components/learn/esn/training.h"

namespace sinew::networks {

enum class Task { kSea, kPea, kForce };

struct TaskInfo {
  std::string_view name;  // "sea"
  std::vector<std::string_view> inputs;
  std::string_view target;
  std::string_view unit;
  std::vector<int> linear;  // inputs of the linear block
};
const TaskInfo& InfoOf(Task task);

struct TableConfig {
  Task task = Task::kSea;
  double period_s = 1.0 / 80.0;  // of a sample
  double gear_ratio = 100.0;
  double link_length_m = 0.3;
  double torque_constant_Nm_A = 60.0 / (2.0 * 3.14159265358979323846 * 600.0);  // (3.1)
  double smoothing_Hz = 8.0;  // cut-off of the zero-phase filter before differentiation
  int blocks = 10;
  double train_share = 0.7;
  bool whole_sea_set = false;  // keep what comes after the link no longer comes back
};

std::vector<esn::Sequence> MakeTable(const std::vector<types::Run>& runs,
                                     const TableConfig& config);

}  // namespace sinew::networks
