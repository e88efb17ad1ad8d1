#include "reproduction/module_tables/section_parts.h"

#include <utility>

namespace sinew::reproduction {

void Compare(report::Section* section, std::string name, std::string unit, std::string ours,
             std::string target, std::optional<bool> met, std::string remark) {
  report::Comparison c;
  c.name = std::move(name);
  c.unit = std::move(unit);
  c.ours = std::move(ours);
  c.target = std::move(target);
  c.met = met;
  c.remark = std::move(remark);
  section->comparisons.push_back(std::move(c));
}

}  // namespace sinew::reproduction
