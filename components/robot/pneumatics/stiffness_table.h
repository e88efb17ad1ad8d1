// Stiffness against pressure, k(P), as identified: straight lines between measured points, both
// rising. Thread: immutable. Allocates when made.
#pragma once

#include <optional>
#include <vector>

namespace sinew::pneumatics {

class StiffnessTable {
 public:
  StiffnessTable() = default;  // no table
  // Throws std::invalid_argument unless there are two or more points, pressure and stiffness
  // strictly rising.
  StiffnessTable(std::vector<double> pressure_bar, std::vector<double> stiffness_Nm_rad);

  bool empty() const noexcept { return pressure_bar_.empty(); }
  // Held constant beyond the ends; 0 without a table.
  double Stiffness_Nm_rad(double pressure_bar) const noexcept;
  // Nothing outside the table's range.
  std::optional<double> Pressure_bar(double stiffness_Nm_rad) const noexcept;

 private:
  std::vector<double> pressure_bar_;
  std::vector<double> stiffness_Nm_rad_;
};

}  // namespace sinew::pneumatics
