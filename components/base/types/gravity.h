// Acceleration of gravity where nothing else is declared.
#pragma once

namespace sinew::types {

inline constexpr double kGravity_m_s2 = 9.81;
inline constexpr double kStandardGravity_m_s2 = 9.80665;  // the unit g of sensors (CGPM 1901)

}  // namespace sinew::types
