// The words and the references of the tree: what docs/glossary.md replaces is not used, a comment
// begins with its noun, and a document cites only files that are there.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "tests/tree/tree_files.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;
using ::testing::UnorderedElementsAre;

constexpr std::size_t kMostTerms = 40;

// Word not used here -> what stands for it.
std::map<std::string, std::string> ReplacedWords() {
  std::map<std::string, std::string> words;
  for (const auto& row : TableBelow(Read(kRoot / "docs/glossary.md"), "## Words not used here")) {
    words[row.at(0)] = row.at(1);
  }
  return words;
}

// Words of a line in lower case: runs of letters, and the parts of identifiers ("TellState" holds
// "tell" and "state"); words with hyphens count whole, too.
std::set<std::string> WordsOf(const std::string& line) {
  const auto is = [](int (*kind)(int), char c) { return kind(static_cast<unsigned char>(c)) != 0; };
  std::set<std::string> words;
  std::string part, hyphened;
  const auto end_part = [&] {
    words.insert(part);
    part.clear();
  };
  for (std::size_t i = 0; i <= line.size(); ++i) {
    const char c = i < line.size() ? line[i] : ' ';
    if (is(std::isalpha, c)) {
      const bool after_lower = i > 0 && is(std::islower, line[i - 1]);
      const bool before_lower = i + 1 < line.size() && is(std::islower, line[i + 1]);
      const bool after_upper = i > 0 && is(std::isupper, line[i - 1]);
      if (is(std::isupper, c) && (after_lower || (after_upper && before_lower))) end_part();
      part += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
      hyphened += part.back();
    } else {
      end_part();
      if (c == '-' && !hyphened.empty()) {
        hyphened += c;
      } else {
        words.insert(hyphened);
        hyphened.clear();
      }
    }
  }
  words.erase("");
  return words;
}

// Places where such a word stays, with the reason.
const std::vector<std::pair<std::string, std::string>> kAllowed = {
    {"--sealed", "alias of --held-out and --held-out-map in the command line"},
    {"\"sealed\"", "report.json repeats held_out under its name of schema 1"},
    {"`sealed`", "docs/formats.md: the map of renamed keys"},
    {"`surprise`", "docs/formats.md: the map of renamed keys"},
    {"`swallowed_by_refit`", "docs/formats.md: the map of renamed keys"},
    {"`look_alikes`", "docs/formats.md: the map of renamed keys"},
    {"sealed.csv", "file of a case of the bank of rigs, and of tests/data/rig_examples"},
    {"\"sealed\"}", "the same, without its extension"},
    {"sealed_declared", "key of truth.json of tests/data/rig_examples"},
    {"sealed_oracle", "key of truth.json of tests/data/rig_examples"},
};

std::string WithoutAllowed(std::string line) {
  for (const auto& [text, reason] : kAllowed) {
    for (std::size_t at = line.find(text); at != std::string::npos; at = line.find(text)) {
      line.erase(at, text.size());
    }
  }
  return line;
}

std::string Joined(const std::vector<std::string>& lines) {
  std::string out;
  for (const std::string& line : lines) out += line + "\n";
  return out;
}

bool IsScanned(const std::string& file) {
  if (file == "CHANGELOG.md" || file == "docs/glossary.md" || StartsWith(file, "tests/data/") ||
      file == "tests/tree/language_test.cc") {
    return false;
  }
  static const std::set<std::string> kExtensions = {".cc", ".h", ".md", ".idl", ".yaml", ".cmake"};
  return EndsWith(file, "CMakeLists.txt") || kExtensions.count(fs::path(file).extension()) != 0;
}

TEST(Language, WordsAreRunsOfLettersAndPartsOfIdentifiers) {
  EXPECT_THAT(WordsOf("TellState told_by HTTPRoom x2y"),
              UnorderedElementsAre("tell", "state", "tellstate", "told", "by", "http", "room",
                                   "httproom", "x", "y"));
  EXPECT_THAT(WordsOf("a look-alike, tellg"),
              UnorderedElementsAre("a", "look", "alike", "look-alike", "tellg"));
}

