#include "tools/verify/verify.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>

#include "components/base/config/config.h"
#include "components/base/types/control_mode.h"
#include "components/base/types/joined.h"
#include "components/base/types/json_text.h"
#include "components/bodies/links/file/urdf_file.h"
#include "components/model/report/report.h"
#include "sim/surrogate/surrogate.h"
#include "sim/world/world.h"

namespace sinew::verify {
namespace {

using report::Text;

// One link on a fixed base whose inertia and gravity the model describes.
arm::Chain PointChain(const actuator::JointModel& joint) {
  arm::Body body;
  body.link_name = "link";
  body.joint_name = joint.name;
  body.moves = true;
  body.prismatic = joint.kind == types::JointKind::kPrismatic;
  body.axis = body.prismatic ? Eigen::Vector3d::UnitX() : Eigen::Vector3d(0.0, -1.0, 0.0);
  body.mass_kg = 1e-3;
  body.inertia_kg_m2 = 1e-6 * Eigen::Matrix3d::Identity();
  body.weightless = true;
  return {.name = joint.name, .bodies = {body}};
}

class WorldBody final : public free_run::Body {
 public:
  WorldBody(const actuator::JointModel& model, const arm::Chain& chain)
      : world_(Config(model, chain)) {}

  void Start(const effects::JointSample& x, std::span<const double> memory) override {
    world_.Start(0, x, memory);
    sensors_.motor_velocity_rad_s[0] = x.motor_velocity_rad_s;
  }
  void SetSurroundings(const effects::JointSample& x) override { world_.SetSurroundings(0, x); }
  void Step(double motor_torque_Nm, double dt_s) override {
    command_.mode[0] = types::ControlMode::kTorque;
    command_.motor_torque_Nm[0] = motor_torque_Nm;
    world_.Step(command_, dt_s, &sensors_);
  }
  double position_rad() const override { return world_.position_rad(0); }
  double velocity_rad_s() const override { return world_.velocity_rad_s(0); }
  double motor_velocity_rad_s() const override { return sensors_.motor_velocity_rad_s[0]; }

 private:
  static world::WorldConfig Config(const actuator::JointModel& model, const arm::Chain& chain) {
    world::WorldConfig config;
    config.chain = chain;
    // A recording's motion is its own: stops would hold a simulation that leaves it.
    for (arm::Body& body : config.chain.bodies) {
      body.lower = -std::numeric_limits<double>::infinity();
      body.upper = std::numeric_limits<double>::infinity();
    }
    config.model.name = model.name;
    config.model.joints = {model};
    config.substep_s = 1e-4;
    return config;
  }

