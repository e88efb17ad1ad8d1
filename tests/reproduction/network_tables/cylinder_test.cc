#include "reproduction/network_tables/cylinder.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "components/base/config/config.h"
#include "reproduction/networks/grey_box.h"
#include "reproduction/networks/samples.h"
#include "tests/support/skip.h"
#include "tests/support/temporary_folder.h"

namespace sinew::reproduction {
namespace {

using networks::Task;
using ::testing::HasSubstr;

TEST(Cylinder, AFolderWithoutRecordingsIsRefusedWithItsName) {
  sinew::testing::TemporaryFolder folder;
  try {
    (void)ReadCylinder(folder.path());
    FAIL() << "accepted";
  } catch (const UsageError& error) {
    EXPECT_THAT(error.what(), HasSubstr(folder.path().string()));
  }
}

// Real measurements: the declared physics, F = A p and a seal friction that grows with pressure.
TEST(Cylinder, TheGreyBoxFindsTheAreaOfThePistonInMeasuredData) {
  const std::filesystem::path folder =
      std::filesystem::path(SINEW_SHARED_DIR) / "data" / "pneumatic_cylinder_3dprinted";
  SKIP_WITHOUT_DATA(folder);
  const std::vector<types::Run> runs = ReadCylinder(folder);
  ASSERT_GE(runs.size(), 6U);
  const networks::Samples samples = networks::MakeSamples(
      networks::MakeTable(runs, {.task = Task::kForce, .period_s = 0.04, .blocks = 2}));
  Eigen::MatrixXd predicted;
  const networks::GreyBox model = networks::FitGreyBox(Task::kForce, samples, &predicted);
  // A piston of 25 mm: 49.1 N a bar.
  EXPECT_NEAR(model.coefficients(0), 49.1, 2.0);
  EXPECT_LT(networks::MeanSquare(samples, predicted, samples.test), 0.002);
}

}  // namespace
}  // namespace sinew::reproduction
