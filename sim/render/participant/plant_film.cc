#include "sim/render/participant/plant_film.h"

#include <spdlog/spdlog.h>

#include "sim/render/file/scene_file.h"

namespace sinew::render {

namespace {

using Eigen::Isometry3d;

Isometry3d BaseOf(const provider::BodyTruth& truth) {
  const auto& p = truth.position_m;
  const auto& q = truth.orientation_wxyz;
  Isometry3d out = Isometry3d::Identity();
  out.translate(Eigen::Vector3d(p[0], p[1], p[2]));
  out.rotate(Eigen::Quaterniond(q[0], q[1], q[2], q[3]));
  return out;
}

LiveFilmOptions ToOptions(const std::vector<std::string>& joint_names,
                          const std::filesystem::path& video, bool fixed_base, bool lockstep) {
  LiveFilmOptions out;
  out.film.video = video;
  out.film.fixed_base = fixed_base;
  out.joint_names = joint_names;
  out.waits = lockstep;
  return out;
}

}  // namespace

PlantFilm::PlantFilm(const provider::SimulatedPlant& plant,
                     const std::vector<std::string>& joint_names, const std::filesystem::path& urdf,
                     const std::filesystem::path& video, bool lockstep)
    : plant_(plant),
      video_(video),
      fixed_base_(MountedPose(LoadScene(urdf)).world_from_base),
      live_(LoadScene(urdf),
            ToOptions(joint_names, video, plant.body_truth() == nullptr, lockstep)) {}

std::function<void(double, const provider::PlantSensors&)> PlantFilm::Observer() {
  return [this](double time_s, const provider::PlantSensors& sensors) {
    const auto read = [&](RobotPose* pose) {
      const provider::BodyTruth* truth = plant_.body_truth();
      pose->world_from_base = truth == nullptr ? fixed_base_ : BaseOf(*truth);
      for (std::size_t i = 0; i < pose->joint_rad.size(); ++i) {
        pose->joint_rad[i] = sensors.position_rad[i];
      }
    };
    live_.Offer(time_s, std::ref(read));
  };
}

void PlantFilm::Finish() {
  spdlog::info("view: ends the video");
  live_.Finish();
  spdlog::info("view: {}: {} frames, {} left out", video_.string(), live_.drawn(),
               live_.left_out());
}

}  // namespace sinew::render