TEST(Language, TablesAreReadByTheirHeading) {
  const std::string text = "## A\n| x | y |\n| --- | --- |\n| 1 |  |\n## B\n| z |\n| --- |\n";
  EXPECT_THAT(TableBelow(text, "## A"), ElementsAre(ElementsAre("1", "")));
  EXPECT_THAT(TableBelow(text, "## B"), IsEmpty());
}

TEST(Language, TheGlossaryIsShortAndNamesWhatReplacesAWord) {
  const auto terms = TableBelow(Read(kRoot / "docs/glossary.md"), "# Glossary");
  EXPECT_GE(terms.size(), kMostTerms / 2);
  EXPECT_LE(terms.size(), kMostTerms);
  std::set<std::string> names;
  for (const auto& row : terms) {
    ASSERT_EQ(row.size(), 3u) << row.front();
    EXPECT_FALSE(row[1].empty()) << row[0];
    EXPECT_TRUE(names.insert(row[0]).second) << row[0] << " stands twice";
  }
  const std::map<std::string, std::string> words = ReplacedWords();
  EXPECT_GE(words.size(), 20u);
  for (const auto& [word, instead] : words) EXPECT_FALSE(instead.empty()) << word;
}

TEST(Language, ReplacedWordsAreNotUsed) {
  const std::map<std::string, std::string> words = ReplacedWords();
  std::vector<std::string> found;
  int scanned = 0;
  for (const std::string& file : Files()) {
    if (!IsScanned(file)) continue;
    ++scanned;
    const std::vector<std::string> lines = Lines(Read(kRoot / file));
    for (std::size_t i = 0; i < lines.size(); ++i) {
      for (const std::string& word : WordsOf(WithoutAllowed(lines[i]))) {
        const auto at = words.find(word);
        if (at == words.end()) continue;
        found.push_back(file + ":" + std::to_string(i + 1) + ": '" + word +
                        "' (use: " + at->second + ")");
      }
    }
  }
  EXPECT_GT(scanned, 500);
  EXPECT_TRUE(found.empty()) << Joined(found);
}

bool IsComment(const std::string& line) {
  const std::size_t first = line.find_first_not_of(' ');
  return first != std::string::npos && line.compare(first, 2, "//") == 0;
}

std::string FirstWordOfComment(const std::string& line) {
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0; };
  const auto begin = line.begin() + static_cast<std::ptrdiff_t>(
                                        std::min(line.find_first_not_of(" /"), line.size()));
  return {begin, std::find_if_not(begin, line.end(), is_letter)};
}

TEST(Language, TheFirstWordOfACommentStandsBehindItsSlashes) {
  EXPECT_TRUE(IsComment("  // Of a link"));
  EXPECT_FALSE(IsComment("int a;  // Of a link"));
  EXPECT_EQ(FirstWordOfComment("  // Of a link"), "Of");
  EXPECT_EQ(FirstWordOfComment("//What's"), "What");
  EXPECT_EQ(FirstWordOfComment("//"), "");
}

TEST(Language, CommentsBeginWithTheirNoun) {
  static const std::set<std::string> kNotFirst = {"Of",       "Who",   "Whoever", "Whose", "What",
                                                  "Whatever", "Which", "How",     "Where", "When"};
  std::vector<std::string> found;
  int comments = 0;
  for (const char* top : {"bridge", "components", "sim", "tools"}) {
    for (const std::string& file : Files(top)) {
      if (!EndsWith(file, ".cc") && !EndsWith(file, ".h")) continue;
      const std::vector<std::string> lines = Lines(Read(kRoot / file));
      for (std::size_t i = 0; i < lines.size(); ++i) {
        if (!IsComment(lines[i]) || (i > 0 && IsComment(lines[i - 1]))) continue;
        ++comments;
        const std::string word = FirstWordOfComment(lines[i]);
        if (kNotFirst.count(word) != 0) found.push_back(file + ":" + std::to_string(i + 1));
      }
    }
  }
  EXPECT_GT(comments, 4000);
  EXPECT_TRUE(found.empty()) << "A comment begins with the noun that it describes, or with a verb; "
                                "not with Of, What, Who, Which, How, Where, When:\n"
                             << Joined(found);
}

