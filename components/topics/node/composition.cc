#include "components/topics/node/composition.h"

#include <algorithm>
#include <mutex>

#include "components/base/types/clock/clock.h"
#include "components/topics/node/node_impl.h"
#include "components/topics/node/reader_impl.h"
#include "components/topics/node/writer_impl.h"

namespace sinew::node {

bool Composition::Carries(const TopicInfo& topic) const {
  return apart() || topic.profile == Profile::kState || IsExclusive(topic.profile);
}

void Composition::Add(internal::ReaderImpl* reader) {
  if (Carries(reader->topic)) readers_.emplace(reader->topic.name, reader);
}

void Composition::Remove(internal::ReaderImpl* reader) {
  std::erase_if(readers_, [reader](const auto& entry) { return entry.second == reader; });
}

void Composition::Add(const internal::WriterImpl* writer) {
  if (!Carries(writer->topic)) return;
  const std::unique_lock<std::shared_mutex> lock(writers_mutex_);
  writers_.emplace(writer->id(), writer);
}

void Composition::Remove(const internal::WriterImpl* writer) {
  for (std::size_t k = 0; k < pending_count_; ++k) {
    if (pending_[k].writer == writer) pending_[k].writer = nullptr;
  }
  const std::unique_lock<std::shared_mutex> lock(writers_mutex_);
  writers_.erase(writer->id());
}

Composition::Taken Composition::taken(std::string_view topic) const {
  Taken taken;
  const auto [first, last] = readers_.equal_range(std::string(topic));
  for (auto entry = first; entry != last; ++entry) {
    ++taken.readers;
    taken.received += entry->second->received();
    taken.malformed += entry->second->malformed();
  }
  return taken;
}

bool Composition::Owns(const WriterId& writer) const {
  const std::shared_lock<std::shared_mutex> lock(writers_mutex_);
  return writers_.contains(writer);
}

WriterId Composition::NewId() {
  ++ids_;
  WriterId id{};
  for (std::size_t i = 0; i < sizeof(ids_); ++i) {
    id[id.size() - 1 - i] = static_cast<std::uint8_t>(ids_ >> (8 * i));
  }
  return id;
}

std::optional<std::string> Composition::NameOf(const WriterId& writer) const {
  const std::shared_lock<std::shared_mutex> lock(writers_mutex_);
  const auto found = writers_.find(writer);
  if (found == writers_.end()) return std::nullopt;
  return found->second->node->options.name;
}

void Composition::Write(internal::WriterImpl* writer, const Bytes& bytes) {
  const std::int64_t now_ns = types::EpochNow_ns();
  const auto [first, last] = readers_.equal_range(writer->topic.name);
  for (auto entry = first; entry != last; ++entry) {
    if (entry->second->node == writer->node) continue;
    entry->second->TakeComposed(bytes, now_ns, writer->id());
  }
  if (apart()) return;
  if (pending_count_ == pending_.size()) pending_.emplace_back();
  pending_[pending_count_].writer = writer;
  pending_[pending_count_].bytes = bytes;
  ++pending_count_;
}

int Composition::Flush() {
  int failed = 0;
  const auto write = [&](bool joint_command) {
    for (std::size_t k = 0; k < pending_count_; ++k) {
      Pending& pending = pending_[k];
      if (pending.writer == nullptr) continue;
      if ((pending.writer->topic.name == kJointCommand.name) != joint_command) continue;
      if (pending.writer->WriteToDds(&pending.bytes) != WriteStatus::kOk) ++failed;
    }
  };
  write(true);
  write(false);
  pending_count_ = 0;
  return failed;
}

}  // namespace sinew::node
