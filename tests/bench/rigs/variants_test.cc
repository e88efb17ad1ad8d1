#include "bench/rigs/variants.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "components/model/actuator/file/model_file.h"
#include "tests/support/temporary_folder.h"

namespace sinew::rig_bank {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

constexpr const char* kModel = R"(schema: sinew-model/1
name: rig
joints:
  - name: joint
    kind: rotary
    constants: {gear_ratio: 10, torque_constant_Nm_A: 0.5}
    terms:
      - effect: drive_current
        efficiency: {value: 0.75, tolerance: 0.15}
      - effect: inertia
        inertia_kg_m2: {value: 2, tolerance: 0.15}
      - effect: viscous
        viscous_Nm_s_rad: {value: 3, tolerance: {absolute: 0.5}}
)";

void Write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }

std::string TextOf(const fs::path& path) {
  std::stringstream out;
  out << std::ifstream(path).rdbuf();
  return out.str();
}

fs::path MakeFolder(const fs::path& folder, const std::string& column) {
  fs::create_directories(folder);
  Write(folder / "model.yaml", kModel);
  Write(folder / "csv_map.yaml", "schema: sinew-csv-map/1\n");
  Write(folder / "truth.json", "{}");
  const std::string rows = "time_s," + column + "\n0,1\n0.01,2\n0.02,4\n0.03,8\n";
  for (const char* name : {"train_1.csv", "train_2.csv", "train_3.csv", "sealed.csv"}) {
    Write(folder / name, rows);
  }
  return folder;
}

const Variant& Named(const std::string& name) {
  static const std::vector<Variant> all = Variants();
  for (const Variant& variant : all) {
    if (variant.name == name) return variant;
  }
  throw std::invalid_argument(name);
}

TEST(Variants, AStrongerMachineHasTheSameRowsAndLargerTorques) {
  const testing::TemporaryFolder dir;
  const fs::path folder = MakeFolder(dir.path() / "case", "output_position_rad");
  ASSERT_TRUE(WriteVariant(folder, Named("strong"), dir.path() / "strong"));
  const auto model = actuator::LoadModelFile(dir.path() / "strong/model.yaml").robot.joints[0];
  EXPECT_EQ(model.constants.torque_constant_Nm_A, 0.5 * 1024.0);
  EXPECT_EQ(model.Parameter("drive_current", "efficiency"), 0.75);
  EXPECT_EQ(model.Parameter("inertia", "inertia"), 2.0 * 1024.0);
  EXPECT_EQ(model.terms[2].linear[0].tolerance_absolute, 0.5 * 1024.0);
  EXPECT_EQ(TextOf(dir.path() / "strong/sealed.csv"),
            "time_s,output_position_rad\n0,1\n0.01,2\n0.02,4\n0.029999999999999999,8\n");
}

TEST(Variants, ASlowerMotionNeedsMoreInertiaForTheSameTorque) {
  const testing::TemporaryFolder dir;
  const fs::path folder = MakeFolder(dir.path() / "case", "output_position_rad");
  ASSERT_TRUE(WriteVariant(folder, Named("slow"), dir.path() / "slow"));
  const auto model = actuator::LoadModelFile(dir.path() / "slow/model.yaml").robot.joints[0];
  EXPECT_EQ(model.Parameter("inertia", "inertia"), 2.0 * 64.0);
  EXPECT_EQ(model.Parameter("viscous", "viscous"), 3.0 * 8.0);
  EXPECT_EQ(TextOf(dir.path() / "slow/train_1.csv").substr(0, 35),
            "time_s,output_position_rad\n0,1\n0.08");
}

TEST(Variants, OtherRatesLeaveRowsOutOrPutThemBetween) {
  const testing::TemporaryFolder dir;
  const fs::path folder = MakeFolder(dir.path() / "case", "output_position_rad");
  ASSERT_TRUE(WriteVariant(folder, Named("half"), dir.path() / "half"));
  EXPECT_EQ(TextOf(dir.path() / "half/sealed.csv"), "time_s,output_position_rad\n0,1\n0.02,4\n");
  ASSERT_TRUE(WriteVariant(folder, Named("double"), dir.path() / "double"));
  EXPECT_EQ(TextOf(dir.path() / "double/sealed.csv").substr(0, 36),
            "time_s,output_position_rad\n0,1\n0.005");
}

TEST(Variants, MassesAndForcesHaveNoScaleInTheModel) {
  const testing::TemporaryFolder dir;
  const fs::path folder = MakeFolder(dir.path() / "case", "load_force_N");
  EXPECT_FALSE(WriteVariant(folder, Named("strong"), dir.path() / "strong"));
  EXPECT_FALSE(fs::exists(dir.path() / "strong"));
  EXPECT_TRUE(WriteVariant(folder, Named("half"), dir.path() / "half"));
}

json ReportOf(const std::string& verdict, const std::string& name = "", double size = 0.0,
              double half_width = 0.0, const std::string& rival = "") {
  json effects = json::array();
  if (!name.empty()) {
    effects.push_back(
        {{"name", name},
         {"rivals", rival.empty() ? json::array() : json::array({rival})},
         {"gain", 0.25},
         {"confirmation", {{"slope", 1.0}}},
         {"parameters", {{"viscous_Nm_s_rad", {{"value", size}, {"half_width_95", half_width}}}}}});
  }
  return {{"verdict", verdict}, {"effects", effects}};
}

TEST(Variants, ANameMayWeakenButNotChange) {
  const Variant& half = Named("half");
  const json found = ReportOf("effect", "viscous", 2.0, 0.1, "motor_viscous");
  EXPECT_TRUE(Compare(found, ReportOf("none"), half).weakened);
  EXPECT_TRUE(Compare(ReportOf("none"), found, half).strengthened);
  EXPECT_FALSE(Compare(found, ReportOf("effect", "motor_viscous", 2.0, 0.1), half).renamed);
  EXPECT_TRUE(Compare(found, ReportOf("effect", "coulomb", 2.0, 0.1), half).renamed);
  EXPECT_FALSE(Compare(found, ReportOf("unexplained"), half).same_verdict);
}

TEST(Variants, SizesAreComparedInTheUnitsOfTheCase) {
  const json found = ReportOf("effect", "viscous", 2.0, 0.1);
  const Difference same = Compare(found, ReportOf("effect", "viscous", 16.0, 0.8), Named("slow"));
  EXPECT_DOUBLE_EQ(same.apart.value(), 0.0);
  EXPECT_DOUBLE_EQ(same.figures.value(), 0.0);
  const Difference apart = Compare(found, ReportOf("effect", "viscous", 2.4, 0.1), Named("half"));
  EXPECT_NEAR(apart.apart.value(), 2.0, 1e-9);
}

}  // namespace
}  // namespace sinew::rig_bank
