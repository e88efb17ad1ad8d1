// Nodes of one process and one thread that hear each other without DDS in between.
//
// What a composed node writes on a topic of the cycle (states and commands) lies in the queues of
// the other composed nodes' readers when the write returns. DDS gets it in Flush, joint_command
// first, so that other processes see the same topics as ever while the chain of a cycle waits for
// none of them. Readers leave out what DDS brings back to them. Of a topic with owners
// (ownership.h) a composed reader hears the composed writer while DDS says that it is the owner:
// another process takes over from it, and is taken over from, as between processes.
//
// A composition apart has no DDS at all: every topic is carried, from raw writers and to recorders
// too, and nothing else is heard; no participant waits or looks at a clock, in lockstep too. In it
// payloads of any kind reach participants as if received (bench/payloads).
//
// With DDS, real time only. Threads: the one that makes, uses and ends the nodes; Owns: any.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <vector>

#include "components/topics/node/codec.h"
#include "components/topics/node/topics.h"
#include "components/topics/node/writer_id.h"

namespace sinew::node {

namespace internal {
struct ReaderImpl;
struct WriterImpl;
}  // namespace internal

class Composition {
 public:
  enum class Reach { kDds, kApart };

  explicit Composition(Reach reach = Reach::kDds) : reach_(reach) {}
  Composition(const Composition&) = delete;
  Composition& operator=(const Composition&) = delete;

  // Gives DDS what was written since the last time. Returns how many writes failed.
  int Flush();

  bool apart() const { return reach_ == Reach::kApart; }
  // Apart: whether its participants have settled (Tick::settled); at first they have.
  void SetSettled(bool settled) { settled_ = settled; }
  bool settled() const { return settled_; }
  // Counts of a topic, by all readers that there are now.
  struct Taken {
    int readers = 0;
    std::uint64_t received = 0, malformed = 0;
  };
  Taken taken(std::string_view topic) const;

 private:
  friend class Node;
  friend struct internal::ReaderImpl;
  friend struct internal::WriterImpl;

  struct Pending {
    internal::WriterImpl* writer;
    Bytes bytes;
  };

  // Topics of the cycle, others go by DDS alone; apart: all.
  bool Carries(const TopicInfo& topic) const;
  void Add(internal::ReaderImpl* reader);
  void Remove(internal::ReaderImpl* reader);
  void Add(const internal::WriterImpl* writer);
  void Remove(const internal::WriterImpl* writer);
  // Hands the sample to the readers, and keeps it for Flush; `bytes` stays as it is.
  void Write(internal::WriterImpl* writer, const Bytes& bytes);
  bool Owns(const WriterId& writer) const;
  WriterId NewId();  // apart: DDS gives none
  // Name of the participant whose writer it is; nothing: not of this composition.
  std::optional<std::string> NameOf(const WriterId& writer) const;

  const Reach reach_;
  bool settled_ = true;
  std::multimap<std::string, internal::ReaderImpl*> readers_;  // by topic
  mutable std::shared_mutex writers_mutex_;
  std::map<WriterId, const internal::WriterImpl*> writers_;
  std::uint32_t ids_ = 0;
  std::vector<Pending> pending_;
  std::size_t pending_count_ = 0;  // of pending_, whose buffers are used again
};

}  // namespace sinew::node
