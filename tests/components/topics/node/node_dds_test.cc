// Nodes of one process talk over DDS. Every test has its own domain.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/reference.h>
#include <sinew_idl/regime.h>
#include <sinew_idl/residual.h>
#include <sinew_idl/status.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <fstream>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <thread>

#include "components/topics/node/codec.h"
#include "components/topics/node/endpoint.h"
#include "components/topics/node/node.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::node {
namespace {

using namespace std::chrono_literals;
using ::testing::Contains;
using ::testing::DoubleEq;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

Options MakeOptions(const std::string& name, int domain, TimeMode mode = TimeMode::kLockstep) {
  Options options;
  options.component = options.name = name;
  options.domain_id = domain;
  options.mode = mode;
  return options;
}

template <class Condition>
bool WaitUntil(Node& node, Condition condition, std::chrono::milliseconds timeout = 10s) {
  const auto deadline = std::chrono::steady_clock::now() + timeout;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    node.WaitForData(20ms);
  }
  return true;
}

msg::JointState StateOfTick(std::uint64_t tick, bool last = false) {
  msg::JointState state;
  state.header.session_id = 9;
  state.header.tick = tick;
  state.period_s = 0.001;
  state.last_tick = last;
  state.joint_count = 1;
  state.position_rad[0] = 0.5 * static_cast<double>(tick);
  return state;
}

TEST(NodeDds, DeliversEverySampleInOrderInLockstep) {
  Node a(MakeOptions("a", 120)), b(MakeOptions("b", 120));
  auto writer = a.MakeWriter(kJointState);
  auto reader = b.MakeReader(kJointState);
  for (std::uint64_t tick = 0; tick < 200; ++tick) {
    ASSERT_EQ(writer.Write(StateOfTick(tick)), WriteStatus::kOk);
  }
  for (std::uint64_t tick = 0; tick < 200; ++tick) {
    const auto state = reader.WaitNext(10s);
    ASSERT_TRUE(state.has_value()) << "tick " << tick;
    EXPECT_EQ(*state, StateOfTick(tick));
  }
  EXPECT_EQ(reader.lost(), 0u);
}

// Files of /dev/shm that this process has mapped, by their modes.
std::map<std::string, mode_t> MappedSharedMemory() {
  std::map<std::string, mode_t> files;
  std::ifstream maps("/proc/self/maps");
  for (std::string line; std::getline(maps, line);) {
    const std::size_t at = line.find("/dev/shm/");
    struct stat status {};
    if (at == std::string::npos || ::stat(line.c_str() + at, &status) != 0) continue;
    files[line.substr(at)] = status.st_mode & 0777;
  }
  return files;
}

TEST(NodeDds, SharedMemoryIsItsUsersAloneFromTheMomentThatItIsMade) {
  Node a(MakeOptions("a", 213)), b(MakeOptions("b", 213));
  auto writer = a.MakeWriter(kJointState);
  auto reader = b.MakeReader(kJointState);
  ASSERT_EQ(writer.Write(StateOfTick(0)), WriteStatus::kOk);
  ASSERT_TRUE(reader.WaitNext(10s));
  const auto files = MappedSharedMemory();
  EXPECT_GE(files.size(), 2U) << "a segment of each";
  for (const auto& [name, mode] : files) EXPECT_EQ(mode, 0600U) << name;

  // As Boost makes a segment, at any time; what comes after is not changed.
  const std::string name = "/sinew-mode-" + std::to_string(::getpid());
  const int file = ::shm_open(name.c_str(), O_CREAT | O_EXCL | O_RDWR, 0644);
  ASSERT_GE(file, 0);
  const auto mode = [file] {
    struct stat status {};
    EXPECT_EQ(::fstat(file, &status), 0);
    return status.st_mode & 0777;
  };
  EXPECT_EQ(mode(), 0600U);
  EXPECT_EQ(::fchmod(file, 0644), 0);
  EXPECT_EQ(mode(), 0600U);
  EXPECT_EQ(::fchmod(file, 0640), 0);
  EXPECT_EQ(mode(), 0640U);
  ::close(file);
  EXPECT_EQ(::shm_unlink(name.c_str()), 0);
  EXPECT_EQ(::fchmod(-1, 0644), -1);
}

