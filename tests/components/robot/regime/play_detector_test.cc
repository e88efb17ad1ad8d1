// Oracle: synthetic play angles whose true contact is known; 14-bit encoder and noise as on the
// rig.
#include "components/robot/regime/play_detector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/base/types/regime.h"
#include "tests/support/allocations.h"
#include "tests/support/rig_constants.h"

namespace sinew::regime {
namespace {

constexpr double kPlay_rad = 0.0464258;

class Encoder {
 public:
  explicit Encoder(double noise_rad, unsigned seed) : noise_rad_(noise_rad), random_(seed) {
    zero_ = std::uniform_real_distribution<double>(-0.5, 0.5)(random_) * kCount_rad;
  }
  double Read(double angle_rad) {
    const double blurred = angle_rad + zero_ + noise_rad_ * normal_(random_);
    return kCount_rad * std::round(blurred / kCount_rad) - zero_;
  }

 private:
  double noise_rad_;
  double zero_;
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

Contact TruthOf(double alpha_rad) {
  if (alpha_rad <= 0.0) return Contact::kLower;
  return alpha_rad >= kPlay_rad ? Contact::kUpper : Contact::kNone;
}

// Rest in a contact, through the play at one speed, rest in the other, and back, several times.
std::vector<double> Crossings(double step_rad, double penetration_rad, int times, unsigned seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> part(0.001, 1.0);
  std::vector<double> alpha;
  for (int i = 0; i <= times; ++i) {
    const bool up = i % 2 == 0;
    for (int k = 0; k < 200; ++k)
      alpha.push_back(up ? -penetration_rad : kPlay_rad + penetration_rad);
    if (i == times) break;
    for (double way = step_rad * part(random); way < kPlay_rad; way += step_rad) {
      alpha.push_back(up ? way : kPlay_rad - way);
    }
  }
  return alpha;
}

struct Score {
  double wrong_share = 0.0;
  int flips = 0;
  int transitions = 0;
};

// Wrong outside one sample of a transition, or, where the play has opened by less than two counts,
// not yet.
Score Assess(const std::vector<double>& alpha, double noise_rad, unsigned seed) {
  PlayConfig config;
  config.backlash_rad = kPlay_rad;
  config.output_noise_rad = noise_rad;
  PlayDetector detector(config);
  Encoder encoder(noise_rad, seed);
  Score score;
  long wrong = 0;
  Contact before = Contact::kNone;
  for (std::size_t k = 0; k < alpha.size(); ++k) {
    const PlayDecision decision = detector.Step(encoder.Read(alpha[k]), 0.0);
    const Contact truth = TruthOf(alpha[k]);
    if (k > 0 && truth != TruthOf(alpha[k - 1])) ++score.transitions;
    if (k > 0 && decision.contact != before) ++score.flips;
    before = decision.contact;
    const bool at_transition = k == 0 || k + 1 == alpha.size() || truth != TruthOf(alpha[k - 1]) ||
                               truth != TruthOf(alpha[k + 1]) ||
                               (k > 1 && truth != TruthOf(alpha[k - 2]));
    const bool hardly_open =
        truth == Contact::kNone && std::min(alpha[k], kPlay_rad - alpha[k]) < 2.0 * kCount_rad;
    EXPECT_EQ(decision.regime,
              decision.contact == Contact::kNone ? types::Regime::kSea : types::Regime::kPea);
    if (!at_transition && !hardly_open && decision.contact != truth) ++wrong;
  }
  score.wrong_share = static_cast<double>(wrong) / static_cast<double>(alpha.size());
  return score;
}

TEST(PlayDetector, IsRightInAtLeast995PerMilleAtEverySpeedAndNoise) {
  for (const double noise_rad : {0.0, 0.00005, 0.00015}) {
    for (const double step_counts :
         {0.02, 0.05, 0.1, 0.2, 0.35, 0.5, 0.75, 1.0, 1.5, 2.0, 4.0, 10.0, 30.0}) {
      for (const double penetration_counts : {0.0, 0.5, 2.0}) {
        const int times = step_counts < 0.1 ? 4 : 40;
        const std::vector<double> alpha =
            Crossings(step_counts * kCount_rad, penetration_counts * kCount_rad, times, 11);
        const Score score = Assess(alpha, noise_rad, 5);
        const std::string where = std::to_string(noise_rad) + " rad, " +
                                  std::to_string(step_counts) + " counts a sample, " +
                                  std::to_string(penetration_counts) + " counts deep";
        EXPECT_LE(score.wrong_share, 0.005) << where;
        EXPECT_EQ(score.flips, score.transitions) << where << ": chatters";
      }
    }
  }
}

TEST(PlayDetector, MoreNoiseThanTwoCountsIsSlowerButDoesNotChatter) {
  const double noise_rad = 2.0 * kCount_rad;
  const Score score = Assess(Crossings(0.5 * kCount_rad, 0.0, 40, 3), noise_rad, 4);
  EXPECT_EQ(score.flips, score.transitions);
  EXPECT_LE(score.wrong_share, 0.05);
}

TEST(PlayDetector, RestingAnywhereNearAContactItDoesNotChatter) {
  // At rest for eight minutes at each distance; the first decision and one correction are allowed.
  int flips = 0;
  for (double counts = -2.0; counts <= 6.0; counts += 0.25) {
    const Score score = Assess(std::vector<double>(240 * 480, counts * kCount_rad), 0.00015, 17);
    EXPECT_LE(score.flips, 4) << counts << " counts";
    flips += score.flips;
  }
  EXPECT_LE(flips, 50);
}

TEST(PlayDetector, FindsAFastTransitionOnTheFirstSample) {
  PlayConfig config;
  config.backlash_rad = kPlay_rad;
  PlayDetector detector(config);
  for (int k = 0; k < 50; ++k) EXPECT_EQ(detector.Step(0.0, 0.0).contact, Contact::kLower);
  EXPECT_EQ(detector.Step(0.01, 0.0).contact, Contact::kNone);
  EXPECT_EQ(detector.Step(0.02, 0.0).contact, Contact::kNone);
  EXPECT_EQ(detector.Step(0.03, 0.0).contact, Contact::kNone);
  EXPECT_EQ(detector.Step(0.04, 0.0).contact, Contact::kNone);
  EXPECT_EQ(detector.Step(kPlay_rad, 0.0).contact, Contact::kUpper);
}

TEST(PlayDetector, ConfidenceIsOneHalfAtTheThresholdAndNearOneAwayFromIt) {
  PlayConfig config;
  config.backlash_rad = kPlay_rad;
  PlayDetector inside(config);
  EXPECT_GT(inside.Step(0.5 * kPlay_rad, 0.0).confidence, 0.999999);
  PlayDetector contact(config);
  EXPECT_GT(contact.Step(-5.0 * kCount_rad, 0.0).confidence, 0.999999);
  PlayDetector edge(config);
  const double threshold = std::max(kCount_rad, 2.5 * edge.sigma_rad());
  EXPECT_NEAR(edge.Step(threshold, 0.0).confidence, 0.5, 1e-9);
}

TEST(PlayDetector, SamplingSkewMakesItMoreCarefulInFastMotion) {
  PlayConfig config;
  config.backlash_rad = kPlay_rad;
  config.sampling_skew_s = 0.001;
  PlayDetector detector(config);
  for (int k = 0; k < 10; ++k) static_cast<void>(detector.Step(0.0, 2.0));
  // 1 ms at 2 rad/s is 0.002 rad: an angle of that size says nothing while it moves so fast.
  EXPECT_EQ(detector.Step(0.003, 2.0).contact, Contact::kLower);
  EXPECT_EQ(detector.Step(0.02, 2.0).contact, Contact::kNone);
}

TEST(PlayDetector, AMillionStepsAllocateNothing) {
  PlayConfig config;
  config.backlash_rad = kPlay_rad;
  PlayDetector detector(config);
  const long before = test::Allocations();
  int inside = 0;
  for (int k = 0; k < 1000000; ++k) {
    inside += detector.Step(0.5 * kPlay_rad * (1.0 + 1.5 * std::sin(1e-3 * k)), 0.0).regime ==
              types::Regime::kSea;
  }
  EXPECT_EQ(test::Allocations() - before, 0);
  // |sin| < 1 / 1.5 inside: 2/pi asin(1/1.5).
  EXPECT_NEAR(inside / 1e6, 2.0 / 3.14159265 * std::asin(1.0 / 1.5), 0.02);
}

TEST(PlayDetector, BadConfigurationIsRefused) {
  EXPECT_THROW(PlayDetector({}), std::invalid_argument);
  EXPECT_THROW(PlayDetector({.backlash_rad = -0.1}), std::invalid_argument);
  EXPECT_THROW(PlayDetector({.backlash_rad = 0.001}), std::invalid_argument);  // under eight counts
  EXPECT_THROW(PlayDetector({.backlash_rad = 0.05, .output_noise_rad = std::nan("")}),
               std::invalid_argument);
  EXPECT_THROW(PlayDetector({.backlash_rad = 0.05, .hysteresis_counts = 0.0}),
               std::invalid_argument);
}

}  // namespace
}  // namespace sinew::regime
