// Outcomes counted: the table of figures with exact intervals, and who was taken for whom.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tests/bank/bank.h"

namespace sinew::bank {

// Exact 95 % interval of a share of `hits` among `trials` (Clopper, Pearson 1934), by bisection of
// the binomial tails. {0, 1} without trials; throws std::invalid_argument for hits outside of
// 0..trials.
std::pair<double, double> ClopperPearson(int hits, int trials);

// Is the effect, or one that shares its class, what was named first? Effects that a refit swallows
// are named by the shift of a parameter.
bool NamedFirst(const Outcome& outcome);
bool NamedItsClass(const Outcome& outcome);

struct Share {
  std::string name, goal;
  int hits = 0, trials = 0;
  bool low_is_good = false;
};

struct Value {
  std::string name, goal;
  double value = 0.0;
  int count = 0;
};

struct Figures {
  std::vector<Share> shares;
  std::vector<Value> values;
  // Effects of which a cell (strength, excitation) is hidden: the oracle is significant in fewer
  // than half of the seeds. "effect/strong/task"
  std::vector<std::string> hidden_cells;
};
Figures CountFigures(const std::vector<Outcome>& outcomes);

// Text for people: figures with intervals, then for every effect what was named first and how
// often.
std::string FormatFigures(const Figures& figures);
std::string FormatConfusion(const std::vector<Outcome>& outcomes);

// One line of JSON per outcome, and back. FromJson throws std::invalid_argument.
std::string ToJson(const Outcome& outcome);
Outcome FromJson(const std::string& line);
std::string FiguresToJson(const Figures& figures);

}  // namespace sinew::bank
