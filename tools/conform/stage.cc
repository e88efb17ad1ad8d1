#include "tools/conform/stage.h"

#include <algorithm>
#include <set>
#include <stdexcept>
#include <utility>

#include "components/topics/node/ownership.h"

namespace sinew::conform {

namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr milliseconds kLockstepAnswer(2000);  // a tick's answers; a healthy program takes 1 ms
constexpr milliseconds kLastAnswer(50);        // after a window of real time, for what is under way
constexpr milliseconds kOwnerSettles =
    5 * node::internal::kSettleTime;  // of the owner that is played

node::Options StageNodeOptions(const StageOptions& options) {
  node::Options node;
  node.component = node.name = "conform";
  node.domain_id = options.domain_id;
  node.mode = options.mode;
  return node;
}

}  // namespace

std::vector<const Output*> Window::Of(const std::string& topic) const {
  std::vector<const Output*> found;
  const auto at = outputs.find(topic);
  if (at == outputs.end()) return found;
  for (const Output& output : at->second) {
    if (!output.facts || output.facts->session_id != session_id) continue;
    const std::uint64_t tick = output.facts->tick;
    if (tick >= first_tick && tick - first_tick < static_cast<std::uint64_t>(ticks)) {
      found.push_back(&output);
    }
  }
  return found;
}

int Window::Answered(const std::string& topic) const {
  std::set<std::uint64_t> answered;
  for (const Output* output : Of(topic)) answered.insert(output->facts->tick);
  return static_cast<int>(answered.size());
}

Stage::Stage(const Role& role, StageOptions options)
    : role_(role),
      options_(std::move(options)),
      node_(StageNodeOptions(options_)),
      statuses_(node_.MakeReader(node::kComponentStatus)),
      operator_(node_.MakeWriter(node::kOperatorCommand)),
      rate_Hz_(options_.rate_Hz) {
  for (const std::string_view name : PlayedTopics()) {
    if (role_.Writes(name)) continue;
    writers_.emplace(name, node_.MakeRawWriter(*node::FindTopic(name)));
  }
  for (const node::TopicInfo& topic : role_.must_write) Read(topic);
  for (const node::TopicInfo& topic : role_.may_write) Read(topic);
}

void Stage::Read(const node::TopicInfo& topic) {
  node_.ReadRaw(topic, [this](node::RawSample&& sample) { OnSample(std::move(sample)); });
}

void Stage::OnSample(node::RawSample&& sample) {
  const std::lock_guard<std::mutex> lock(mutex_);
  heard_.push_back({std::move(sample.topic), std::move(sample.payload), StageClock::now()});
}

void Stage::PlayOwner() {
  for (const node::TopicInfo& topic : role_.must_write) {
    if (!node::IsExclusive(topic.profile)) continue;
    owners_.emplace(topic.name, node_.MakeRawWriter(topic));
  }
  const auto settled = [this] {
    return std::all_of(owners_.begin(), owners_.end(), [](const auto& owner) {
      return owner.second.strength() > node::internal::kJoiningStrength;
    });
  };
  if (!WaitUntil(settled, kOwnerSettles)) {
    throw std::runtime_error("the owner that is played has not settled");
  }
}

std::uint32_t Stage::OwnerStrength(std::string_view topic) const {
  const auto owner = owners_.find(std::string(topic));
  return owner == owners_.end() ? 0 : owner->second.strength();
}

void Stage::EndOwner() { owners_.clear(); }

void Stage::SetRate(double rate_Hz) {
  rate_Hz_ = rate_Hz;
  node_.SetPeriod(std::chrono::duration_cast<std::chrono::nanoseconds>(
      std::chrono::duration<double>(1.0 / rate_Hz)));
}

void Stage::StartSession(std::uint64_t session_id) {
  session_id_ = session_id;
  next_tick_ = 0;
  sent_.clear();
}

void Stage::PublishTick(const Moment& like) {
  Moment moment = like;
  moment.session_id = session_id_;
  moment.tick = next_tick_++;
  moment.period_s = 1.0 / rate_Hz_;
  moment.valve_open = valve_open_;
  for (const auto& [topic, write] : owners_) {
    const node::Bytes bytes = PlayedMessage(topic, moment);
    (void)write(bytes.data(), bytes.size());
  }
  for (const std::string_view name : PlayedTopics()) {
    const auto writer = writers_.find(std::string(name));
    if (writer == writers_.end() || name == moment.withheld) continue;
    const auto damaged = damaged_.find(writer->first);
    node::Bytes bytes = PlayedMessage(name, moment);
    if (damaged != damaged_.end()) bytes = damaged->second(bytes);
    if (name == node::kJointState.name) sent_[moment.tick] = StageClock::now();
    (void)writer->second(bytes.data(), bytes.size());
  }
  damaged_.clear();
  node_.SetCycle(session_id_, moment.tick, 0, msg::Origin::kSim);
}

