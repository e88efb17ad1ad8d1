// The bridge's own time per cycle for twelve joints on two buses, without wire and DDS, and the
// speed of the codec.
//   cmake --preset release -DSINEW_BUILD_BENCH=ON && cmake --build build/release --target can_bench
//   build/release/bin/can_bench
// Goal: 50 us at the median, 500 us at p99.9.
//
// A cycle is CanPlant::Act and CanPlant::Step: frames taken and decoded, limits and faults
// assessed, setpoints computed, encoded and handed to the transport, sensors filled. Not in it: the
// wire, DDS and the messages of the topics (bus_status has the bridge's work in the running
// system), and making the frames of the other side. All joints are armed and move; each cycle
// brings estimates of all, Iq of all in every fourth, heartbeats at 10 Hz, and with sensor nodes
// output encoder and sensors of all. Two transports:
//   memory   hands out what it has: CanPlant alone
//   sockets  a virtual bus per bus (transport/virtual_can.cc): real system calls, up to 32 frames
//            in one, and the count of their bits, as transport/socketcan.cc has them; not the
//            kernel's CAN layer and driver
// "paced" sleeps to the next period of 240 Hz in between, so that caches are as cold as they are in
// the running bridge, and the scheduler takes part.
#include <benchmark/benchmark.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "bridge/can/bit_timing.h"
#include "bridge/can/candump.h"
#include "bridge/can/codec.h"
#include "bridge/can/sensor_node.h"
#include "bridge/can/transport/bus_protocol.h"
#include "bridge/can/transport/virtual_can.h"
#include "bridge/joints/can_plant.h"
#include "components/base/types/clock/clock.h"
#include "components/base/types/control_mode.h"
#include "tests/fuzz/watched_plant.h"

namespace sinew {
namespace {

constexpr int kJoints = 12;
constexpr int kBuses = 2;

// The other end of a virtual bus: what sinew-can-bus would be, without a wire's time.
class BusEnd {
 public:
  explicit BusEnd(int bus)
      : path_("/tmp/sinew-can-bench-" + std::to_string(::getpid()) + "-" + std::to_string(bus)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    std::copy(path_.begin(), path_.end(), address.sun_path);
    listener_ = ::socket(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0);
    ::unlink(path_.c_str());
    if (::bind(listener_, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0 ||
        ::listen(listener_, 1) != 0) {
      std::abort();
    }
    std::thread accept([this] {
      socket_ = ::accept4(listener_, nullptr, nullptr, SOCK_NONBLOCK | SOCK_CLOEXEC);
      can::Packet welcome;
      welcome.kind = can::PacketKind::kWelcome;
      welcome.value = 1'000'000;
      SendPacket(welcome);
    });
    transport_ = std::make_unique<can::VirtualCan>(can::VirtualCanOptions{.bus = path_});
    accept.join();
    const int bytes = 1 << 20;
    ::setsockopt(socket_, SOL_SOCKET, SO_SNDBUF, &bytes, sizeof bytes);
  }
  ~BusEnd() {
    ::close(socket_);
    ::close(listener_);
    ::unlink(path_.c_str());
  }
  BusEnd(const BusEnd&) = delete;
  BusEnd& operator=(const BusEnd&) = delete;

  can::VirtualCan& transport() { return *transport_; }
  void Feed(const can::Frame& frame) {
    SendPacket(can::FramePacket(frame, types::MonotonicNow_ns()));
  }
  bool Take(can::Frame* frame) {
    can::Packet packet;
    if (::recv(socket_, &packet, sizeof packet, MSG_DONTWAIT) != sizeof packet) return false;
    *frame = can::FrameOf(packet);
    return true;
  }

 private:
  void SendPacket(const can::Packet& packet) {
    if (::send(socket_, &packet, sizeof packet, MSG_NOSIGNAL) != sizeof packet) std::abort();
  }

  std::string path_;
  int listener_ = -1, socket_ = -1;
  std::unique_ptr<can::VirtualCan> transport_;
};

// One robot and both kinds of buses; `sockets` chooses.
class Bench {
 public:
  Bench(bool nodes, bool sockets) : sockets_(sockets), config_(Config(nodes)), robot_(config_) {
    robot_.amplitude_rad = 1.0;
    std::vector<can::Transport*> ends;
    for (int bus = 0; bus < kBuses; ++bus) {
      memory_.push_back(std::make_unique<fuzz::FedBus>(bus, now_ns_, nullptr));
      socket_.push_back(std::make_unique<BusEnd>(bus));
      ends.push_back(sockets ? static_cast<can::Transport*>(&socket_.back()->transport())
                             : memory_.back().get());
    }
    plant_ = std::make_unique<bridge::CanPlant>(config_, ends);
  }

