// HTTP and the Foxglove WebSocket protocol on one port (Boost.Beast).
//
// Threads: the server has one of its own, in which the handler is called: it must not wait.
// Publish, clients and Stop may be called by any thread. A client that reads too slowly loses its
// oldest data (frame_queue.h) and is sent a status that says so; it never delays anybody else, and
// one that does not read at all is closed.
//
// Limits: connections have places (places.h), those without the page's token apart from those whose
// last request had it. The former, however many, close each other only.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "tools/view/protocol.h"
#include "tools/view/request_rule.h"

namespace sinew::live {

struct HttpRequest {
  std::string method;  // "GET"
  std::string path;    // "/api/status"
  std::string query;   // after '?', as sent; may be empty
  std::string body;
  std::string why_no_command;  // request_rule.h; empty: it may command
  std::string page_token;      // for the page, should it be asked for; empty: none
};

struct HttpReply {
  unsigned status = 200;
  std::string content_type = "text/plain; charset=utf-8";
  std::string body;
};

using HttpHandler = std::function<HttpReply(const HttpRequest&)>;

// Connections with the page's token, and as many without: 5 browsers with 6 each to a host.
constexpr std::size_t kMostConnections = 32;
// WebSockets with it, and as many without: the windows of 16 people; 32 kClientBytes are 370 MB.
constexpr std::size_t kMostClients = 16;
// Replies that wait for their reader: two spans of a recording (recorded_view.h), the largest.
constexpr std::size_t kMostReplyBytes = 128u << 20;
// Bytes that may wait for a client: at 2.5 MB/s, all topics of the rig at 240 Hz, more than 3 s.
constexpr std::size_t kQueueBytes = 8u << 20;
constexpr std::size_t kLargestBatch = 1u << 20;  // of the queue, in one frame
// A text of a client: 1000 subscriptions are 40 kB.
constexpr std::size_t kLargestClientText = 64u << 10;
// Memory of a client: its queue, a batch in a vector that doubles, and its text, as it came and as
// values (of the 3 bytes "[]," come 72).
constexpr std::size_t kClientBytes = kQueueBytes + 2 * kLargestBatch + 25 * kLargestClientText;

struct ServerOptions {
  std::string address = "127.0.0.1";  // IPv4, of this host
  unsigned short port = 0;            // 0: any that is free
  int listener = -1;                  // of Listen(address, port); -1: the server's own
  std::string name;                   // in serverInfo
  std::string session;                // in serverInfo; changes with every start
  std::string token;                  // of commands (request_rule.h)
  std::size_t queue_bytes = kQueueBytes;
  // For a request to come. It is one segment: lost twice it comes after 3 s (RFC 6298: 1 s, 2 s).
  std::chrono::milliseconds request_limit{5000};
};

// A socket that listens, for a Server of a process that changes its network meanwhile. Throws
// UsageError naming address and port when they cannot be had.
int Listen(const std::string& address, unsigned short port);

// Counts of a client of the WebSocket.
struct ClientCounts {
  std::string address;  // "127.0.0.1:40312"
  std::size_t subscriptions = 0;
  std::uint64_t sent = 0;  // data frames
  std::uint64_t lost = 0;
  std::size_t waiting = 0;  // frames
};

class Server {
 public:
  // Listens at once. Without channels (numbered from 1 on) there is no WebSocket. Throws UsageError
  // as Listen does.
  Server(const ServerOptions& options, std::vector<Channel> channels, HttpHandler handler);
  ~Server();  // closes all connections
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  unsigned short port() const;
  // Waits for nothing. payload: CDR with its header; stamp_ns: reception, epoch time.
  void Publish(ChannelNumber channel, std::int64_t stamp_ns, std::vector<std::byte> payload);
  std::vector<ClientCounts> clients() const;
  // The handler is not called any more when this returns.
  void Stop();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sinew::live
