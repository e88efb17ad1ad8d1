// Keeps the ownership strengths of a participant's writers by the rules of ownership.h.
//
// Real time only: in lockstep no topic has owners. Its thread starts with the first writer of an
// EXCLUSIVE topic and sleeps until discovery finds or loses something, a writer has settled, or the
// operator hands over: nothing of it runs in the loop's thread but StepBelow after a stall.
//
// Threads: Add, Remove and Close by the node's owner, StepBelow, Leads and SetCycle by the loop,
// Notify by DDS.
#pragma once

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <thread>
#include <vector>

#include "components/topics/node/command_gate.h"
#include "components/topics/node/node.h"
#include "components/topics/node/ownership.h"

namespace sinew::node::internal {

struct NodeImpl;
struct ReaderImpl;
struct WriterImpl;

class OwnershipKeeper {
 public:
  explicit OwnershipKeeper(NodeImpl& node) : node_(node) {}
  ~OwnershipKeeper();
  OwnershipKeeper(const OwnershipKeeper&) = delete;
  OwnershipKeeper& operator=(const OwnershipKeeper&) = delete;

  void Add(WriterImpl* writer);
  void Remove(WriterImpl* writer);
  // Ends the thread; its reader keeps the node alive until then.
  void Close();

  // This participant was silent for so long, longer than the deadline: its writers go below all
  // others before this returns, or join anew where these may have been forgotten. True: one of
  // both, and false where there are no others.
  bool StepBelow(std::chrono::nanoseconds silence);
  // All writers of this participant are above all others, as far as discovery knows.
  bool Leads();
  // Sets the running cycle: a handover counts for its session only, on live hardware from a live
  // operator only, and never from a recording.
  // stamp_ns: by the provider's clock.
  void SetCycle(std::uint64_t session_id, msg::Origin origin, std::int64_t stamp_ns);
  void Notify();  // discovery found or lost something

 private:
  using Clock = std::chrono::steady_clock;
  struct Entry {
    WriterImpl* writer;
    Clock::time_point settles;
    std::chrono::system_clock::time_point started;  // by the own clock
    Strength first;                                 // FirstStrength of that, by the provider's
    bool settled = false;
  };

  void Start();
  void Run();
  void TakeOperatorCommand(RawSample&& sample);
  Strength FirstOf(std::chrono::system_clock::time_point started) const;
  // With writers_mutex_ held:
  void Settle(Clock::time_point now);
  void HandOver();
  std::optional<Clock::time_point> NextToSettle() const;
  std::vector<Rival> RivalsOf(const WriterImpl& writer) const;

  NodeImpl& node_;
  std::atomic<std::uint64_t> session_id_{0};
  std::atomic<msg::Origin> origin_{};
  std::atomic<std::chrono::nanoseconds> clock_offset_{};  // of the provider
  CommandGate gate_{"handover"};                          // DDS thread
  std::mutex writers_mutex_;  // held while strengths change, so never waited for by DDS threads
  std::vector<Entry> writers_;
  std::mutex news_mutex_;
  std::condition_variable wake_;
  bool news_ = false;
  bool hand_over_ = false;  // acted on when all have settled
  Clock::time_point all_settle_{};
  bool stop_ = false;
  std::unique_ptr<ReaderImpl> operator_command_;
  std::thread thread_;
};

}  // namespace sinew::node::internal
