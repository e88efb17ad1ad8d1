// The fields that are an object's state, once for both ways (types/state_archive.h).
#include "components/base/types/state_archive.h"
#include "components/robot/regime/detector.h"

namespace sinew::regime {

void PlayDetector::Exchange(types::StateArchive& archive) {
  archive(alpha_);
  archive.Bounded(next_, kWindow - 1);
  archive.Bounded(known_, kWindow);
  archive(since_, far_, firm_, contact_, started_);
}

void RegimeDetector::Exchange(types::StateArchive& archive) {
  archive(play_, session_id_, session_known_, setup_done_, offset_rad_, offset_error_rad_, trouble_,
          outside_, stage_, stage_s_, start_motor_rad_, target_rad_, rigid_motor_rad_,
          rigid_first_rad_, rigid_sum_rad_, rigid_squares_rad2_, rigid_count_);
}

}  // namespace sinew::regime
