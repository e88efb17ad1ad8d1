#include "components/robot/provider/participant/awaited_topics.h"

#include <atomic>
#include <memory>
#include <utility>

#include "components/base/config/config.h"
#include "components/topics/node/codec.h"
#include "components/topics/node/topics.h"

namespace sinew::provider {

namespace {

// Answers of a topic whose messages the provider does not read itself.
std::function<std::uint64_t()> CountAnswers(const std::string& topic, std::uint64_t session_id,
                                            node::Node& node) {
  auto answered = std::make_shared<std::atomic<std::uint64_t>>(0);
  node.ReadRaw(*node::FindTopic(topic), [answered, session_id](node::RawSample&& sample) {
    node::HeadOfMessage head;
    if (!node::PeekHead(sample.payload.data(), sample.payload.size(), &head)) return;
    if (head.session_id == session_id) answered->store(head.tick + 1);
  });
  return [answered] { return answered->load(); };
}

}  // namespace

std::vector<AwaitedTopic> MakeAwaitedTopics(const std::vector<std::string>& await, node::Node& node,
                                            const ProviderCycle& cycle, CommandReaders& readers) {
  std::vector<AwaitedTopic> topics;
  for (const std::string& text : await) {
    AwaitedTopic topic = ParseAwaited(text);
    if (topic.topic == node::kJointCommand.name) {
      topic.answers = [&cycle] { return cycle.joint_answers(); };
      topic.wait = [&readers](auto timeout) { readers.WaitForJointCommand(timeout); };
    } else if (topic.topic == node::kValveCommand.name) {
      topic.answers = [&cycle] { return cycle.valve_answers(); };
      topic.wait = [&readers](auto timeout) { readers.WaitForValveCommand(timeout); };
    } else if (topic.topic == node::kSimPressure.name) {
      if (!readers.simulated()) {
        throw UsageError("--await: hardware reads no sim_pressure, expected a simulated robot");
      }
      topic.answers = [&readers] { return readers.pressure_answers(); };
      topic.wait = [&readers](auto timeout) { readers.WaitForPressure(timeout); };
    } else if (topic.topic == node::kSimBodyDisturbance.name) {
      if (!readers.has_body()) {
        throw UsageError("--await: a robot on a fixed base reads no sim_body_disturbance");
      }
      topic.answers = [&readers] { return readers.body_disturbance_answers(); };
      topic.wait = [&readers](auto timeout) { readers.WaitForBodyDisturbance(timeout); };
    } else {
      topic.answers = CountAnswers(topic.topic, cycle.session_id(), node);
      topic.wait = [&node](auto timeout) { node.WaitForData(timeout); };
    }
    topics.push_back(std::move(topic));
  }
  return topics;
}

}  // namespace sinew::provider
