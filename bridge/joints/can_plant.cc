#include "bridge/joints/can_plant.h"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "components/base/types/signal.h"
#include "components/base/types/text.h"

namespace sinew::bridge {
namespace {

constexpr std::int64_t kStartRequest_ns = 20'000'000;  // between requests at the start
constexpr int kMostBatches = 64;                       // taken from a bus at once
constexpr std::int64_t kListen_ns = 250'000'000;       // longer than any period of a bridge

const BridgeConfig& Checked(const BridgeConfig& config, std::size_t buses) {
  CheckBridgeConfig(config);
  if (config.bitrate_bit_s.size() != buses) {
    throw std::invalid_argument("a bit rate for each bus is expected");
  }
  return config;
}

}  // namespace

CanPlant::CanPlant(const BridgeConfig& config, std::vector<can::Transport*> transports)
    : config_(Checked(config, transports.size())),
      transports_(std::move(transports)),
      outbox_(transports_.size()),
      references_(config_.gateways.size()),
      nodes_(transports_.size()),
      statistics_(config_.bitrate_bit_s) {
  const auto own = [this](int bus, int node, Owner owner, std::size_t index) {
    nodes_[static_cast<std::size_t>(bus)][static_cast<std::size_t>(node)] = {owner, index};
  };
  for (const GatewayConfig& g : config_.gateways) links_.emplace_back(g.node);
  std::vector<std::unique_ptr<JointExchange>> exchanges(config_.joints.size());
  for (std::size_t i = 0; i < links_.size(); ++i) {
    const GatewayConfig& g = config_.gateways[i];
    own(g.bus, g.node, Owner::kGateway, i);
    for (std::size_t field = 0; field < g.joints.size(); ++field) {
      const auto j = static_cast<std::size_t>(g.joints[field]);
      exchanges[j] = std::make_unique<GatewayExchange>(
          config_.joints[j], config_.short_frames, &outbox_, &links_[i], static_cast<int>(field));
    }
  }
  std::vector<int> on_bus(transports_.size(), 0);
  for (std::size_t j = 0; j < config_.joints.size(); ++j) {
    const JointConfig& c = config_.joints[j];
    own(c.bus, c.node, Owner::kAxis, j);
    if (c.output) own(c.bus, c.output->node, Owner::kSensorNode, j);
    if (!exchanges[j]) {
      exchanges[j] = std::make_unique<DirectExchange>(c, config_.short_frames, &outbox_);
    }
    joints_.emplace_back(c, config_.timing, std::move(exchanges[j]), &outbox_);
    turns_.push_back(on_bus[static_cast<std::size_t>(c.bus)]++);
  }
  for (std::size_t i = 0; i < config_.body_nodes.size(); ++i) {
    const BodyNodeConfig& c = config_.body_nodes[i];
    own(c.bus, c.node, Owner::kBodyNode, i);
    body_nodes_.emplace_back(c, config_.timing);
  }
  has_body_ = !body_nodes_.empty() || (!links_.empty() && (config_.gateways.front().carries_feet ||
                                                           config_.gateways.front().carries_imu));
}

std::uint32_t CanPlant::measured_flags() const {
  const bool all_outputs = std::all_of(joints_.begin(), joints_.end(), [](const CanJoint& j) {
    return j.config().output.has_value();
  });
  return types::kMotorSignals | types::SignalBit(types::Signal::kPayload) |
         (all_outputs ? types::kOutputSignals : 0u);
}

void CanPlant::Reset(provider::PlantSensors* sensors) {
  *sensors = provider::PlantSensors{};
  Drain();  // what waited in the sockets since they were opened is old
  if (!commands_) ListenForMaster();
  commands_ = true;
  for (CanJoint& joint : joints_) joint.Reset();
  for (BodyMeasurement& node : body_nodes_) node.Reset(now_ns());
  body_ = {};
  Flush();
  AwaitAllNodes();
  ClearFault();
  const std::int64_t start_ns = now_ns();
  for (CanJoint& joint : joints_) joint.Start(start_ns);
  Fill(sensors);
  statistics_.Start(start_ns);
}

void CanPlant::ListenForMaster() {
  for (CanJoint& joint : joints_) joint.Forget();
  const std::int64_t end_ns = now_ns() + kListen_ns;
  can::Received received;
  while (now_ns() < end_ns) {
    if (transports_.front()->Receive(std::chrono::milliseconds(2), &received)) Take(0, received);
    Drain();
    for (const CanJoint& joint : joints_) {
      if (joint.fault().cause() == types::FaultCause::kAnotherMaster) {
        throw std::runtime_error(joint.fault().text());
      }
    }
  }
}

void CanPlant::AwaitAllNodes() {
  can::Transport& clock = *transports_.front();
  const std::int64_t give_up_ns = now_ns() + ToNs(config_.timing.start_timeout_s);
  std::int64_t next_request_ns = 0;
  for (;;) {
    Drain();
    const auto silent = std::find_if(joints_.begin(), joints_.end(), [](const CanJoint& j) {
      return !j.measured().Missing().empty();
    });
    if (silent == joints_.end()) return;
    const std::int64_t now = now_ns();
    if (now >= give_up_ns) {
      throw std::runtime_error(
          "joint '" + silent->config().name + "': " + silent->measured().Missing() +
          types::Text(" within %.1f s; is it powered, on bus '%s' (%s), at %.0f bit/s?",
                      config_.timing.start_timeout_s, bus_of(*silent).name().c_str(),
                      can::LinkName(bus_of(*silent).link()),
                      config_.bitrate_bit_s[static_cast<std::size_t>(silent->config().bus)]));
    }
    if (now >= next_request_ns) {
      next_request_ns = now + kStartRequest_ns;
      for (CanJoint& joint : joints_) {
        joint.SendNeutral();  // feeds watchdogs
        if (joint.is_polled()) joint.RequestEstimates(now_ns());
      }
      PostReferences();
      Flush();
    }
    can::Received received;
    if (clock.Receive(std::chrono::milliseconds(2), &received)) Take(0, received);
  }
}

std::int64_t CanPlant::idle_reported_ns() const {
  std::int64_t oldest_ns = joints_.front().idle_reported_ns();
  for (const CanJoint& joint : joints_) {
    oldest_ns = std::min(oldest_ns, joint.idle_reported_ns());
  }
  return oldest_ns;
}

void CanPlant::ClearFault() {
  const std::int64_t now = now_ns();
  for (CanJoint& joint : joints_) joint.ClearFault(now);
  Flush();
}

void CanPlant::ShutDown() noexcept {
  if (!commands_) return;
  const std::int64_t now = now_ns();
  for (CanJoint& joint : joints_) joint.ShutDown(now);
  PostReferences();
  Flush();
}

void CanPlant::Act(const provider::PlantCommand& command, double period_s) {
  acted_ = true;
  const std::int64_t start_ns = now_ns();
  // Phases and limits are decided by the newest frames; an axis that has just reported an error
  // gets no setpoint.
  Drain();
  AssessJoints();
  // Cyclic estimates: the answer is there by the end of the cycle. Requested ones: Step asks.
  const bool cyclic = config_.timing.estimates == Estimates::kCyclic;
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    joints_[j].Command(CommandOf(command, j), period_s, start_ns);
    if (cyclic && AsksIq(j)) joints_[j].RequestIq(now_ns());
    joints_[j].SendValves(CommandOf(command, j));
  }
  PostReferences();
  Flush();
  acted_us_ = 1e-3 * static_cast<double>(now_ns() - start_ns);
}

