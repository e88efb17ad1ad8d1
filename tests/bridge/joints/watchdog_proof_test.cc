#include "bridge/joints/watchdog_proof.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "bridge/joints/file/proof_file.h"
#include "components/base/config/config.h"
#include "tests/bridge/joints/plant_bench.h"
#include "tests/support/temporary_folder.h"

namespace sinew::bridge {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

const std::function<bool()> kNeverStopped = [] { return false; };

// A trial of the bench's first axis in simulated time, and every torque that was on the bus.
struct TrialBench {
  explicit TrialBench(double watchdog_s) : bench({.watchdog_s = watchdog_s}) {
    bench.Prepare();
    end = bench.buses[0]->Join("trial");
    bench.buses[0]->OnFrame([this](const can::Delivery& delivery) {
      if (const auto torque = can::Decode<can::SetInputTorque>(delivery.frame)) {
        largest_torque_Nm = std::max(largest_torque_Nm, std::abs(torque->torque_Nm));
      }
    });
  }
  WatchdogTrial Try(const std::function<bool()>& stopped = kNeverStopped) {
    return TryWatchdog(bench.config.joints[0], bench.config.timing, *end, stopped);
  }
  can::AxisState state() const { return bench.axes->axis_state(0); }

  Bench bench;
  std::unique_ptr<can::Transport> end;
  double largest_torque_Nm = 0.0;
};

TEST(WatchdogProof, AWatchdogOfTheLimitIsProvenAndTheAxisIsIdleAfterwards) {
  TrialBench bench(0.1);
  const WatchdogTrial trial = bench.Try();
  EXPECT_TRUE(trial.proven) << trial.why;
  EXPECT_GE(trial.idle_after_ms, 100.0);
  EXPECT_LE(trial.idle_after_ms, 110.0);
  EXPECT_GT(trial.runs_after_ms, 0.0) << "it was in closed loop when the setpoints ended";
  EXPECT_LT(trial.runs_after_ms, 100.0);
  EXPECT_EQ(bench.state(), can::AxisState::kIdle);
  EXPECT_EQ(bench.largest_torque_Nm, 0.0);
}

TEST(WatchdogProof, AFasterWatchdogIsProvenToo) {
  for (const double watchdog_s : {0.02, 0.05, 0.08}) {
    TrialBench bench(watchdog_s);
    const WatchdogTrial trial = bench.Try();
    EXPECT_TRUE(trial.proven) << watchdog_s << ": " << trial.why;
  }
}

TEST(WatchdogProof, AWatchdogThatIsOffOrSlowIsNotAndTheAxisIsIdledByCommand) {
  for (const double watchdog_s : {0.0, 0.115, 0.15, 0.5}) {
    TrialBench bench(watchdog_s);
    const WatchdogTrial trial = bench.Try();
    EXPECT_FALSE(trial.proven) << watchdog_s;
    EXPECT_EQ(trial.idle_after_ms, 0.0) << watchdog_s;
    EXPECT_THAT(trial.why, HasSubstr("does not fire"));
    EXPECT_TRUE(trial.refuted);
    EXPECT_EQ(bench.state(), can::AxisState::kIdle) << watchdog_s;
    EXPECT_EQ(bench.largest_torque_Nm, 0.0);
  }
}

TEST(WatchdogProof, SomebodyElsesSetpointsAreNoticedBeforeAnythingIsArmed) {
  TrialBench bench(0.1);
  const auto other = bench.bench.buses[0]->Join("another bridge");
  std::int64_t next_ns = 0;
  bench.bench.buses[0]->AddAgent([&] { return next_ns; },
                                 [&](std::int64_t now_ns) {
                                   next_ns = now_ns + 4'000'000;
                                   (void)other->Send(can::Encode(1, can::SetInputTorque{0.0}));
                                 });
  int sent = 0;  // by the trial
  bench.bench.buses[0]->OnFrame([&](const can::Delivery& delivery) {
    const auto address = can::AddressOf(delivery.frame);
    if (address->command == can::Command::kSetAxisState ||
        address->command == can::Command::kClearErrors) {
      ++sent;
    }
  });
  const WatchdogTrial trial = bench.Try();
  EXPECT_FALSE(trial.proven);
  EXPECT_FALSE(trial.refuted) << "an older proof stands";
  EXPECT_THAT(trial.why, HasSubstr("another program sends to axis node 1"));
  EXPECT_EQ(sent, 0) << "its robot may be armed";
}

TEST(WatchdogProof, AnAxisThatIsNotThereOrDoesNotArmIsNoProof) {
  TrialBench silent(0.1);
  silent.bench.config.joints[0].node = 9;
  EXPECT_THAT(silent.Try().why, HasSubstr("no heartbeats of axis node 9"));
}

TEST(WatchdogProof, AStopIdlesTheAxisWhereverTheTrialIs) {
  for (int asked_at = 1; asked_at < 400; asked_at += 7) {
    TrialBench bench(0.0);
    int asked = 0;
    const WatchdogTrial trial = bench.Try([&] { return ++asked >= asked_at; });
    EXPECT_FALSE(trial.proven);
    bench.bench.buses[0]->AdvanceTo(bench.bench.buses[0]->now_ns() + 5'000'000);
    EXPECT_EQ(bench.state(), can::AxisState::kIdle) << asked_at;
  }
}

JointConfig ProvenJoint() {
  JointConfig joint;
  joint.name = "knee";
  joint.node = 3;
  joint.serial_number = "3861324D3037";
  return joint;
}

TEST(WatchdogProof, IsOfOneSerialNumberNodeAndFirmware) {
  const JointConfig joint = ProvenJoint();
  const WatchdogProof proof{"knee", joint.serial_number, 3, joint.firmware, 105.0, "2026-01-01"};
  EXPECT_TRUE(Proves(proof, joint));
  JointConfig other = joint;
  other.serial_number = "3861324D3038";
  EXPECT_FALSE(Proves(proof, other)) << "another controller";
  other = joint;
  other.node = 4;
  EXPECT_FALSE(Proves(proof, other)) << "the other axis of the same controller";
  other = joint;
  other.firmware = can::Firmware::k0_5_4;
  EXPECT_FALSE(Proves(proof, other));
  WatchdogProof late = proof;
  late.idle_after_ms = 111.0;
  EXPECT_FALSE(Proves(late, joint)) << "a file that somebody has edited";
  other.serial_number.clear();
  EXPECT_FALSE(Proves({"", "", 3, joint.firmware, 100.0, ""}, other)) << "nobody is nobody";
}

TEST(WatchdogProof, WhatIsMissingIsNamedWithTheCommandThatMakesIt) {
  const std::vector<JointConfig> joints = {ProvenJoint()};
  const std::string missing = MissingProofs(joints, {}, "sinew-can-bridge --prove-watchdogs");
  EXPECT_THAT(missing, HasSubstr("joint 'knee' (axis node 3, serial number 3861324D3037)"));
  EXPECT_THAT(missing, HasSubstr("make it with: sinew-can-bridge --prove-watchdogs"));
  const WatchdogProof proof{"", "3861324D3037", 3, joints[0].firmware, 99.0, ""};
  EXPECT_THAT(MissingProofs(joints, {proof}, ""), IsEmpty());
  JointConfig second = ProvenJoint();
  second.name = "hip";
  second.serial_number.clear();
  EXPECT_THAT(MissingProofs({joints[0], second}, {proof}, ""),
              HasSubstr("'hip' (axis node 3, no serial_number"));
  EXPECT_THAT(MissingProofs({joints[0], second}, {}, ""), HasSubstr("and 1 more"));
}

TEST(ProofFile, KeepsWhatWasWrittenAndRefusesWhatIsNoProof) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "proof.yaml";
  EXPECT_TRUE(ReadProofs(path).empty());
  WriteProofs(path, {});
  EXPECT_TRUE(ReadProofs(path).empty());
  WriteProofs(path,
              {{"knee", "3861324D3037", 3, can::Firmware::k0_5_4, 104.6, "2026-01-02T03:04:05Z"}});
  const std::vector<WatchdogProof> proofs = ReadProofs(path);
  ASSERT_EQ(proofs.size(), 1U);
  EXPECT_EQ(proofs[0].joint, "knee");
  EXPECT_EQ(proofs[0].serial_number, "3861324D3037");
  EXPECT_EQ(proofs[0].node, 3);
  EXPECT_EQ(proofs[0].firmware, can::Firmware::k0_5_4);
  EXPECT_NEAR(proofs[0].idle_after_ms, 104.6, 1e-9);
  EXPECT_EQ(proofs[0].made, "2026-01-02T03:04:05Z");
  EXPECT_THROW((void)ReadProofs(folder.Write("a", "schema: sinew-watchdog-proof/2\n")), UsageError);
  EXPECT_THROW((void)ReadProofs(folder.Write(
                   "b", "schema: sinew-watchdog-proof/1\nproofs:\n  - {joint: a, node: 3}\n")),
               UsageError);
  EXPECT_THROW(WriteProofs(folder.path() / "nowhere" / "x", {}), UsageError);
}

}  // namespace
}  // namespace sinew::bridge
