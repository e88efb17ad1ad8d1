// Functions that the checks share: quantities of a channel, local polynomials on uneven stamps.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "components/base/types/run.h"
#include "components/model/gate/gate.h"

namespace sinew::gate {

double Median(std::vector<double> values);                // 0 of none
double QuantileOf(std::vector<double> values, double p);  // 0 of none
double Range(const Eigen::VectorXd& x);
double StandardDeviationOf(const Eigen::VectorXd& x);
double MedianPeriod(const types::Run& run);
// Resolution, else the white noise: differences below it are none.
double SmallestStep(const Eigen::VectorXd& x);
// The range in smallest steps; 0 of a channel that never changes.
double StepsIn(const Eigen::VectorXd& x);

struct Span {
  Eigen::Index first = 0, last = 0;
  Eigen::Index rows() const { return last - first + 1; }
};
// Spans of at least `rows` equal values.
std::vector<Span> EqualSpans(const Eigen::VectorXd& x, Eigen::Index rows);

// Sizes of the changes from a row to the next one; row: the first of the two.
template <class Keep>
std::vector<double> ChangesWhere(const Eigen::VectorXd& x, const Keep& keep) {
  std::vector<double> out;
  for (Eigen::Index row = 0; row + 1 < x.size(); ++row) {
    if (x[row + 1] != x[row] && keep(row)) out.push_back(std::abs(x[row + 1] - x[row]));
  }
  return out;
}

// A local cubic with tricube weights at every instant of `at`: value, first and second derivative.
struct Local {
  Eigen::VectorXd value, rate, acceleration;
};
std::map<types::Signal, Local> LocalCubics(const types::Run& run,
                                           const std::vector<types::Signal>& signals,
                                           double half_width_s, const std::vector<double>& at);

// A quarter of the time in which the channel moves by its standard deviation, at least five rows.
double HalfWidth_s(const types::Run& run, types::Signal signal);
// Instants half a half width apart, away from both ends and from gaps.
std::vector<double> Centres(const types::Run& run, double half_width_s, std::size_t most);

Measurement Measure(std::string_view rule, types::Signal signal, const types::Run& run, Span rows,
                    double statistic, std::string reason = {}, std::string remedy = {});
Span WholeRun(const types::Run& run);
// The signal that the model's drive reads; nothing: it has none or several.
std::optional<types::Signal> OnlyDrive(const actuator::JointModel& model);
std::string Number(double value);  // four significant digits

template <class Value>
void Append(std::vector<Value> more, std::vector<Value>* all) {
  for (Value& at : more) all->push_back(std::move(at));
}

}  // namespace sinew::gate
