// Everything that may explain a residual, as columns beside the declared terms: the effects of the
// catalogue over their grids, lines of the order spectrum, free curves. Pure; allocates.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "components/model/actuator/model.h"
#include "components/model/identify/balance.h"
#include "components/model/identify/design.h"
#include "components/model/trace/candidates.h"
#include "components/model/trace/curves.h"
#include "components/model/trace/evidence.h"
#include "components/model/trace/rules.h"
#include "components/model/trace/whitened_fit.h"

namespace sinew::trace {

// Charge of a shape that is searched for: Akaike's criterion for a free parameter.
inline constexpr double kChargePerShape = 2.0;

// A term of the model with its setting; several for an effect of several orders.
struct TermSetting {
  std::vector<double> psi;
  Columns columns;  // of the bank, a column per linear parameter
};

// The part that a hypothesis may be found to play.
enum class Asked {
  kSearched,  // an effect of the set, or a free curve
  kRival,     // too much like any smooth curve to lead: what stands in an effect's place
  kNoise,     // no cause (Candidate::stated): a part of the richest model, whose rest is the noise
};

struct Hypothesis {
  std::string name;      // of the effect, or what the curve is over
  std::string variable;  // signal it follows
  double order_per_turn = 0.0;
  std::shared_ptr<const effects::Effect> effect;  // null: a free curve
  std::vector<TermSetting> settings;              // more than one: several orders of one effect
  Columns columns;                                // of all settings
  int family = 0;       // hypotheses of one family are settings of one thing
  double charge = 0.0;  // misfit that its shapes and searches are charged
  // Range of each coefficient, in units of the balance.
  std::vector<double> lower, upper;
  Asked asked = Asked::kSearched;
  bool steady = false;  // as large behind another low-pass of the angles (CompareBands)

  bool physical() const { return effect != nullptr; }
  // An effect or a free curve over an acceleration, its derivatives or the drive's rate.
  bool follows_rates() const;
  // An effect of the motion that does: what the low-pass of the angles gets wrong looks like it.
  bool from_rates() const;
};

// Is a wave of so many periods a turn more than a smooth curve over a range of so many turns?
// Wheels on the output turn once or twice with it: one period. What comes more often has to come
// back: three.
bool ShowsPeriods(double order, double turns);

// Share of the misfit that it has to explain: rule explained_share, or curve_share where it is
// identified from rates and not steady.
const Rule& RuleOfShare(const Hypothesis& hypothesis);
// The same of the residual's variance (rule variance_share), as much more there.
double LeastVariance(const Hypothesis& hypothesis, const InForce& in_force);

struct Bank {
  InForce in_force;          // of the run
  Eigen::MatrixXd declared;  // used rows, not whitened
  Prior prior;               // of the declared columns, before whitening by sigma
  Eigen::VectorXd target;
  Eigen::MatrixXd columns;  // used rows, not whitened
  Eigen::VectorXd spread;   // prior standard deviation of each coefficient
  std::vector<Hypothesis> hypotheses;
  std::vector<Untestable> untestable;
  Eigen::Index parameters = 0;  // declared ones; columns behind them are nuisances
};

// The drive of `design` must be predicted. model: as declared; balance: made for it.
Bank MakeBank(const identify::Design& design, const Likelihood& likelihood,
              const actuator::JointModel& model, const identify::Balance& balance);

// Adds what an order spectrum of the whitened residual shows: lines of cogging and of the gear as
// one hypothesis each, other orders as free lines.
void AddOrders(const identify::Design& design, const Likelihood& likelihood,
               const actuator::JointModel& model, const identify::Balance& balance,
               const Eigen::VectorXd& whitened_residual, Bank* bank);

}  // namespace sinew::trace
