// A relay with Fast DDS alone, none of Sinew's code: what the middleware costs by itself.
//
//   chain_relay source --rate HZ --seconds S --out TOPIC:PROFILE:BYTES ... --await TOPIC:PROFILE
//   chain_relay relay --await TOPIC:PROFILE ... --in TOPIC:PROFILE ... --out TOPIC:PROFILE:BYTES
//   ...
//
// The source stands for the provider: it writes its topics at the rate, the last one last, and
// measures until the sample of its input that carries the same number is there; an answer that
// comes after half of the period is late; the time that a cycle's writes take is printed too. A
// relay stands for a participant: it answers in the listener, when the samples of a number have
// come on all topics of --await; those of --in are only read. Payloads, QoS (--qos, the profiles of
// components/topics/node), transports, readers a topic, threads and memory are those of the
// participants that are compared. --transports udp, as ours in real time, both or shm.
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastdds/rtps/transport/shared_mem/SharedMemTransportDescriptor.h>
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
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

namespace dds = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;
namespace transport = eprosima::fastdds::rtps;

constexpr std::uint32_t kLargest = 65536;
constexpr std::size_t kThreadStackBytes = 512 * 1024;  // as components/topics/node/realtime.h
constexpr double kLateShare = 0.5;  // of the period, as components/topics/node/cut_off.h
constexpr std::int64_t kWarmUp_ns = 4'000'000'000;  // until all have found each other

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

// TOPIC:PROFILE or TOPIC:PROFILE:BYTES
struct End {
  explicit End(const std::string& text) {
    const std::size_t first = text.find(':'), second = text.find(':', first + 1);
    topic = text.substr(0, first);
    profile = text.substr(first + 1, second - first - 1);
    if (second != std::string::npos) {
      bytes = static_cast<std::uint32_t>(std::stoul(text.substr(second + 1)));
    }
  }
  std::string topic, profile;
  std::uint32_t bytes = 0;
};

std::int64_t Now_ns() {
  timespec now{};
  ::clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1'000'000'000ll + now.tv_nsec;
}

std::atomic<bool> g_stop{false};
extern "C" void OnSignal(int) { g_stop = true; }

template <class Entity>
Entity* Made(Entity* entity, const char* what) {
  if (entity == nullptr) throw std::runtime_error(std::string("cannot make a ") + what);
  return entity;
}

class Participant {
 public:
  Participant(int domain, const std::string& qos_file, const std::string& transports) {
    auto* factory = dds::DomainParticipantFactory::get_instance();
    if (factory->load_XML_profiles_file(qos_file) != ReturnCode_t::RETCODE_OK) {
      throw std::runtime_error(qos_file + ": no QoS profiles");
    }
    dds::DomainParticipantQos qos;
    (void)factory->get_participant_qos_from_profile("sinew", qos);
    auto& used = qos.transport();  // as components/topics/node/transports.cc
    used.use_builtin_transports = false;
    if (transports != "shm") {
      auto udp = std::make_shared<transport::UDPv4TransportDescriptor>();
      udp->interfaceWhiteList = {"127.0.0.1"};
      udp->sendBufferSize = used.send_socket_buffer_size;
      udp->receiveBufferSize = used.listen_socket_buffer_size;
      used.user_transports.push_back(udp);
    }
    if (transports != "udp") {
      auto shared_memory = std::make_shared<transport::SharedMemTransportDescriptor>();
      shared_memory->max_message_size(65500);  // as UDP
      used.user_transports.push_back(shared_memory);
    }
    participant_ =
        Made(factory->create_participant(static_cast<std::uint32_t>(domain), qos), "participant");
    type_.register_type(participant_);
    publisher_ = Made(participant_->create_publisher(dds::PUBLISHER_QOS_DEFAULT), "publisher");
    subscriber_ = Made(participant_->create_subscriber(dds::SUBSCRIBER_QOS_DEFAULT), "subscriber");
  }
  ~Participant() {
    participant_->delete_contained_entities();
    dds::DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  Out MakeWriter(const End& end) {
    dds::DataWriterQos qos;
    if (publisher_->get_datawriter_qos_from_profile(end.profile, qos) != ReturnCode_t::RETCODE_OK) {
      throw std::runtime_error("no writer profile " + end.profile);
    }
    return {Made(publisher_->create_datawriter(Topic(end.topic), qos), "writer"), end.bytes};
  }
  dds::DataReader* MakeReader(const End& end, dds::DataReaderListener* listener) {
    dds::DataReaderQos qos;
    if (subscriber_->get_datareader_qos_from_profile(end.profile, qos) !=
        ReturnCode_t::RETCODE_OK) {
      throw std::runtime_error("no reader profile " + end.profile);
    }
    return Made(subscriber_->create_datareader(Topic(end.topic), qos, listener,
                                               dds::StatusMask::data_available()),
                "reader");
  }

 private:
  dds::Topic* Topic(const std::string& name) {
    if (auto* found = participant_->lookup_topicdescription(name)) {
      return dynamic_cast<dds::Topic*>(found);
    }
    return Made(participant_->create_topic(name, "relay_message", dds::TOPIC_QOS_DEFAULT), "topic");
  }
  dds::TypeSupport type_{new Type};
  dds::DomainParticipant* participant_ = nullptr;
  dds::Publisher* publisher_ = nullptr;
  dds::Subscriber* subscriber_ = nullptr;
};

// Answers in the thread that brought the last of the awaited samples of a number.
class Answerer {
 public:
  void Await(std::size_t inputs) { numbers_.assign(inputs, 0); }
  void Arrived(std::size_t input, std::uint64_t number) {
    const std::lock_guard<std::mutex> lock(mutex_);
    numbers_[input] = number;
    for (const std::uint64_t other : numbers_) {
      if (other != number) return;
    }
    for (const Out& out : outs) {
      Message answer{number, out.size};
      (void)out.writer->write(&answer);
    }
    arrived_ns = Now_ns();
    complete = number;
  }
  std::vector<Out> outs;
  std::atomic<std::int64_t> arrived_ns{0};
  std::atomic<std::uint64_t> complete{0};