  world::World world_;
  provider::PlantCommand command_;
  provider::PlantSensors sensors_;
};

double Mean(const std::vector<TrackingRun>& runs, bool after) {
  double sum = 0.0;
  for (const TrackingRun& run : runs) sum += (after ? run.after : run.before).mse_rad2;
  return std::sqrt(sum / static_cast<double>(runs.size()));
}

}  // namespace

free_run::MakeBody InWorld(const actuator::RobotModel& robot) {
  if (robot.joints.size() != 1) {
    throw std::invalid_argument("the model has " + std::to_string(robot.joints.size()) +
                                " joints, expected 1: a recording of one joint does not say what "
                                "the others did");
  }
  const arm::Chain chain = robot.urdf_path.empty()
                               ? PointChain(robot.joints.front())
                               : arm::ParseUrdf(config::ReadFile(robot.urdf_path), robot.urdf_path);
  return [chain](const actuator::JointModel& model) {
    return std::make_unique<WorldBody>(model, chain);
  };
}

free_run::FreeRunResult FollowRecordings(const std::vector<types::Run>& runs,
                                         const actuator::RobotModel& before,
                                         const actuator::RobotModel& after,
                                         const identify::ProcessingOptions& processing,
                                         double horizon_s) {
  free_run::FreeRunOptions options;
  options.horizon_s = horizon_s;
  static_cast<void>(InWorld(before));  // says what is wrong with it
  if (before.joints[0].kind != after.joints[0].kind ||
      before.joints[0].name != after.joints[0].name) {
    throw std::invalid_argument("the models describe '" + before.joints[0].name + "' and '" +
                                after.joints[0].name + "', expected the same joint");
  }
  return free_run::Compare(runs, {before.joints[0], after.joints[0]}, processing, InWorld(after),
                           options);
}

actuator::RobotModel WithoutAdded(actuator::RobotModel robot) {
  for (actuator::JointModel& joint : robot.joints) {
    std::erase_if(joint.terms, [](const actuator::Term& term) { return !term.declared; });
  }
  return robot;
}

TrackingRun Track(const TrackingSetup& setup, std::uint64_t seed) {
  TrackingRun run;
  run.seed = seed;
  surrogate::RigParameters rig = setup.rig;
  rig.seed = seed;
  surrogate::Surrogate before(rig), after(rig);
  run.before = tune::RunClosedLoop(setup.before, before);
  run.after = tune::RunClosedLoop(setup.after, after);
  return run;
}

report::Section MakeSection(const Names& names, types::JointKind kind,
                            const free_run::FreeRunResult* following,
                            const std::vector<TrackingRun>& tracking) {
  report::Section section = {.id = "verify", .title = "The corrected model where it is used"};
  const std::string added = types::Joined(names.added);
  section.paragraphs.push_back(
      "Before: " + names.before + ". After: " + names.after +
      (added.empty() ? ", which has no added effect." : ", with " + added + "."));
  const std::string unit = kind == types::JointKind::kRevolute ? "mrad" : "mm";
  const auto compare = [&](const std::string& name, double before, double after,
                           const std::string& remark) {
    const auto text = [](double error) {
      return std::isfinite(error) ? Text("%.3f", 1e3 * error) : std::string("diverged");
    };
    section.comparisons.push_back({.name = name,
                                   .unit = unit,
                                   .ours = text(before) + " -> " + text(after) + " " + unit,
                                   .target = "smaller after",
                                   .met = std::isfinite(after) && !(after >= before),
                                   .remark = remark});
  };
  if (following != nullptr && following->errors) {
    const free_run::FreeRun& free = *following->errors;
    const free_run::ModelError &before = free.models[0], &after = free.models[1];
    const bool closed = free.method == free_run::Method::kClosedLoop;
    section.paragraphs.push_back(
        closed
            ? "The world followed the recorded set point under the servo that the model declares."
            : Text("The recorded drive moved the world for %.2g s from the measured state, again "
                   "and again: driven by effort for longer, a joint with a load falls over and "
                   "proves nothing. Pressure, load force, payload and temperature are the "
                   "recorded ones.",
                   free.horizon_s));
    compare("simulated less measured, rms", before.rms, after.rms,
            "samples that both models reached");
    compare("simulated less measured, mean magnitude", before.mean_abs, after.mean_abs, "");
    section.tables.push_back(
        {.title = "Simulated beside the recordings",
         .caption = closed ? "A piece is a stretch of the recording without a gap."
                           : "A piece is a horizon.",
         .header = {"recording", "pieces", "diverged before", "after", "rms before, " + unit,
                    "after"}});
    for (std::size_t r = 0; r < before.runs.size(); ++r) {
      section.Add({before.runs[r].run, std::to_string(before.runs[r].pieces),
                   std::to_string(before.runs[r].diverged), std::to_string(after.runs[r].diverged),
                   Text("%.3f", 1e3 * before.runs[r].rms), Text("%.3f", 1e3 * after.runs[r].rms)});
    }
    if (!following->traces.empty())
      section.pictures.push_back(report::PathPicture(*following, kind, 0, 1));
  }
  if (!tracking.empty()) {
    section.paragraphs.push_back(
        "The surrogate followed its reference under PID with the model's torque fed forward; its "
        "undeclared effects: " +
        names.effects + ".");
    compare("tracking error in control, rms", Mean(tracking, false), Mean(tracking, true),
            std::to_string(tracking.size()) + " seeds");
    section.tables.push_back(
        {.title = "Tracking error in control",
         .caption = "Reference less measured position, without the soft start.",
         .header = {"seed", "rms before, " + unit, "after", "largest before, " + unit, "after"}});
    for (const TrackingRun& run : tracking) {
      section.Add({std::to_string(run.seed), Text("%.3f", 1e3 * std::sqrt(run.before.mse_rad2)),
                   Text("%.3f", 1e3 * std::sqrt(run.after.mse_rad2)),
                   Text("%.3f", 1e3 * run.before.worst_rad),
                   Text("%.3f", 1e3 * run.after.worst_rad)});
    }
  }
  return section;
}

std::string FormatJson(const Names& names, types::JointKind kind,
                       const free_run::FreeRunResult* following,
                       const std::vector<TrackingRun>& tracking) {
  using nlohmann::ordered_json;
  const std::string unit = kind == types::JointKind::kRevolute ? "rad" : "m";
  ordered_json root = {{"before", names.before}, {"after", names.after}, {"added", names.added}};
  if (following != nullptr && following->errors) {
    const free_run::FreeRun& free = *following->errors;
    const free_run::ModelError &before = free.models[0], &after = free.models[1];
    // rms and mean_abs are null for a model that diverged.
    const auto errors = [](const auto& of) {
      return ordered_json{{"rms", of.rms}, {"mean_abs", of.mean_abs}, {"diverged", of.diverged}};
    };
    ordered_json runs = ordered_json::array();
    for (std::size_t r = 0; r < before.runs.size(); ++r) {
      runs.push_back({{"recording", before.runs[r].run},
                      {"pieces", before.runs[r].pieces},
                      {"before", errors(before.runs[r])},
                      {"after", errors(after.runs[r])}});
    }
    root["simulation"] = {
        {"method", free.method == free_run::Method::kClosedLoop ? "closed_loop" : "horizons"},
        {"horizon_s", free.horizon_s},
        {"unit", unit},
        {"before", errors(before)},
        {"after", errors(after)},
        {"recordings", runs}};
  }
  if (!tracking.empty()) {
    ordered_json runs = ordered_json::array();
    const auto one = [](const tune::ClosedLoopScore& score) {
      return ordered_json{{"rms", std::sqrt(score.mse_rad2)},
                          {"largest", score.worst_rad},
                          {"motor_torque_rms_Nm", score.torque_rms_Nm},
                          {"faulted", score.faulted}};
    };
    for (const TrackingRun& run : tracking) {
      runs.push_back({{"seed", run.seed}, {"before", one(run.before)}, {"after", one(run.after)}});
    }
    root["tracking"] = {{"effects", names.effects},
                        {"unit", unit},
                        {"before_rms", Mean(tracking, false)},
                        {"after_rms", Mean(tracking, true)},
                        {"runs", runs}};
  }
  return types::JsonText(root, 2) + "\n";
}

}  // namespace sinew::verify