void Stage::Collect(Window* window) {
  std::vector<Heard> heard;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    heard.swap(heard_);
  }
  for (Heard& sample : heard) {
    Output output;
    output.facts = ReadFacts(sample.topic, sample.payload);
    output.size = sample.payload.size();
    if (output.facts) {
      if (sample.topic == node::kValveCommand.name) valve_open_ = output.facts->valve_open;
      const auto sent = sent_.find(output.facts->tick);
      const bool asked = sent != sent_.end() && sent->second <= sample.at;
      output.early = output.facts->session_id == session_id_ && !asked;
      if (asked) {
        output.latency_s = std::chrono::duration<double>(sample.at - sent->second).count();
      }
    }
    window->outputs[sample.topic].push_back(std::move(output));
  }
}

bool Stage::AllAnswered(const Window& window, std::uint64_t tick) const {
  return std::all_of(
      role_.must_write.begin(), role_.must_write.end(), [&](const node::TopicInfo& topic) {
        const auto outputs = window.outputs.find(topic.name);
        if (outputs == window.outputs.end()) return false;
        return std::any_of(outputs->second.rbegin(), outputs->second.rend(),
                           [&](const Output& output) {
                             return output.facts && output.facts->session_id == session_id_ &&
                                    output.facts->tick == tick;
                           });
      });
}

Window Stage::Play(const Moment& like, int ticks) { return PlayTicks(like, ticks, kLastAnswer); }

Window Stage::PlayTicks(const Moment& like, int ticks, milliseconds last_answer) {
  Window window{.session_id = session_id_, .first_tick = next_tick_, .ticks = ticks, .outputs = {}};
  Window before;  // what was still under way
  Collect(&before);
  const auto period = std::chrono::duration_cast<StageClock::duration>(
      std::chrono::duration<double>(1.0 / rate_Hz_));
  for (int i = 0; i < ticks; ++i) {
    const std::uint64_t tick = next_tick_;
    const bool lockstep = options_.mode == node::TimeMode::kLockstep;
    if (!lockstep) {
      due_ = std::max(due_ + period, StageClock::now());  // no burst after a stall
      WaitUntil([] { return false; }, std::chrono::ceil<microseconds>(due_ - StageClock::now()));
    }
    PublishTick(like);
    const auto limit = lockstep ? kLockstepAnswer : i + 1 == ticks ? last_answer : milliseconds(0);
    const bool answered = WaitUntil(
        [&] {
          Collect(&window);
          return AllAnswered(window, tick);
        },
        limit);
    if (lockstep && !answered) break;
  }
  return window;
}

bool Stage::PlayUntil(const Moment& like, const std::function<bool()>& condition,
                      milliseconds limit) {
  const auto end = StageClock::now() + limit;
  while (!condition()) {
    if (StageClock::now() > end) return false;
    (void)PlayTicks(like, 1, milliseconds(0));
  }
  return true;
}

bool Stage::WaitUntil(const std::function<bool()>& condition, microseconds limit) {
  const auto end = StageClock::now() + limit;
  while (!condition()) {
    const auto left = std::chrono::duration_cast<microseconds>(end - StageClock::now());
    if (left.count() <= 0) return condition();
    node_.WaitForData(std::min<microseconds>(left, milliseconds(50)));
  }
  return true;
}

void Stage::Send(msg::OperatorAction action, const std::string& target) {
  msg::OperatorCommand command;
  command.header.session_id = session_id_;
  command.header.tick = next_tick_;
  command.header.origin = msg::Origin::kSim;
  command.action = action;
  command.reason = "conform";
  command.role = role_.name;
  command.target = target;
  (void)operator_.Write(command);
}

void Stage::Damage(const std::string& topic, Damaging damaging) {
  damaged_[topic] = std::move(damaging);
}

std::optional<msg::ComponentStatus> Stage::status() {
  while (auto status = statuses_.TakeNext()) {
    if (status->name == options_.subject) status_ = *status;
  }
  return status_;
}

std::vector<node::Endpoint> Stage::SubjectEndpoints() const {
  std::vector<node::Endpoint> endpoints = node_.Endpoints();
  std::erase_if(endpoints, [this](const node::Endpoint& endpoint) {
    return endpoint.participant != options_.subject;
  });
  return endpoints;
}

bool Stage::SubjectReads(std::string_view topic) const {
  const auto endpoints = SubjectEndpoints();
  return std::any_of(endpoints.begin(), endpoints.end(), [topic](const node::Endpoint& endpoint) {
    return !endpoint.is_writer && endpoint.topic == topic;
  });
}

bool Stage::SubjectWrites(std::string_view topic) const {
  const auto endpoints = SubjectEndpoints();
  return std::any_of(endpoints.begin(), endpoints.end(), [topic](const node::Endpoint& endpoint) {
    return endpoint.is_writer && endpoint.topic == topic;
  });
}

bool Stage::IsHeard(const std::string& topic) const {
  const int own = static_cast<int>(owners_.count(topic));
  return node_.RawMatchedWriters(topic) > own;
}

std::vector<std::string> Stage::Strangers() const {
  std::set<std::string> names;
  for (const node::Endpoint& endpoint : node_.Endpoints()) {
    if (endpoint.participant != options_.subject) names.insert(endpoint.participant);
  }
  return {names.begin(), names.end()};
}

}  // namespace sinew::conform
