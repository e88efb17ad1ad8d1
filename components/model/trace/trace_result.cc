#include "components/model/trace/trace_result.h"

#include <algorithm>

namespace sinew::trace {

std::string_view ConfirmationWord(ConfirmationVerdict verdict) {
  switch (verdict) {
    case ConfirmationVerdict::kConfirmed:
      return "confirmed";
    case ConfirmationVerdict::kRefuted:
      return "refuted";
    case ConfirmationVerdict::kNotConfirmed:
      break;
  }
  return "not confirmed";
}

bool NearNoise(const Assessment& assessed) {
  const double noise = assessed.noise_floor_rms, error = assessed.before_held_out.rms;
  return error * error < 2.0 * noise * noise;
}

void SortByGain(std::vector<FoundEffect>* effects) {
  std::stable_sort(
      effects->begin(), effects->end(),
      [](const FoundEffect& a, const FoundEffect& b) { return a.gain_share > b.gain_share; });
}

}  // namespace sinew::trace
