// component_snapshot over DDS: when it is taken, and that all parts arrive. Domains 217 and 218.
#include <gtest/gtest.h>
#include <sinew_idl/snapshot.h>

#include <chrono>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/topics/node/node.h"
#include "components/topics/node/snapshot.h"

namespace sinew::node {
namespace {

using namespace std::chrono_literals;

constexpr std::size_t kNumbers = 40000;  // 320 kB: ten parts
constexpr std::uint64_t kSnapshotSession = 77;

struct BigState {
  std::vector<double> numbers = std::vector<double>(kNumbers);
  void Exchange(types::StateArchive& archive) { archive(numbers); }
};

Options Named(const std::string& name, int domain, TimeMode mode) {
  Options options;
  options.component = options.name = name;
  options.domain_id = domain;
  options.mode = mode;
  return options;
}

Tick At(std::uint64_t tick) {
  Tick at;
  at.session_id = kSnapshotSession;
  at.tick = tick;
  return at;
}

class Heard {
 public:
  explicit Heard(Node& node) : reader_(node.MakeReader(kComponentSnapshot)) {}
  int writers() const { return reader_.matched_writers(); }

  // The next whole snapshot; nothing: not within 10 s. wait: called while no part comes.
  std::optional<std::vector<double>> Next(
      std::uint64_t* tick, const std::function<void()>& wait = [] {}) {
    std::vector<std::byte> content;
    std::uint32_t part = 0;
    const auto end = std::chrono::steady_clock::now() + 10s;
    while (std::chrono::steady_clock::now() < end) {
      const auto message = reader_.WaitNext(10ms);
      if (!message) {
        wait();
        continue;
      }
      EXPECT_EQ(message->part, part);
      EXPECT_EQ(message->name, "keeper");
      EXPECT_EQ(message->version, 3u);
      const auto* begin = reinterpret_cast<const std::byte*>(message->content.data());
      content.insert(content.end(), begin, begin + message->content.size());
      if (++part < message->part_count) continue;
      *tick = message->header.tick;
      BigState state;
      types::StateArchive archive(content);
      state.Exchange(archive);
      archive.Finish();
      return state.numbers;
    }
    return std::nullopt;
  }
  bool Nothing() { return !reader_.WaitNext(200ms); }

 private:
  Reader<msg::ComponentSnapshot> reader_;
};

template <class Condition>
bool Within10s(Node& node, const Condition& condition) {
  const auto end = std::chrono::steady_clock::now() + 10s;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    node.WaitForData(20ms);
  }
  return true;
}

void TakesTheFirstCycleAndWhatIsAskedFor(int domain, TimeMode mode) {
  Node keeper(Named("keeper", domain, mode)), recorder(Named("recorder", domain, mode));
  BigState state;
  Snapshots<BigState> snapshots(keeper, 3, &state);
  Heard heard(recorder);
  auto requests = recorder.MakeWriter(kSnapshotRequest);
  ASSERT_TRUE(
      Within10s(recorder, [&] { return heard.writers() == 1 && requests.matched_readers() == 1; }));

  std::uint64_t tick = 99;
  state.numbers[7] = 0.25;
  std::uint64_t next = 0;
  const auto cycle = [&] { snapshots.Cycle(At(next++)); };
  cycle();  // a writer that has not found its reader yet looks again after 64 cycles
  auto numbers = heard.Next(&tick, cycle);
  ASSERT_TRUE(numbers.has_value());
  EXPECT_EQ(tick % 64, 0u);
  EXPECT_EQ(numbers->at(7), 0.25);
  state.numbers[7] = 0.5;
  cycle();
  EXPECT_TRUE(heard.Nothing());

  msg::SnapshotRequest request;
  request.header.session_id = kSnapshotSession;
  request.after_tick = 5;
  for (const char* name : {"another", "keeper"}) {
    request.name = name;
    ASSERT_EQ(requests.Write(request), WriteStatus::kOk);
  }
  numbers = heard.Next(&tick, cycle);
  ASSERT_TRUE(numbers.has_value());
  EXPECT_GE(tick, 64u) << "so long after the first";
  EXPECT_EQ(numbers->at(7), 0.5);
  EXPECT_TRUE(heard.Nothing());

  EXPECT_THROW(snapshots.Restore({4, {}}), std::invalid_argument);
}

TEST(SnapshotDds, InRealTime) { TakesTheFirstCycleAndWhatIsAskedFor(217, TimeMode::kRealtime); }

TEST(SnapshotDds, InLockstep) { TakesTheFirstCycleAndWhatIsAskedFor(218, TimeMode::kLockstep); }

}  // namespace
}  // namespace sinew::node
