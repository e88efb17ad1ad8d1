// One body node alone: frames in, the body's sensors out; which samples are new, valid, missed and
// lost.
#include "bridge/joints/body_measurement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <tuple>
#include <utility>

namespace sinew::bridge {
namespace {

constexpr std::int64_t kMillisecond_ns = 1'000'000;
constexpr int kBodyNode = 40;

class FootMeasurement : public ::testing::Test {
 protected:
  FootMeasurement() { Heartbeat(); }
  void Heartbeat(std::uint8_t version = can::kNodeFramesVersion) {
    (void)measured.Take({can::Encode(kBodyNode, can::NodeHeartbeat{1, 0, version}), 0});
  }
  void Send(std::uint8_t sequence, double force_N, std::int64_t stamp_ns,
            std::array<bool, 4> valid = {true, true, true, true}) {
    const can::FootForces forces{{force_N, 2.0, 3.0, 4.0}, valid, sequence};
    EXPECT_EQ(measured.Take({can::Encode(kBodyNode, forces), stamp_ns}),
              BodyMeasurement::Taken::kStored);
  }
  provider::BodySensors At(std::int64_t now_ns) {
    measured.Fill(now_ns, &body);
    return body;
  }

  BodyNodeConfig config{0, kBodyNode, can::BodyPart::kLeftFoot};
  BridgeTiming timing;  // valid for 20 ms, lost after 60 ms
  BodyMeasurement measured{config, timing};
  provider::BodySensors body;
};

TEST_F(FootMeasurement, HasItsOwnFourOfTheEightSensors) {
  body.foot_force_N.fill(7.0);
  Send(1, 1.0, 0, {true, false, true, false});
  const provider::BodySensors read = At(0);
  const std::array<double, 8> forces = {7.0, 7.0, 7.0, 7.0, 1.0, 2.0, 3.0, 4.0};
  for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(read.foot_force_N[i], forces[i], 1e-9) << i;
  EXPECT_EQ(read.foot_valid,
            (std::array<bool, 8>{false, false, false, false, true, false, true, false}));
}

TEST_F(FootMeasurement, NothingIsValidBeforeTheFirstSample) {
  EXPECT_FALSE(At(0).foot_valid[4]);
  EXPECT_EQ(At(0).foot_force_N[4], 0.0);
}

TEST_F(FootMeasurement, IsValidForTheTimeOfEstimatesAndKeepsItsLastForceAfterIt) {
  Send(1, 10.0, 5 * kMillisecond_ns);
  EXPECT_TRUE(At(25 * kMillisecond_ns).foot_valid[4]);
  EXPECT_FALSE(At(25 * kMillisecond_ns + 1).foot_valid[4]);
  EXPECT_NEAR(body.foot_force_N[4], 10.0, 1e-9);
  Send(2, 11.0, 26 * kMillisecond_ns);
  EXPECT_TRUE(At(26 * kMillisecond_ns).foot_valid[4]);
}

TEST_F(FootMeasurement, ASequenceThatStandsStillIsAMeasurementThatStandsStill) {
  for (int ms = 0; ms <= 100; ms += 2) {
    Send(9, ms, ms * kMillisecond_ns);  // other forces every time
    const provider::BodySensors read = At(ms * kMillisecond_ns);
    EXPECT_EQ(read.foot_valid[4], ms <= 20) << ms;
    EXPECT_EQ(read.foot_force_N[4], 0.0) << "that of the first";
    EXPECT_EQ(measured.lost(), ms > 60) << ms;
  }
  EXPECT_EQ(measured.counts().lost, 1U);
  EXPECT_EQ(measured.counts().samples_missed, 0U);
}

TEST_F(FootMeasurement, ALossIsCountedOnceAndEndsWithANewSample) {
  Send(1, 1.0, 0);
  (void)At(60 * kMillisecond_ns);
  EXPECT_FALSE(measured.lost());
  for (int ms = 61; ms < 100; ++ms) (void)At(ms * kMillisecond_ns);
  EXPECT_TRUE(measured.lost());
  EXPECT_EQ(measured.counts().lost, 1U);
  Send(2, 1.0, 100 * kMillisecond_ns);
  EXPECT_TRUE(At(100 * kMillisecond_ns).foot_valid[4]);
  EXPECT_FALSE(measured.lost());
  (void)At(200 * kMillisecond_ns);
  EXPECT_EQ(measured.counts().lost, 2U);
}

TEST_F(FootMeasurement, OneThatNeverSendsIsLostFromTheResetOn) {
  measured.Reset(1000 * kMillisecond_ns);
  (void)At(1060 * kMillisecond_ns);
  EXPECT_EQ(measured.counts().lost, 0U);
  (void)At(1061 * kMillisecond_ns);
  EXPECT_EQ(measured.counts().lost, 1U);
}

TEST_F(FootMeasurement, GapsOfTheSequenceAreMissedSamplesAlsoWhereItBeginsAnew) {
  for (const int sequence : {200, 201, 204, 255, 0, 2}) {
    Send(static_cast<std::uint8_t>(sequence), 1.0, 0);
  }
  EXPECT_EQ(measured.counts().samples_missed, 2U + 50U + 0U + 1U);
  Send(200, 1.0, 0);  // 58 back: the node has started again
  EXPECT_EQ(measured.counts().samples_missed, 53U);
}

TEST_F(FootMeasurement, AForceAtAnEndOfItsFieldMayBeAnythingBeyond) {
  std::uint8_t sequence = 0;
  for (const auto& [force_N, valid] :
       {std::pair{818.8, true}, {819.0, false}, {5000.0, false}, {-819.0, true}, {-819.2, false}}) {
    Send(++sequence, force_N, 0);
    const provider::BodySensors read = At(0);
    EXPECT_EQ(read.foot_valid[4], valid) << force_N;
    EXPECT_TRUE(read.foot_valid[5]) << "its neighbour";
  }
  EXPECT_NEAR(body.foot_force_N[4], -819.2, 1e-9) << "held";
}

TEST_F(FootMeasurement, AnotherVersionOfTheFramesIsNotValid) {
  Send(1, 1.0, 0);
  EXPECT_TRUE(At(0).foot_valid[4]);
  Heartbeat(can::kNodeFramesVersion + 1);
  EXPECT_FALSE(At(0).foot_valid[4]);
  measured.Reset(0);
  Send(2, 1.0, 0);
  EXPECT_FALSE(At(0).foot_valid[4]) << "before the first heartbeat";
  Heartbeat();
  EXPECT_TRUE(At(0).foot_valid[4]);
}

TEST_F(FootMeasurement, MalformedFramesAndThoseOfAnImuChangeNothing) {
  Send(1, 1.0, 0);
  can::Frame cut = can::Encode(kBodyNode, can::FootForces{{9.0}, {}, 2});
  cut.length = 7;
  EXPECT_EQ(measured.Take({cut, kMillisecond_ns}), BodyMeasurement::Taken::kMalformed);
  can::Frame beat = can::Encode(kBodyNode, can::NodeHeartbeat{});
  beat.length = 5;
  EXPECT_EQ(measured.Take({beat, kMillisecond_ns}), BodyMeasurement::Taken::kMalformed);
  EXPECT_EQ(measured.Take({can::Encode(kBodyNode, can::ImuForce{{9.0}, 2}), kMillisecond_ns}),
            BodyMeasurement::Taken::kUnused);
  EXPECT_NEAR(At(0).foot_force_N[4], 1.0, 1e-9);
  EXPECT_TRUE(body.foot_valid[4]);
}

class ImuMeasurement : public ::testing::Test {
 protected:
  ImuMeasurement() { (void)measured.Take({can::Encode(42, can::NodeHeartbeat{}), 0}); }
  // Bits of `parts`: force, rate, orientation.
  void Send(std::uint8_t sequence, double value, std::int64_t stamp_ns, int parts = 7) {
    if ((parts & 1) != 0) {
      Take(can::Encode(42, can::ImuForce{{value, 0.0, 9.81}, sequence, true, true, true}),
           stamp_ns);
    }
    if ((parts & 2) != 0) {
      Take(can::Encode(42, can::ImuRate{{0.0, value, 0.0}, sequence, {}}), stamp_ns);
    }
    if ((parts & 4) != 0) Take(can::Encode(42, can::ImuOrientation{{}, sequence, 0}), stamp_ns);
  }
  void Take(const can::Frame& frame, std::int64_t stamp_ns) {
    EXPECT_EQ(measured.Take({frame, stamp_ns}), BodyMeasurement::Taken::kStored);
  }
  provider::BodySensors At(std::int64_t now_ns) {
    measured.Fill(now_ns, &body);
    return body;
  }