  bool Start() {
    // Reset throws away what waits, then listens: it is fed while it waits.
    if (sockets_) {
      std::atomic<bool> started{false};
      std::thread speaker([&] {
        while (!started) {
          SendMessages(true);
          std::this_thread::sleep_for(std::chrono::milliseconds(2));
        }
      });
      plant_->Reset(&sensors_);
      started = true;
      speaker.join();
    } else {
      memory_[0]->on_wait = [this] { SendMessages(true); };
      plant_->Reset(&sensors_);
      memory_[0]->on_wait = nullptr;
    }
    for (std::size_t j = 0; j < kJoints; ++j) {
      command_.mode[j] = static_cast<types::ControlMode>(1 + j % 3);
    }
    for (int i = 0; i < 60; ++i) Cycle();
    return !sensors_.any_fault();
  }

  // The time that the plant took.
  double Cycle() {
    now_ns_ += fuzz::kPeriod_ns;
    SendMessages(false);
    const double phase = 0.01 * static_cast<double>(cycle_++);
    for (std::size_t j = 0; j < kJoints; ++j) {
      command_.motor_torque_Nm[j] = 0.1 * std::sin(phase);
      command_.position_rad[j] = std::sin(phase);
      command_.velocity_rad_s[j] = std::cos(phase);
    }
    const auto start = std::chrono::steady_clock::now();
    plant_->Act(command_, fuzz::kPeriod_s);
    plant_->Step(command_, fuzz::kPeriod_s, &sensors_);
    const auto end = std::chrono::steady_clock::now();
    for (int bus = 0; bus < kBuses; ++bus) {
      if (sockets_) {
        can::Frame frame;
        while (socket_[std::size_t(bus)]->Take(&frame)) robot_.Take(bus, frame);
      } else {
        for (const can::Frame& frame : memory_[std::size_t(bus)]->sent) robot_.Take(bus, frame);
        memory_[std::size_t(bus)]->sent.clear();
        memory_[std::size_t(bus)]->Clear();
      }
    }
    return std::chrono::duration<double>(end - start).count();
  }

  bool fault() const { return sensors_.any_fault(); }
  const std::string& message() const { return sensors_.message; }
  double frames_per_cycle() const {
    double frames = 0.0;
    for (int bus = 0; bus < kBuses; ++bus) {
      const can::TransportCounters c = sockets_ ? socket_[std::size_t(bus)]->transport().counters()
                                                : memory_[std::size_t(bus)]->counters();
      frames += static_cast<double>(c.sent + c.received);
    }
    return frames / static_cast<double>(cycle_);
  }

 private:
  static bridge::BridgeConfig Config(bool nodes) {
    bridge::BridgeConfig config = fuzz::FuzzedRobot(kJoints);
    config.timing.iq_every_cycles = 4;
    // Unpaced cycles take no time on the sockets' clock.
    config.timing.heartbeat_timeout_s = 1e3;
    for (bridge::JointConfig& joint : config.joints) {
      joint.limits.velocity_rad_s = 1e4;  // positions jump by a period in no time
      joint.output.reset();
      if (nodes) joint.output = bridge::OutputNode{joint.node + 32, 1, 0.25};
    }
    return config;
  }

  void SendMessages(bool all) {
    for (int bus = 0; bus < kBuses; ++bus) {
      std::vector<can::Frame>& feed = memory_[std::size_t(bus)]->feed;
      robot_.SendMessages(bus, 1e-9 * static_cast<double>(now_ns_), all, &feed);
      if (!sockets_) continue;
      for (const can::Frame& frame : feed) socket_[std::size_t(bus)]->Feed(frame);
      feed.clear();
    }
  }