TEST(NodeDds, AReaderThatDoesNotReadKeepsTheNewestAndCountsWhatItDropped) {
  Node a(MakeOptions("a", 137, TimeMode::kRealtime)), b(MakeOptions("b", 137, TimeMode::kRealtime));
  auto writer = a.MakeWriter(kOperatorCommand);  // reliable, so that DDS loses nothing
  auto reader = b.MakeReader(kOperatorCommand);
  ASSERT_TRUE(WaitUntil(b, [&] { return reader.matched_writers() == 1; }));
  ASSERT_TRUE(WaitUntil(a, [&] { return writer.matched_readers() == 1; }));
  constexpr std::uint64_t kSent = 300, kKept = 256;
  for (std::uint64_t tick = 0; tick < kSent; ++tick) {
    msg::OperatorCommand command;
    command.header.tick = tick;
    ASSERT_EQ(writer.Write(command), WriteStatus::kOk);
    ASSERT_TRUE(WaitUntil(b, [&] { return reader.received() == tick + 1; }));
  }
  EXPECT_EQ(reader.dropped(), kSent - kKept);
  for (std::uint64_t tick = kSent - kKept; tick < kSent; ++tick) {
    const auto command = reader.TakeNext();
    ASSERT_TRUE(command.has_value());
    EXPECT_EQ(command->header.tick, tick);
  }
  EXPECT_FALSE(reader.TakeNext().has_value());
}

TEST(NodeDds, RecordersSeeTheBytesThatWereWritten) {
  Node a(MakeOptions("a", 121)), b(MakeOptions("b", 121));
  std::mutex mutex;
  std::vector<RawSample> samples;
  b.ReadRaw(*FindTopic("joint_state"), [&](RawSample&& sample) {
    const std::lock_guard<std::mutex> lock(mutex);
    samples.push_back(std::move(sample));
  });
  auto writer = a.MakeWriter(kJointState);
  ASSERT_EQ(writer.Write(StateOfTick(3)), WriteStatus::kOk);
  ASSERT_TRUE(WaitUntil(b, [&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return samples.size() == 1;
  }));
  Bytes expected;
  ASSERT_TRUE(Encode(StateOfTick(3), &expected));
  EXPECT_EQ(samples[0].payload, expected);
  EXPECT_EQ(samples[0].topic, "joint_state");
  EXPECT_GT(samples[0].reception_stamp_ns, 0);
}

TEST(NodeDds, RecordersSeeWhoWroteWhichSample) {
  Node a(MakeOptions("a", 121)), b(MakeOptions("b", 121));
  std::mutex mutex;
  std::vector<RawSample> samples;
  b.ReadRaw(
      *FindTopic("joint_state"),
      [&](RawSample&& sample) {
        const std::lock_guard<std::mutex> lock(mutex);
        samples.push_back(std::move(sample));
      },
      /*wakes=*/false);
  auto writer = a.MakeWriter(kJointState);
  for (int tick = 0; tick < 5; ++tick) {
    ASSERT_EQ(writer.Write(StateOfTick(tick)), WriteStatus::kOk);
  }
  ASSERT_TRUE(WaitUntil(b, [&] {
    const std::lock_guard<std::mutex> lock(mutex);
    return samples.size() == 5;
  }));
  for (std::size_t i = 0; i < samples.size(); ++i) {
    EXPECT_EQ(samples[i].sequence, i + 1);
    EXPECT_EQ(samples[i].writer, samples[0].writer);
  }
  const auto name = b.NameOf(samples[0].writer);
  ASSERT_TRUE(name.has_value());
  EXPECT_EQ(name->participant, "a");
  EXPECT_EQ(b.RawLost("joint_state"), 0u);
  EXPECT_EQ(b.RawLost("reference"), 0u) << "nobody reads it";
}

