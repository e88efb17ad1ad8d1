// A client of the page's server on a socket, for tests: HTTP and WebSocket, byte by byte.
#pragma once

#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <string>
#include <string_view>
#include <thread>

namespace sinew::live {

constexpr std::chrono::seconds kClientLimit(20);

// headers: of lines that end with "\r\n".
inline std::string RequestText(unsigned short port, const std::string& line,
                               const std::string& headers) {
  return line + " HTTP/1.1\r\nHost: 127.0.0.1:" + std::to_string(port) + "\r\n" + headers + "\r\n";
}

inline std::string UpgradeRequest(unsigned short port, const std::string& target,
                                  const std::string& origin,
                                  const std::string& subprotocols = "foxglove.websocket.v1") {
  return RequestText(port, "GET " + target,
                     "Connection: Upgrade\r\nUpgrade: websocket\r\nSec-WebSocket-Version: 13\r\n"
                     "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\nSec-WebSocket-Protocol: " +
                         subprotocols + "\r\n" +
                         (origin.empty() ? "" : "Origin: " + origin + "\r\n"));
}

// RFC 6455, 5.2: a text of less than 65536 bytes, masked with zeros.
inline std::string TextFrame(const std::string& text) {
  std::string frame = {static_cast<char>(0x81)};
  if (text.size() < 126) {
    frame += static_cast<char>(0x80 | text.size());
  } else {
    frame += {static_cast<char>(0x80 | 126), static_cast<char>(text.size() >> 8),
              static_cast<char>(text.size() & 0xff)};
  }
  return frame + std::string(4, '\0') + text;
}

class Connection {
 public:
  explicit Connection(unsigned short port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    const timeval limit{kClientLimit.count(), 0};
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof limit);
    const int small = 16 << 10;
    ::setsockopt(socket_, SOL_SOCKET, SO_RCVBUF, &small, sizeof small);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(port);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    connected_ = ::connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof address) == 0;
  }
  ~Connection() { ::close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  bool connected() const { return connected_; }
  void Send(const std::string& bytes) { ASSERT_TRUE(TrySend(bytes, kClientLimit)); }
  // False: the other end has closed, or has taken nothing for so long.
  bool TrySend(std::string_view bytes, std::chrono::milliseconds limit) {
    while (!bytes.empty()) {
      pollfd ready{socket_, POLLOUT, 0};
      if (::poll(&ready, 1, static_cast<int>(limit.count())) <= 0) return false;
      const ssize_t sent = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
    return true;
  }
  // Exactly so many bytes; fewer when the time is over or the other end has closed.
  std::string Read(std::size_t size) {
    std::string bytes(size, '\0');
    std::size_t done = 0;
    while (done < size) {
      const ssize_t more = ::recv(socket_, bytes.data() + done, size - done, 0);
      if (more <= 0) break;
      done += static_cast<std::size_t>(more);
    }
    bytes.resize(done);
    return bytes;
  }
  std::string ReadHead() {
    std::string head;
    while (!head.ends_with("\r\n\r\n")) {
      const std::string next = Read(1);
      if (next.empty()) break;
      head += next;
    }
    return head;
  }
  // All until the other end closes.
  std::string ReadAll() {
    std::string all;
    for (std::string next = Read(4096); !next.empty(); next = Read(4096)) all += next;
    return all;
  }
  void SendText(const std::string& text) { Send(TextFrame(text)); }
  struct Received {
    bool text = false;
    std::string payload;
  };
  Received ReadFrame() {
    const std::string head = Read(2);
    if (head.size() < 2) return {};
    std::size_t size = static_cast<unsigned char>(head[1]);
    if (size >= 126) {
      const std::string length = Read(size == 126 ? 2 : 8);
      size = 0;
      for (const char byte : length) size = size << 8 | static_cast<unsigned char>(byte);
    }
    return {(head[0] & 15) == 1, Read(size)};
  }
  void Upgrade(unsigned short port, const std::string& subprotocols = "foxglove.websocket.v1",
               const std::string& chosen = "foxglove.websocket.v1") {
    Send(UpgradeRequest(port, "/", "", subprotocols));
    const std::string head = ReadHead();
    EXPECT_THAT(head, ::testing::StartsWith("HTTP/1.1 101"));
    EXPECT_THAT(head, ::testing::HasSubstr("Sec-WebSocket-Protocol: " + chosen + "\r\n"));
    EXPECT_THAT(ReadFrame().payload, ::testing::HasSubstr("serverInfo"));
    EXPECT_THAT(ReadFrame().payload, ::testing::HasSubstr("advertise"));
  }

 private:
  int socket_;
  bool connected_ = false;
};

inline bool WaitUntil(const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + kClientLimit;
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    std::this_thread::yield();
  }
  return true;
}

}  // namespace sinew::live
