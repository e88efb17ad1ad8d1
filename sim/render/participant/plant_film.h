// --view of a simulated state provider: a video of its plant.
//
// The base is that of the plant's body_truth; a fixed base is that of MountedPose. Joints are where
// their sensors read.
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "components/robot/provider/plant.h"
#include "components/robot/provider/simulated_plant.h"
#include "sim/render/participant/live_film.h"

namespace sinew::render {

class PlantFilm {
 public:
  // joint_names: of the plant's joints, in its order. The plant must outlive this. Throws
  // UsageError: URDF or video; std::invalid_argument: a joint that is not in the URDF.
  PlantFilm(const provider::SimulatedPlant& plant, const std::vector<std::string>& joint_names,
            const std::filesystem::path& urdf, const std::filesystem::path& video, bool lockstep);

  // For ProviderOptions::stepped. This must outlive it.
  std::function<void(double time_s, const provider::PlantSensors& sensors)> Observer();
  // LiveFilm::Finish, with a line in the log.
  void Finish();

 private:
  const provider::SimulatedPlant& plant_;
  std::filesystem::path video_;
  Eigen::Isometry3d fixed_base_;
  LiveFilm live_;
};

}  // namespace sinew::render