TEST(NodeDds, LoopTakesTicksOneByOneAndWaitsForEveryInput) {
  Node provider(MakeOptions("provider", 122)), node(MakeOptions("loop", 122));
  auto state = provider.MakeWriter(kJointState);
  auto reference = provider.MakeWriter(kReference);
  constexpr std::uint64_t kTicks = 100;
  std::thread writer([&] {
    for (std::uint64_t tick = 0; tick < kTicks; ++tick) {
      EXPECT_EQ(state.Write(StateOfTick(tick, tick + 1 == kTicks)), WriteStatus::kOk);
    }
    for (std::uint64_t tick = 0; tick < kTicks; ++tick) {  // all answers come after all triggers
      msg::Reference message;
      message.header.session_id = 9;
      message.header.tick = tick;
      message.position_rad[0] = 2.0 * static_cast<double>(tick);
      EXPECT_EQ(reference.Write(message), WriteStatus::kOk);
    }
  });
  StopFlag stop;
  TickLoop loop(node, stop);
  auto& trigger = loop.AddInput(kJointState);
  auto& input = loop.AddInput(kReference);
  auto& delayed = loop.AddInput(kReference, {.delay_ticks = 2});
  std::uint64_t expected = 0;
  while (const auto tick = loop.Next()) {
    ASSERT_EQ(tick->tick, expected);
    EXPECT_FALSE(tick->any_stale);
    EXPECT_EQ(trigger.value().position_rad[0], 0.5 * static_cast<double>(expected));
    ASSERT_TRUE(input.fresh());
    EXPECT_EQ(input.value().position_rad[0], 2.0 * static_cast<double>(expected));
    EXPECT_EQ(delayed.has_value(), expected >= 2);
    if (expected >= 2) {
      EXPECT_EQ(delayed.tick(), expected - 2);
    }
    ++expected;
  }
  EXPECT_EQ(expected, kTicks);
  writer.join();
}

TEST(NodeDds, LoopFlagsAnInputThatNeverComesAsStaleInRealTime) {
  Node provider(MakeOptions("provider", 123, TimeMode::kRealtime));
  Node node(MakeOptions("loop", 123, TimeMode::kRealtime));
  auto state = provider.MakeWriter(kJointState);
  StopFlag stop;
  TickLoop loop(node, stop, {.cut_off_share = 0.5});
  loop.AddInput(kJointState);
  auto& input = loop.AddInput(kReference);
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (std::uint64_t tick = 0; !done; ++tick) {
      EXPECT_EQ(state.Write(StateOfTick(tick)), WriteStatus::kOk);
      provider.WaitForData(10ms);
    }
  });
  const auto tick = loop.Next();
  done = true;
  writer.join();
  ASSERT_TRUE(tick.has_value());
  EXPECT_TRUE(tick->any_stale);
  EXPECT_FALSE(input.fresh());
  EXPECT_FALSE(input.has_value());
}

// A joint_state whose joint_count no array has.
Bytes MalformedState(std::uint64_t tick) {
  msg::JointState state = StateOfTick(tick);
  state.joint_count = 200;
  Bytes bytes;
  EXPECT_TRUE(Encode(state, &bytes));
  return bytes;
}

TEST(NodeDds, MalformedSamplesAreCountedAndNeverHandedOn) {
  Node a(MakeOptions("a", 170)), b(MakeOptions("b", 170));
  const RawWriter write = a.MakeRawWriter(*FindTopic("joint_state"));
  auto reader = b.MakeReader(kJointState);
  const auto send = [&write](const Bytes& bytes) {
    EXPECT_EQ(write(bytes.data(), bytes.size()), WriteStatus::kOk);
  };
  Bytes good;
  ASSERT_TRUE(Encode(StateOfTick(3), &good));
  send(MalformedState(1));
  send(MalformedState(2));
  send(good);
  const auto state = reader.WaitNext(10s);
  ASSERT_TRUE(state.has_value());
  EXPECT_EQ(state->header.tick, 3u);
  EXPECT_EQ(reader.malformed(), 2u);
}