void CanPlant::Step(const provider::PlantCommand& command, double period_s,
                    provider::PlantSensors* sensors) {
  if (!acted_) Act(command, period_s);
  acted_ = false;
  if (config_.timing.estimates == Estimates::kRequested) {
    const std::int64_t asked_ns = now_ns();
    for (std::size_t j = 0; j < joints_.size(); ++j) {
      if (joints_[j].is_polled()) joints_[j].RequestEstimates(now_ns());
      if (AsksIq(j)) joints_[j].RequestIq(now_ns());
    }
    Flush();
    AwaitAnswers(asked_ns);
  }
  const std::int64_t start_ns = now_ns();
  Drain();
  AssessJoints();
  Flush();
  Fill(sensors);
  ++cycle_;
  UpdateStatistics(start_ns);
}

// --- receiving

void CanPlant::Drain() {
  std::array<can::Received, can::kFramesAtOnce> waiting;
  for (std::size_t b = 0; b < transports_.size(); ++b) {
    // Bounded: a flooded bus must not keep the cycle.
    for (int i = 0; i < kMostBatches; ++i) {
      const std::size_t count = transports_[b]->TakeWaiting(waiting);
      for (std::size_t k = 0; k < count; ++k) Take(static_cast<int>(b), waiting[k]);
      if (count < waiting.size()) break;
    }
  }
}