// Documents of the project; a changelog names what once was.
std::vector<std::string> Documents() {
  std::vector<std::string> out;
  for (const std::string& file : Files()) {
    if (EndsWith(file, ".md") && file != "CHANGELOG.md") out.push_back(file);
  }
  return out;
}

// A document without its fenced blocks of code.
std::string Prose(const std::string& file) {
  std::string out;
  bool code = false;
  for (const std::string& line : Lines(Read(kRoot / file))) {
    const std::size_t first = line.find_first_not_of(' ');
    if (first != std::string::npos && line.compare(first, 3, "```") == 0) code = !code;
    if (!code) out += line + "\n";
  }
  return out;
}

TEST(Language, LinksOfTheDocumentsLead) {
  static const std::regex kLink(R"(\]\(([^)#\s]+)[^)]*\))");
  std::vector<std::string> found;
  for (const std::string& file : Documents()) {
    const std::string text = Prose(file);
    for (std::sregex_iterator it(text.begin(), text.end(), kLink), end; it != end; ++it) {
      const std::string target = (*it)[1];
      if (target.find("://") != std::string::npos) continue;
      if (!fs::exists(kRoot / fs::path(file).parent_path() / target)) {
        found.push_back(file + " -> " + target);
      }
    }
  }
  EXPECT_THAT(found, IsEmpty());
}

// A path from the root that a document cites: a file, a folder, a module's file without extension,
// or what a build makes (build/).
bool PathIsThere(const std::string& path) {
  return fs::exists(kRoot / path) || fs::exists(kRoot / (path + ".h")) ||
         fs::exists(kRoot / (path + ".cc"));
}

TEST(Language, FilesThatTheDocumentsCiteAreThere) {
  // `components/model/identify/gas.h`, `robots/rig` and `set_search.h`; no patterns, no
  // placeholders.
  static const std::regex kQuoted("`([.A-Za-z0-9_][A-Za-z0-9_./-]*)`");
  static const std::regex kSource(R"([a-z0-9_]+\.(h|cc|idl))");
  std::set<std::string> names, tops;
  for (const std::string& file : Files()) {
    names.insert(fs::path(file).filename());
    tops.insert(fs::path(file).begin()->string());
  }
  std::vector<std::string> found;
  int cited = 0;
  for (const std::string& file : Documents()) {
    const std::string text = Prose(file);
    const fs::path here = fs::path(file).parent_path();
    for (std::sregex_iterator it(text.begin(), text.end(), kQuoted), end; it != end; ++it) {
      const std::string word = (*it)[1];
      const bool path =
          word.find('/') != std::string::npos && tops.count(fs::path(word).begin()->string()) != 0;
      const bool source = std::regex_match(word, kSource);
      if (!path && !source) continue;
      ++cited;
      if (path ? !PathIsThere(word) && !PathIsThere((here / word).string())
               : names.count(word) == 0) {
        found.push_back(file + ": `" + word + "`");
      }
    }
  }
  EXPECT_GT(cited, 300);
  EXPECT_TRUE(found.empty()) << Joined(found);
}

TEST(Language, CommandsThatTheDocumentsCiteAreThere) {
  static const std::regex kCommand("(?:^|`|\n *)sinew ([a-z][a-z-]+)");
  std::string sources;
  for (const char* folder :
       {"tools/sinew", "tools/export_recording", "tools/export_model", "tools/rerun",
        "tools/security", "tools/tune_robot", "tools/view", "reproduction/commands"}) {
    for (const std::string& file : Files(folder)) {
      if (EndsWith(file, ".cc")) sources += Read(kRoot / file);
    }
  }
  std::vector<std::string> found;
  std::set<std::string> cited;
  for (const std::string& file : Documents()) {
    const std::string text = Read(kRoot / file);
    for (std::sregex_iterator it(text.begin(), text.end(), kCommand), end; it != end; ++it) {
      const std::string command = (*it)[1];
      cited.insert(command);
      if (sources.find("\"" + command + "\"") == std::string::npos) {
        found.push_back(file + ": `sinew " + command + "`");
      }
    }
  }
  EXPECT_GT(cited.size(), 15u);
  EXPECT_TRUE(found.empty()) << Joined(found);
}

}  // namespace
}  // namespace sinew
