#include "tools/view/frame_queue.h"

#include <algorithm>
#include <utility>

namespace sinew::live {

std::size_t Frame::size() const {
  return sizeof(Frame) + (payload ? payload->size() : text.size());
}

void FrameQueue::Push(Frame frame) {
  if (!frame.payload) {
    ++texts_;
  } else {
    const std::size_t size = frame.size();
    // Texts are few and at the front: the first data frame is found at once.
    while (data_bytes_ > 0 && data_bytes_ + size > limit_bytes_) {
      const auto oldest = std::find_if(frames_.begin(), frames_.end(), [](const Frame& waiting) {
        return waiting.payload != nullptr;
      });
      data_bytes_ -= oldest->size();
      frames_.erase(oldest);
      ++lost_;
    }
    data_bytes_ += size;
  }
  frames_.push_back(std::move(frame));
}

std::optional<Frame> FrameQueue::Pop() {
  if (frames_.empty()) return std::nullopt;
  Frame frame = std::move(frames_.front());
  frames_.pop_front();
  if (frame.payload) {
    data_bytes_ -= frame.size();
  } else {
    --texts_;
  }
  return frame;
}

std::vector<Frame> FrameQueue::PopData(std::size_t most_bytes) {
  std::vector<Frame> popped;
  std::size_t bytes = 0;
  while (!frames_.empty() && frames_.front().payload) {
    bytes += frames_.front().size();
    if (!popped.empty() && bytes > most_bytes) break;
    popped.push_back(*Pop());
  }
  return popped;
}

}  // namespace sinew::live