TEST(NodeDds, AMalformedTriggerMakesNoCycleAndAMalformedInputLeavesTheLastValue) {
  Node provider(MakeOptions("provider", 171)), node(MakeOptions("loop", 171));
  const RawWriter write_state = provider.MakeRawWriter(*FindTopic("joint_state"));
  const RawWriter write_reference = provider.MakeRawWriter(*FindTopic("reference"));
  const auto send_state = [&](std::uint64_t tick) {
    Bytes bytes = MalformedState(tick);
    if (tick != 1) {
      ASSERT_TRUE(Encode(StateOfTick(tick, tick == 2), &bytes));
    }
    EXPECT_EQ(write_state(bytes.data(), bytes.size()), WriteStatus::kOk);
  };
  const auto send_reference = [&](std::uint64_t tick) {
    msg::Reference message;
    message.header.session_id = 9;
    message.header.tick = tick;
    message.position_rad[0] = 7.0 + static_cast<double>(tick);
    if (tick == 2) message.joint_count = 13;
    Bytes bytes;
    ASSERT_TRUE(Encode(message, &bytes));
    constexpr std::size_t kCut = 10;  // shorter than session and tick
    // Before the whole one, which ends the wait of its cycle.
    if (tick == 2) {
      EXPECT_EQ(write_reference(bytes.data(), kCut), WriteStatus::kOk);
    }
    EXPECT_EQ(write_reference(bytes.data(), bytes.size()), WriteStatus::kOk);
  };
  for (std::uint64_t tick = 0; tick < 3; ++tick) {
    send_state(tick);
    send_reference(tick);
  }
  StopFlag stop;
  TickLoop loop(node, stop);
  auto& trigger = loop.AddInput(kJointState);
  auto& input = loop.AddInput(kReference);
  const auto first = loop.Next();
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->tick, 0u);
  EXPECT_EQ(input.value().position_rad[0], 7.0);
  const auto next = loop.Next();
  ASSERT_TRUE(next.has_value());
  EXPECT_EQ(next->tick, 2u) << "the malformed state of tick 1 made no cycle";
  EXPECT_EQ(trigger.malformed(), 1u);
  EXPECT_TRUE(next->any_stale);
  EXPECT_EQ(input.value().position_rad[0], 8.0) << "of tick 1, the last that could be read";
  EXPECT_EQ(input.malformed(), 2u) << "a count beyond its array, and ten bytes";
}

// Who divides by the period, or makes filters of it, never sees one that is none.
TEST(NodeDds, AStateWhosePeriodIsNoneMakesNoCycle) {
  Node provider(MakeOptions("provider", 171)), node(MakeOptions("loop", 171));
  const RawWriter write = provider.MakeRawWriter(*FindTopic("joint_state"));
  constexpr double kNone[] = {std::numeric_limits<double>::quiet_NaN(), 0.0, -0.004, 1e300,
                              std::numeric_limits<double>::infinity()};
  std::uint64_t tick = 0;
  const auto send = [&](double period_s) {
    msg::JointState state = StateOfTick(tick, false);
    state.period_s = period_s;
    Bytes bytes;
    ASSERT_TRUE(Encode(state, &bytes));
    EXPECT_EQ(write(bytes.data(), bytes.size()), WriteStatus::kOk);
    ++tick;
  };
  for (const double period_s : kNone) send(period_s);
  send(0.004);
  StopFlag stop;
  TickLoop loop(node, stop);
  auto& trigger = loop.AddInput(kJointState);
  const auto first = loop.Next();
  ASSERT_TRUE(first.has_value());
  EXPECT_EQ(first->tick, std::size(kNone));
  EXPECT_EQ(trigger.malformed(), std::size(kNone));
}

// Three ticks of joint_state, regime and reference; the second reference is as given.
struct Origins {
  msg::Origin state, regime, reference;
  std::uint64_t reference_session = 9;
};

struct Cycles {
  std::vector<msg::Origin> origins;    // of what is computed
  std::vector<bool> reference_is_new;  // false: it was refused
};

Cycles CyclesOf(const Origins& given) {
  Node provider(MakeOptions("provider", 172, TimeMode::kRealtime));
  Node node(MakeOptions("loop", 172, TimeMode::kRealtime));
  StopFlag stop;
  TickLoop loop(node, stop, {.cut_off_share = 0.5});
  loop.AddInput(kJointState);
  auto& input = loop.AddInput(kReference);
  loop.AddInput(kRegime);
  // Best effort, so that all is said again until its cycle is over.
  std::atomic<std::uint64_t> now{0};
  std::atomic<bool> done{false};
  std::thread writer([&] {
    auto state = provider.MakeWriter(kJointState);
    auto reference = provider.MakeWriter(kReference);
    auto regime = provider.MakeWriter(kRegime);
    while (!done) {
      const std::uint64_t k = now;
      msg::JointState message = StateOfTick(k);
      message.period_s = 1.0;  // a reference that never comes is awaited for half a second
      message.header.origin = given.state;
      msg::Reference wanted;
      wanted.header = message.header;
      wanted.header.session_id = k == 1 ? given.reference_session : 9;
      wanted.header.origin = k == 1 ? given.reference : given.state;
      msg::RegimeState found;
      found.header = message.header;
      found.header.origin = k == 1 ? given.regime : given.state;
      EXPECT_EQ(reference.Write(wanted), WriteStatus::kOk);
      EXPECT_EQ(regime.Write(found), WriteStatus::kOk);
      EXPECT_EQ(state.Write(message), WriteStatus::kOk);
      provider.WaitForData(20ms);
    }
  });
  Cycles cycles;
  while (now < 3) {
    const auto tick = loop.Next();
    if (!tick) break;
    cycles.origins.push_back(tick->origin);
    cycles.reference_is_new.push_back(input.fresh());
    ++now;
  }
  done = true;
  writer.join();
  return cycles;
}

