// SocketCAN on a real kernel: run_on_kernel.sh starts this program where there is a vcan interface,
// on this machine or under qemu with Debian's kernel. SINEW_CAN_INTERFACE names the interface;
// candump, cangen and ip are at hand.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/can.h>
#include <linux/can/error.h>
#include <linux/can/raw.h>
#include <linux/tty.h>
#include <net/if.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <memory>
#include <random>
#include <string>
#include <thread>

#include "bridge/can/candump.h"
#include "bridge/can/codec.h"
#include "bridge/can/file/bus_config.h"
#include "bridge/can/transport/replay_can.h"
#include "bridge/can/transport/socketcan.h"
#include "bridge/joints/can_plant.h"
#include "bridge/virtual_axes/virtual_axes.h"
#include "components/base/config/config.h"
#include "components/base/types/clock/clock.h"
#include "components/base/types/control_mode.h"
#include "tests/bridge/virtual_axes/rotors.h"
#include "tests/kernel/raw_socket.h"

namespace sinew::can {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

int Shell(const std::string& command) {
  const int status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

Frame Data(std::uint32_t id, std::initializer_list<int> bytes) {
  Frame frame;
  frame.id = id;
  for (const int byte : bytes) frame.data[frame.length++] = static_cast<std::uint8_t>(byte);
  return frame;
}

TEST(SocketCanOnAKernel, EveryKindOfFrameArrivesByteForByte) {
  SocketCan a({Interface(), {}, 0}), b({Interface(), {}, 0});
  std::mt19937 random(1);
  for (int i = 0; i < 500; ++i) {
    Frame frame;
    frame.extended = random() % 2 == 0;
    frame.id = random() & (frame.extended ? kMaxExtendedId : kMaxStandardId);
    frame.remote = random() % 4 == 0;
    frame.length = static_cast<std::uint8_t>(random() % 9);
    if (!frame.remote) {
      for (std::size_t k = 0; k < frame.length; ++k)
        frame.data[k] = static_cast<std::uint8_t>(random());
    }
    const std::int64_t before = a.now_ns();
    ASSERT_EQ(a.Send(frame), SendStatus::kOk);
    Received received;
    ASSERT_TRUE(b.Receive(seconds(2), &received)) << i;
    ASSERT_EQ(received.frame, frame) << i;
    // Stamped by the kernel between sending and now. Epoch and monotonic clock are read one after
    // the other: a millisecond's tolerance on a slow emulated machine.
    EXPECT_GE(received.stamp_ns, before - 1'000'000);
    EXPECT_LE(received.stamp_ns, b.now_ns());
  }
  EXPECT_EQ(a.counters().sent, 500U);
  EXPECT_EQ(b.counters().received, 500U);
  EXPECT_EQ(a.counters().wire_bits, b.counters().wire_bits);
  Received own;
  EXPECT_FALSE(a.Receive(milliseconds(0), &own)) << "own frames do not come back";
}

TEST(SocketCanOnAKernel, FdFramesArriveWhereTheInterfaceCarriesThem) {
  // vcan's MTU is that of CAN FD.
  SocketCan a({Interface(), {}, 0}), b({Interface(), {}, 0});
  for (const int length : {0, 8, 12, 20, 32, 48, 64}) {
    Frame frame;
    frame.fd = true;
    frame.bit_rate_switch = length > 8;
    frame.id = 0x123;
    frame.length = static_cast<std::uint8_t>(length);
    for (std::size_t k = 0; k < frame.length; ++k) frame.data[k] = static_cast<std::uint8_t>(k + 1);
    ASSERT_EQ(a.Send(frame), SendStatus::kOk);
    Received received;
    ASSERT_TRUE(b.Receive(seconds(2), &received)) << length;
    EXPECT_EQ(received.frame, frame) << length;
  }
}

TEST(SocketCanOnAKernel, KernelFiltersLetThroughExactlyTheWantedIdentifiers) {
  const std::vector<IdFilter> filters = {{0x60, 0x7E0, false}, {0x429, 0x7FF, false}};
  SocketCan all({Interface(), {}, 0}), some({Interface(), filters, 0});
  int wanted = 0;
  for (std::uint32_t id = 0; id <= kMaxStandardId; ++id) {
    const Frame frame = Data(id, {1});
    wanted += Passes(filters, frame) ? 1 : 0;
    ASSERT_EQ(all.Send(frame), SendStatus::kOk);
    Frame extended = frame;  // the same number as an extended identifier is another one
    extended.extended = true;
    if (id % 16 == 0) {
      ASSERT_EQ(all.Send(extended), SendStatus::kOk);
    }
    Received received;
    while (some.Receive(milliseconds(0), &received)) {
      ASSERT_TRUE(Passes(filters, received.frame)) << received.frame.id;
    }
  }
  EXPECT_EQ(wanted, 33);
  EXPECT_EQ(some.counters().received, static_cast<std::uint64_t>(wanted));
}

TEST(SocketCanOnAKernel, FramesThatWereNotReadInTimeAreCountedAsLost) {
  SocketCan a({Interface(), {}, 0}), slow({Interface(), {}, 0});
  constexpr int kFrames = 5000;  // the system's buffer holds some hundreds
  for (int i = 0; i < kFrames; ++i) ASSERT_EQ(a.Send(Data(0x123, {1, 2, 3})), SendStatus::kOk);
  Received received;
  while (slow.Receive(milliseconds(20), &received)) {
  }
  ASSERT_EQ(a.Send(Data(0x123, {4})), SendStatus::kOk);  // the count comes with the next frame
  ASSERT_TRUE(slow.Receive(seconds(2), &received));
  EXPECT_GT(slow.counters().lost, 0U);
  EXPECT_EQ(slow.counters().received + slow.counters().lost, kFrames + 1U);
}

TEST(SocketCanOnAKernel, SilenceEndsWithTheTimeout) {
  SocketCan a({Interface(), {}, 0});
  Received received;
  const std::int64_t before = a.now_ns();
  EXPECT_FALSE(a.Receive(milliseconds(50), &received));
  EXPECT_GE(a.now_ns() - before, 50'000'000);
}

TEST(SocketCanOnAKernel, ErrorFramesReportBusOffRestartAndPassive) {
  SocketCan a({Interface(), {{0x1, 0x7FF, false}}, 0});  // filters for data do not hide errors
  const RawSocket injector;
  Received received;
  ASSERT_TRUE(injector.SendError(CAN_ERR_CRTL, {0, CAN_ERR_CRTL_TX_PASSIVE}));
  ASSERT_TRUE(a.Receive(seconds(2), &received));
  EXPECT_TRUE(received.frame.error);
  EXPECT_EQ(a.link(), Link::kPassive);
  ASSERT_TRUE(injector.SendError(CAN_ERR_BUSOFF));
  ASSERT_TRUE(a.Receive(seconds(2), &received));
  EXPECT_EQ(a.link(), Link::kBusOff);
  ASSERT_TRUE(injector.SendError(CAN_ERR_RESTARTED));
  ASSERT_TRUE(a.Receive(seconds(2), &received));
  EXPECT_EQ(a.link(), Link::kUp);
  ASSERT_TRUE(injector.SendError(CAN_ERR_LOSTARB));
  EXPECT_FALSE(a.Receive(milliseconds(20), &received))
      << "lost arbitration is not reported as an error";
  EXPECT_EQ(a.counters().error_frames, 3U);
  EXPECT_EQ(a.counters().received, 0U);
}

TEST(SocketCanOnAKernel, InterfaceThatIsDownIsAUsageErrorAndComesBackWhileInUse) {
  SocketCan a({Interface(), {}, 0}), b({Interface(), {}, 0});
  ASSERT_EQ(Shell("ip link set " + Interface() + " down"), 0);
  try {
    SocketCan late({Interface(), {}, 0});
    ADD_FAILURE();
  } catch (const UsageError& error) {
    EXPECT_NE(std::string(error.what()).find("down"), std::string::npos) << error.what();
    EXPECT_NE(std::string(error.what()).find("ip link set"), std::string::npos) << error.what();
  }
  Received received;
  EXPECT_FALSE(b.Receive(milliseconds(1), &received));
  EXPECT_EQ(a.Send(Data(1, {1})), SendStatus::kDown);
  EXPECT_EQ(a.link(), Link::kDown);
  EXPECT_EQ(a.counters().dropped, 1U);
  ASSERT_EQ(Shell("ip link set " + Interface() + " up"), 0);
  ASSERT_EQ(a.Send(Data(1, {1})), SendStatus::kOk);
  EXPECT_EQ(a.link(), Link::kUp);
  ASSERT_TRUE(b.Receive(seconds(2), &received));
  EXPECT_EQ(b.link(), Link::kUp);
}

TEST(SocketCanOnAKernel, InterfaceThatVanishesIsOpenedAgainWhenItReturns) {
  SocketCan a({Interface(), {}, 0});
  ASSERT_EQ(Shell("ip link del " + Interface()), 0);
  Received received;
  EXPECT_FALSE(a.Receive(milliseconds(1), &received));
  EXPECT_EQ(a.Send(Data(1, {1})), SendStatus::kDown);
  ASSERT_EQ(Shell("ip link add dev " + Interface() + " type vcan"), 0);
  ASSERT_EQ(Shell("ip link set " + Interface() + " up"), 0);
  const std::int64_t give_up = types::MonotonicNow_ns() + 5'000'000'000;
  while (a.link() != Link::kUp && types::MonotonicNow_ns() < give_up)
    (void)a.Receive(milliseconds(20), &received);
  ASSERT_EQ(a.link(), Link::kUp);
  SocketCan b({Interface(), {}, 0});
  ASSERT_EQ(a.Send(Data(1, {1})), SendStatus::kOk);
  EXPECT_TRUE(b.Receive(seconds(2), &received));
}

TEST(SocketCanOnAKernel, InterfaceThatIsNoCanIsRefused) {
  EXPECT_THROW(SocketCan({"lo", {}, 0}), UsageError);
  EXPECT_THROW(SocketCan({"nocan7", {}, 0}), UsageError);
}

// Twelve joints: the bridge here, the virtual axes in a process of their own, cangen's noise
// between them, and candump as the witness of every byte.
TEST(SocketCanOnAKernel,
     BridgeAndVirtualAxesRunTwelveJointsThroughNoiseAndCandumpSeesTheSameBytes) {
  constexpr int kJoints = 12;
  constexpr int kCycles = 1000;
  constexpr double kPeriod_s = 0.01;  // an emulated machine is slow
  bridge::BridgeConfig config;
  config.bitrate_bit_s = {1e6};
  // Limits of time for an emulated machine.
  config.timing.estimate_timeout_s = 1.0;
  config.timing.lost_after_s = 2.0;
  config.timing.heartbeat_timeout_s = 3.0;
  config.timing.start_timeout_s = 20.0;
  config.timing.closed_loop_timeout_s = 5.0;
  virtual_axes::VirtualAxesConfig axes;
  axes.step_s = 0.002;
  for (int j = 0; j < kJoints; ++j) {
    bridge::JointConfig joint;
    joint.name = "joint" + std::to_string(j);
    joint.node = j + 1;
    joint.gear_ratio = 100.0;
    joint.direction = j % 2 == 0 ? 1 : -1;
    joint.torque_constant_Nm_A = test::Rotors::kTorqueConstant_Nm_A;
    joint.controller_torque_constant_Nm_A = 8.27 / 600;
    joint.limits = {0.398, 25.0, 8.0, -3.0, 3.0, 0.2};
    joint.output = bridge::OutputNode{j + 33, 1, 0.0};
    config.joints.push_back(joint);
    virtual_axes::AxisConfig axis;
    axis.node = j + 1;
    axis.joint = j;
    axis.direction = joint.direction;
    axis.gear_ratio = 100.0;
    axes.axes.push_back(axis);
    virtual_axes::SensorNodeConfig node;
    node.node = j + 33;
    node.joint = j;
    node.encoder_ms = node.sensors_ms = 10;
    axes.nodes.push_back(node);
  }

  const std::string log = "/tmp/candump.log";
  ASSERT_EQ(Shell("candump -r 16000000 -L " + Interface() + " > " + log +
                  " 2>/dev/null & echo $! > /tmp/candump.pid"),
            0);

  // It listens as soon as the kernel lists its socket.
  const std::int64_t listens_by_ns = types::MonotonicNow_ns() + 10'000'000'000;
  while (Shell("grep -q " + Interface() + ".*raw /proc/net/can/rcvlist_all") != 0 &&
         types::MonotonicNow_ns() < listens_by_ns) {
  }

  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    test::Rotors rotors(kJoints);
    SocketCan can({Interface(), {}, 0});
    std::vector<Transport*> transports = {&can};
    virtual_axes::VirtualAxes it(axes, rotors, transports);
    it.Start(types::MonotonicNow_ns());
    for (;;) {
      const std::int64_t now = types::MonotonicNow_ns();
      if (now >= it.next_ns()) {
        it.Run(now);
      } else {
        WaitForAny(transports, std::chrono::nanoseconds(it.next_ns() - now));
        it.Answer(types::MonotonicNow_ns());
      }
    }
  }

  // What the bridge sends, as it sends it.
  class Recording : public Transport {
   public:
    explicit Recording(Transport& to) : to_(to) {}
    SendStatus Send(const Frame& frame) noexcept override {
      const SendStatus status = to_.Send(frame);
      if (status == SendStatus::kOk) sent.push_back(frame);
      return status;
    }
    bool Receive(std::chrono::nanoseconds timeout, Received* received) noexcept override {
      return to_.Receive(timeout, received);
    }
    Link link() const noexcept override { return to_.link(); }
    TransportCounters counters() const noexcept override { return to_.counters(); }
    std::int64_t now_ns() const noexcept override { return to_.now_ns(); }
    int descriptor() const noexcept override { return to_.descriptor(); }
    const std::string& name() const noexcept override { return to_.name(); }
    std::vector<Frame> sent;

   private:
    Transport& to_;
  };

  SocketCan can({Interface(), bridge::ReceiveFilters(config, 0), 0});
  Recording recording(can);
  bridge::CanPlant plant(config, {&recording});
  provider::PlantSensors sensors;
  plant.Reset(&sensors);
  provider::PlantCommand command;
  // Extended identifiers only: noise that cannot be mistaken for a controller of ours.
  const int noise = Shell("cangen " + Interface() + " -e -g 2 -n 2000 > /dev/null 2>&1 &");
  EXPECT_EQ(noise, 0);
  std::vector<double> work_us;
  std::int64_t next_ns = types::MonotonicNow_ns();
  int faults = 0;
  for (int cycle = 0; cycle < kCycles; ++cycle) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      command.mode[j] = types::ControlMode::kTorque;
      // A damped spring to an angle of its own.
      command.motor_torque_Nm[j] =
          2e-3 * (20.0 * (static_cast<double>(j) - 5.5) / 5.5 - sensors.motor_position_rad[j]) -
          2.5e-4 * sensors.motor_velocity_rad_s[j];
      command.motor_torque_Nm[j] = std::clamp(command.motor_torque_Nm[j], -0.01, 0.01);
    }
    const std::int64_t start_ns = types::MonotonicNow_ns();
    plant.Step(command, kPeriod_s, &sensors);
    work_us.push_back(1e-3 * static_cast<double>(types::MonotonicNow_ns() - start_ns));
    faults += sensors.fault ? 1 : 0;
    next_ns = std::max(next_ns + 10'000'000, types::MonotonicNow_ns());
    while (types::MonotonicNow_ns() < next_ns) ::usleep(500);
  }
  EXPECT_EQ(faults, 0) << sensors.message;
  for (std::size_t j = 0; j < kJoints; ++j) {
    EXPECT_NEAR(sensors.motor_position_rad[j], 20.0 * (static_cast<double>(j) - 5.5) / 5.5, 1.0)
        << j;
    EXPECT_NEAR(sensors.position_rad[j], sensors.motor_position_rad[j] / 100.0, 0.02) << j;
  }
  EXPECT_EQ(plant.malformed(), 0U);
  const TransportCounters counters = can.counters();
  std::sort(work_us.begin(), work_us.end());
  std::cout << kCycles << " cycles of 12 joints: " << counters.sent << " frames sent, "
            << counters.received << " received, " << counters.dropped
            << " dropped; bridge's own work p50 " << work_us[work_us.size() / 2] << " us, max "
            << work_us.back() << " us\n";
  EXPECT_GT(counters.received, 10'000U);

  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_EQ(Shell("kill $(cat /tmp/candump.pid)"), 0);
  // candump may lose frames when the machine is too slow to read them; those it has must be ours,
  // in order.
  std::size_t at = 0, seen = 0, foreign = 0;
  for (const LogLine& line : ReadCandumpFile(log)) {
    if (line.frame.extended) {
      ++foreign;
      continue;
    }
    const std::size_t found = static_cast<std::size_t>(
        std::find(recording.sent.begin() + static_cast<std::ptrdiff_t>(at),
                  recording.sent.begin() +
                      static_cast<std::ptrdiff_t>(std::min(at + 400, recording.sent.size())),
                  line.frame) -
        recording.sent.begin());
    if (found < std::min(at + 400, recording.sent.size())) {
      at = found + 1;
      ++seen;
    }
  }
  std::cout << "candump saw " << seen << " of " << recording.sent.size()
            << " frames of the bridge byte for byte, " << foreign << " of the noise\n";
  EXPECT_GE(seen, recording.sent.size() * 99 / 100);
  EXPECT_GT(foreign, 0U);
}

BusEntry SocketCanAt(const std::string& interface) {
  BusEntry entry;
  entry.kind = TransportKind::kSocketCan;
  entry.interface = interface;
  return entry;
}

TEST(SocketCanOnAKernel, AnAdapterAtASerialPortIsHardwareAndVcanIsNone) {
  EXPECT_FALSE(IsHardware(SocketCanAt(Interface())));
  EXPECT_FALSE(IsHardware(SocketCanAt("absent0")));
  const int port = ::posix_openpt(O_RDWR | O_NOCTTY);
  ASSERT_GE(port, 0);
  ASSERT_EQ(::grantpt(port) + ::unlockpt(port), 0);
  const int line = ::open(::ptsname(port), O_RDWR | O_NOCTTY);
  ASSERT_GE(line, 0);
  const int slcan = N_SLCAN;
  ASSERT_EQ(::ioctl(line, TIOCSETD, &slcan), 0) << std::strerror(errno);
  char name[IFNAMSIZ] = "";
  ASSERT_EQ(::ioctl(line, SIOCGIFNAME, name), 0) << std::strerror(errno);
  EXPECT_TRUE(IsHardware(SocketCanAt(name))) << name;
  ::close(line);
  ::close(port);
}

}  // namespace
}  // namespace sinew::can
