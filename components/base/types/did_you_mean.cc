#include "components/base/types/did_you_mean.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "components/base/types/joined.h"

namespace sinew::types {

namespace {

// Insertions, deletions and changes of a letter, and neighbours exchanged.
std::size_t Distance(const std::string& a, const std::string& b) {
  std::vector<std::size_t> before, above(b.size() + 1), row(b.size() + 1);
  std::iota(above.begin(), above.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + (a[i - 1] != b[j - 1])});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1]) {
        row[j] = std::min(row[j], before[j - 2] + 1);
      }
    }
    before = std::exchange(above, row);
  }
  return above[b.size()];
}

}  // namespace

std::string DidYouMean(const std::string& word, const std::vector<std::string>& known) {
  std::string nearest;
  std::size_t least = 1 + word.size() / 3;
  for (const std::string& one : known) {
    const std::size_t distance = Distance(word, one);
    if (distance >= least) continue;
    least = distance;
    nearest = one;
  }
  return nearest.empty() ? "" : "; did you mean '" + nearest + "'?";
}

std::string NoSuch(const std::string& what, const std::string& word,
                   const std::vector<std::string>& known) {
  return "no " + what + " '" + word +
         "', expected one of: " + (known.empty() ? "none" : Joined(known)) +
         DidYouMean(word, known);
}

}  // namespace sinew::types
