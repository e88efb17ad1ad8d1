#include "components/base/types/unit_name.h"

#include <cctype>
#include <set>
#include <vector>

namespace sinew::types {

UnitName SplitUnit(const std::string& name) {
  static const std::set<std::string> kUnits = {
      "N",   "Nm",      "rad",  "deg", "m",   "mm",  "s",    "ms", "us",   "ns", "Hz",
      "V",   "A",       "bar",  "Pa",  "kg",  "K",   "degC", "m2", "m3",   "s2", "rad2",
      "per", "percent", "turn", "rev", "W",   "ohm", "H",    "l",  "J",    "MB", "g",
      "cm",  "kPa",     "min",  "h",   "mNm", "kN",  "mA",   "mV", "litre"};
  static const std::set<std::string> kBeforeTime = {"N", "Nm", "V", "kg"};  // "Nm s", not "Nm/s"
  UnitName out{name, ""};
  std::vector<std::string> words;  // the last one first
  for (std::size_t cut = name.rfind('_');
       cut != std::string::npos && kUnits.contains(out.stem.substr(cut + 1));
       cut = out.stem.rfind('_')) {
    words.push_back(out.stem.substr(cut + 1));
    out.stem.resize(cut);
  }
  std::string above, below;
  for (auto word = words.rbegin(); word != words.rend(); ++word) {
    const bool multiplies = below.empty() && kBeforeTime.contains(words.back()) &&
                            (*word == "s" || *word == "s2" || *word == "m2");
    std::string& part = above.empty() || multiplies ? above : below;
    part += (part.empty() ? "" : " ") + (*word == "per" ? "1" : *word);
    if (std::isdigit(static_cast<unsigned char>(part.back())) != 0 && *word != "per") {
      part.insert(part.size() - 1, "^");
    }
  }
  out.unit = above;
  if (!below.empty())
    out.unit += below.find(' ') == std::string::npos ? "/" + below : "/(" + below + ")";
  return out;
}

}  // namespace sinew::types