  BodyNodeConfig config{0, 42, can::BodyPart::kImu};
  BridgeTiming timing;
  BodyMeasurement measured{config, timing};
  provider::BodySensors body;
};

TEST_F(ImuMeasurement, ASampleCountsWhenAllThreeFramesCame) {
  Send(1, 1.0, 0);
  EXPECT_TRUE(At(0).imu_valid);
  Send(2, 2.0, 1, 3);
  EXPECT_NEAR(At(1).acceleration_m_s2[0], 1.0, 1e-9) << "the whole sample before";
  EXPECT_NEAR(body.angular_velocity_rad_s[1], 1.0, 1e-9);
  Send(2, 2.0, 2, 4);
  EXPECT_NEAR(At(2).acceleration_m_s2[0], 2.0, 1e-9);
  EXPECT_NEAR(body.angular_velocity_rad_s[1], 2.0, 1e-9);
}

TEST_F(ImuMeasurement, ALostFrameLosesItsSampleOnly) {
  Send(1, 1.0, 0);
  Send(2, 2.0, 1, 5);  // no rate
  Send(3, 3.0, 2, 6);  // no force
  EXPECT_NEAR(At(2).acceleration_m_s2[0], 1.0, 1e-9);
  Send(4, 4.0, 3);
  EXPECT_NEAR(At(3).acceleration_m_s2[0], 4.0, 1e-9);
  EXPECT_EQ(measured.counts().samples_missed, 2U);
}

TEST_F(ImuMeasurement, TheAgeIsThatOfTheFirstFrame) {
  Send(1, 1.0, 0, 1);
  Send(1, 1.0, 15 * kMillisecond_ns, 6);
  EXPECT_TRUE(At(20 * kMillisecond_ns).imu_valid);
  EXPECT_FALSE(At(20 * kMillisecond_ns + 1).imu_valid);
}

TEST_F(ImuMeasurement, ASequenceThatStandsStillIsAMeasurementThatStandsStill) {
  for (int ms = 0; ms <= 100; ms += 2) {
    Send(3, ms, ms * kMillisecond_ns);
    EXPECT_EQ(At(ms * kMillisecond_ns).imu_valid, ms <= 20) << ms;
    EXPECT_EQ(body.acceleration_m_s2[0], 0.0) << ms;
  }
  EXPECT_EQ(measured.counts().lost, 1U);
}

TEST_F(ImuMeasurement, AnySensorThatIsNotValidMakesTheSampleNotValid) {
  for (int missing = 0; missing < 3; ++missing) {
    const auto sequence = static_cast<std::uint8_t>(missing);
    Take(can::Encode(42, can::ImuForce{{}, sequence, missing != 0, missing != 1, missing != 2}), 0);
    Send(sequence, 0.0, 0, 6);
    EXPECT_FALSE(At(0).imu_valid) << missing;
  }
  Send(3, 0.0, 0);
  EXPECT_TRUE(At(0).imu_valid);
}

TEST_F(ImuMeasurement, AValueAtAnEndOfItsFieldMakesTheSampleNotValid) {
  std::uint8_t sequence = 0;
  for (const auto& [force_m_s2, rate_rad_s, valid] : {std::tuple{163.83, 32.766, true},
                                                      {163.835, 1.0, false},
                                                      {-163.83, -32.767, true},
                                                      {-163.84, 1.0, false},
                                                      {9.81, 32.767, false},
                                                      {9.81, -40.0, false},
                                                      {9.81, 0.0, true}}) {
    ++sequence;
    Take(can::Encode(42, can::ImuForce{{0.0, force_m_s2, 0.0}, sequence, true, true, true}), 0);
    Take(can::Encode(42, can::ImuRate{{0.0, 0.0, rate_rad_s}, sequence, {}}), 0);
    Send(sequence, 0.0, 0, 4);
    EXPECT_EQ(At(0).imu_valid, valid) << force_m_s2 << ' ' << rate_rad_s;
  }
}

TEST_F(ImuMeasurement, AnOrientationThatIsNoRotationIsMalformed) {
  Send(1, 1.0, 0);
  Send(2, 2.0, 1, 3);
  const can::ImuOrientation impossible{{0.7, 0.7, 0.7}, 2, 0};
  EXPECT_EQ(measured.Take({can::Encode(42, impossible), 2}), BodyMeasurement::Taken::kMalformed);
  EXPECT_NEAR(At(2).acceleration_m_s2[0], 1.0, 1e-9);
}

// Turned by 90 degrees about z: the housing's x is the torso's y.
TEST(ImuMounting, TurnsHousingIntoTorso) {
  const double quarter_rad = std::acos(0.0);
  const BodyNodeConfig config{0, 42, can::BodyPart::kImu, {0.0, 0.0, quarter_rad}};
  const BridgeTiming timing;
  BodyMeasurement measured(config, timing);
  // The torso level and straight: the housing is turned in the world as it is in the torso.
  const double half = std::sqrt(0.5);
  for (const can::Frame& frame :
       {can::Encode(42, can::NodeHeartbeat{}),
        can::Encode(42, can::ImuForce{{1.0, 2.0, 9.81}, 1, true, true, true}),
        can::Encode(42, can::ImuRate{{0.5, 0.25, -1.0}, 1, {}}),
        can::Encode(42, *can::OmitLargest({half, 0.0, 0.0, half}, 1))}) {
    EXPECT_EQ(measured.Take({frame, 0}), BodyMeasurement::Taken::kStored);
  }
  provider::BodySensors body;
  measured.Fill(0, &body);
  const std::array<double, 3> force = {-2.0, 1.0, 9.81}, rate = {-0.25, 0.5, -1.0};
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_NEAR(body.acceleration_m_s2[i], force[i], 0.0026) << i;
    EXPECT_NEAR(body.angular_velocity_rad_s[i], rate[i], 0.00051) << i;
    EXPECT_NEAR(body.orientation_wxyz[1 + i], 0.0, 4e-5) << i;
  }
  EXPECT_NEAR(std::abs(body.orientation_wxyz[0]), 1.0, 1e-9);
  EXPECT_TRUE(body.imu_valid);
}

}  // namespace
}  // namespace sinew::bridge
