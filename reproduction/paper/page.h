// Sections of results as one HTML page.
#pragma once

#include <string>
#include <vector>

#include "components/model/report/section.h"

namespace sinew::reproduction {

struct PageText {
  std::string title;
  std::string introduction;
};

// One HTML file: contents, a summary of all comparisons with a target, the sections.
std::string FormatPage(const PageText& text, const std::vector<report::Section>& sections);

}  // namespace sinew::reproduction
