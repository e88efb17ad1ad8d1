#include "components/topics/node/ownership_keeper.h"

#include <sinew_idl/operator.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "components/topics/node/codec.h"
#include "components/topics/node/node_impl.h"
#include "components/topics/node/realtime.h"

namespace sinew::node::internal {

OwnershipKeeper::~OwnershipKeeper() { Close(); }

void OwnershipKeeper::Add(WriterImpl* writer) {
  const Clock::time_point settles = Clock::now() + kSettleTime;
  const auto started = std::chrono::system_clock::now();
  {
    const std::lock_guard<std::mutex> lock(writers_mutex_);
    writers_.push_back(
        {.writer = writer, .settles = settles, .started = started, .first = FirstOf(started)});
  }
  {
    const std::lock_guard<std::mutex> lock(news_mutex_);
    all_settle_ = settles;
  }
  if (thread_.joinable()) {
    Notify();
  } else {
    Start();
  }
}

void OwnershipKeeper::Remove(WriterImpl* writer) {
  const std::lock_guard<std::mutex> lock(writers_mutex_);
  std::erase_if(writers_, [writer](const Entry& entry) { return entry.writer == writer; });
}

void OwnershipKeeper::Start() {
  operator_command_ = std::make_unique<ReaderImpl>(
      node_.shared_from_this(), *FindTopic(kOperatorCommand.name),
      [this](RawSample&& sample) { TakeOperatorCommand(std::move(sample)); });
  thread_ = std::thread([this] { Run(); });
}

void OwnershipKeeper::Close() {
  {
    const std::lock_guard<std::mutex> lock(news_mutex_);
    stop_ = true;
  }
  wake_.notify_one();
  if (thread_.joinable()) thread_.join();
  operator_command_.reset();
}

void OwnershipKeeper::SetCycle(std::uint64_t session_id, msg::Origin origin,
                               std::int64_t stamp_ns) {
  const bool is_new = session_id_.exchange(session_id, std::memory_order_relaxed) != session_id;
  origin_.store(origin, std::memory_order_relaxed);
  if (!is_new || origin == msg::Origin::kReplay) return;
  const auto offset = ClockOffset(stamp_ns, std::chrono::system_clock::now());
  if (clock_offset_.exchange(offset) == offset) return;
  spdlog::warn("the clock of the state provider is {:.0f} s ahead of this host's",
               std::chrono::duration<double>(offset).count());
  Notify();
}

Strength OwnershipKeeper::FirstOf(std::chrono::system_clock::time_point started) const {
  return FirstStrength(started + std::chrono::duration_cast<std::chrono::system_clock::duration>(
                                     clock_offset_.load()));
}

void OwnershipKeeper::Notify() {
  {
    const std::lock_guard<std::mutex> lock(news_mutex_);
    news_ = true;
  }
  wake_.notify_one();
}

void OwnershipKeeper::TakeOperatorCommand(RawSample&& sample) {
  msg::OperatorCommand command;
  if (!Decode(sample.payload, &command) || command.action != msg::OperatorAction::kHandover) return;
  const types::RunningSession running{session_id_.load(std::memory_order_relaxed),
                                      origin_.load(std::memory_order_relaxed)};
  if (command.target != node_.options.name) {
    // The last handover counts: one to this participant that has not been acted on is superseded.
    if (command.role == RoleOf(node_.options) &&
        types::RefusalOf(types::CommandKind::kPermission, command.header, running) ==
            types::CommandRefusal::kNone) {
      const std::lock_guard<std::mutex> lock(news_mutex_);
      hand_over_ = false;
    }
    return;
  }
  if (!gate_.Admits(types::CommandKind::kPermission, command.header, running)) {
    return;
  }
  if (command.role != RoleOf(node_.options)) {
    spdlog::warn("handover of '{}' refused: this is '{}'", command.role, RoleOf(node_.options));
    return;
  }
  {
    const std::lock_guard<std::mutex> lock(news_mutex_);
    hand_over_ = true;
  }
  wake_.notify_one();
}

void OwnershipKeeper::Run() {
  std::optional<Clock::time_point> next = Clock::now();
  while (true) {
    bool hand_over = false;
    {
      std::unique_lock<std::mutex> lock(news_mutex_);
      const auto may_take_over = [this] { return hand_over_ && Clock::now() >= all_settle_; };
      const auto roused = [&] { return stop_ || news_ || may_take_over(); };
      if (next) {
        wake_.wait_until(lock, *next, roused);
      } else {
        wake_.wait(lock, roused);
      }
      if (stop_) return;
      news_ = false;
      hand_over = may_take_over();
      if (hand_over) hand_over_ = false;
    }
    const std::lock_guard<std::mutex> lock(writers_mutex_);
    if (hand_over) {
      BeginRealtime();  // before its first command counts
      HandOver();
    }
    Settle(Clock::now());
    next = NextToSettle();
  }
}

std::optional<OwnershipKeeper::Clock::time_point> OwnershipKeeper::NextToSettle() const {
  std::optional<Clock::time_point> next;
  for (const Entry& entry : writers_) {
    if (!entry.settled && (!next || entry.settles < *next)) next = entry.settles;
  }
  return next;
}

std::vector<Rival> OwnershipKeeper::RivalsOf(const WriterImpl& writer) const {
  std::vector<Rival> rivals;
  for (const Endpoint& endpoint : node_.discovery.endpoints()) {
    if (endpoint.is_writer && endpoint.topic == writer.topic.name) {
      rivals.push_back({endpoint.guid, endpoint.strength});
    }
  }
  return rivals;
}

void OwnershipKeeper::Settle(Clock::time_point now) {
  for (Entry& entry : writers_) {
    const std::vector<Rival> rivals = RivalsOf(*entry.writer);
    const Strength before = std::exchange(entry.first, FirstOf(entry.started));
    if (entry.settled && rivals.empty() && entry.writer->strength() == before) {
      entry.writer->SetStrength(entry.first);
    } else if (entry.settled) {
      entry.writer->SetStrength(
          StrengthWithoutTie(entry.writer->strength(), entry.writer->guid(), rivals));
    } else if (now >= entry.settles) {
      entry.settled = true;
      entry.writer->SetStrength(SettledStrength(entry.first, rivals));
      if (!rivals.empty()) {
        spdlog::info("topic '{}': another participant writes it, this one stands by",
                     entry.writer->topic.name);
      }
    }
  }
}

void OwnershipKeeper::HandOver() {
  for (Entry& entry : writers_) {
    entry.settled = true;
    entry.writer->SetStrength(
        StrengthAbove(entry.writer->strength(), entry.first, RivalsOf(*entry.writer)));
  }
  spdlog::info("handover: '{}' takes over", node_.options.name);
}

bool OwnershipKeeper::Leads() {
  const std::lock_guard<std::mutex> lock(writers_mutex_);
  return std::all_of(writers_.begin(), writers_.end(), [this](const Entry& entry) {
    return internal::Leads(entry.writer->strength(), RivalsOf(*entry.writer));
  });
}

bool OwnershipKeeper::StepBelow(std::chrono::nanoseconds silence) {
  const std::lock_guard<std::mutex> lock(writers_mutex_);
  const Clock::time_point settles = Clock::now() + kSettleTime;
  bool stepped = false;
  for (Entry& entry : writers_) {
    const Strength before = entry.writer->strength();
    if (silence >= kForgottenAfter) {
      entry.settled = false;
      entry.settles = settles;
      entry.started = std::chrono::system_clock::now();
      entry.writer->SetStrength(kJoiningStrength);
    } else if (entry.settled) {
      entry.writer->SetStrength(StrengthBelow(before, RivalsOf(*entry.writer)));
    }
    stepped = stepped || entry.writer->strength() != before;
  }
  if (stepped && silence >= kForgottenAfter) {
    spdlog::warn("silent for {:.1f} s: another participant may have taken over, joining anew",
                 std::chrono::duration<double>(silence).count());
    {
      const std::lock_guard<std::mutex> news_lock(news_mutex_);
      all_settle_ = settles;
    }
    Notify();
  } else if (stepped) {
    spdlog::warn("silent for too long: another participant has taken over");
  }
  return stepped;
}

}  // namespace sinew::node::internal