void CanPlant::Take(int bus, const can::Received& received) {
  const auto address = can::AddressOf(received.frame);
  if (!address || received.frame.remote) return;
  const Node& node = nodes_[static_cast<std::size_t>(bus)][static_cast<std::size_t>(address->node)];
  CanJoint::News news;
  switch (node.owner) {
    case Owner::kAxis:
      news = joints_[node.index].TakeFromAxis(received);
      break;
    case Owner::kSensorNode:
      news = joints_[node.index].TakeFromNode(received);
      break;
    case Owner::kGateway:
      TakeFromGateway(node.index, received);
      break;
    case Owner::kBodyNode:
      news.malformed = body_nodes_[node.index].Take(received) == BodyMeasurement::Taken::kMalformed;
      break;
    case Owner::kNobody:
      break;
  }
  if (news.malformed) ++malformed_;
  if (news.answer_us) statistics_.AddAnswer(bus, *news.answer_us);
}

void CanPlant::TakeFromGateway(std::size_t gateway, const can::Received& received) {
  CompactLink& link = links_[gateway];
  can::CompactReferences references;
  if (can::DecodeReferences(config_.gateways[gateway].node, received.frame, &references)) {
    for (const int j : config_.gateways[gateway].joints) {
      joints_[static_cast<std::size_t>(j)].HearMaster();
    }
    return;
  }
  const CompactLink::Taken taken = link.Take(received);
  if (taken == CompactLink::Taken::kRefused) ++malformed_;
  if (taken != CompactLink::Taken::kComplete) return;
  const GatewayConfig& config = config_.gateways[gateway];
  if (const auto answer_us = references_[gateway].Stop(received.stamp_ns)) {
    statistics_.AddAnswer(config.bus, *answer_us);
  }
  const can::CompactState& state = link.state();
  for (std::size_t field = 0; field < config.joints.size(); ++field) {
    joints_[static_cast<std::size_t>(config.joints[field])].TakeFromGateway(
        {state.position_turns[field], state.velocity_turns_s[field]}, state.iq_A[field],
        link.stamp_ns());
  }
}

bool CanPlant::AllAnswered(std::int64_t cycle_start_ns) const {
  for (std::size_t j = 0; j < joints_.size(); ++j) {
    const JointMeasurement& measured = joints_[j].measured();
    if (!joints_[j].is_polled()) continue;
    if (measured.estimates_ns < cycle_start_ns) return false;
    if (AsksIq(j) && measured.iq_ns < cycle_start_ns) return false;
  }
  return true;
}

