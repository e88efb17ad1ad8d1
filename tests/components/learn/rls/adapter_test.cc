#include "components/learn/rls/adapter.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace sinew::rls {
namespace {

constexpr double kPeriod_s = 1.0 / 240.0;

// A source of samples: features that vary, a target that W makes of them.
class Plant {
 public:
  explicit Plant(const Eigen::MatrixXd& truth) : truth_(truth), features_(truth.cols()) {}

  Observation Next(int network = 1) {
    ++t_;
    for (Eigen::Index i = 0; i < features_.size(); ++i) {
      features_(i) =
          std::sin(0.11 * t_ * (1.0 + 0.37 * static_cast<double>(i)) + static_cast<double>(i));
    }
    target_ = truth_ * features_;
    return {.armed = true,
            .usable = true,
            .fastest_velocity_rad_s = 1.0,
            .period_s = kPeriod_s,
            .network = network,
            .features = features_,
            .target_Nm = target_};
  }

 private:
  Eigen::MatrixXd truth_;
  Eigen::VectorXd features_;
  Eigen::VectorXd target_;
  int t_ = 0;
};

const Eigen::MatrixXd kOffline = Eigen::MatrixXd::Zero(1, 4);
const Eigen::MatrixXd kTruth = Eigen::RowVector4d(1.0, -2.0, 0.5, 3.0);

TEST(Adapter, LearnsTheTruthWhileArmedAndMoving) {
  Adapter adapter(AdapterConfig{}, std::nullopt, kOffline);
  Plant plant(kTruth);
  for (int t = 0; t < 3000; ++t) ASSERT_EQ(adapter.Step(plant.Next()), Frozen::kNo);
  // The leak holds back a little: delta / (samples remembered * variance) = 0.01 / 500.
  EXPECT_LT((adapter.estimator(1).readout() - kTruth).norm(), 1e-3);
  EXPECT_EQ(adapter.version(1), 3000u);
}

TEST(Adapter, IsFrozenUnlessArmedMovingAndUsable) {
  Adapter adapter(AdapterConfig{}, std::nullopt, kOffline);
  Plant plant(kTruth);
  Observation o = plant.Next();
  o.armed = false;
  EXPECT_EQ(adapter.Step(o), Frozen::kNotArmed);
  Observation p = plant.Next();
  p.usable = false;
  EXPECT_EQ(adapter.Step(p), Frozen::kNoSample);
  EXPECT_EQ(adapter.Step(plant.Next(0)), Frozen::kNoSample) << "there is no SEA network";
  Observation q = plant.Next();
  const Eigen::VectorXd bad = Eigen::VectorXd::Constant(1, std::nan(""));
  EXPECT_EQ(adapter.Step({.armed = true,
                          .usable = true,
                          .fastest_velocity_rad_s = 1.0,
                          .period_s = kPeriod_s,
                          .network = 1,
                          .features = q.features,
                          .target_Nm = bad}),
            Frozen::kNoSample);
  EXPECT_EQ(Eigen::MatrixXd(adapter.estimator(1).readout()), kOffline);
  EXPECT_EQ(adapter.version(1), 0u);
}

TEST(Adapter, StopsSomeTimeAfterTheJointsStandStill) {
  AdapterConfig config;
  config.still_after_s = 0.1;
  config.slowest_velocity_rad_s = 0.02;
  Adapter adapter(config, std::nullopt, kOffline);
  Plant plant(kTruth);
  const auto step = [&](double velocity) {
    Observation o = plant.Next();
    o.fastest_velocity_rad_s = velocity;
    return adapter.Step(o);
  };
  EXPECT_EQ(step(0.0), Frozen::kStandingStill) << "nothing has moved yet";
  EXPECT_EQ(step(0.05), Frozen::kNo);
  int learnt = 0;
  for (int t = 0; t < 240; ++t) learnt += step(0.01) == Frozen::kNo;
  EXPECT_NEAR(learnt, 24, 1);
  EXPECT_EQ(step(std::nan("")), Frozen::kStandingStill);
  EXPECT_EQ(step(0.02), Frozen::kNo);
}

TEST(Adapter, EachNetworkHasItsOwnReadoutAndVersionsOnlyGrow) {
  Adapter adapter(AdapterConfig{}, kOffline, kOffline);
  Plant sea(kTruth);
  Plant pea(2.0 * kTruth);
  for (int t = 0; t < 2000; ++t) {
    ASSERT_EQ(adapter.Step(sea.Next(0)), Frozen::kNo);
    EXPECT_EQ(adapter.network(), 0);
    ASSERT_EQ(adapter.Step(pea.Next(1)), Frozen::kNo);
    EXPECT_EQ(adapter.network(), 1);
  }
  EXPECT_LT((adapter.estimator(0).readout() - kTruth).norm(), 2e-3);
  EXPECT_LT((adapter.estimator(1).readout() - 2.0 * kTruth).norm(), 2e-3);
  EXPECT_EQ(adapter.version(0), 3999u);
  EXPECT_EQ(adapter.version(1), 4000u);
  adapter.Reset();
  EXPECT_EQ(adapter.version(0), 0u);
  EXPECT_EQ(Eigen::MatrixXd(adapter.estimator(0).readout()), kOffline);
}

TEST(Adapter, RefusesWhatCannotBe) {
  EXPECT_THROW(Adapter(AdapterConfig{}, std::nullopt, std::nullopt), std::invalid_argument);
  AdapterConfig config;
  config.still_after_s = -1.0;
  EXPECT_THROW(Adapter(config, kOffline, std::nullopt), std::invalid_argument);
  config = {};
  config.slowest_velocity_rad_s = std::nan("");
  EXPECT_THROW(Adapter(config, kOffline, std::nullopt), std::invalid_argument);
  config = {};
  config.rls.forgetting = 2.0;
  EXPECT_THROW(Adapter(config, kOffline, std::nullopt), std::invalid_argument);
}

TEST(Adapter, AStandbyGoesOnFromTheOwnersReadoutAndVersion) {
  Adapter owner(AdapterConfig{}, std::nullopt, kOffline);
  Adapter standby(AdapterConfig{}, std::nullopt, kOffline);
  Plant plant(kTruth);
  for (int t = 0; t < 500; ++t) (void)owner.Step(plant.Next());
  ASSERT_TRUE(standby.Adopt(1, owner.version(1), owner.estimator(1).readout()));
  EXPECT_EQ(standby.version(1), 500u);
  EXPECT_EQ(Eigen::MatrixXd(standby.estimator(1).readout()),
            Eigen::MatrixXd(owner.estimator(1).readout()));
  ASSERT_EQ(standby.Step(plant.Next()), Frozen::kNo);
  EXPECT_EQ(standby.version(1), 501u) << "a version says that the readout has changed";
  EXPECT_LT((standby.estimator(1).readout() - owner.estimator(1).readout()).norm(), 0.1);
}

TEST(Adapter, AReadoutThatDoesNotFitIsNotFollowed) {
  Adapter standby(AdapterConfig{}, std::nullopt, kOffline);
  EXPECT_FALSE(standby.Adopt(0, 9, kTruth)) << "no such network";
  EXPECT_FALSE(standby.Adopt(2, 9, kTruth));
  EXPECT_FALSE(standby.Adopt(1, 9, Eigen::MatrixXd::Zero(1, 3)));
  Eigen::MatrixXd broken = kTruth;
  broken(0, 2) = std::nan("");
  EXPECT_FALSE(standby.Adopt(1, 9, broken));
  EXPECT_EQ(standby.version(1), 0u);
  EXPECT_EQ(Eigen::MatrixXd(standby.estimator(1).readout()), kOffline);
}

}  // namespace
}  // namespace sinew::rls