TEST(NodeDds, WhatIsComputedFromARecordingSaysSo) {
  using enum msg::Origin;
  const Cycles live = CyclesOf({kLive, kReplay, kLive});
  EXPECT_THAT(live.origins, ElementsAre(kLive, kReplay, kLive));
  const Cycles simulated = CyclesOf({kSim, kSim, kReplay});
  EXPECT_THAT(simulated.origins, ElementsAre(kSim, kReplay, kSim));
  EXPECT_THAT(simulated.reference_is_new, ElementsAre(true, true, true));
}

TEST(NodeDds, OnLiveHardwareAReplayedRequestIsAsIfItHadNeverCome) {
  using enum msg::Origin;
  const Cycles cycles = CyclesOf({kLive, kLive, kReplay});
  EXPECT_THAT(cycles.reference_is_new, ElementsAre(true, false, true));
  EXPECT_THAT(cycles.origins, ElementsAre(kLive, kLive, kLive))
      << "what is refused does not make the outputs replayed";
}

TEST(NodeDds, ARequestOfAnotherSessionIsAsIfItHadNeverCome) {
  using enum msg::Origin;
  EXPECT_THAT(CyclesOf({kSim, kSim, kSim, 8}).reference_is_new, ElementsAre(true, false, true));
}

// Two state providers that discovery did not show each other: nobody goes to and fro between them.
TEST(NodeDds, ALoopStaysWithTheWriterOfItsSessionWhileThatIsHeard) {
  Node first(MakeOptions("first", 173, TimeMode::kRealtime));
  Node second(MakeOptions("second", 173, TimeMode::kRealtime));
  Node node(MakeOptions("loop", 173, TimeMode::kRealtime));
  StopFlag stop;
  TickLoop loop(node, stop);
  loop.AddInput(kJointState);
  std::atomic<bool> both{false}, one_only{false}, done{false};
  std::thread provider([&] {
    auto a = first.MakeWriter(kJointState), b = second.MakeWriter(kJointState);
    const auto send = [](Writer<msg::JointState>& to, std::uint64_t session, std::uint64_t tick) {
      msg::JointState state = StateOfTick(tick);
      state.header.session_id = session;
      state.period_s = 0.002;
      EXPECT_NE(to.Write(state), WriteStatus::kFailed);
    };
    for (std::uint64_t tick = 1; !done; ++tick) {
      if (!one_only) send(a, 1, tick);
      if (both) send(b, 2, tick);
      first.WaitForData(2ms);
    }
  });
  const auto session = [&] {
    const auto tick = loop.Next();
    return tick ? tick->session_id : 0;
  };
  EXPECT_EQ(session(), 1u);
  both = true;
  for (int cycle = 0; cycle < 100; ++cycle) EXPECT_EQ(session(), 1u);
  one_only = true;
  const auto end = std::chrono::steady_clock::now() + 10s;
  std::uint64_t now = 1;
  while (now == 1 && std::chrono::steady_clock::now() < end) now = session();
  EXPECT_EQ(now, 2u) << "the first one is not heard any more";
  done = true;
  provider.join();
}

template <class Message>
concept CanBeAnInput = requires(TickLoop& loop, const Topic<Message>& topic) {
  loop.AddInput(topic);
};
static_assert(CanBeAnInput<msg::JointState> && CanBeAnInput<msg::Reference>);
static_assert(!CanBeAnInput<msg::ComponentStatus>, "it does not begin with its header");