  bool sockets_;
  bridge::BridgeConfig config_;
  fuzz::LiveRobot robot_;
  std::int64_t now_ns_ = 1'000'000'000;
  std::vector<std::unique_ptr<fuzz::FedBus>> memory_;
  std::vector<std::unique_ptr<BusEnd>> socket_;
  std::unique_ptr<bridge::CanPlant> plant_;
  provider::PlantCommand command_;
  provider::PlantSensors sensors_;
  std::uint64_t cycle_ = 0;
};

// Arguments: sensor nodes, sockets, paced.
void Cycle(benchmark::State& state) {
  Bench bench(state.range(0) != 0, state.range(1) != 0);
  const bool paced = state.range(2) != 0;
  if (!bench.Start()) {
    state.SkipWithError(("a fault: " + bench.message()).c_str());
    return;
  }
  std::vector<double> times_us;
  times_us.reserve(1 << 20);
  timespec next{};
  ::clock_gettime(CLOCK_MONOTONIC, &next);
  for (auto _ : state) {
    if (paced) {
      next.tv_nsec += fuzz::kPeriod_ns;
      if (next.tv_nsec >= 1'000'000'000) {
        next.tv_nsec -= 1'000'000'000;
        ++next.tv_sec;
      }
      ::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &next, nullptr);
    }
    const double seconds = bench.Cycle();
    state.SetIterationTime(seconds);
    times_us.push_back(1e6 * seconds);
  }
  if (bench.fault()) state.SkipWithError(("a fault: " + bench.message()).c_str());
  std::sort(times_us.begin(), times_us.end());
  const auto quantile = [&](double share) {
    return times_us[static_cast<std::size_t>(share * static_cast<double>(times_us.size() - 1))];
  };
  state.counters["p50_us"] = quantile(0.5);
  state.counters["p99_us"] = quantile(0.99);
  state.counters["p99.9_us"] = quantile(0.999);
  state.counters["max_us"] = times_us.back();
  state.counters["frames"] = bench.frames_per_cycle();
}
BENCHMARK(Cycle)
    ->ArgNames({"nodes", "sockets", "paced"})
    ->ArgsProduct({{0, 1}, {0, 1}, {0}})
    ->UseManualTime()
    ->Iterations(100'000)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK(Cycle)
    ->ArgNames({"nodes", "sockets", "paced"})
    ->ArgsProduct({{0, 1}, {0, 1}, {1}})
    ->UseManualTime()
    ->Iterations(5'000)
    ->Unit(benchmark::kMicrosecond);

// One message after the other, as they come and go in a cycle.
template <class Message>
void Encode(benchmark::State& state, Message message) {
  int node = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(message);
    benchmark::DoNotOptimize(can::Encode(++node & can::kMaxNode, message));
  }
  state.SetItemsProcessed(state.iterations());
}
template <class Message>
void Decode(benchmark::State& state, Message message) {
  can::Frame frame = can::Encode(3, message);
  for (auto _ : state) {
    benchmark::DoNotOptimize(frame);
    benchmark::DoNotOptimize(can::Decode<Message>(frame));
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK_CAPTURE(Encode, torque, can::SetInputTorque{0.1});
BENCHMARK_CAPTURE(Encode, position, can::SetInputPos{1.5, 0.25, 0.0});
BENCHMARK_CAPTURE(Decode, heartbeat, can::Heartbeat{0, can::AxisState::kClosedLoopControl});
BENCHMARK_CAPTURE(Decode, estimates, can::EncoderEstimates{1.5, -2.25});
BENCHMARK_CAPTURE(Decode, iq, can::Iq{2.5, 2.4375});

void DecodeOutput(benchmark::State& state) {
  can::Frame frame = can::Encode(33, can::OutputEncoder{0.25, 0.5, 7, true});
  for (auto _ : state) {
    benchmark::DoNotOptimize(frame);
    benchmark::DoNotOptimize(can::DecodeOutputEncoder(frame));
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(DecodeOutput);

void FrameBits(benchmark::State& state) {
  can::Frame frame = can::Encode(3, can::EncoderEstimates{1.5, -2.25});
  for (auto _ : state) {
    benchmark::DoNotOptimize(frame);
    benchmark::DoNotOptimize(can::FrameBits(frame));
  }
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(FrameBits);

void ParseCandump(benchmark::State& state) {
  const std::string line = "(1436509052.249713) can0 069#0000C03F000010C0";
  for (auto _ : state) benchmark::DoNotOptimize(can::ParseCandump(line));
  state.SetItemsProcessed(state.iterations());
}
BENCHMARK(ParseCandump);

}  // namespace
}  // namespace sinew

BENCHMARK_MAIN();
