// A relay with Fast DDS alone, none of Sinew's code: what the middleware costs by itself.
//
//   relay source --rate HZ --seconds S --out TOPIC:BYTES ... --in TOPIC    the provider's place
//   relay relay --in TOPIC ... --out TOPIC:BYTES ...                       a participant's place
//
// The source writes its topics at the rate, the last one last, and measures until the sample of its
// input that carries the same number is there. A relay answers in the listener of its last input
// with that sample's number. Payloads, QoS, transport and readers a topic are those of the
// participants that are compared.
#include <pthread.h>
#include <sched.h>
#include <signal.h>
#include <sys/mman.h>
#include <time.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/DataReaderListener.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TopicDataType.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>
#include <memory>
#include <string>
#include <vector>

namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

constexpr std::uint32_t kLargest = 65536;

struct Message {
  std::uint64_t number = 0;
  std::uint32_t size = 0;  // of the payload, which is filled with it
};

class Type final : public dds::TopicDataType {
 public:
  Type() {
    setName("relay_message");
    m_typeSize = kLargest;
    m_isGetKeyDefined = false;
    auto_fill_type_information(false);
    auto_fill_type_object(false);
  }
  bool serialize(void* data, rtps::SerializedPayload_t* payload) override {
    const Message& message = *static_cast<const Message*>(data);
    std::memset(payload->data, 0, message.size);
    std::memcpy(payload->data + 4, &message.number, sizeof message.number);
    payload->data[1] = 1;
    payload->length = message.size;
    payload->encapsulation = CDR_LE;
    return true;
  }
  bool deserialize(rtps::SerializedPayload_t* payload, void* data) override {
    Message& message = *static_cast<Message*>(data);
    std::memcpy(&message.number, payload->data + 4, sizeof message.number);
    message.size = payload->length;
    return true;
  }
  std::function<uint32_t()> getSerializedSizeProvider(void* data) override {
    return [data] { return static_cast<const Message*>(data)->size; };
  }
  void* createData() override { return new Message; }
  void deleteData(void* data) override { delete static_cast<Message*>(data); }
  bool getKey(void*, rtps::InstanceHandle_t*, bool) override { return false; }
};

struct Out {
  dds::DataWriter* writer;
  std::uint32_t size;
};

std::int64_t Now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1'000'000'000ll + now.tv_nsec;
}

std::atomic<bool> g_stop{false};
extern "C" void OnSignal(int) { g_stop = true; }

class Participant {
 public:
  explicit Participant(int domain) {
    auto* factory = dds::DomainParticipantFactory::get_instance();
    participant_ = factory->create_participant(static_cast<std::uint32_t>(domain),
                                               dds::PARTICIPANT_QOS_DEFAULT);
    type_.register_type(participant_);
    publisher_ = participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT);
    subscriber_ = participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT);
  }
  ~Participant() {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  Out MakeWriter(const std::string& text) {
    const std::size_t colon = text.find(':');
    dds::DataWriterQos qos;
    qos.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
    qos.reliability().max_blocking_time = {0, 1'000'000};
    qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
    qos.history().depth = 1;
    qos.data_sharing().off();
    qos.endpoint().history_memory_policy = rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
    return {publisher_->create_datawriter(Topic(text.substr(0, colon)), qos),
            static_cast<std::uint32_t>(std::stoul(text.substr(colon + 1)))};
  }
  dds::DataReader* MakeReader(const std::string& name, dds::DataReaderListener* listener) {
    dds::DataReaderQos qos;
    qos.reliability().kind = dds::BEST_EFFORT_RELIABILITY_QOS;
    qos.durability().kind = dds::VOLATILE_DURABILITY_QOS;
    qos.history().depth = 1;
    qos.data_sharing().off();
    qos.endpoint().history_memory_policy = rtps::DYNAMIC_REUSABLE_MEMORY_MODE;
    return subscriber_->create_datareader(Topic(name), qos, listener,
                                          dds::StatusMask::data_available());
  }

 private:
  dds::Topic* Topic(const std::string& name) {
    if (auto* found = participant_->lookup_topicdescription(name)) {
      return dynamic_cast<dds::Topic*>(found);
    }
    return participant_->create_topic(name, "relay_message", dds::TOPIC_QOS_DEFAULT);
  }
  dds::TypeSupport type_{new Type};
  dds::DomainParticipant* participant_ = nullptr;
  dds::Publisher* publisher_ = nullptr;
  dds::Subscriber* subscriber_ = nullptr;
};

