// Builders that CloseLoop (close_loop.h) is made of, one for each kind of robot. They throw
// std::invalid_argument and UsageError.
#pragma once

#include <functional>
#include <vector>

#include "components/bodies/links/bodies.h"
#include "components/model/close_loop/close_loop.h"
#include "components/model/close_loop/input.h"
#include "components/model/trace/rotation.h"

namespace sinew::close_loop {

// One joint on recordings that are read already.
struct JointTask {
  int joint = 0;
  std::vector<types::Run> train, held_out;  // held_out empty: each of `train` is held out once
  // Result of the data gate, on recordings without the rows that it left out; empty: it is asked.
  std::optional<gate::GateReport> gate{};
  int searches = 1;  // joints that are traced together (trace::TraceOptions)
  std::function<double(const actuator::JointModel&)> held_out_error{};  // the same
  std::vector<trace::Fold> folds{};  // of an arm's joint without held-out recordings
  std::function<void(double)> progress{};
};

// Adds the joint's report to the result, and where it was assessed the corrected joint to its
// model. The page has its pictures.
report::Page TraceJoint(const Options& options, const Input& input, JointTask task, Result* out);

// All joints that the options name, or that one; an arm's rigid bodies with them.
void TraceJoints(const Options& options, Input input, Result* out);
void ReportRobot(std::vector<report::Page> pages, Result* out);

void FitStanding(const Options& options, const Input& input, Result* out);

// Bodies of the robot with its payloads. Throws UsageError where there is no URDF.
arm::Chain BodiesOf(const Options& options, const Input& input);

// Takes out the rows that the gate left out of the recordings, train in front of held_out.
void LeaveOutRows(const std::vector<gate::LeftOut>& left_out, std::vector<types::Run>* train,
                  std::vector<types::Run>* held_out);
std::vector<types::Run> Together(const std::vector<types::Run>& train,
                                 const std::vector<types::Run>& held_out);

// Can these recordings be held out in turn? Throws UsageError.
void RequireRotation(const Options& options, const std::vector<types::Run>& runs);

// Entries of one time and source, for the history of a joint.
struct History {
  std::string when, from;
  void Add(const std::string& effect, const std::string& note, actuator::JointModel* joint) const;
};

}  // namespace sinew::close_loop
