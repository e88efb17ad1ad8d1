// Nodes of one process and one thread that hear each other without DDS in between.
//
// What a composed node writes on a topic of the cycle (states and commands) lies in the queues of
// the other composed nodes' readers when the write returns. DDS gets it in Flush, joint_command
// first, so that other processes see the same topics as ever while the chain of a cycle waits for
// none of them. Readers leave out what DDS brings back to them. Of a topic with owners
// (ownership.h) a composed reader hears the composed writer while DDS says that it is the owner:
// another process takes over from it, and is taken over from, as between processes.
//
// Real time only. Threads: the one that makes, uses and ends the nodes; Owns: any.
#pragma once

#include <cstddef>
#include <map>
#include <memory>
#include <set>
#include <shared_mutex>
#include <string>
#include <vector>

#include "components/node/codec.h"
#include "components/node/topics.h"
#include "components/node/writer_id.h"

namespace sinew::node {

namespace internal {
struct ReaderImpl;
struct WriterImpl;
}  // namespace internal

class Composition {
 public:
  Composition() = default;
  Composition(const Composition&) = delete;
  Composition& operator=(const Composition&) = delete;

  // Gives DDS what was written since the last time. Returns how many writes failed.
  int Flush();

 private:
  friend struct internal::ReaderImpl;
  friend struct internal::WriterImpl;

  struct Pending {
    internal::WriterImpl* writer;
    Bytes bytes;
  };

  // Topics of the cycle; others go by DDS alone.
  static bool Carries(const TopicInfo& topic);
  void Add(internal::ReaderImpl* reader);
  void Remove(internal::ReaderImpl* reader);
  void Add(const internal::WriterImpl* writer);
  void Remove(const internal::WriterImpl* writer);
  // Hands the sample to the readers, and keeps it for Flush; `bytes` stays as it is.
  void Write(internal::WriterImpl* writer, const Bytes& bytes);
  bool Owns(const WriterId& writer) const;

  std::multimap<std::string, internal::ReaderImpl*> readers_;  // by topic
  mutable std::shared_mutex writers_mutex_;
  std::set<WriterId> writers_;
  std::vector<Pending> pending_;
  std::size_t pending_count_ = 0;  // of pending_, whose buffers are used again
};

}  // namespace sinew::node