void CanPlant::AwaitAnswers(std::int64_t cycle_start_ns) {
  can::Transport& clock = *transports_.front();
  const std::int64_t give_up_ns = cycle_start_ns + ToNs(config_.timing.answer_window_s);
  can::Received received;
  for (;;) {
    Drain();
    const std::int64_t left_ns = give_up_ns - now_ns();
    if (left_ns <= 0 || AllAnswered(cycle_start_ns)) return;
    if (transports_.size() == 1 || clock.descriptor() < 0) {
      if (clock.Receive(std::chrono::nanoseconds(left_ns), &received)) Take(0, received);
    } else {
      can::WaitForAny(transports_, std::chrono::nanoseconds(left_ns));
    }
  }
}

// --- assessing and sending

void CanPlant::AssessJoints() {
  const std::int64_t now = now_ns();
  for (CanJoint& joint : joints_) joint.Assess(now, bus_of(joint));
}

// In turn: the answers of all in one cycle would be more than its share of the bus.
bool CanPlant::AsksIq(std::size_t joint) const {
  const auto every = static_cast<std::uint64_t>(config_.timing.iq_every_cycles);
  return joints_[joint].is_polled() && every > 0 &&
         (cycle_ + static_cast<std::uint64_t>(turns_[joint])) % every == 0;
}

void CanPlant::PostReferences() {
  for (std::size_t g = 0; g < links_.size(); ++g) {
    for (const can::Frame& frame : links_[g].References()) {
      outbox_.Post(config_.gateways[g].bus, frame);
    }
    references_[g].Start(now_ns());
  }
}

// --- sensors

void CanPlant::Fill(provider::PlantSensors* sensors) {
  const std::int64_t now = now_ns();
  for (std::size_t j = 0; j < joints_.size(); ++j) joints_[j].Fill(j, now, sensors);
  FillBody(now);
  const auto first = std::find_if(joints_.begin(), joints_.end(),
                                  [](const CanJoint& joint) { return joint.fault().active(); });
  if (first == joints_.end()) {
    sensors->message.clear();
  } else if (sensors->message != first->fault().text()) {
    sensors->message = first->fault().text();
  }
}

void CanPlant::FillBody(std::int64_t now_ns) {
  if (!links_.empty()) FillBodyFromGateway(now_ns);
  for (BodyMeasurement& node : body_nodes_) node.Fill(now_ns, &body_);
}

void CanPlant::FillBodyFromGateway(std::int64_t now_ns) {
  const GatewayConfig& gateway = config_.gateways.front();
  const CompactLink& link = links_.front();
  const can::CompactState& state = link.state();
  const bool fresh =
      link.stamp_ns() != 0 && now_ns - link.stamp_ns() <= ToNs(config_.timing.estimate_timeout_s);
  if (gateway.carries_feet) {
    body_.foot_force_N = state.force_N;
    body_.foot_valid.fill(fresh);
  }
  if (gateway.carries_imu) {
    body_.acceleration_m_s2 = state.acceleration_m_s2;
    body_.angular_velocity_rad_s = state.angular_velocity_rad_s;
    body_.orientation_wxyz = QuaternionOf(state.roll_pitch_yaw_rad);
    body_.imu_valid = fresh;
  }
}

void CanPlant::UpdateStatistics(std::int64_t start_ns) {
  std::array<BusSample, provider::BusReport::kMaxBuses> samples;
  for (std::size_t b = 0; b < transports_.size(); ++b) {
    samples[b] = {transports_[b]->link(), transports_[b]->counters()};
  }
  for (const BodyMeasurement& node : body_nodes_) {
    BodyCounts& counts = samples[static_cast<std::size_t>(node.config().bus)].body;
    counts.samples_missed += node.counts().samples_missed;
    counts.lost += node.counts().lost;
  }
  const std::int64_t end_ns = now_ns();
  statistics_.Update(std::span(samples).first(transports_.size()),
                     acted_us_ + 1e-3 * static_cast<double>(end_ns - start_ns), end_ns);
}

}  // namespace sinew::bridge
