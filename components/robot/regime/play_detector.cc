#include "components/robot/regime/play_detector.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "components/base/types/regime.h"

namespace sinew::regime {
namespace {

std::size_t Index(Contact side) { return side == Contact::kUpper ? 1 : 0; }

}  // namespace

PlayDetector::PlayDetector(const PlayConfig& config) : config_(config) {
  const auto positive = [](double value, const char* what) {
    if (!(value > 0.0) || !std::isfinite(value)) {
      throw std::invalid_argument(std::string(what) + " is " + std::to_string(value) +
                                  ", expected more than 0");
    }
  };
  positive(config.backlash_rad, "backlash");
  positive(config.output_count_rad, "encoder count");
  positive(config.hysteresis_counts, "hysteresis");
  if (!(config.output_noise_rad >= 0.0) || !std::isfinite(config.output_noise_rad) ||
      !(config.sampling_skew_s >= 0.0) || !std::isfinite(config.sampling_skew_s)) {
    throw std::invalid_argument("encoder noise or sampling skew is negative or not finite");
  }
  sigma_rad_ = std::hypot(config.output_noise_rad, config.output_count_rad / std::sqrt(12.0));
  const double threshold_rad =
      std::max(0.5 * config.hysteresis_counts * config.output_count_rad, 2.5 * sigma_rad_);
  if (config.backlash_rad < 8.0 * threshold_rad) {
    throw std::invalid_argument(
        "backlash " + std::to_string(config.backlash_rad) +
        " rad cannot be distinguished from encoder noise, expected at least " +
        std::to_string(8.0 * threshold_rad) + " rad");
  }
}

void PlayDetector::Reset() noexcept {
  next_ = known_ = since_ = 0;
  far_ = {};
  started_ = firm_ = false;
  contact_ = Contact::kNone;
}

PlayDecision PlayDetector::Step(double alpha_rad, double velocity_rad_s) noexcept {
  alpha_[next_] = alpha_rad;
  next_ = (next_ + 1) % kWindow;
  known_ = std::min(known_ + 1, kWindow);
  since_ = std::min(since_ + 1, kWindow);

  const double sigma = std::hypot(sigma_rad_, config_.sampling_skew_s * velocity_rad_s);
  const double threshold =
      std::max(0.5 * config_.hysteresis_counts * config_.output_count_rad, 2.5 * sigma);
  // Distance into the play from a contact, of the sample `age` samples ago.
  const auto distance = [this](Contact contact, int age) {
    return contact == Contact::kUpper ? config_.backlash_rad - Recent(age) : Recent(age);
  };

  for (const Contact side : {Contact::kLower, Contact::kUpper}) {
    if (contact_ == side) {
      far_[Index(side)] = false;
    } else if (known_ >= 4) {
      const double mean =
          0.25 * (distance(side, 0) + distance(side, 1) + distance(side, 2) + distance(side, 3));
      far_[Index(side)] = far_[Index(side)] || mean > threshold + 5.5 * sigma;
    }
  }

  if (!started_) {
    started_ = true;
    if (distance(Contact::kLower, 0) <= threshold) contact_ = Contact::kLower;
    if (distance(Contact::kUpper, 0) <= threshold) contact_ = Contact::kUpper;
  } else if (contact_ != Contact::kNone) {
    double sum = 0.0;
    // Firmly in contact, two samples that both point away are enough.
    bool leaves = firm_ && distance(contact_, 0) > threshold + 2.0 * sigma &&
                  distance(contact_, 1) > threshold + 0.5 * sigma;
    double mean_8 = 0.0;
    for (int n = 1; n <= since_ && !leaves; ++n) {
      sum += distance(contact_, n - 1);
      leaves = sum > n * threshold + 4.5 * sigma * std::sqrt(n);
      if (n == 8) mean_8 = sum / 8.0;
    }
    firm_ = !leaves && (firm_ || (since_ >= 8 && mean_8 < threshold - 1.75 * sigma));
    if (leaves) {
      contact_ = Contact::kNone;
      since_ = 0;
    }
  }
  if (contact_ == Contact::kNone) {
    for (const Contact side : {Contact::kLower, Contact::kUpper}) {
      double sum = 0.0;
      bool reaches = false;
      for (int n = 1; n <= std::max(since_, 1) && !reaches; ++n) {
        sum += distance(side, n - 1);
        reaches = sum < n * threshold - 4.5 * sigma * std::sqrt(n);
      }
      if (!reaches && far_[Index(side)] && known_ >= 5) {
        const double nearer = 0.5 * (distance(side, 3) - distance(side, 1));
        const double nearer_before = 0.5 * (distance(side, 4) - distance(side, 2));
        const double jump = distance(side, 1) - distance(side, 0);
        reaches =
            (distance(side, 0) <= threshold - sigma && (nearer >= sigma || jump >= 6.0 * sigma)) ||
            (distance(side, 0) <= threshold && nearer_before >= 1.5 * sigma);
      }
      if (reaches) {
        contact_ = side;
        firm_ = false;
        since_ = 0;
        break;
      }
    }
  }

  PlayDecision decision;
  decision.contact = contact_;
  decision.regime = contact_ == Contact::kNone ? types::Regime::kSea : types::Regime::kPea;
  double margin = 0.0;
  const int n = std::clamp(since_, 1, 4);
  if (contact_ == Contact::kNone) {
    double lower = 0.0, upper = 0.0;
    for (int age = 0; age < n; ++age) {
      lower += distance(Contact::kLower, age);
      upper += distance(Contact::kUpper, age);
    }
    margin = std::min(lower, upper) / n - threshold;
  } else {
    double sum = 0.0;
    for (int age = 0; age < n; ++age) sum += distance(contact_, age);
    margin = threshold - sum / n;
  }
  decision.confidence = 0.5 * std::erfc(-margin * std::sqrt(n) / (sigma * std::sqrt(2.0)));
  return decision;
}

}  // namespace sinew::regime
