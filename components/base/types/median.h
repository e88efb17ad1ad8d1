// The median of a list.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace sinew::types {

// The middle value, of an even number the upper of the two in the middle. At least one value.
template <class Number>
Number UpperMedian(std::vector<Number> values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace sinew::types
