// Outcomes counted: shares with exact intervals, and with intervals that allow for cases of one rig
// being alike.
#pragma once

#include <map>
#include <string>
#include <utility>
#include <vector>

#include "bench/rigs/outcome.h"

namespace sinew::rig_bank {

// Exact binomial interval of 95 %. Throws std::invalid_argument unless 0 <= hits <= trials.
std::pair<double, double> ClopperPearson(int hits, int trials);

struct Figure {
  std::string name;
  bool low_is_good = false;
  std::map<int, std::pair<int, int>> by_rig;  // hits, trials
  int hits() const;
  int trials() const;
  // Percentiles 2.5 and 97.5 of 2000 draws of rigs with replacement (fixed seed).
  std::pair<double, double> ClusteredInterval() const;
};

// The first name is the effect, its class or a name of the same meaning; or the effect stands among
// the first name's rivals; or, where a refit absorbs it, among the causes of a parameter shift.
bool RightClass(const Outcome& outcome);
bool RightFirst(const Outcome& outcome);
// A name that stands for no true effect. `refuted` names do not count.
bool WrongName(const Outcome& outcome);
bool Names(const Outcome& outcome);

struct Figures {
  std::vector<Figure> shares;
  int p_count = 0;          // of p_global on recordings without effect
  double p_ks = 0.0;        // Kolmogorov-Smirnov distance from uniform
  double p_ks_limit = 0.0;  // 95 %
  double seconds_median = 0.0, seconds_95 = 0.0;
};
Figures CountFigures(const std::vector<Outcome>& outcomes);
std::string TableOfShares(const std::vector<Figure>& shares);
std::string TableOf(const Figures& figures);
// Names in the model and open ones, by the p that the report prints: how many were right in each
// tenth, and of those above 0.8 and 0.95. Recordings with a fault of the log are left out.
std::string ReliabilityOf(const std::vector<Outcome>& outcomes);
// The line on which the logarithm of the odds of being right depends on that of the p's odds: what
// makes a p that was trained elsewhere a probability here (Platt 1999). Maximum likelihood with two
// pseudo-observations, so that no line is vertical. Names as in ReliabilityOf.
struct Calibration {
  double offset = 0.0, slope = 1.0;
  int names = 0;
};
Calibration Calibrate(const std::vector<Outcome>& outcomes);
// Cases of kind `planted`: by effect how many were found; empty: there are none.
std::string PlantedTableOf(const std::vector<Outcome>& outcomes);
// Who was taken for whom: a line per true effect.
std::string ConfusionOf(const std::vector<Outcome>& outcomes);
nlohmann::json ToJson(const Figures& figures);

}  // namespace sinew::rig_bank
