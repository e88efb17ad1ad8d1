// The fields that are an object's state, once for both ways (types/state_archive.h).
#include "components/base/types/state_archive.h"
#include "components/robot/pneumatics/manager.h"

namespace sinew::pneumatics {

void Relay::Exchange(types::StateArchive& archive) {
  std::int64_t switches = switches_;  // a long of any width
  archive(on_, since_s_, switches);
  switches_ = static_cast<long>(switches);
}

void PressureManager::Filtered::Exchange(types::StateArchive& archive) {
  archive(value_bar, rate_bar_s);
}

void PressureManager::Exchange(types::StateArchive& archive) {
  archive(valve_, compressor_, vent_, target_bar_, fault_, mode_, known_, uses_reservoir_, chamber_,
          reservoir_, stage_, stage_s_, joined_, bad_sensor_s_, bad_reservoir_s_, overpressure_s_,
          feedback_s_, still_s_, correcting_s_, progress_bar_, rest_change_bar_, rest_time_s_,
          leaking_s_);
}

}  // namespace sinew::pneumatics
