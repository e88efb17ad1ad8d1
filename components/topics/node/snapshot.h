// component_snapshot of a participant: the state after a cycle, so that a recording can be run
// again from there (tools/rerun).
//
//   node::Snapshots<Detector> snapshots(node, kStateVersion, &detector);   // has Exchange()
//   ...
//   loop.Publish(output, message, *tick);
//   snapshots.Cycle(*tick);
//
// One is written after the first cycle of a session, after the cycle that a snapshot_request names,
// and in real time when a reader of the topic has come (a recorder); real time: none without
// readers. The cycle's thread copies the state into bytes; another one sends them, in parts. In a
// composition apart, which has one thread, they are sent at once. Between two of them lie 64 cycles
// at least: a request waits for that.
#pragma once

#include <cstdint>
#include <memory>
#include <stdexcept>
#include <string>

#include "components/base/types/state_archive.h"
#include "components/topics/node/codec.h"
#include "components/topics/node/component.h"
#include "components/topics/node/tick_loop.h"

namespace sinew::node {

class SnapshotPublisher {
 public:
  // Throws DdsError.
  SnapshotPublisher(Node& node, std::uint32_t version);
  ~SnapshotPublisher();  // what was not sent yet is dropped
  SnapshotPublisher(const SnapshotPublisher&) = delete;
  SnapshotPublisher& operator=(const SnapshotPublisher&) = delete;

  // A snapshot is to be taken after this cycle.
  bool Due(const Tick& tick);
  void Send(const Tick& tick, Bytes content);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

// The state of `object` to bytes and back. Object: any with Exchange(types::StateArchive&).
template <class Object>
class Snapshots {
 public:
  // version: of the object's fields; another one is not read. The object outlives it.
  Snapshots(Node& node, std::uint32_t version, Object* object)
      : publisher_(node, version), version_(version), object_(object) {}

  void Cycle(const Tick& tick) {
    if (!publisher_.Due(tick)) return;
    types::StateArchive archive;
    object_->Exchange(archive);
    publisher_.Send(tick, archive.Release());
  }
  // Throws std::invalid_argument; the object is then to be thrown away.
  void Restore(const SavedState& saved) {
    if (saved.version != version_) {
      throw std::invalid_argument("state: version " + std::to_string(saved.version) +
                                  ", expected " + std::to_string(version_));
    }
    types::StateArchive archive(saved.content);
    object_->Exchange(archive);
    archive.Finish();
  }

 private:
  SnapshotPublisher publisher_;
  const std::uint32_t version_;
  Object* object_;
};

}  // namespace sinew::node
