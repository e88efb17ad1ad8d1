#include "components/model/shooting/pieces.h"

#include <gtest/gtest.h>

#include "components/model/identify/uniform.h"
#include "sim/plant/joint_body.h"
#include "tests/components/model/shooting/swing.h"

namespace sinew::shooting {
namespace {

Recordings Pieces(const std::vector<types::Run>& runs, const actuator::JointModel& joint) {
  return Recordings(runs, joint, ProcessingOf(runs, joint, 0.25), plant::JointAlone(), {});
}

TEST(Pieces, CoverARecordingWithoutOverlap) {
  const Recordings recordings = Pieces({Swing(Pendulum(), {.duration_s = 6.0})}, Pendulum());
  Eigen::Index row = 0;
  for (std::size_t p = 0; p < recordings.pieces().size(); ++p) {
    const Piece& piece = recordings.pieces()[p];
    EXPECT_EQ(piece.row, row);
    EXPECT_EQ(piece.first, row);
    EXPECT_EQ(piece.continues, p + 1 < recordings.pieces().size());
    row += piece.count;
  }
  EXPECT_EQ(row, recordings.rows());
  EXPECT_EQ(row, 6 * 200 - 1);  // the first sample is a start only
  EXPECT_GE(recordings.piece_s(), 0.5);
}

TEST(Pieces, RowsThatWereLostAreInNone) {
  types::Run run = Swing(Pendulum(), {.duration_s = 6.0});
  run.time_s.tail(600).array() += 2.0;  // between two rows
  const Recordings recordings = Pieces({run}, Pendulum());
  int ends = 0;
  for (const Piece& piece : recordings.pieces()) ends += piece.continues ? 0 : 1;
  EXPECT_EQ(ends, 2);
}

TEST(Pieces, TheTruthFollowsWithinTheNoiseOfItsStart) {
  const Recordings recordings = Pieces({Swing(Pendulum(), {.duration_s = 6.0})}, Pendulum());
  const Eigen::VectorXd stacked = recordings.Stacked(Pendulum(), recordings.Measured());
  const Eigen::VectorXd error = stacked.head(recordings.rows()) - recordings.measured();
  // Start velocities are off by their deviation, over half a second.
  EXPECT_LT(error.cwiseAbs().maxCoeff(), 3.0 * 0.5 * recordings.deviation()[1]);
  // A gap is the difference to the next start.
  const Path path = recordings.Simulate(Pendulum(), 0, Eigen::VectorXd::Zero(2), 0.0);
  const double gap_rad =
      path.angle[path.angle.size() - 1] - recordings.measured()[path.angle.size() - 1];
  EXPECT_NEAR(stacked[recordings.rows()], gap_rad / recordings.deviation()[0], 1e-9);
}

TEST(Pieces, AnInvertedPendulumHasShortOnes) {
  // Upright: a deviation grows by exp(sqrt(G / J) t), tenfold in half a second.
  types::Run run = Swing(Pendulum(), {.duration_s = 12.0});
  EXPECT_GT(Pieces({run}, Pendulum()).piece_s(), 0.6);
  run.signals[types::Signal::kPosition].array() += M_PI;
  EXPECT_EQ(Pieces({run}, Pendulum()).piece_s(), 0.5);
}

TEST(Pieces, AModelWithoutInertiaCannotBeSimulated) {
  const Recordings recordings = Pieces({Swing(Pendulum(), {.duration_s = 3.0})}, Pendulum());
  actuator::JointModel weightless = Pendulum();
  weightless.terms[1].linear[0].value = 0.0;
  EXPECT_THROW(recordings.Stacked(weightless, recordings.Measured()), std::invalid_argument);
}

TEST(Pieces, AFifthOfASecondIsTooLittle) {
  types::Run run = Swing(Pendulum(), {.duration_s = 0.6});
  run.time_s.tail(70).array() += 1.0;
  EXPECT_ANY_THROW(Pieces({run}, Pendulum()));
}

}  // namespace
}  // namespace sinew::shooting
