#include "components/model/experiment/model_update.h"

#include <gtest/gtest.h>

#include <numbers>

namespace sinew::experiment {
namespace {

actuator::JointModel Rig() {
  actuator::JointModel model;
  model.constants.gear_ratio = 100.0;
  model.backlash_rad = 0.04;
  for (const char* effect : {"gravity", "coulomb", "rotor_inertia"}) {
    model.terms.push_back(actuator::MakeTerm(effect, model.constants));
  }
  return model;
}

TEST(ModelUpdate, PlayGoesIntoTheModelWithALineOfHistory) {
  actuator::JointModel model = Rig();
  Result result{.experiment = "backlash"};
  result.quantities = {{.id = "backlash_deg", .estimate = {2.7, 0.01, 100}}};
  const auto changes = UpdateModel(result, "run.mcap", "2026-01-01T00:00:00Z", &model);
  ASSERT_EQ(changes.size(), 1u);
  EXPECT_NEAR(model.backlash_rad, 2.7 * std::numbers::pi / 180.0, 1e-12);
  ASSERT_EQ(model.history.size(), 1u);
  EXPECT_EQ(model.history[0].recording, "run.mcap");
  EXPECT_NE(model.history[0].note.find("backlash"), std::string::npos);
}

TEST(ModelUpdate, RotorValuesGoToTheOutputByTheRatioSquared) {
  actuator::JointModel model = Rig();
  Result result{.experiment = "motor"};
  result.quantities = {{.id = "rotor_inertia_kg_m2", .estimate = {1.2e-5, 1e-7, 40}},
                       {.id = "rotor_viscous_Nm_s_rad", .estimate = {3e-5, 1e-6, 40}}};
  // The model has no motor_viscous: only the inertia is written.
  EXPECT_EQ(UpdateModel(result, "x", "now", &model).size(), 1u);
  EXPECT_NEAR(model.Parameter("rotor_inertia", "rotor_inertia"), 0.12, 1e-12);
  const auto term = static_cast<std::size_t>(model.Find("rotor_inertia"));
  EXPECT_NEAR(*model.terms[term].linear[0].half_width_95, 1e-3, 1e-12);
}

TEST(ModelUpdate, AResultWithoutAPlaceChangesNothing) {
  actuator::JointModel model = Rig();
  Result result{.experiment = "pea-data"};
  result.quantities = {{.id = "cycles", .estimate = {100.0, 0.0, 1}}};
  EXPECT_TRUE(UpdateModel(result, "x", "now", &model).empty());
  EXPECT_TRUE(model.history.empty());
}

}  // namespace
}  // namespace sinew::experiment
