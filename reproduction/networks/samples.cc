#include "reproduction/networks/samples.h"

#include <cmath>
#include <stdexcept>
#include <string>

namespace sinew::networks {
namespace {

constexpr std::size_t kFewestSamples = 10;

// Rows by mean and standard deviation over the training samples.
esn::Normalisation Normalise(Eigen::MatrixXd* values, const std::vector<int>& train) {
  esn::Normalisation n;
  n.offset = Eigen::VectorXd::Zero(values->rows());
  for (const int t : train) n.offset += values->col(t);
  n.offset /= static_cast<double>(train.size());
  Eigen::VectorXd squares = Eigen::VectorXd::Zero(values->rows());
  for (const int t : train) squares += (values->col(t) - n.offset).cwiseAbs2();
  n.scale = (squares / static_cast<double>(train.size())).cwiseSqrt();
  for (Eigen::Index r = 0; r < n.scale.size(); ++r) {
    // Below rounding of the mean the row does not vary.
    if (!(n.scale(r) > 1e-9 * std::max(1.0, std::abs(n.offset(r))))) n.scale(r) = 1.0;
  }
  for (Eigen::Index t = 0; t < values->cols(); ++t) {
    values->col(t) = (values->col(t) - n.offset).cwiseQuotient(n.scale);
  }
  return n;
}

}  // namespace

Samples MakeSamples(const std::vector<esn::Sequence>& sequences, double validation_share, int gap) {
  if (sequences.empty()) throw std::invalid_argument("samples: no sequence");
  if (!(validation_share >= 0.0 && validation_share <= 0.9) || gap < 0) {
    throw std::invalid_argument("samples: validation share " + std::to_string(validation_share) +
                                " and gap " + std::to_string(gap) +
                                ", expected 0 .. 0.9 and at least 0");
  }
  const Eigen::Index inputs = sequences.front().inputs.cols();
  const Eigen::Index outputs = sequences.front().targets.cols();
  Eigen::Index count = 0;
  for (const esn::Sequence& q : sequences) {
    if (q.inputs.cols() != inputs || q.targets.cols() != outputs || inputs < 1 || outputs < 1 ||
        q.targets.rows() != q.inputs.rows() ||
        static_cast<Eigen::Index>(q.use.size()) != q.inputs.rows()) {
      throw std::invalid_argument("samples: sequences differ in shape");
    }
    if (!q.inputs.allFinite() || !q.targets.allFinite()) {
      throw std::invalid_argument("samples: a value is not finite");
    }
    count += q.inputs.rows();
  }

  Samples samples;
  samples.inputs.resize(inputs, count);
  samples.targets.resize(outputs, count);
  samples.first.reserve(static_cast<std::size_t>(count));
  int start = 0;
  for (const esn::Sequence& q : sequences) {
    const int length = static_cast<int>(q.inputs.rows());
    samples.inputs.middleCols(start, length) = q.inputs.transpose();
    samples.targets.middleCols(start, length) = q.targets.transpose();
    int piece = 0;  // where the piece of training samples began
    for (int t = 0; t < length; ++t) {
      samples.first.push_back(start);
      const esn::Use use = q.use[static_cast<std::size_t>(t)];
      if (use == esn::Use::kTest) samples.test.push_back(start + t);
      if (use == esn::Use::kTrain) {
        const bool begins = t == 0 || q.use[static_cast<std::size_t>(t - 1)] != esn::Use::kTrain;
        if (begins) piece = t;
        samples.train.push_back(start + t);
      }
      const bool ends =
          use == esn::Use::kTrain &&
          (t + 1 == length || q.use[static_cast<std::size_t>(t + 1)] != esn::Use::kTrain);
      if (!ends || validation_share == 0.0) continue;
      const int all = t + 1 - piece;
      const int held = static_cast<int>(std::lround(validation_share * all));
      const int taught = std::max(0, all - held - gap);
      samples.train.resize(samples.train.size() - static_cast<std::size_t>(all - taught));
      for (int v = t + 1 - held; v <= t; ++v) samples.validation.push_back(start + v);
    }
    start += length;
  }
  if (samples.train.size() < kFewestSamples) {
    throw std::invalid_argument("samples: " + std::to_string(samples.train.size()) +
                                " to train on, expected at least " +
                                std::to_string(kFewestSamples));
  }
  samples.input = Normalise(&samples.inputs, samples.train);
  samples.output = Normalise(&samples.targets, samples.train);
  return samples;
}

Samples SelectInputs(const Samples& samples, const std::vector<int>& rows) {
  Samples selected = samples;
  const Eigen::Index count = static_cast<Eigen::Index>(rows.size());
  selected.inputs.resize(count, samples.inputs.cols());
  selected.input.offset.resize(count);
  selected.input.scale.resize(count);
  for (Eigen::Index r = 0; r < count; ++r) {
    const int from = rows[static_cast<std::size_t>(r)];
    if (from < 0 || from >= samples.inputs.rows()) {
      throw std::invalid_argument("samples: no input " + std::to_string(from));
    }
    selected.inputs.row(r) = samples.inputs.row(from);
    selected.input.offset(r) = samples.input.offset(from);
    selected.input.scale(r) = samples.input.scale(from);
  }
  return selected;
}

Samples AppendInput(const Samples& samples, const Eigen::VectorXd& row) {
  if (row.size() != samples.inputs.cols()) {
    throw std::invalid_argument("samples: a row of " + std::to_string(row.size()) +
                                " values, expected " + std::to_string(samples.inputs.cols()));
  }
  Samples more = samples;
  const Eigen::Index inputs = samples.inputs.rows();
  more.inputs.conservativeResize(inputs + 1, Eigen::NoChange);
  more.inputs.row(inputs) = row.transpose();
  more.input.offset.conservativeResize(inputs + 1);
  more.input.scale.conservativeResize(inputs + 1);
  more.input.offset(inputs) = 0.0;
  more.input.scale(inputs) = 1.0;
  return more;
}

double MeanSquare(const Samples& samples, const Eigen::MatrixXd& predicted,
                  const std::vector<int>& indices) {
  if (indices.empty()) return 0.0;
  double sum = 0.0;
  for (const int t : indices) sum += (predicted.col(t) - samples.targets.col(t)).squaredNorm();
  return sum / (static_cast<double>(indices.size()) * static_cast<double>(predicted.rows()));
}

}  // namespace sinew::networks