TEST(NodeDds, LoopIsTriggeredByAnyMessageWithAHeader) {
  Node provider(MakeOptions("provider", 131)), node(MakeOptions("loop", 131));
  auto writer = provider.MakeWriter(kReference);
  auto answers = provider.MakeReader(kResidual);
  StopFlag stop;
  TickLoop loop(node, stop, {.nominal_period_s = 0.004});
  auto& trigger = loop.AddInput(kReference);
  auto output = node.MakeWriter(kResidual);
  for (std::uint64_t tick = 5; tick < 8; ++tick) {
    msg::Reference message;
    message.header.session_id = 3;
    message.header.tick = tick;
    message.header.stamp_ns = 4'000'000 * static_cast<std::int64_t>(tick);
    message.header.origin = msg::Origin::kReplay;
    message.position_rad[0] = 0.5 * static_cast<double>(tick);
    ASSERT_EQ(writer.Write(message), WriteStatus::kOk);
  }
  for (std::uint64_t expected = 5; expected < 8; ++expected) {
    const auto tick = loop.Next();
    ASSERT_TRUE(tick.has_value());
    EXPECT_EQ(tick->session_id, 3u);
    EXPECT_EQ(tick->tick, expected);
    EXPECT_EQ(tick->stamp_ns, 4'000'000 * static_cast<std::int64_t>(expected));
    EXPECT_EQ(tick->origin, msg::Origin::kReplay);
    EXPECT_EQ(tick->period_s, 0.004);
    EXPECT_FALSE(tick->last);
    EXPECT_EQ(trigger.value().position_rad[0], 0.5 * static_cast<double>(expected));
    loop.Publish(output, msg::ResidualState(), *tick);
    const auto answer = answers.WaitNext(10s);
    ASSERT_TRUE(answer.has_value());
    EXPECT_EQ(answer->header.tick, expected);
    EXPECT_EQ(answer->header.stamp_ns, tick->stamp_ns);
    EXPECT_EQ(answer->header.origin, msg::Origin::kReplay);
  }
}

// Periods of a loop that gets three ticks, measured 0, 5 and 8 ms after the start. Every tick is
// sent until it is taken, since best-effort samples may be lost before reader and writer know of
// each other; the loop ignores the repetitions.
std::vector<double> PeriodsOf(TimeMode mode, msg::Origin origin, int domain) {
  Node provider(MakeOptions("provider", domain, mode)), node(MakeOptions("loop", domain, mode));
  auto writer = provider.MakeWriter(kJointState);
  StopFlag stop;
  TickLoop loop(node, stop);
  loop.AddInput(kJointState);
  constexpr std::int64_t kStamps_ns[] = {0, 5'000'000, 8'000'000};
  std::atomic<std::size_t> taken{0};
  std::thread sender([&] {
    while (taken < std::size(kStamps_ns)) {
      msg::JointState state = StateOfTick(std::min<std::size_t>(taken, std::size(kStamps_ns) - 1));
      state.header.stamp_ns = 1'700'000'000'000'000'000 + kStamps_ns[state.header.tick];
      state.header.origin = origin;
      state.period_s = 0.004;
      EXPECT_EQ(writer.Write(state), WriteStatus::kOk);
      provider.WaitForData(2ms);
    }
  });
  std::vector<double> periods;
  while (taken < std::size(kStamps_ns)) {
    const auto tick = loop.Next();
    EXPECT_EQ(tick->tick, taken);
    EXPECT_EQ(tick->nominal_period_s, 0.004);
    periods.push_back(tick->period_s);
    ++taken;
  }
  sender.join();
  return periods;
}

TEST(NodeDds, LoopMeasuresThePeriodOfALiveRobotInRealTime) {
  EXPECT_THAT(PeriodsOf(TimeMode::kRealtime, msg::Origin::kLive, 133),
              ElementsAre(0.004, DoubleEq(0.005), DoubleEq(0.003)));
  EXPECT_THAT(PeriodsOf(TimeMode::kRealtime, msg::Origin::kSim, 134),
              ElementsAre(0.004, 0.004, 0.004));
}

TEST(NodeDds, LoopHasTheNominalPeriodInLockstep) {
  EXPECT_THAT(PeriodsOf(TimeMode::kLockstep, msg::Origin::kReplay, 136),
              ElementsAre(0.004, 0.004, 0.004));
}

