// Fields of a topic's messages as curves (`sinew echo --plot`), and curves in this terminal.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "components/record/recording/cdr.h"
#include "tools/inspect/plot.h"

namespace sinew::tools {

class EchoPlot {
 public:
  // Fields are paths to numbers, e.g. position_rad[0]. window_s: only the newest seconds are kept;
  // 0: all. Keeps a reference to the type. Throws recording::CdrError naming a field that is not
  // there, std::invalid_argument for one that is a text.
  EchoPlot(const std::string& topic, const recording::IdlType& type,
           const std::vector<std::string>& fields, double window_s);

  // Time is header.stamp_ns where the type has it, else the arrival. Throws recording::CdrError.
  void Add(std::span<const std::byte> payload, std::int64_t arrival_ns);
  std::uint64_t messages() const { return messages_; }

  const std::vector<inspect::Curve>& curves() const { return curves_; }

 private:
  const double window_s_;
  std::vector<recording::CdrField> fields_;
  std::optional<recording::CdrField> stamp_;
  std::optional<std::int64_t> first_ns_;
  std::vector<inspect::Curve> curves_;
  std::uint64_t messages_ = 0;
};

// Text of a plot as large as the terminal but for two rows, in colour where it has any; 80 x 24
// without one. columns, rows: 0, or in place of the terminal's. Throws UsageError without gnuplot,
// std::runtime_error when it fails.
std::string DrawnHere(const std::vector<inspect::Curve>& curves, int columns = 0, int rows = 0);

}  // namespace sinew::tools
