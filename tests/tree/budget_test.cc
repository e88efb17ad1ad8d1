// The size of the product against docs/budget.md: growth is a decision, with a reason in writing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "tests/tree/tree_files.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;
using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::Key;

constexpr const char* kPage = "docs/budget.md";

constexpr std::size_t kLongestFunction = 80;  // lines

std::vector<std::string> Sources(const std::vector<const char*>& tops) {
  std::vector<std::string> sources;
  for (const char* top : tops) {
    for (const std::string& file : Files(top)) {
      if (EndsWith(file, ".cc") || EndsWith(file, ".h")) sources.push_back(file);
    }
  }
  return sources;
}

// "components/wing/module" or "top/module".
std::string ModuleOf(const std::string& file) {
  fs::path module;
  const fs::path path(file);
  auto part = path.begin();
  const int parts = StartsWith(file, "components/") ? 3 : 2;
  for (int k = 0; k < parts; ++k) module /= *part++;
  return module.string();
}

std::size_t Indentation(const std::string& line) { return line.find_first_not_of(' '); }

struct Function {
  std::size_t first_line = 0, lines = 0;  // first_line from 1
  std::string head;                       // before the arguments
};

bool IsNoCode(const std::string& line) {
  const std::size_t at = Indentation(line);
  return at == std::string::npos || line[at] == '#' || line.compare(at, 2, "//") == 0;
}

bool EndsStatement(const std::string& line) { return line.find_last_of(";{}:") == line.size() - 1; }

// Functions of a formatted file: from the first line of the definition to its closing brace.
// Lambdas and local classes belong to the function around them.
std::vector<Function> FunctionsOf(const std::vector<std::string>& lines) {
  static const std::set<std::string> kOther = {"extern", "namespace", "class", "struct", "enum",
                                               "union",  "if",        "for",   "while",  "switch",
                                               "do",     "else",      "try",   "catch"};
  std::vector<Function> functions;
  for (std::size_t end = 0; end < lines.size(); ++end) {
    if (!EndsWith(lines[end], "{") || IsNoCode(lines[end])) continue;
    std::size_t begin = end;
    while (begin > 0 && !EndsStatement(lines[begin - 1]) && !IsNoCode(lines[begin - 1])) --begin;
    std::string statement;
    for (std::size_t k = begin; k <= end; ++k) statement += lines[k].substr(Indentation(lines[k]));
    const std::string head = statement.substr(0, statement.find('('));
    if (head.size() == statement.size() || head.find_first_of("={") != std::string::npos ||
        kOther.count(head.substr(0, head.find(' '))) != 0) {
      continue;
    }
    const std::string closing = std::string(Indentation(lines[begin]), ' ') + "}";
    std::size_t last = end + 1;
    while (last < lines.size() && !StartsWith(lines[last], closing)) ++last;
    functions.push_back({begin + 1, last - begin + 1, head});
    end = last;
  }
  return functions;
}

TEST(Budget, AFunctionReachesFromItsFirstLineToItsBrace) {
  const std::vector<Function> found = FunctionsOf(Lines(R"(namespace sinew {
class A {
 public:
  int Get() const {
    return a_;
  }
  int a_ = 0;
};

Result LongName(int a,
                int b) {
  const auto lambda = [&](int c) {
    return c;
  };
  if (a > b) {
    return {};
  }
  return lambda(a);
}
const std::vector<Rule> kRules = {
    {1, [](int x) {
       return x;
     }}};
}  // namespace sinew)"));
  std::vector<std::size_t> numbers;
  for (const Function& function : found) {
    numbers.insert(numbers.end(), {function.first_line, function.lines});
  }
  EXPECT_THAT(numbers, ElementsAre(4, 3, 10, 10));
}

TEST(Budget, NoFunctionIsLongerThanEightyLines) {
  std::size_t read = 0;
  for (const char* top : {"bench", "bridge", "components", "sim", "tools"}) {
    for (const std::string& file : Sources({top})) {
      for (const Function& function : FunctionsOf(Lines(Read(kRoot / file)))) {
        ++read;
        EXPECT_LE(function.lines, kLongestFunction)
            << file << ":" << function.first_line << ": " << function.head;
      }
    }
  }
  EXPECT_GT(read, 5000u);
}

// Limits of a table of docs/budget.md.
std::map<std::string, long> Limits(const std::string& heading) {
  std::map<std::string, long> limits;
  for (const auto& row : TableBelow(Read(kRoot / kPage), heading)) {
    limits[row.at(0)] = std::stol(row.at(1));
  }
  return limits;
}

TEST(Budget, TheProductKeepsItsLimits) {
  long product = 0;
  std::map<std::string, long> modules;
  for (const std::string& file : Sources({"bridge", "components", "sim", "tools"})) {
    const long count = static_cast<long>(Lines(Read(kRoot / file)).size());
    product += count;
    modules[ModuleOf(file)] += count;
  }
  const std::string advice = std::string("; see ") + kPage;
  std::map<std::string, long> limits = Limits("## Limits");
  ASSERT_EQ(limits.size(), 1u);
  EXPECT_LE(product, limits["lines of product"]) << advice;

  std::map<std::string, long> module_limits = Limits("## Lines of each module");
  for (const auto& [module, count] : modules) {
    EXPECT_THAT(module_limits, Contains(Key(module))) << count << " lines" << advice;
    EXPECT_LE(count, module_limits[module]) << module << advice;
    module_limits.erase(module);
  }
  EXPECT_THAT(module_limits, IsEmpty()) << "modules that are not there";
}

}  // namespace
}  // namespace sinew