TEST(NodeDds, LoopRefusesATriggerWithoutAPeriodAndADelayedTrigger) {
  Node node(MakeOptions("loop", 132));
  StopFlag stop;
  for (const double period_s : {0.0, -1.0, std::numeric_limits<double>::infinity(),
                                std::numeric_limits<double>::quiet_NaN()}) {
    TickLoop loop(node, stop, {.nominal_period_s = period_s});
    EXPECT_THAT(
        [&] { loop.AddInput(kReference); },
        ThrowsMessage<std::invalid_argument>(HasSubstr("'reference': it carries no period")))
        << period_s;
    loop.AddInput(kJointState);  // carries its own
    loop.AddInput(kReference);   // no trigger
  }
  TickLoop loop(node, stop);
  EXPECT_THAT([&] { loop.AddInput(kJointState, {.delay_ticks = 1}); },
              ThrowsMessage<std::invalid_argument>(HasSubstr("delay of 1 ticks, expected 0")));
}

TEST(NodeDds, StatusIsLatchedPerComponent) {
  Node a(MakeOptions("first", 124)), b(MakeOptions("second", 124)), late(MakeOptions("late", 124));
  a.SetState(Node::State::kActive, "running");
  b.SetState(Node::State::kFault, "sensor lost");
  auto reader = late.MakeReader(kComponentStatus);
  std::map<std::string, msg::ComponentStatus> seen;
  ASSERT_TRUE(WaitUntil(late, [&] {
    while (const auto status = reader.TakeNext()) seen[status->name] = *status;
    return seen.count("first") && seen.count("second") &&
           seen["first"].state == msg::ComponentState::kActive &&
           seen["second"].state == msg::ComponentState::kFault;
  }));
  EXPECT_EQ(seen["second"].message, "sensor lost");
  EXPECT_EQ(seen["first"].idl_hash, AllTopicsHash());
  EXPECT_GT(seen["first"].resident_MB, 1.0);
}

TEST(NodeDds, AFaultIsHeardByAnObserverThatFindsTheComponentAtItsEnd) {
  std::optional<Node> ends(std::in_place, MakeOptions("ends", 117));
  ends->SetState(Node::State::kFault, "sensor lost");
  std::thread end([&ends] { ends.reset(); });
  Node late(MakeOptions("late", 117));
  auto reader = late.MakeReader(kComponentStatus);
  std::string heard;
  EXPECT_TRUE(WaitUntil(late, [&] {
    while (const auto status = reader.TakeNext()) {
      if (status->name == "ends") heard = status->message;
    }
    return !heard.empty();
  }));
  EXPECT_EQ(heard, "sensor lost");
  end.join();
}

TEST(NodeDds, StatusCountsWhatReadersCouldNotUse) {
  Node a(MakeOptions("a", 173)), b(MakeOptions("b", 173));
  const RawWriter write = a.MakeRawWriter(*FindTopic("joint_state"));
  auto states = b.MakeReader(kJointState);
  auto statuses = a.MakeReader(kComponentStatus);
  for (std::uint64_t tick = 0; tick < 3; ++tick) {
    const Bytes bytes = MalformedState(tick);
    EXPECT_EQ(write(bytes.data(), bytes.size()), WriteStatus::kOk);
  }
  ASSERT_TRUE(WaitUntil(b, [&] { return states.received() == 3; }));
  EXPECT_FALSE(states.TakeNext().has_value());
  b.SetState(Node::State::kActive, "has read");
  ASSERT_TRUE(WaitUntil(a, [&] {
    while (const auto status = statuses.TakeNext()) {
      if (status->message == "has read") return status->malformed_samples == 3;
    }
    return false;
  }));
}

TEST(NodeDds, StatusCountsSamplesThatWereDroppedUnread) {
  Node a(MakeOptions("a", 174, TimeMode::kRealtime)), b(MakeOptions("b", 174, TimeMode::kRealtime));
  auto writer = a.MakeWriter(kOperatorCommand);
  auto reader = b.MakeReader(kOperatorCommand);
  auto statuses = a.MakeReader(kComponentStatus);
  ASSERT_TRUE(WaitUntil(a, [&] { return writer.matched_readers() == 1; }));
  constexpr std::uint64_t kSent = 260, kKept = 256;
  for (std::uint64_t tick = 0; tick < kSent; ++tick) {
    ASSERT_EQ(writer.Write(msg::OperatorCommand()), WriteStatus::kOk);
    ASSERT_TRUE(WaitUntil(b, [&] { return reader.received() == tick + 1; }));
  }
  b.SetState(Node::State::kActive, "has not read");
  ASSERT_TRUE(WaitUntil(a, [&] {
    while (const auto status = statuses.TakeNext()) {
      if (status->message != "has not read") continue;
      return status->dropped_samples == kSent - kKept;
    }
    return false;
  }));
}