 private:
  std::mutex mutex_;
  std::vector<std::uint64_t> numbers_;
};

class Listener final : public dds::DataReaderListener {
 public:
  Listener(Answerer* answerer, std::size_t input) : answerer_(answerer), input_(input) {}
  void on_data_available(dds::DataReader* reader) override {
    Message message;
    dds::SampleInfo info;
    while (reader->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK) {
      if (info.valid_data && answerer_ != nullptr) answerer_->Arrived(input_, message.number);
    }
  }

 private:
  Answerer* answerer_;  // null: only read
  std::size_t input_;
};

void SleepUntil(std::int64_t end_ns) {
  const timespec end{static_cast<time_t>(end_ns / 1'000'000'000),
                     static_cast<long>(end_ns % 1'000'000'000)};
  while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &end, nullptr) == EINTR && !g_stop) {
  }
}

double Quantile_us(std::vector<std::int64_t>* times_ns, double share) {
  if (times_ns->empty()) return 0.0;
  std::sort(times_ns->begin(), times_ns->end());
  const auto at = static_cast<std::size_t>(share * static_cast<double>(times_ns->size() - 1));
  return 1e-3 * static_cast<double>((*times_ns)[at]);
}

void RunSource(const std::vector<Out>& outs, const Answerer& answer, double rate_Hz,
               double seconds) {
  constexpr std::int64_t kLate_ns = 20'000'000;  // what a late answer counts as
  const auto period_ns = static_cast<std::int64_t>(1e9 / rate_Hz);
  const auto late_after_ns = static_cast<std::int64_t>(kLateShare * 1e9 / rate_Hz);
  std::vector<std::int64_t> latency_ns, writes_ns;
  for (auto* times : {&latency_ns, &writes_ns}) {
    times->reserve(static_cast<std::size_t>(seconds * rate_Hz) + 1);
  }
  std::uint64_t late = 0;
  std::int64_t next_ns = Now_ns();
  const std::int64_t begin_ns = next_ns + kWarmUp_ns;
  const std::int64_t end_ns = begin_ns + static_cast<std::int64_t>(1e9 * seconds);
  for (std::uint64_t number = 1; next_ns < end_ns && !g_stop; ++number) {
    const std::int64_t start_ns = Now_ns();
    std::int64_t written_ns = start_ns;
    for (const Out& out : outs) {
      Message message{number, out.size};
      written_ns = Now_ns();
      (void)out.writer->write(&message);
    }
    const std::int64_t all_written_ns = Now_ns();
    const bool counts = next_ns >= begin_ns;
    next_ns += period_ns;
    SleepUntil(next_ns);
    if (!counts) continue;
    writes_ns.push_back(all_written_ns - start_ns);
    const std::int64_t took_ns = answer.arrived_ns - written_ns;
    const bool in_time = answer.complete == number && took_ns <= late_after_ns;
    if (!in_time) ++late;
    latency_ns.push_back(in_time ? took_ns : kLate_ns);
  }
  const double p50_us = Quantile_us(&latency_ns, 0.5), p999_us = Quantile_us(&latency_ns, 0.999);
  std::printf(
      "{\"cycles\": %zu, \"late\": %llu, \"p50_us\": %.1f, \"p999_us\": %.1f, "
      "\"writes_p50_us\": %.1f}\n",
      latency_ns.size(), static_cast<unsigned long long>(late), p50_us, p999_us,
      Quantile_us(&writes_ns, 0.5));
}

// As components/topics/node/realtime.cc.
void BecomeRealtime(int priority, int cpu) {
  const sched_param parameters{.sched_priority = priority};
  cpu_set_t cpus;
  CPU_ZERO(&cpus);
  CPU_SET(static_cast<std::size_t>(cpu), &cpus);
  pthread_attr_t attributes;
  ::pthread_attr_init(&attributes);
  ::pthread_attr_setstacksize(&attributes, kThreadStackBytes);
  const bool done = ::sched_setscheduler(0, SCHED_FIFO, &parameters) == 0 &&
                    ::sched_setaffinity(0, sizeof cpus, &cpus) == 0 &&
                    ::pthread_setattr_default_np(&attributes) == 0 &&
                    ::mlockall(MCL_CURRENT | MCL_FUTURE) == 0;
  ::pthread_attr_destroy(&attributes);
  if (!done) throw std::runtime_error("SCHED_FIFO, the core or locked memory refused");
}

struct Arguments {
  Arguments(int argc, char** argv) {
    kind = argc > 1 ? argv[1] : "";
    for (int k = 2; k + 1 < argc; k += 2) {
      const std::string key = argv[k], value = argv[k + 1];
      if (key == "--in") ins.emplace_back(value);
      if (key == "--await") awaited.emplace_back(value);
      if (key == "--out") outs.emplace_back(value);
      if (key == "--rate") rate_Hz = std::stod(value);
      if (key == "--seconds") seconds = std::stod(value);
      if (key == "--domain") domain = std::stoi(value);
      if (key == "--priority") priority = std::stoi(value);
      if (key == "--cpu") cpu = std::stoi(value);
      if (key == "--qos") qos_file = value;
      if (key == "--transports") transports = value;
    }
    if ((kind != "source" && kind != "relay") || awaited.empty() || qos_file.empty()) {
      throw std::runtime_error("usage: see the head of bench/chain/relay.cc");
    }
  }
  std::string kind, qos_file, transports = "udp";
  std::vector<End> ins, awaited, outs;
  double rate_Hz = 240.0, seconds = 10.0;
  int domain = 0, priority = 0, cpu = 0;
};

}  // namespace

int main(int argc, char** argv) try {
  const Arguments arguments(argc, argv);
  ::signal(SIGINT, OnSignal);
  ::signal(SIGTERM, OnSignal);
  if (arguments.priority > 0) BecomeRealtime(arguments.priority, arguments.cpu);
  Answerer answerer;
  answerer.Await(arguments.awaited.size());
  std::vector<std::unique_ptr<Listener>> listeners;  // outlive the participant
  Participant participant(arguments.domain, arguments.qos_file, arguments.transports);
  std::vector<Out> writers;
  for (const End& end : arguments.outs) writers.push_back(participant.MakeWriter(end));
  if (arguments.kind == "relay") answerer.outs = writers;
  for (const End& end : arguments.ins) {
    listeners.push_back(std::make_unique<Listener>(nullptr, 0));
    participant.MakeReader(end, listeners.back().get());
  }
  for (std::size_t k = 0; k < arguments.awaited.size(); ++k) {
    listeners.push_back(std::make_unique<Listener>(&answerer, k));
    participant.MakeReader(arguments.awaited[k], listeners.back().get());
  }
  if (arguments.kind == "source") {
    RunSource(writers, answerer, arguments.rate_Hz, arguments.seconds);
  } else {
    while (!g_stop) SleepUntil(Now_ns() + 100'000'000);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "chain_relay: %s\n", error.what());
  return 1;
}
