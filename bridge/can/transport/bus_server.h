// The bus between processes: a process that joins its socket is a node. Frames arbitrate and take
// their time as BusModel says; every other node gets them with the stamp of their last bit.
//
// One thread calls RunOnce in a loop. A client that does not read loses frames (counted), never the
// others.
#pragma once

#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

#include "bridge/can/bus_model.h"
#include "components/base/config/descriptor.h"
#include "components/base/config/unix_socket.h"

namespace sinew::can {

class BusServer {
 public:
  // Listens on BusSocketPath(bus); a process of a user whom SocketFolder::Admits not is no node.
  // Throws UsageError when the path cannot be used or a server
  // already lives there; what a killed one left behind is removed.
  BusServer(const std::string& bus, const BusConfig& config);
  ~BusServer();
  BusServer(const BusServer&) = delete;
  BusServer& operator=(const BusServer&) = delete;

  // Waits for the next thing to happen, at most `timeout`, and does what is due.
  void RunOnce(std::chrono::nanoseconds timeout);

  // Called for every frame that was on the bus.
  void OnFrame(std::function<void(const Delivery&)> callback) { on_frame_ = std::move(callback); }

  const BusCounters& counters() const { return model_.counters(); }
  int clients() const { return static_cast<int>(clients_.size()); }
  std::uint64_t lost() const { return lost_; }  // packets clients had no space for
  const std::string& path() const { return path_; }

 private:
  struct Client {
    int node = -1;
    NodeHealth health = NodeHealth::kActive;
  };
  void Accept();
  void Read(int socket, std::int64_t now_ns);
  void Drop(int socket);
  void Deliver(const Delivery& delivery);
  void SendErrorsAndHealth();
  void SendTo(int socket, const void* data, std::size_t size);

  std::string path_;
  config::SocketFolder folder_;
  config::Descriptor listener_;
  BusModel model_;
  std::map<int, Client> clients_;  // by socket
  std::function<void(const Delivery&)> on_frame_;
  std::uint64_t lost_ = 0;
  std::uint64_t sent_errors_ = 0;
};

}  // namespace sinew::can
