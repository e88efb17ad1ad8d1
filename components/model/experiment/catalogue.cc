#include "components/model/experiment/catalogue.h"

#include <stdexcept>

#include "components/base/types/angle.h"
#include "components/base/types/joined.h"
#include "components/model/experiment/backlash.h"
#include "components/model/experiment/breakaway.h"
#include "components/model/experiment/data_sets.h"
#include "components/model/experiment/motor.h"
#include "components/model/experiment/push.h"

namespace sinew::experiment {
namespace {

[[noreturn]] void NoSuch(std::string_view name) {
  throw std::invalid_argument("no experiment '" + std::string(name) +
                              "', expected one of: " + types::Joined(ExperimentNames()));
}

}  // namespace

const std::vector<std::string>& ExperimentNames() {
  static const std::vector<std::string> kNames{
      "backlash", "breakaway", "moving-friction", "stiffness", "motor", "sea-data", "pea-data"};
  return kNames;
}

std::unique_ptr<Protocol> MakeProtocol(std::string_view name, const Repetition& r) {
  const int trials = r.trials;
  if (name == "backlash") {
    return std::make_unique<BacklashProtocol>(
        BacklashPlan{.trials = trials > 0 ? trials : (r.quick ? 8 : 100)});
  }
  if (name == "breakaway") {
    std::vector<double> angles_rad;
    int number = 0;
    for (const double angle_deg : kBreakawayAngles_deg) {
      if (!r.quick || number++ % 2 == 0) angles_rad.push_back(angle_deg * types::kDegree_rad);
    }
    return std::make_unique<BreakawayTour>(
        angles_rad, BreakawayPlan{.rest_s = r.rest_s, .play_rad = r.play_rad}, r.gear_ratio);
  }
  if (name == "moving-friction") {
    return std::make_unique<PushProtocol>(PushPlan{.duration_s = r.quick ? 50.0 : 120.0});
  }
  if (name == "stiffness") {
    return std::make_unique<PushProtocol>(
        PushPlan{.last_bar = 1.2, .duration_s = r.quick ? 75.0 : 180.0, .shut_every = 3});
  }
  if (name == "motor") {
    return std::make_unique<MotorProtocol>(
        MotorPlan{.duration_s = r.quick ? 15.0 : 40.0, .seed = r.seed});
  }
  if (name == "sea-data") return std::make_unique<SeaProtocol>(SeaPlan{.seed = r.seed});
  if (name == "pea-data") {
    return std::make_unique<PeaProtocol>(
        PeaPlan{.cycles = trials > 0 ? trials : (r.quick ? 6 : 100), .seed = r.seed});
  }
  NoSuch(name);
}

Result Identify(std::string_view name, const Recording& rows, const RigConstants& rig) {
  if (name == "backlash") return IdentifyBacklash(rows, rig);
  if (name == "breakaway") return IdentifyBreakaway(FindBreakaways(rows), rig);
  if (name == "moving-friction") return IdentifyMovingFriction(rows, rig);
  if (name == "stiffness") return IdentifyStiffness(rows, rig);
  if (name == "motor") return IdentifyMotor(rows, rig);
  if (name == "sea-data") return DescribeSea(rows, rig);
  if (name == "pea-data") return DescribePea(rows, rig);
  NoSuch(name);
}

}  // namespace sinew::experiment
