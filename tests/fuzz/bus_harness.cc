#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <deque>
#include <map>
#include <string>
#include <vector>

#include "bridge/can/bit_timing.h"
#include "bridge/can/bus_model.h"
#include "bridge/can/transport/bus_protocol.h"
#include "bridge/can/transport/bus_server.h"
#include "tests/fuzz/harness.h"
#include "tests/fuzz/property.h"

namespace sinew::fuzz {
namespace {

constexpr int kMostOps = 2000;

int Connect(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.size() >= sizeof address.sun_path) return -1;
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  const int client = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
  if (::connect(client, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0)
    return client;
  ::close(client);
  return -1;
}

}  // namespace

void RunBusModel(std::span<const std::uint8_t> input) {
  Bytes bytes(input);
  can::BusConfig config;
  config.queue_frames = 1 + bytes.Byte() % 8;
  config.restart_ns = bytes.Byte() % 4 == 0 ? -1 : 1'000'000;
  can::BusModel bus(config);
  std::int64_t now_ns = 0;
  std::int64_t free_ns = 0;
  std::map<int, std::deque<can::Frame>> offered;  // of the nodes on the bus
  const auto deliver = [&](const can::Delivery& d) {
    Check(can::IsValid(d.frame) && !d.frame.error, "an impossible frame was delivered");
    Check(!d.senders.empty(), "a frame without a sender");
    Check(d.end_ns <= now_ns, "a frame from the future");
    Check(d.end_ns - 1000 * can::FrameBits(d.frame) >= free_ns, "two frames at once");
    free_ns = d.end_ns;
    for (const int sender : d.senders) {
      // Bus-off throws the queue away: what comes is then a later one, never an unknown one.
      auto& queue = offered[sender];
      while (!queue.empty() && !(queue.front() == d.frame)) queue.pop_front();
      Check(!queue.empty(), "a frame was delivered that was not offered, or twice");
      queue.pop_front();
    }
  };
  std::vector<int> nodes;
  for (int op = 0; op < kMostOps && !bytes.empty(); ++op) {
    const std::uint8_t choice = bytes.Byte();
    switch (choice % 8) {
      case 0:
        if (nodes.size() < 16) {
          nodes.push_back(bus.Attach());
          offered[nodes.back()].clear();
        }
        break;
      case 1:
        if (!nodes.empty()) {
          const auto it = nodes.begin() + (choice >> 3) % static_cast<int>(nodes.size());
          bus.Detach(*it);
          nodes.erase(it);
        } else {
          bus.Detach(choice);
        }
        break;
      case 2:
      case 3:
        now_ns += 1000 * bytes.Byte();
        bus.Advance(now_ns, deliver);
        break;
      default: {
        can::Frame frame = bytes.Frame();
        if ((choice & 0x80) != 0) {  // a possible one, of few identifiers, so that they collide
          frame.error = frame.extended = false;
          frame.id &= 3;
          frame.length = static_cast<std::uint8_t>(frame.length % 9);
          std::fill(frame.data.begin() + (frame.remote ? 0 : frame.length), frame.data.end(),
                    std::uint8_t{0});
        }
        const int node =
            nodes.empty() ? choice >> 3 : nodes[(choice >> 3) % std::size_t(nodes.size())];
        const int before = nodes.empty() ? 0 : bus.queued(node);
        if (bus.Offer(node, frame, now_ns)) {
          Check(!nodes.empty() && can::IsValid(frame) && before < config.queue_frames,
                "an offer was taken that must be refused");
          offered[node].push_back(frame);
        }
        break;
      }
    }
    if (const auto end = bus.NextEnd()) Check(*end >= free_ns, "the next end lies in the past");
  }
  now_ns += 100'000'000;
  bus.Advance(now_ns, deliver);
  Check(bus.counters().busy_ns <= now_ns, "busy for longer than there was time");
  for (const int node : nodes)
    Check(bus.queued(node) == 0, "a frame stayed though the bus is free");
}

std::vector<Input> BusModelSeeds() {
  std::vector<Input> seeds;
  for (int nodes = 1; nodes <= 3; ++nodes) {
    Input seed{3, 1};
    seed.insert(seed.end(), static_cast<std::size_t>(nodes), 0);
    for (int i = 0; i < 24; ++i) {
      seed.push_back(static_cast<std::uint8_t>(0x84 | i << 3));
      can::Frame frame;
      frame.id = static_cast<std::uint32_t>(i / 3);
      frame.length = static_cast<std::uint8_t>(i % 9);
      frame.remote = i % 7 == 0;
      frame.data.fill(static_cast<std::uint8_t>(17 * i));
      Append(seed, frame);
      if (i % 4 == 0) seed.insert(seed.end(), {2, 100});
      if (i == 17) seed.push_back(1);
    }
    seeds.push_back(seed);
  }
  return seeds;
}

// One server for all inputs; a well-behaved client stays, a hostile one comes with each input.
void RunBusServer(std::span<const std::uint8_t> input) {
  static can::BusServer server("/tmp/sinew-fuzz-" + std::to_string(::getpid()) + ".sock",
                               can::BusConfig{});
  static bool possible = true;
  static const int witness = [] {
    server.OnFrame([](const can::Delivery& d) {
      possible = possible && can::IsValid(d.frame) && !d.frame.error;
    });
    const int client = Connect(server.path());
    server.RunOnce(std::chrono::milliseconds(1));
    return client;
  }();
  Check(witness >= 0, "no client can join the bus");

  const int hostile = Connect(server.path());
  Check(hostile >= 0, "no second client can join the bus");
  server.RunOnce(std::chrono::nanoseconds(0));
  Bytes bytes(input);
  for (int i = 0; i < 64 && !bytes.empty(); ++i) {
    const std::uint8_t choice = bytes.Byte();
    std::array<std::uint8_t, 64> raw{};
    std::size_t size = sizeof(can::Packet);
    if ((choice & 1) != 0) {  // a packet with a frame of any kind
      const can::Packet packet = can::FramePacket(bytes.Frame(), bytes.Take<std::int64_t>());
      std::memcpy(raw.data(), &packet, sizeof packet);
    } else {  // any bytes, of any length but none: that is how a socket says that it closed
      size = 1 + choice / 2 % raw.size();
      for (std::size_t k = 0; k < size; ++k) raw[k] = bytes.Byte();
    }
    (void)::send(hostile, raw.data(), size, MSG_DONTWAIT | MSG_NOSIGNAL);
    if ((choice & 0xC0) == 0xC0) server.RunOnce(std::chrono::nanoseconds(0));
  }
  server.RunOnce(std::chrono::nanoseconds(0));
  ::close(hostile);

  // The witness still sends and receives.
  can::Frame frame;
  frame.id = 0;
  frame.length = 1;
  const can::Packet packet = can::FramePacket(frame, 0);
  Check(::send(witness, &packet, sizeof packet, MSG_DONTWAIT | MSG_NOSIGNAL) == sizeof packet,
        "the server dropped a client that did nothing wrong");
  const std::uint64_t before = server.counters().frames;
  for (int i = 0; i < 1000 && server.counters().frames == before; ++i)
    server.RunOnce(std::chrono::milliseconds(1));
  Check(server.counters().frames > before, "the bus stands still");
  Check(server.clients() <= 2, "clients that left are kept");
  for (can::Packet received; ::recv(witness, &received, sizeof received, MSG_DONTWAIT) > 0;) {
    Check(received.magic == can::Packet::kMagic, "a packet of another kind");
    if (received.kind == can::PacketKind::kFrame) {
      Check(can::IsValid(can::FrameOf(received)), "an impossible frame reached a client");
    }
  }
  Check(possible, "an impossible frame was on the bus");
}

std::vector<Input> BusServerSeeds() {
  std::vector<Input> seeds;
  Input frames;
  for (int i = 0; i < 12; ++i) {
    frames.push_back(static_cast<std::uint8_t>(i % 3 == 0 ? 0xC1 : 0x01));
    can::Frame frame;
    frame.id = static_cast<std::uint32_t>(100 * i);
    frame.length = static_cast<std::uint8_t>(i);  // the last ones too long
    frame.extended = i % 2 == 0;
    Append(frames, frame);
    frames.insert(frames.end(), 8, 0);
  }
  seeds.push_back(frames);
  for (const int size : {1, 31, 32, 33, 64}) {
    Input raw{static_cast<std::uint8_t>(2 * (size - 1))};
    raw.insert(raw.end(), {0x01, 0x5C, 0x02, 0x00});
    raw.insert(raw.end(), static_cast<std::size_t>(size), 0x07);
    seeds.push_back(raw);
  }
  return seeds;
}

}  // namespace sinew::fuzz
