#include "bridge/virtual_axes/participant/simulation_topics.h"

#include <algorithm>

#include "components/base/types/clock/clock.h"
#include "components/robot/provider/participant/simulation_messages.h"

namespace sinew::virtual_axes {

namespace {

constexpr std::int64_t kSilence_ns = 100'000'000;

}  // namespace

SimulationTopics::SimulationTopics(const node::Options& node_options,
                                   const SimulationTopicsOptions& options,
                                   provider::SimulatedPlant& plant)
    : plant_(plant), node_(node_options), states_(node_.MakeReader(node::kJointState)) {
  const bool floats = plant.body_truth() != nullptr;
  if (options.hand) {
    disturbance_.emplace(node_.MakeReader(node::kSimDisturbance));
    if (floats) body_disturbance_.emplace(node_.MakeReader(node::kSimBodyDisturbance));
  }
  if (options.truth) {
    truth_.emplace(node_.MakeWriter(node::kSimTruth));
    if (floats) body_truth_.emplace(node_.MakeWriter(node::kSimBodyTruth));
  }
}

void SimulationTopics::Exchange(VirtualAxes& axes, std::int64_t now_ns) {
  const auto state = states_.TakeLatest();
  if (state) {
    const types::MessageHeader header = state->header;
    running_ = {header.session_id, header.origin};
  }
  if (disturbance_) PushLinks(axes, now_ns);
  if (body_disturbance_) PushBody(now_ns);
  if (state && truth_) WriteTruth(state->header);
}

void SimulationTopics::PushLinks(VirtualAxes& axes, std::int64_t now_ns) {
  const auto said = disturbance_->TakeLatest();
  if (said && gate_.Admits(types::CommandKind::kRequest, said->header, running_)) {
    pushed_ns_ = now_ns;
    for (int j = 0; j < std::min<int>(plant_.joint_count(), said->joint_count); ++j) {
      axes.SetHand(j, said->load_force_N[static_cast<std::size_t>(j)]);
    }
  } else if (now_ns - pushed_ns_ > kSilence_ns) {
    for (int j = 0; j < plant_.joint_count(); ++j) axes.SetHand(j, 0.0);
  }
}

void SimulationTopics::PushBody(std::int64_t now_ns) {
  while (const auto said = body_disturbance_->TakeNext()) {
    if (!body_gate_.Admits(types::CommandKind::kRequest, said->header, running_)) {
      continue;
    }
    const provider::BodyDisturbance disturbance = provider::FromMessage(*said);
    if (!provider::IsPossible(disturbance)) {
      body_gate_.Refuse("a value that is not finite, or a mass below 0");
      continue;
    }
    body_pushed_ns_ = now_ns;
    plant_.DisturbBody(disturbance);
  }
  if (body_pushed_ns_ != 0 && now_ns - body_pushed_ns_ > kSilence_ns) {
    body_pushed_ns_ = 0;
    plant_.DisturbBody({});
  }
}

void SimulationTopics::WriteTruth(const msg::Header& of_state) {
  msg::Header header = of_state;
  header.stamp_ns = types::EpochNow_ns();
  header.origin = msg::Origin::kSim;
  Count(truth_->Write(provider::ToMessage(header, plant_.joint_count(), plant_.gear_truth())));
  if (body_truth_) Count(body_truth_->Write(provider::ToMessage(header, *plant_.body_truth())));
}

}  // namespace sinew::virtual_axes