TEST(NodeDds, StatusIsPublishedOnceASecondWhileTheLoopGoesRound) {
  Node a(MakeOptions("a", 175)), b(MakeOptions("b", 175));
  a.SetState(Node::State::kActive, "running");
  auto reader = b.MakeReader(kComponentStatus);
  std::vector<std::uint64_t> cycles;
  Node::Counts counts;
  ASSERT_TRUE(WaitUntil(b, [&] {
    ++counts.cycles;
    a.SetCounts(counts);
    while (const auto status = reader.TakeNext()) {
      if (status->name == "a") cycles.push_back(status->cycles);
    }
    return cycles.size() >= 3;
  }));
  EXPECT_LT(cycles[1], cycles[2]);
  // A loop that hangs: nothing more, although the process lives.
  EXPECT_FALSE(WaitUntil(
      b,
      [&] {
        while (const auto status = reader.TakeNext()) {
          if (status->name == "a") cycles.push_back(status->cycles);
        }
        return cycles.size() >= 5;  // one may be under way
      },
      2500ms));
}

TEST(NodeDds, EndpointsAreThoseOfOthersWithTheirNames) {
  Node a(MakeOptions("writer_node", 125)), b(MakeOptions("watcher", 125));
  auto writer = a.MakeWriter(kReference);
  ASSERT_TRUE(WaitUntil(b, [&] {
    for (const Endpoint& endpoint : b.Endpoints()) {
      if (endpoint.topic == "reference" && endpoint.is_writer &&
          endpoint.participant == "writer_node")
        return true;
    }
    return false;
  }));
  for (const Endpoint& endpoint : b.Endpoints()) EXPECT_NE(endpoint.participant, "watcher");
}

TEST(NodeDds, AnotherTypeHashIsReportedAndNeverMatches) {
  Node a(MakeOptions("a", 126)), b(MakeOptions("b", 126));
  TopicInfo other = *FindTopic("reference");
  other.dds_type_name = "sinew::msg::Reference_00000000";
  const auto write = a.MakeRawWriter(other);
  auto reader = b.MakeReader(kReference);
  ASSERT_TRUE(WaitUntil(b, [&] { return !b.Problems().empty(); }));
  EXPECT_THAT(b.Problems(), Contains(HasSubstr("uses type sinew::msg::Reference_00000000")));
  EXPECT_EQ(reader.matched_writers(), 0);
}

TEST(NodeDds, LockstepAndRealTimeEndsReportThatTheyDoNotMatch) {
  Node a(MakeOptions("a", 127, TimeMode::kRealtime)), b(MakeOptions("b", 127, TimeMode::kLockstep));
  auto writer = a.MakeWriter(kReference);
  auto reader = b.MakeReader(kReference);
  ASSERT_TRUE(WaitUntil(b, [&] { return !b.Problems().empty(); }));
  EXPECT_THAT(b.Problems(), Contains(HasSubstr("topic 'reference'")));
}

TEST(NodeDds, DomainsAreApart) {
  Node a(MakeOptions("a", 128)), b(MakeOptions("b", 129)), c(MakeOptions("c", 128));
  auto writer = a.MakeWriter(kReference);
  auto other = b.MakeReader(kReference);
  auto same = c.MakeReader(kReference);
  ASSERT_TRUE(WaitUntil(c, [&] { return same.matched_writers() == 1; }));
  EXPECT_EQ(other.matched_writers(), 0);
}

TEST(NodeDds, AQosFileThatIsNoneIsRefused) {
  // In a fresh process: profiles are loaded once per process.
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  EXPECT_EXIT(
      {
        const std::string path = ::testing::TempDir() + "/bad_qos.xml";
        std::ofstream(path) << "<nothing/>";
        Options options = MakeOptions("a", 130);
        options.qos_path = path;
        try {
          Node node(options);
        } catch (const UsageError& error) {
          std::fprintf(stderr, "%s\n", error.what());
          std::exit(2);
        }
        std::exit(0);
      },
      ::testing::ExitedWithCode(2), "bad_qos.xml: no valid QoS profiles");
}

}  // namespace
}  // namespace sinew::node
