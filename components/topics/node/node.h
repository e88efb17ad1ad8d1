// Owner objects for DDS. Every create is checked; a constructor that throws leaves nothing behind.
//
// Fast DDS is included only by this module's .cc files. Readers copy samples in the DDS reception
// thread into a queue; all other calls may come from one thread of the caller. Messages come from
// <sinew_idl/...h> (generated); include the one you use.
#pragma once

#include <sinew_idl/status.h>

#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "components/base/types/fault.h"
#include "components/topics/node/options.h"
#include "components/topics/node/topics.h"
#include "components/topics/node/writer_id.h"

namespace sinew::node {

// Participant, topic, reader or writer could not be made, or QoS did not match.
class DdsError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

enum class [[nodiscard]] WriteStatus{kOk, kTimeout, kFailed};

namespace internal {
struct NodeImpl;
struct ReaderImpl;
struct WriterImpl;
}  // namespace internal

// Queue of received samples of one topic. Movable. The queue is bounded (QueueLimit in
// sample_queue.h): a full one drops its oldest sample and counts it. Real time: 8 samples of states
// and commands, 256 of events and latched topics. Lockstep: 65536, in order.
template <class Message>
class Reader {
 public:
  Reader(Reader&&) noexcept;
  Reader& operator=(Reader&&) noexcept;
  ~Reader();

  std::optional<Message> TakeNext();    // oldest waiting sample
  std::optional<Message> TakeLatest();  // newest; drops the rest
  std::optional<Message> WaitNext(std::chrono::milliseconds timeout);
  // Returns when a sample is waiting here or the timeout is over; sleeps through other topics'
  // samples.
  void WaitForSample(std::chrono::microseconds timeout);
  int matched_writers() const;
  std::uint64_t received() const;  // samples since the start
  std::uint64_t lost() const;      // samples that DDS reports as lost
  std::uint64_t dropped() const;   // samples dropped unread because the queue was full
  // Samples that were no such message or had no meaning (codec.h); they are never handed on.
  std::uint64_t malformed() const;
  // The writer of the sample that was taken last.
  const WriterId& writer() const { return writer_; }

 private:
  friend class Node;
  WriterId writer_{};
  explicit Reader(std::shared_ptr<internal::ReaderImpl> impl);
  std::shared_ptr<internal::ReaderImpl> impl_;
};

template <class Message>
class Writer {
 public:
  Writer(Writer&&) noexcept;
  Writer& operator=(Writer&&) noexcept;
  ~Writer();  // in lockstep waits up to 2 s until every reader has everything

  WriteStatus Write(const Message& message);
  int matched_readers() const;

 private:
  friend class Node;
  explicit Writer(std::shared_ptr<internal::WriterImpl> impl);
  std::shared_ptr<internal::WriterImpl> impl_;
};

// A sample of any topic as it travelled: CDR with its 4-byte header.
struct RawSample {
  std::string topic;
  std::vector<std::byte> payload;
  std::int64_t source_stamp_ns = 0;     // writer's clock
  std::int64_t reception_stamp_ns = 0;  // epoch time
  WriterId writer{};
  // DDS numbers the samples of a writer from 1 on, without gaps. 0: not known (composition.h).
  std::uint64_t sequence = 0;
};

// Writes payloads as they are. Copies write through the same DDS writer.
class RawWriter {
 public:
  WriteStatus operator()(const std::byte* payload, std::size_t size) const;
  int matched_readers() const;
  // True once every matched reliable reader has everything (best-effort readers are not waited
  // for).
  bool WaitAcknowledged(std::chrono::milliseconds timeout) const;
  // Strength on an EXCLUSIVE topic, in real time: now; it changes by the rules of ownership.h.
  std::uint32_t strength() const;

 private:
  friend class Node;
  explicit RawWriter(std::shared_ptr<internal::WriterImpl> impl);
  std::shared_ptr<internal::WriterImpl> impl_;
};

struct Endpoint;  // endpoint.h

class Node {
 public:
  // joint_names: of those that it commands, in order, for JointNamesOf at other nodes; empty where
  // it commands none. Without component_status where its certificate of DDS security forbids it:
  // what may write nothing still reads. Throws DdsError.
  explicit Node(const Options& options, const std::vector<std::string>& joint_names = {});
  ~Node();
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  template <class Message>
  Reader<Message> MakeReader(const Topic<Message>& topic);
  // One of several writers of an EXCLUSIVE topic is heard, by the rules of ownership.h.
  template <class Message>
  Writer<Message> MakeWriter(const Topic<Message>& topic);

  // Untyped ends for recorders and players. The callback runs in a DDS thread: copy and return.
  // wakes: samples end WaitForData. A callback that hands its sample to another thread needs none.
  // Of the log nothing, with a warning, where the QoS profiles lack its own.
  using RawCallback = std::function<void(RawSample&&)>;
  void ReadRaw(const TopicInfo& topic, RawCallback callback, bool wakes = true);
  RawWriter MakeRawWriter(const TopicInfo& topic);
  // Number of writers matched to the raw readers of a topic.
  int RawMatchedWriters(const std::string& topic) const;
  // Samples that DDS reports as lost to the raw readers of a topic (SAMPLE_LOST).
  std::uint64_t RawLost(const std::string& topic) const;

  // Name and GUID of a writer: an endpoint of this participant or a discovered one; nothing for one
  // that has gone.
  struct WriterName {
    std::string participant, guid;
    bool own = false;
  };
  std::optional<WriterName> NameOf(const WriterId& writer) const;
  // The joint names of the node whose writer it is; empty: it has none, is not known, or has gone.
  std::vector<std::string> JointNamesOf(const WriterId& writer) const;
  // This node's own writer. Cheap, unlike NameOf.
  bool Owns(const WriterId& writer) const;
  // The nominal period of the cycle, once it is known or when it has changed: it sets how long the
  // owner of a topic may be silent (ownership.h).
  void SetPeriod(std::chrono::nanoseconds period);

  // Endpoints of other participants seen so far, and problems (other type hash, incompatible QoS).
  std::vector<Endpoint> Endpoints() const;
  // Grows with every change of them or of their participants; for loops.
  std::uint64_t EndpointChanges() const;
  std::vector<std::string> Problems() const;

  // component_status, published by a thread beside the loop: at once when the state or message
  // changes, and once a second while the loop calls SetCycle, SetCounts or any wait of this node.
  using State = msg::ComponentState;
  void SetState(State state, const std::string& message = "", const types::Fault& fault = {});
  // Another participant is heard in this one's place (other_owner.h).
  void SetStandby(bool standby);
  // The participant whose recording may move live hardware, as this one decides; empty: none.
  void SetPermittedReplay(const std::string& participant);
  struct Counts {
    std::uint64_t cycles = 0, stale_inputs = 0, missed_ticks = 0, write_failures = 0;
  };
  void SetCounts(const Counts& counts);
  // The cycle that component_status speaks of.
  void SetCycle(std::uint64_t session_id, std::uint64_t tick, std::int64_t stamp_ns,
                msg::Origin origin);

  // Blocks until anything arrived on any reader of this node, or the timeout.
  bool WaitForData(std::chrono::microseconds timeout);
  // Any thread: the present WaitForData, or else the next one, returns at once.
  void Wake();

  bool has_security() const;  // DDS security, by its QoS profiles

  const Options& options() const;

 private:
  friend class TickLoop;
  std::shared_ptr<internal::NodeImpl> impl_;
};

}  // namespace sinew::node
