#include "components/topics/node/snapshot.h"

#include <sinew_idl/snapshot.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <deque>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "components/topics/node/composition.h"
#include "components/topics/node/helper_thread.h"
#include "components/topics/node/node.h"

namespace sinew::node {
namespace {

constexpr std::size_t kPartBytes = 32768;  // bound of ComponentSnapshot.content
// Parts that may be on their way: half of the history of the profile `event`.
constexpr std::size_t kPartsInFlight = 8;
// A reader that does not take its parts within this does not get the rest.
constexpr std::chrono::milliseconds kTaken(2000);
// Interval at which new readers are looked for, in ticks.
constexpr std::uint64_t kLookEvery = 64;
constexpr std::size_t kMostRequests = 64;  // that wait for their tick
// A reader that asks all the time does not make every cycle copy a state (1.2 MB of rls with 549
// features).
constexpr std::uint64_t kLeastTicksBetween = 64;

}  // namespace

struct SnapshotPublisher::Impl {
  struct Taken {
    Tick tick;
    Bytes content;
  };

  Impl(Node& owner, std::uint32_t of_content)
      : node(owner),
        version(of_content),
        composition(owner.options().composition),
        apart(composition != nullptr && composition->apart()),
        lockstep(owner.options().mode == TimeMode::kLockstep),
        writer(owner.MakeRawWriter(*FindTopic(kComponentSnapshot.name))),
        requests(owner.MakeReader(kSnapshotRequest)) {
    if (!apart) thread = std::thread([this] { Run(); });
  }
  ~Impl() {
    ended = true;
    wake_up.Give();
    if (thread.joinable()) thread.join();
  }

  int Readers() const {
    if (apart) return composition->taken(kComponentSnapshot.name).readers;
    return writer.matched_readers();
  }

  void TakeRequests(const Tick& tick) {
    while (const auto request = requests.TakeNext()) {
      const std::string name = request->name;
      if (request->header.session_id != tick.session_id) continue;
      if (!name.empty() && name != node.options().name) continue;
      if (asked.size() < kMostRequests) asked.push_back(request->after_tick);
    }
  }

  bool Due(const Tick& tick) {
    const bool first = session_id != tick.session_id;
    if (first) {
      session_id = tick.session_id;
      asked.clear();
      last_taken = tick.tick;
    }
    TakeRequests(tick);
    if (!first && tick.tick < last_taken + kLeastTicksBetween) return false;
    const auto due = std::remove_if(asked.begin(), asked.end(), [&](std::uint64_t after_tick) {
      return after_tick <= tick.tick;
    });
    const bool requested = due != asked.end();
    asked.erase(due, asked.end());
    if (!Wanted(first || requested, tick.tick)) return false;
    last_taken = tick.tick;
    return true;
  }

  bool Wanted(bool asked_for, std::uint64_t tick) {
    // Late joiners get it there, and runs with one seed have the same snapshots.
    if (lockstep) return asked_for;
    if (!asked_for && tick % kLookEvery != 0) return false;
    const int now = Readers();
    const bool came = now > readers;
    readers = now;
    return now > 0 && (asked_for || came);
  }

  void SendParts(const Taken& taken) {
    msg::ComponentSnapshot message;
    message.header.session_id = taken.tick.session_id;
    message.header.tick = taken.tick.tick;
    message.header.stamp_ns = taken.tick.stamp_ns;
    message.header.origin = taken.tick.origin;
    message.name = node.options().name;
    message.component_kind = RoleOf(node.options());
    message.version = version;
    const std::size_t parts =
        std::max<std::size_t>(1, (taken.content.size() + kPartBytes - 1) / kPartBytes);
    message.part_count = static_cast<std::uint16_t>(parts);
    Bytes bytes;
    for (std::size_t part = 0; part < parts && !ended; ++part) {
      const std::size_t from = part * kPartBytes;
      const std::size_t size = std::min(kPartBytes, taken.content.size() - from);
      message.part = static_cast<std::uint16_t>(part);
      const auto* begin = reinterpret_cast<const std::uint8_t*>(taken.content.data()) + from;
      message.content.assign(begin, begin + size);
      if (!Encode(message, &bytes)) return;
      if (writer(bytes.data(), bytes.size()) != WriteStatus::kOk) return;
      if ((part + 1) % kPartsInFlight == 0 && !writer.WaitAcknowledged(kTaken)) return;
    }
  }

  void Run() {
    internal::BecomeWriter("sinew-snapshot");
    while (true) {
      wake_up.Wait();
      if (ended) return;
      while (true) {
        std::optional<Taken> next;
        {
          const std::lock_guard<internal::PriorityMutex> lock(mutex);
          if (waiting.empty()) break;
          next = std::move(waiting.front());
          waiting.pop_front();
        }
        SendParts(*next);
        if (ended) return;
      }
    }
  }

  Node& node;
  const std::uint32_t version;
  const Composition* composition;
  const bool apart, lockstep;
  RawWriter writer;
  Reader<msg::SnapshotRequest> requests;
  std::vector<std::uint64_t> asked;  // after which ticks
  std::uint64_t session_id = 0;
  std::uint64_t last_taken = 0;  // tick
  int readers = 0;
  std::atomic<bool> ended{false};
  internal::WakeUp wake_up;
  internal::PriorityMutex mutex;
  std::deque<Taken> waiting;  // of the thread
  std::thread thread;
};

SnapshotPublisher::SnapshotPublisher(Node& node, std::uint32_t version)
    : impl_(std::make_unique<Impl>(node, version)) {}

SnapshotPublisher::~SnapshotPublisher() = default;

bool SnapshotPublisher::Due(const Tick& tick) { return impl_->Due(tick); }

void SnapshotPublisher::Send(const Tick& tick, Bytes content) {
  Impl::Taken taken{tick, std::move(content)};
  if (impl_->apart) {
    impl_->SendParts(taken);
    return;
  }
  {
    const std::lock_guard<internal::PriorityMutex> lock(impl_->mutex);
    impl_->waiting.push_back(std::move(taken));
  }
  impl_->wake_up.Give();
}

}  // namespace sinew::node
