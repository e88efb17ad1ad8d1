// The checks of a program in real time, in their order.
#include "components/base/config/config.h"
#include "tools/conform/real_time_run.h"

namespace sinew::conform {

namespace {

using std::chrono::milliseconds;

// Participants announce themselves at once and answer a newcomer at once: this is for a busy
// machine.
constexpr milliseconds kLookForOthers(300);

// It would be driven by a robot that is only played.
void RefuseUsedDomain(Stage& stage) {
  if (!stage.WaitUntil([&stage] { return !stage.Strangers().empty(); }, kLookForOthers)) return;
  throw UsageError("domain " + std::to_string(stage.options().domain_id) + " is in use by '" +
                   stage.Strangers().front() + "', expected one where nobody is; see --domain");
}

}  // namespace

const std::vector<RealTimePart>& RealTimeParts() {
  static const std::vector<RealTimePart> kParts = {
      {{"start", "kind", "idl_hash"}, &CheckStart},
      {{"joins_below", "handover"}, &CheckOwnership},
      {{"writes_its_topics", "types", "no_other_topics", "qos"}, &CheckTypes},
      {{"answers_every_tick", "tick_and_session", "answers_within_a_cycle"}, &CheckTicks},
      {{"joint_count", "finite", "no_torque_unarmed", "estop", "finite_from_broken_inputs"},
       &CheckJointCommands},
      {{"goes_on_without_inputs", "marks_lost_inputs", "recovers", "refuses_other_sessions"},
       &CheckLostInputs},
      {{"origin"}, &CheckOrigins},
      {{"new_session"}, &CheckSessions},
      {{"malformed_goes_on", "malformed_counted"}, &CheckMalformed},
      {{"sigterm"}, &CheckSigterm}};
  return kParts;
}

void CheckRealTime(const Options& options, const Role& role, Report* report) {
  const std::string name = "conform_subject";
  Stage stage(role, {.domain_id = options.domain_id,
                     .mode = node::TimeMode::kRealtime,
                     .rate_Hz = options.rate_Hz,
                     .subject = name});
  RefuseUsedDomain(stage);
  bool owner = false;
  for (const RealTimePart& part : RealTimeParts()) {
    owner = owner || (part.run == &CheckOwnership && part.IsWanted(options));
  }
  if (owner) stage.PlayOwner();
  launch::Program program(SubjectCommandLine(options, name, node::TimeMode::kRealtime));
  RealTimeRun run{options, role, stage, program, *report};
  CheckStart(run);
  if (!stage.status()) return;  // nothing more can be seen of it
  for (const RealTimePart& part : RealTimeParts()) {
    if (part.run == &CheckStart || !part.IsWanted(options)) continue;
    part.run(run);
    if (part.run == &CheckOwnership) stage.EndOwner();  // from here on the program is heard
  }
}

}  // namespace sinew::conform
