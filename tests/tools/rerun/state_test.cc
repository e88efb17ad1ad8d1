// Law: an object that goes on from the state of another gives the same bits from then on. Each is
// taken in the middle of what it does: a move, a contact, a correction, learning.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <random>
#include <vector>

#include "components/base/types/state_archive.h"
#include "components/learn/esn/file/weights_file.h"
#include "components/learn/esn/predictor.h"
#include "components/learn/rls/rls.h"
#include "components/robot/control/file/control_file.h"
#include "components/robot/control/robot_controller.h"
#include "components/robot/pneumatics/file/pneumatics_file.h"
#include "components/robot/pneumatics/manager.h"
#include "components/robot/reference/file/reference_file.h"
#include "components/robot/reference/standby.h"
#include "components/robot/regime/detector.h"
#include "components/robot/regime/file/regime_file.h"

namespace sinew {
namespace {

const std::string kRigFolder = SINEW_SOURCE_DIR "/robots/rig/";
constexpr double kStatePeriod_s = 1.0 / 240.0;
constexpr int kStepsBefore = 700;
constexpr int kStepsAfter = 500;

// What a step gives, as numbers that are compared by their bits.
using Values = std::vector<double>;

template <class Object>
void GoesOnFromItsState(const std::function<Object()>& make,
                        const std::function<Values(Object&, int)>& step) {
  Object first = make();
  for (int i = 0; i < kStepsBefore; ++i) (void)step(first, i);
  types::StateArchive out;
  first.Exchange(out);
  Object second = make();
  types::StateArchive in(out.bytes());
  second.Exchange(in);
  in.Finish();
  Object fresh = make();
  bool state_matters = false;
  for (int i = kStepsBefore; i < kStepsBefore + kStepsAfter; ++i) {
    const Values expected = step(first, i), got = step(second, i);
    ASSERT_EQ(expected.size(), got.size());
    ASSERT_EQ(std::memcmp(expected.data(), got.data(), expected.size() * sizeof(double)), 0)
        << "step " << i;
    state_matters = state_matters || step(fresh, i) != expected;
  }
  EXPECT_TRUE(state_matters) << "the state is in nothing that was compared";
}

double Wave(int step, double frequency_Hz) {
  return std::sin(2.0 * 3.14159 * frequency_Hz * kStatePeriod_s * step);
}

TEST(State, OfAControllerInAMove) {
  GoesOnFromItsState<control::RobotController>(
      [] {
        return control::RobotController(
            control::LoadControl(kRigFolder + "control_pid_model.yaml").joints);
      },
      [](control::RobotController& controller, int i) {
        control::RobotInput input;
        input.session_id = 5;
        input.period_s = kStatePeriod_s;
        input.armed = true;
        input.joint_count = 1;
        control::MeasuredJointState& m = input.joint[0];
        m.valid = m.actuator_valid = true;
        m.position_rad = 0.1 * Wave(i, 0.4);
        m.velocity_rad_s = 0.2 * Wave(i, 0.7);
        m.motor_velocity_rad_s = 10.0 * Wave(i, 0.7);
        m.pressure_bar = 3.0;
        // Moved slowly all the time; no reference.
        input.motion[0] = {types::Motion::kMoveSlowly, 1.0, 0.1, 0.0};
        const control::JointOutput output = controller.Step(input).joint[0];
        return Values{output.motor_torque_Nm, output.position_rad, output.velocity_rad_s};
      });
}

TEST(State, OfARegimeDetector) {
  GoesOnFromItsState<regime::RegimeDetector>(
      [] {
        return regime::RegimeDetector(regime::LoadRegime(kRigFolder + "regime.yaml").joints[0]);
      },
      [](regime::RegimeDetector& detector, int i) {
        regime::DetectorInput input;
        input.session_id = 5;
        input.period_s = kStatePeriod_s;
        input.armed = input.valid = true;
        // In firm lower contact, then a little above the threshold of 2.5 sigma, where the contact
        // is kept and nobody who comes there sees one (play_detector.h; sigma is 1.9e-4 rad).
        const double alpha_rad = i < kStepsBefore - 100 ? 0.0 : 5.4e-4;
        const regime::DetectorConfig& config = detector.config();
        input.motor_position_rad = config.gear_ratio * (config.play_center_rad -
                                                        0.5 * config.play.backlash_rad + alpha_rad);
        const regime::DetectorOutput output = detector.Step(input);
        return Values{output.alpha_rad, output.confidence, static_cast<double>(output.regime),
                      static_cast<double>(output.contact)};
      });
}

TEST(State, OfAPressureManagerInACorrection) {
  GoesOnFromItsState<pneumatics::PressureManager>(
      [] {
        return pneumatics::PressureManager(
            pneumatics::LoadPneumatics(kRigFolder + "pneumatics.yaml").joints[0]);
      },
      [](pneumatics::PressureManager& manager, int i) {
        if (i == 0) {
          EXPECT_TRUE(manager.RequestPressure(4.0));
        }
        pneumatics::ManagerInput input;
        input.period_s = kStatePeriod_s;
        input.active = input.valid = true;
        input.chamber_bar = 0.8 * kStatePeriod_s * i + 0.02 * Wave(i, 3.0);
        input.reservoir_bar = input.chamber_bar + 0.05;
        input.valve_is_open = true;
        const pneumatics::ManagerOutput output = manager.Step(input);
        return Values{output.pressure_bar, output.target_bar,
                      static_cast<double>(output.compressor_on), static_cast<double>(output.mode)};
      });
}

TEST(State, OfAReferenceInItsSoftStart) {
  const reference::RobotReferenceConfig config =
      reference::LoadReference(kRigFolder + "reference_benchmark.yaml").config;
  GoesOnFromItsState<reference::Standby>(
      [&] { return reference::Standby(config); },
      [](reference::Standby& standby, int i) {
        const double position_rad[] = {0.2};
        const bool valid[] = {true};
        reference::RobotReferenceInput input;
        input.session_id = 5;
        input.tick = static_cast<std::uint64_t>(i);
        input.period_s = kStatePeriod_s;
        input.may_move = i > kStepsBefore - 200;  // it starts shortly before the state is taken
        input.joint_count = 1;
        input.position_rad = position_rad;
        input.valid = valid;
        const reference::Point point = standby.Step(input, false).joint[0];
        return Values{point.position_rad, point.velocity_rad_s, point.acceleration_rad_s2};
      });
}

TEST(State, OfAPredictorAndItsReadout) {
  const esn::Weights sea = esn::LoadWeights(kRigFolder + "esn_sea.json");
  const esn::Weights pea = esn::LoadWeights(kRigFolder + "esn_pea.json");
  GoesOnFromItsState<esn::Predictor>(
      [&] { return esn::Predictor(sea, pea); },
      [&](esn::Predictor& predictor, int i) {
        if (i == kStepsBefore / 2) {
          EXPECT_TRUE(predictor.SetReadout(esn::Which::kPea, 9, 0.9 * pea.readout));
        }
        esn::Frame frame;
        for (int s = 0; s < esn::kSignalCount; ++s) {
          frame.Set(static_cast<esn::Signal>(s), 0, 0.3 * Wave(i + 11 * s, 0.5));
        }
        const esn::Prediction prediction = predictor.Step(frame, types::Regime::kPea);
        return Values{prediction.torque_Nm[0], prediction.sea_torque_Nm[0],
                      prediction.pea_torque_Nm[0],
                      static_cast<double>(predictor.readout_version(esn::Which::kPea))};
      });
}

TEST(State, OfAnEstimatorThatLearns) {
  constexpr int kFeatures = 40;
  const Eigen::MatrixXd offline = Eigen::MatrixXd::Constant(1, kFeatures, 0.1);
  GoesOnFromItsState<rls::RecursiveLeastSquares>(
      [&] { return rls::RecursiveLeastSquares(rls::Config{}, offline); },
      [&](rls::RecursiveLeastSquares& estimator, int i) {
        std::mt19937 random(static_cast<unsigned>(i));
        Eigen::VectorXd features(kFeatures);
        for (int f = 0; f < kFeatures; ++f) {
          features(f) = static_cast<double>(random()) / static_cast<double>(std::mt19937::max());
        }
        const Eigen::VectorXd target = Eigen::VectorXd::Constant(1, features.sum() * 0.3);
        (void)estimator.Update(features, target);
        return Values{estimator.readout()(0, 7), estimator.CovarianceTrace(),
                      estimator.innovation()(0), static_cast<double>(estimator.updates()),
                      static_cast<double>(estimator.clipped())};
      });
}

}  // namespace
}  // namespace sinew
