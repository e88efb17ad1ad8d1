#include "tools/new_bench/propose.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>
#include <string>

#include "components/base/types/angle.h"
#include "components/model/actuator/file/model_file.h"
#include "components/record/recording/csv_map.h"
#include "components/record/recording/file/csv_map_file.h"
#include "tests/support/temporary_folder.h"

namespace sinew::new_bench {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using types::Signal;

std::string SignalsOf(const Guess& guess) {
  std::string text;
  for (const Column& column : guess.columns) {
    text += column.name + "=" +
            (column.signal ? std::string(types::SignalName(*column.signal)) : "time") + "[" +
            column.unit + "] ";
  }
  return text;
}

TEST(NewBench, ColumnsAndUnitsOfPublicRecordings) {
  EXPECT_EQ(SignalsOf(GuessColumns("time_s,q_goal_rad,q_meas_rad,qd_meas_rad_s,duty,temp_C,u_V\n"
                                   "0,0,0,0,0,25,1\n0.1,0,0,0,0,25,1\n",
                                   "a.csv")),
            "time_s=time[s] q_meas_rad=position[rad] qd_meas_rad_s=velocity[rad/s] "
            "temp_C=temperature[degC] u_V=drive_voltage[V] q_goal_rad=reference_position[rad] ");
  EXPECT_EQ(
      SignalsOf(GuessColumns("Time [ms];MotorAngle [deg];JointAngle [deg];Iq [A];Torque [Nm]\n"
                             "0;1;2;3;4\n1;1;2;3;4\n",
                             "b.csv")),
      "Time [ms]=time[ms] MotorAngle [deg]=motor_position[deg] JointAngle [deg]=position[deg] "
      "Iq [A]=motor_current[A] Torque [Nm]=torque[Nm] ");
}

TEST(NewBench, AFileWithoutAHeaderHasTheNamesThatAreGiven) {
  const Guess guess = GuessColumns("0\t1\t2\n0.1\t1\t2\n", "d.txt", {"t_s", "q_rad", "tau_Nm"});
  EXPECT_EQ(SignalsOf(guess), "t_s=time[s] q_rad=position[rad] tau_Nm=torque[Nm] ");
  EXPECT_THAT(Propose(guess, {}, "d.txt").csv_map, HasSubstr("header: [t_s, q_rad, tau_Nm]\n"));
}

TEST(NewBench, WithoutUnitsTheValuesDecideAndItSaysSo) {
  const Guess guess = GuessColumns(
      "timestamp,angle,current,state\n1000000,-90,0.1,7\n"
      "1001000,270,0.2,7\n",
      "c.csv");
  EXPECT_EQ(SignalsOf(guess), "timestamp=time[us] angle=position[deg] current=motor_current[A] ");
  EXPECT_THAT(guess.columns[1].why, HasSubstr("more than two turns"));
  EXPECT_THAT(guess.columns[2].why, HasSubstr("no unit"));
  EXPECT_THAT(guess.unused, ElementsAre("state"));
}

TEST(NewBench, WhatIsMissingIsNamed) {
  const auto why = [](const std::string& text) {
    try {
      (void)GuessColumns(text, "d.csv");
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(why("q,tau\n1,2\n"), AllOf(HasSubstr("d.csv"), HasSubstr("time_s")));
  EXPECT_THAT(why("t,tau\n1,2\n"), HasSubstr("is an angle"));
  EXPECT_THAT(why("t,q\n1,2\n"), HasSubstr("drives"));
  EXPECT_THROW(Propose(GuessColumns("t,q,i\n1,2,3\n2,2,3\n", "d.csv"), {}, "d.csv"),
               std::invalid_argument)
      << "a current without a torque constant";
}

// A hanging link is at -90 degrees, in the reading's unit, and the files are read as they are.
TEST(NewBench, TheFilesAreReadAndAHangingLinkIsAtMinusNinetyDegrees) {
  const std::string text = "t_ms,angle_deg,iq\n0,10,1\n1,10,1\n2,11,1\n";
  const Guess guess = GuessColumns(text, "e.csv");
  ASSERT_TRUE(NeedsTorqueConstant(guess));
  Answers answers;
  answers.gear_ratio = 9.0;
  answers.torque_constant_Nm_A = 0.09;
  answers.drive_sign = -1;
  answers.hanging = 10.0;
  answers.joint = "left: knee";
  const Files files = Propose(guess, answers, "e.csv");
  const recording::CsvMap map = recording::ParseCsvMap(files.csv_map, "csv_map.yaml");
  const types::Run run = recording::ReadCsvRun(text, "e.csv", map);
  EXPECT_NEAR(run.signals.at(Signal::kPosition)[0], -0.5 * types::kPi, 1e-9);
  EXPECT_EQ(run.signals.at(Signal::kMotorCurrent)[0], -1.0);
  EXPECT_NEAR(run.time_s[2], 0.002, 1e-12);
  const testing::TemporaryFolder folder;
  const auto model = actuator::LoadRobotModel(folder.Write("model.yaml", files.model));
  ASSERT_EQ(model.joints.size(), 1U);
  EXPECT_EQ(model.joints[0].name, "left: knee");
  EXPECT_THAT(files.readme, AllOf(HasSubstr("iq"), HasSubstr("-m g l cos q")));
  EXPECT_THAT(files.readme, HasSubstr("e.csv@:0.001 --held-out e.csv@0.001:"));
  // Without gravity, and driven by a voltage.
  const Guess voltage = GuessColumns("t,q,u\n0,0,1\n1,0,1\n", "f.csv");
  const auto second =
      actuator::LoadRobotModel(folder.Write("model2.yaml", Propose(voltage, {}, "f.csv").model));
  EXPECT_EQ(second.joints.size(), 1U);
}

}  // namespace
}  // namespace sinew::new_bench
