// Places for what a peer can open any number of: connections, WebSockets, replies on their way.
// Bounded, and a further one is always let in: it closes the oldest of the owner that has most, so
// that the many of one owner never close the few of another. One thread.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <list>
#include <string>
#include <utility>

namespace sinew::live {

class Places {
 public:
  // Sum of the weights that may be there; a single one that weighs more is there alone.
  explicit Places(std::size_t most) : most_(most) {}

  std::size_t taken() const { return taken_; }

 private:
  friend class Place;
  struct Entry {
    std::uint64_t number;
    std::string owner;
    std::size_t weight;
    std::function<void()> close;
  };

  std::uint64_t Take(std::string owner, std::size_t weight, std::function<void()> close);
  void Leave(std::uint64_t number);  // does nothing after close()
  // The oldest one of the owner that has most, the newcomer's weight counted with its owner.
  std::list<Entry>::iterator ToClose(const std::string& owner, std::size_t weight);

  const std::size_t most_;
  std::size_t taken_ = 0;
  std::uint64_t next_ = 0;
  std::list<Entry> entries_;  // the oldest first
};

// A place while it lives. close: called once, when a newer one takes the place.
class Place {
 public:
  Place(Places* places, std::string owner, std::size_t weight, std::function<void()> close)
      : places_(places), number_(places->Take(std::move(owner), weight, std::move(close))) {}
  ~Place() { places_->Leave(number_); }
  Place(const Place&) = delete;
  Place& operator=(const Place&) = delete;

 private:
  Places* places_;
  std::uint64_t number_;
};

}  // namespace sinew::live