// Reads and, where it has outputs, answers at once.
class Listener final : public dds::DataReaderListener {
 public:
  void on_data_available(dds::DataReader* reader) override {
    Message message;
    dds::SampleInfo info;
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (!info.valid_data) continue;
      for (const Out& out : outs) {
        Message answer{message.number, out.size};
        (void)out.writer->write(&answer);
      }
      arrived_ns = Now_ns();
      number = message.number;
    }
  }
  std::vector<Out> outs;
  std::atomic<std::int64_t> arrived_ns{0};
  std::atomic<std::uint64_t> number{0};
};

void SleepUntil(std::int64_t end_ns) {
  const timespec end{static_cast<time_t>(end_ns / 1'000'000'000),
                     static_cast<long>(end_ns % 1'000'000'000)};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &end, nullptr) == EINTR && !g_stop) {
  }
}

void RunSource(const std::vector<Out>& outs, const Listener& answer, double rate_Hz,
               double seconds) {
  const auto period_ns = static_cast<std::int64_t>(1e9 / rate_Hz);
  const auto cycles = static_cast<std::uint64_t>(seconds * rate_Hz);
  std::vector<std::int64_t> latency_ns;
  std::uint64_t lost = 0;
  std::int64_t next_ns = Now_ns();
  for (std::uint64_t number = 1; number <= cycles && !g_stop; ++number) {
    std::int64_t written_ns = 0;
    for (const Out& out : outs) {
      Message message{number, out.size};
      written_ns = Now_ns();
      (void)out.writer->write(&message);
    }
    next_ns += period_ns;
    SleepUntil(next_ns);
    if (answer.number == number) {
      latency_ns.push_back(answer.arrived_ns - written_ns);
    } else {
      ++lost;
    }
  }
  std::sort(latency_ns.begin(), latency_ns.end());
  const auto quantile_us = [&](double share) {
    if (latency_ns.empty()) return 0.0;
    const auto at = static_cast<std::size_t>(share * static_cast<double>(latency_ns.size() - 1));
    return 1e-3 * static_cast<double>(latency_ns[at]);
  };
  std::printf("{\"cycles\": %zu, \"lost\": %llu, \"p50_us\": %.1f, \"p999_us\": %.1f}\n",
              latency_ns.size(), static_cast<unsigned long long>(lost), quantile_us(0.5),
              quantile_us(0.999));
}

}  // namespace

int main(int argc, char** argv) {
  std::string kind = argc > 1 ? argv[1] : "";
  std::vector<std::string> ins, outs;
  double rate_Hz = 240.0, seconds = 10.0;
  int domain = 0, priority = 0;
  for (int k = 2; k + 1 < argc; k += 2) {
    const std::string key = argv[k], value = argv[k + 1];
    if (key == "--in") ins.push_back(value);
    if (key == "--out") outs.push_back(value);
    if (key == "--rate") rate_Hz = std::stod(value);
    if (key == "--seconds") seconds = std::stod(value);
    if (key == "--domain") domain = std::stoi(value);
    if (key == "--priority") priority = std::stoi(value);
  }
  if ((kind != "source" && kind != "relay") || ins.empty()) {
    std::fprintf(stderr, "see the head of bench/chain/relay.cc\n");
    return 2;
  }
  ::signal(SIGINT, OnSignal);
  ::signal(SIGTERM, OnSignal);
  if (priority > 0) {
    const sched_param parameters{.sched_priority = priority};
    if (::sched_setscheduler(0, SCHED_FIFO, &parameters) != 0) std::perror("SCHED_FIFO");
  }
  Participant participant(domain);
  Listener last, others;  // the last input is answered
  std::vector<Out> writers;
  for (const std::string& out : outs) writers.push_back(participant.MakeWriter(out));
  if (kind == "relay") last.outs = writers;
  for (std::size_t k = 0; k < ins.size(); ++k) {
    participant.MakeReader(ins[k], k + 1 == ins.size() ? &last : &others);
  }
  if (kind == "source") {
    SleepUntil(Now_ns() + 2'000'000'000);  // until all have found each other
    RunSource(writers, last, rate_Hz, seconds);
  } else {
    while (!g_stop) SleepUntil(Now_ns() + 100'000'000);
  }
  return 0;
}
