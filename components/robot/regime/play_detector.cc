#include "components/robot/regime/play_detector.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

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
  const double threshold_rad = Threshold_rad(sigma_rad_);
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

double PlayDetector::Threshold_rad(double sigma_rad) const noexcept {
  return std::max(0.5 * config_.hysteresis_counts * config_.output_count_rad, 2.5 * sigma_rad);
}

double PlayDetector::Sum(Contact contact, int samples) const noexcept {
  double sum = 0.0;
  for (int age = 0; age < samples; ++age) sum += Distance(contact, age);
  return sum;
}

bool PlayDetector::Leaves(double threshold, double sigma) const noexcept {
  // Firmly in contact, two samples that both point away are enough.
  bool leaves = firm_ && Distance(contact_, 0) > threshold + 2.0 * sigma &&
                Distance(contact_, 1) > threshold + 0.5 * sigma;
  double sum = 0.0;
  for (int n = 1; n <= since_ && !leaves; ++n) {
    sum += Distance(contact_, n - 1);
    leaves = sum > n * threshold + 4.5 * sigma * std::sqrt(n);
  }
  return leaves;
}

bool PlayDetector::Reaches(Contact side, double threshold, double sigma) const noexcept {
  double sum = 0.0;
  for (int n = 1; n <= std::max(since_, 1); ++n) {
    sum += Distance(side, n - 1);
    if (sum < n * threshold - 4.5 * sigma * std::sqrt(n)) return true;
  }
  if (!far_[Index(side)] || known_ < 5) return false;
  const double nearer = 0.5 * (Distance(side, 3) - Distance(side, 1));
  const double nearer_before = 0.5 * (Distance(side, 4) - Distance(side, 2));
  const double jump = Distance(side, 1) - Distance(side, 0);
  return (Distance(side, 0) <= threshold - sigma && (nearer >= sigma || jump >= 6.0 * sigma)) ||
         (Distance(side, 0) <= threshold && nearer_before >= 1.5 * sigma);
}

PlayDecision PlayDetector::Step(double alpha_rad, double velocity_rad_s) noexcept {
  alpha_[next_] = alpha_rad;
  next_ = (next_ + 1) % kWindow;
  known_ = std::min(known_ + 1, kWindow);
  since_ = std::min(since_ + 1, kWindow);

  const double sigma = std::hypot(sigma_rad_, config_.sampling_skew_s * velocity_rad_s);
  const double threshold = Threshold_rad(sigma);
  for (const Contact side : {Contact::kLower, Contact::kUpper}) {
    bool& far = far_[Index(side)];
    if (contact_ == side) {
      far = false;
    } else if (known_ >= 4) {
      far = far || 0.25 * Sum(side, 4) > threshold + 5.5 * sigma;
    }
  }

  if (!started_) {
    started_ = true;
    if (Distance(Contact::kLower, 0) <= threshold) contact_ = Contact::kLower;
    if (Distance(Contact::kUpper, 0) <= threshold) contact_ = Contact::kUpper;
  } else if (contact_ != Contact::kNone) {
    const bool leaves = Leaves(threshold, sigma);
    const bool surely = since_ >= 8 && Sum(contact_, 8) / 8.0 < threshold - 1.75 * sigma;
    firm_ = !leaves && (firm_ || surely);
    if (leaves) {
      contact_ = Contact::kNone;
      since_ = 0;
    }
  }
  if (contact_ == Contact::kNone) {
    for (const Contact side : {Contact::kLower, Contact::kUpper}) {
      if (!Reaches(side, threshold, sigma)) continue;
      contact_ = side;
      firm_ = false;
      since_ = 0;
      break;
    }
  }

  const int n = std::clamp(since_, 1, 4);
  const double margin =
      contact_ == Contact::kNone
          ? std::min(Sum(Contact::kLower, n), Sum(Contact::kUpper, n)) / n - threshold
          : threshold - Sum(contact_, n) / n;
  PlayDecision decision;
  decision.contact = contact_;
  decision.regime = contact_ == Contact::kNone ? types::Regime::kSea : types::Regime::kPea;
  decision.confidence = 0.5 * std::erfc(-margin * std::sqrt(n) / (sigma * std::sqrt(2.0)));
  return decision;
}

}  // namespace sinew::regime
