// Recordings cut into pieces, each simulated from a start state of its own (multiple shooting: Bock
// 1981, Numerical treatment of inverse problems in chemical reaction kinetics).
//
//     row: measured angle (state-filtered) less the simulated one, rad (m of a linear joint)
//
// A piece is about one period of the motion long, 0.5 to 2 s, and shorter where a deviation of the
// start grows more than tenfold. Its start state is the measured one
// plus a deviation: position and velocity, with free play also the motor's place in the play and
// its velocity. Deviations are counted in their prior standard deviation: noise of the angle behind
// its low-pass, and what that takes from an acceleration that jumps. Where the model declares the
// servo and every recording has the set point, the servo moves a piece, else the recorded drive.
// An encoder whose zero is not known (types::Run::zero_unknown) has one offset a recording. Pure;
// allocates; one thread.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "components/base/types/run.h"
#include "components/model/free_run/simulation.h"
#include "components/model/identify/design.h"
#include "components/model/trace/machine_size.h"
#include "components/model/trace/rules.h"

namespace sinew::shooting {

// Differences of a count (a tolerance, a deviation) for derivatives. Columns that cancel, as
// inertia and gravity of a free swing do, have to do so within the noise of the angle.
inline constexpr double kDifference = 1e-5, kCentralDifference = 1e-4;

struct Piece {
  std::size_t segment = 0;  // of StateSet::segments
  Eigen::Index first = 0;   // sample of the start state
  Eigen::Index count = 0;   // samples behind it: rows
  Eigen::Index row = 0;     // of its first one
  int run = 0;
  bool continues = false;  // the next piece starts where it ends
};

// Starts of the pieces, beside what was measured.
struct Start {
  Eigen::MatrixXd state;     // a column a piece, in prior deviations
  Eigen::VectorXd zero_rad;  // of each recording: angle of the model where its encoder reads 0
};

// A simulated piece: what the encoder would read at its samples, and the velocity at the last one.
struct Path {
  Eigen::VectorXd angle;
  double end_velocity = 0.0;
};

// Settings as of the torque balance, but for the low-pass: that behind which the velocity has the
// least error. An acceleration is not needed, so that its noise beside the drive counts for
// nothing.
identify::ProcessingOptions ProcessingOf(const std::vector<types::Run>& runs,
                                         const actuator::JointModel& joint, double longest_gap_s);

class Recordings {
 public:
  // processing: resolved. Throws std::invalid_argument as identify::MakeStates, and
  // identify::TooLittleData where no piece is left. in_force: of the run, which decides how many
  // pieces there have to be.
  Recordings(const std::vector<types::Run>& runs, const actuator::JointModel& joint,
             const identify::ProcessingOptions& processing, free_run::MakeBody make_body,
             const trace::InForce& in_force);

  const identify::Design& design() const { return design_; }
  const std::vector<Piece>& pieces() const { return pieces_; }
  double piece_s() const { return piece_s_; }
  Eigen::Index rows() const { return measured_.size(); }
  const Eigen::VectorXd& measured() const { return measured_; }  // every row
  double noise_rad() const { return noise_rad_; }                // of a row, white
  bool closed_loop() const { return !gains_.empty(); }
  // Prior standard deviations of a start state, SI; 2 of them, 4 with free play.
  const Eigen::VectorXd& deviation() const { return deviation_; }
  // The same of each recording's zero, rad; 0: known.
  const Eigen::VectorXd& zero_deviation() const { return zero_deviation_; }
  // Expectations of a machine of this size, as declared; all rows count.
  const trace::MachineSize& machine() const { return machine_; }
  Start Measured() const;

  // state: in deviations. Where the model leaves the range of the motion by more than its width it
  // stays there. Throws std::invalid_argument: a model that cannot be simulated.
  Path Simulate(const actuator::JointModel& model, std::size_t piece,
                const Eigen::Ref<const Eigen::VectorXd>& state, double zero_rad) const;
  // Angles of all pieces, every row; behind them two values of each gap.
  Eigen::VectorXd Stacked(const actuator::JointModel& model, const Start& start) const;
  // Gap between two pieces, in deviations: position and velocity, simulated at the end of a piece
  // less the start of the next one.
  Eigen::Vector2d Gap(std::size_t piece, const Path& path,
                      const Eigen::Ref<const Eigen::VectorXd>& next_state) const;

 private:
  void Cut();
  // Factor by which a deviation of the start position grows over a piece.
  double Growth(const actuator::JointModel& joint) const;
  void SetDeviations(const std::vector<types::Run>& runs, const actuator::JointModel& joint);

  identify::Design design_;
  free_run::MakeBody make_body_;
  trace::MachineSize machine_;
  std::optional<actuator::Servo> servo_;
  std::vector<double> gains_;  // of each segment; empty: by the recorded drive
  std::vector<double> lowest_, highest_;
  std::vector<Piece> pieces_;
  double piece_s_ = 0.0, noise_rad_ = 0.0;
  Eigen::VectorXd measured_, deviation_, zero_deviation_;
};

}  // namespace sinew::shooting
