// A property of a recording that does not stop the analysis: reported, never silently corrected.
#pragma once

#include <string>

namespace sinew::identify {

struct Finding {
  std::string name;  // stable, e.g. "lost_rows"
  std::string text;  // one sentence
  double value = 0.0;
  std::string unit;
};

}  // namespace sinew::identify
