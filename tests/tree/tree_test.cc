// Reads the sources as text and holds them to the rules of the tree (ARCHITECTURE.md, "Modules").
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "components/topics/node/topics.h"
#include "tests/tree/tree_files.h"

namespace sinew {
namespace {

namespace fs = std::filesystem;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

bool IsSource(const std::string& file) { return EndsWith(file, ".cc") || EndsWith(file, ".h"); }

struct Include {
  int line = 0;
  std::string name;  // between the marks
};

std::vector<Include> IncludesOf(const std::string& file) {
  static const std::regex kInclude(R"(^\s*#\s*include\s*[<"]([^">]+)[">])");
  std::vector<Include> includes;
  const std::vector<std::string> lines = Lines(Read(kRoot / file));
  for (std::size_t i = 0; i < lines.size(); ++i) {
    std::smatch match;
    if (std::regex_search(lines[i], match, kInclude)) {
      includes.push_back({static_cast<int>(i) + 1, match[1]});
    }
  }
  return includes;
}

// Modules of bench/: what tests and reproduction include of it. The rest of bench/ are programs; as
// tests they include from everywhere.
const std::vector<std::string> kBenchModules = {"bench/acceptance/", "bench/floating_world/",
                                                "bench/rigs/"};

bool IsBelowOneOf(const std::vector<std::string>& folders, const std::string& file) {
  return std::any_of(folders.begin(), folders.end(),
                     [&file](const std::string& folder) { return StartsWith(file, folder); });
}

// Tests, and the programs of bench/.
bool IsTest(const std::string& file) {
  return StartsWith(file, "tests/") ||
         (StartsWith(file, "bench/") && !IsBelowOneOf(kBenchModules, file));
}

// Modules that are not pure, and why. Everything else under components/, bridge/ and sim/ is, but
// for its folders participant/ (a process) and file/ (reading and writing).
const std::map<std::string, std::string> kNotPure = {
    {"components/base/config", "reads and writes files"},
    {"components/model/close_loop", "reads recordings, writes reports, says how long it took"},
    {"components/robot/estop", "a socket, a file, and the devices that are pressed"},
    {"components/record/logger", "a queue and a thread in front of a file"},
    {"components/base/types/clock", "reads the clock"},
    {"components/topics/isolation", "namespaces of the kernel"},
    {"components/topics/node", "owns DDS, options, logs and clocks"},
    {"sim/surrogate/csv", "a program: runs as CSV files"},
    {"bridge/can/bus", "a program: the server of the virtual bus"},
    {"bridge/can/transport", "sockets to buses"},
};

// Pure libraries outside of these wings.
const std::vector<std::string> kPureElsewhere = {"bench/floating_world/", "bench/rigs/drawn/",
                                                 "reproduction/networks/"};

bool IsPure(const std::string& file) {
  if (!IsSource(file)) return false;
  const fs::path path(file);
  const std::string top = path.begin()->string();
  if (top != "components" && top != "bridge" && top != "sim" &&
      !IsBelowOneOf(kPureElsewhere, file)) {
    return false;
  }
  for (const fs::path& part : path) {
    if (part == "participant" || part == "file") return false;
  }
  return std::none_of(kNotPure.begin(), kNotPure.end(),
                      [&file](const auto& entry) { return StartsWith(file, entry.first + "/"); });
}

TEST(Tree, PureLibrariesIncludeNoTransportLogFileOrClock) {
  static const std::regex kForbidden(
      "^(fastdds|fastrtps|fastcdr|spdlog|boost/"
      "(asio|process|filesystem|interprocess)|CLI|yaml-cpp|nlohmann|sys/|netinet/|arpa/|"
      "linux/|components/topics/node/|components/base/config/|components/base/types/clock/|tools/"
      "|tests/)"
      "|^(fstream|iostream|filesystem|fcntl\\.h|unistd\\.h|ctime|time\\.h|thread|"
      "mutex|random_device)$"
      "|/(participant|file)/");
  std::vector<std::string> found;
  int scanned = 0;
  for (const std::string& file : Files()) {
    if (!IsPure(file)) continue;
    ++scanned;
    for (const Include& include : IncludesOf(file)) {
      if (std::regex_search(include.name, kForbidden)) {
        found.push_back(file + ":" + std::to_string(include.line) + " includes " + include.name);
      }
    }
  }
  EXPECT_GT(scanned, 5);
  EXPECT_THAT(found, IsEmpty());
}

TEST(Tree, PureLibrariesUseNoClockChanceOrFile) {
  static const std::regex kForbidden(
      R"((steady|system|high_resolution)_clock|clock_gettime|gettimeofday|random_device|\brand\(|)"
      R"(::Random\(|\bsetRandom\(|\bfopen\(|\bf?printf\(|\bgetenv\()");
  std::vector<std::string> found;
  for (const std::string& file : Files()) {
    // Times inner loops whose results are equal, and takes the fastest.
    if (!IsPure(file) || file == "components/base/simd/fastest.cc") continue;
    const std::vector<std::string> lines = Lines(Read(kRoot / file));
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::string code = lines[i].substr(0, lines[i].find("//"));
      if (std::regex_search(code, kForbidden)) {
        found.push_back(file + ":" + std::to_string(i + 1) + ": " + lines[i]);
      }
    }
  }
  EXPECT_THAT(found, IsEmpty());
}

TEST(Tree, OnlyTheNodeModuleIncludesFastDds) {
  std::vector<std::string> found;
  for (const std::string& file : Files()) {
    // The relays of bench/chain show what the middleware costs without any code of ours.
    if (!IsSource(file) || StartsWith(file, "components/topics/node/") ||
        file == "bench/chain/relay.cc") {
      continue;
    }
    for (const Include& include : IncludesOf(file)) {
      if (StartsWith(include.name, "fastdds") || StartsWith(include.name, "fastrtps")) {
        found.push_back(file + ":" + std::to_string(include.line));
      }
    }
  }
  EXPECT_THAT(found, IsEmpty());
}

// "components/learn/rls/participant/x.cc" belongs to the unit "components/learn/rls/participant".
std::string UnitOf(const std::string& file) { return fs::path(file).parent_path().string(); }

// Which folder uses which.
using Uses = std::map<std::string, std::set<std::string>>;

// The folders of circles of dependencies (and folders between two circles).
std::set<std::string> InCircles(const Uses& uses) {
  std::set<std::string> left;
  for (const auto& [folder, used] : uses) left.insert(folder);
  const auto depends = [&uses](const std::string& on, const std::string& folder) {
    return uses.at(folder).count(on) != 0;
  };
  // Take away what depends on nothing that is left or is used by nothing that is left.
  for (bool progress = true; progress;) {
    progress = false;
    for (auto it = left.begin(); it != left.end();) {
      const bool uses_any = std::any_of(left.begin(), left.end(),
                                        [&](const auto& name) { return depends(name, *it); });
      const bool is_used = std::any_of(left.begin(), left.end(),
                                       [&](const auto& name) { return depends(*it, name); });
      const bool free = !uses_any || !is_used;
      progress = progress || free;
      it = free ? left.erase(it) : std::next(it);
    }
  }
  return left;
}

TEST(Tree, CirclesAreFound) {
  EXPECT_THAT(InCircles({}), IsEmpty());
  EXPECT_THAT(InCircles({{"a", {"b", "c"}}, {"b", {"c"}}}), IsEmpty());
  EXPECT_THAT(InCircles({{"a", {"b"}}, {"b", {"a", "d"}}, {"c", {"a"}}}), ElementsAre("a", "b"));
  EXPECT_THAT(InCircles({{"a", {"b"}}, {"b", {"c"}}, {"c", {"a"}}}), ElementsAre("a", "b", "c"));
}

TEST(Tree, FoldersDependOnEachOtherInOneDirection) {
  Uses uses;
  for (const std::string& file : Files()) {
    if (!IsSource(file) || IsTest(file)) continue;
    for (const Include& include : IncludesOf(file)) {
      const std::string unit = UnitOf(include.name);
      if (fs::exists(kRoot / include.name) && unit != UnitOf(file)) uses[UnitOf(file)].insert(unit);
    }
  }
  EXPECT_THAT(InCircles(uses), IsEmpty()) << "folders that depend on each other in a circle";
}

// Folder at the top of the tree that a file or an include belongs to; programs of bench count as
// tests, generated IDL types as idl; empty for includes from elsewhere.
std::string TopOf(const std::string& file) {
  const std::string top = fs::path(file).begin()->string();
  if (top == "sinew_idl") return "idl";
  if (IsTest(file)) return "tests";
  return fs::is_directory(kRoot / top) && fs::path(file).has_parent_path() ? top : "";
}

TEST(Tree, TopLevelFoldersDependOnEachOtherInOneDirection) {
  Uses uses;
  std::map<std::string, std::string> examples;  // "a -> b": the file in a
  for (const std::string& file : Files()) {
    if (!IsSource(file)) continue;
    const std::string top = TopOf(file);
    for (const Include& include : IncludesOf(file)) {
      const std::string used = TopOf(include.name);
      if (used.empty() || used == top) continue;
      uses[top].insert(used);
      examples.emplace(top + " -> " + used, file + " includes " + include.name);
    }
  }
  EXPECT_GE(uses.size(), 4u) << "too few folders were scanned";
  const std::set<std::string> circles = InCircles(uses);
  for (const auto& [edge, file] : examples) {
    const bool in_circle = circles.count(edge.substr(0, edge.find(' '))) != 0 &&
                           circles.count(edge.substr(edge.rfind(' ') + 1)) != 0;
    EXPECT_FALSE(in_circle) << edge << ": " << file;
  }
}

// Includes of the files below a folder that match none of the given beginnings, of those that
// exist in the project.
std::vector<std::string> ForeignIncludes(const std::string& below,
                                         const std::vector<std::string>& allowed) {
  std::vector<std::string> found;
  for (const std::string& file : Files(below)) {
    if (!IsSource(file)) continue;
    for (const Include& include : IncludesOf(file)) {
      if (TopOf(include.name).empty()) continue;
      if (std::none_of(allowed.begin(), allowed.end(), [&include](const std::string& begin) {
            return StartsWith(include.name, begin);
          })) {
        found.push_back(file + " includes " + include.name);
      }
    }
  }
  return found;
}

TEST(Tree, ComponentsIncludeComponentsAndTopicTypesOnly) {
  EXPECT_THAT(ForeignIncludes("components", {"components/", "sinew_idl/", "idl/"}), IsEmpty());
}

// In the order in which components/README.md lists them.
std::vector<std::string> Wings() {
  static const std::regex kRow(R"(\| \[`(\w+)`\].*)");
  std::vector<std::string> wings;
  for (const std::string& line : Lines(Read(kRoot / "components/README.md"))) {
    std::smatch match;
    if (std::regex_match(line, match, kRow)) wings.push_back(match[1]);
  }
  return wings;
}

TEST(Tree, AWingIncludesItselfAndThoseAboveIt) {
  const std::vector<std::string> wings = Wings();
  std::set<std::string> folders;
  for (const auto& entry : fs::directory_iterator(kRoot / "components")) {
    if (entry.is_directory()) folders.insert(entry.path().filename());
  }
  EXPECT_EQ(std::set<std::string>(wings.begin(), wings.end()), folders);
  const auto place = [&wings](const std::string& file) {
    const std::string wing = *std::next(fs::path(file).begin());
    return std::find(wings.begin(), wings.end(), wing) - wings.begin();
  };
  std::vector<std::string> found;
  for (const std::string& file : Files("components")) {
    if (!IsSource(file)) continue;
    for (const Include& include : IncludesOf(file)) {
      if (StartsWith(include.name, "components/") && place(include.name) > place(file)) {
        found.push_back(file + ":" + std::to_string(include.line) + " includes " + include.name);
      }
    }
  }
  EXPECT_THAT(found, IsEmpty());
}

TEST(Tree, SharedTypesIncludeNothingElseOfTheProjectButMessages) {
  EXPECT_GT(Files("components/base/types").size(), 5u);
  EXPECT_THAT(ForeignIncludes("components/base/types", {"components/base/types/", "sinew_idl/"}),
              IsEmpty());
  // Nor anything installed but the standard library (names without a folder), Eigen and Boost's
  // conversion of UTF-8.
  std::vector<std::string> found;
  for (const std::string& file : Files("components/base/types")) {
    if (!IsSource(file)) continue;
    for (const Include& include : IncludesOf(file)) {
      const bool folder = include.name.find('/') != std::string::npos;
      const bool ours = StartsWith(include.name, "components/base/types/") ||
                        StartsWith(include.name, "sinew_idl/");
      if (folder && !ours && !StartsWith(include.name, "Eigen/") &&
          include.name != "boost/nowide/utf/convert.hpp") {
        found.push_back(file + " includes " + include.name);
      }
    }
  }
  EXPECT_THAT(found, IsEmpty());
}

// Who includes from tools/, and from what is no part of the product (components, bridge, sim,
// tools): what measures it, what regenerates published tables with it, what tests it.
const std::map<std::string, std::set<std::string>> kUsers = {
    {"tools", {"tools", "bench", "reproduction", "tests"}},
    {"bench", {"bench", "reproduction", "tests"}},
    {"reproduction", {"reproduction", "tests"}},
    {"tests", {"tests"}},
};

TEST(Tree, TheProductIncludesNothingOfBenchReproductionOrTests) {
  std::vector<std::string> found;
  std::set<std::string> used;
  for (const std::string& file : Files()) {
    if (!IsSource(file)) continue;
    for (const Include& include : IncludesOf(file)) {
      const auto users = kUsers.find(TopOf(include.name));
      if (users == kUsers.end()) continue;
      used.insert(users->first);
      if (users->second.count(TopOf(file)) == 0)
        found.push_back(file + " includes " + include.name);
    }
  }
  EXPECT_EQ(used.size(), kUsers.size()) << "too few folders were scanned";
  EXPECT_THAT(found, IsEmpty());
}

TEST(Tree, IncludesStartAtTheRoot) {
  std::vector<std::string> found;
  for (const std::string& file : Files()) {
    if (!IsSource(file)) continue;
    for (const Include& include : IncludesOf(file)) {
      const bool beside = fs::exists(kRoot / fs::path(file).parent_path() / include.name);
      if (StartsWith(include.name, "..") || (beside && !fs::exists(kRoot / include.name))) {
        found.push_back(file + " includes " + include.name);
      }
    }
  }
  EXPECT_THAT(found, IsEmpty());
}

TEST(Tree, HeadersBeginWithTheirPurpose) {
  std::vector<std::string> found;
  for (const std::string& file : Files()) {
    if (!EndsWith(file, ".h")) continue;
    const std::string text = Read(kRoot / file);
    if (!StartsWith(text, "// ")) found.push_back(file + ": no comment at the top");
    const bool many_times = EndsWith(file, "_body.h");  // included once per instruction set
    if (!many_times && text.find("#pragma once") == std::string::npos)
      found.push_back(file + ": no pragma once");
  }
  EXPECT_THAT(found, IsEmpty());
}

// A module is a folder with a CMakeLists.txt of its own that holds sources.
std::vector<std::string> Modules() {
  std::set<std::string> modules;
  for (const std::string& file : Files()) {
    const std::string folder = UnitOf(file);
    const bool in_tests = IsTest(file);
    const bool part = EndsWith(folder, "/participant") || EndsWith(folder, "/file");
    if ((IsSource(file) || EndsWith(file, ".idl")) && !in_tests && !part &&
        fs::exists(kRoot / folder / "CMakeLists.txt")) {
      modules.insert(folder);
    }
  }
  return {modules.begin(), modules.end()};
}

TEST(Tree, EveryModuleSaysWhatItIsForAndNamesItsFiles) {
  std::vector<std::string> found;
  for (const std::string& module : Modules()) {
    const fs::path readme = kRoot / module / "README.md";
    if (!fs::exists(readme)) {
      found.push_back(module + ": no README.md");
      continue;
    }
    const std::string text = Read(readme);
    const std::string first = Lines(text).empty() ? "" : Lines(text).front();
    if (first.size() < 20 || first.front() == '#') {
      found.push_back(module + "/README.md: the first line must say what the module is for");
    }
    for (const std::string& file : Files(module)) {
      const std::string stem = fs::path(file).stem();
      const bool here = UnitOf(file) == module && !EndsWith(file, "_body.h") &&
                        (EndsWith(file, ".h") || EndsWith(file, ".idl"));
      if (here && text.find(stem) == std::string::npos) {
        found.push_back(module + "/README.md does not name " + stem);
      }
    }
  }
  EXPECT_GE(Modules().size(), 5u);
  EXPECT_THAT(found, IsEmpty());
}

TEST(Tree, EveryLibraryIsIncludedByATest) {
  std::set<std::string> tested;
  for (const std::string& file : Files("tests")) {
    if (!IsSource(file)) continue;
    for (const Include& include : IncludesOf(file)) tested.insert(UnitOf(include.name));
  }
  std::vector<std::string> untested;
  for (const std::string& file : Files()) {
    if (IsPure(file) && EndsWith(file, ".h") && tested.insert(UnitOf(file)).second) {
      untested.push_back(UnitOf(file));
    }
  }
  EXPECT_THAT(untested, IsEmpty()) << "no test includes a header of these folders";
}

std::set<std::string> Packages() {
  std::set<std::string> packages;
  std::string lists;
  for (const char* list :
       {"packages", "run_packages", "test_packages", "oracle_packages", "notebook_packages"}) {
    lists += Read(kRoot / "tools" / (std::string(list) + ".txt"));
  }
  for (const std::string& line : Lines(lists)) {
    std::istringstream words(line.substr(0, line.find('#')));
    for (std::string word; words >> word;) packages.insert(word);
  }
  return packages;
}

// Second words of sinew_find, sinew_find_pc and sinew_missing: Debian packages.
std::set<std::string> PackagesThatCMakeNames() {
  std::set<std::string> packages;
  static const std::regex kCall(
      R"re((sinew_find\(\w[\w-]* |sinew_find_pc\(\w+ [\w-]+ |sinew_missing\([\w-]+ )"?([^")\n]+))re");
  const std::string text = Read(kRoot / "cmake/SinewDependencies.cmake");
  for (std::sregex_iterator it(text.begin(), text.end(), kCall), end; it != end; ++it) {
    std::istringstream words((*it)[2]);
    for (std::string word; words >> word;) {
      const bool is_package = std::regex_match(word, std::regex("[a-z0-9][a-z0-9.+-]+"));
      if (is_package) packages.insert(word);
    }
  }
  return packages;
}

TEST(Tree, PackagesAreExactlyWhatTheBuildAndTheProgramsNeed) {
  // Tools that are run, not linked, so that CMake does not look for them as libraries.
  const std::set<std::string> run = {"g++",
                                     "cmake",
                                     "ninja-build",
                                     "ccache",
                                     "mold",
                                     "libgmock-dev",
                                     "gnuplot-nox",
                                     "graphviz",
                                     "libgl1-mesa-dri",
                                     "procps",
                                     "systemd",
                                     "iproute2",
                                     "fastdds-tools",
                                     "libfaketime",
                                     "zsh",
                                     "openssl",
                                     "patch",
                                     "nodejs",
                                     "ca-certificates",
                                     "fonts-dejavu-core",
                                     "cyclonedds-tools",
                                     "qemu-system-x86",
                                     "mandoc",
                                     "fish",
                                     "busybox-static",
                                     "cpio",
                                     "can-utils",
                                     "python3-canmatrix",
                                     "python3-numpy",
                                     "python3-zstandard",
                                     "python3-lz4",
                                     "python3-matplotlib",
                                     "python3-jsonschema",
                                     "python3-yaml"};
  // Part of every compiler installation, or only for measurements.
  const std::set<std::string> implied = {"libc6-dev", "libbenchmark-dev"};
  const std::set<std::string> listed = Packages();
  const std::set<std::string> named = PackagesThatCMakeNames();
  EXPECT_GE(named.size(), 10u);
  for (const std::string& package : named) {
    if (implied.count(package) == 0) {
      EXPECT_EQ(listed.count(package), 1u) << package << " is asked for but in no list of tools/";
    }
  }
  for (const std::string& package : listed) {
    EXPECT_TRUE(named.count(package) != 0 || run.count(package) != 0)
        << package << " is listed but nothing asks for it";
  }
}

TEST(Tree, NothingIsLeftUnfinished) {
  // Written in two pieces so that this file does not find itself.
  static const std::regex kWords(std::string("\\b(TO") + "DO|FIX" + "ME|XX" + "X|HA" + "CK)\\b" +
                                 "|^(<<<<" + "<<< |>>>>" + ">>> )");
  std::vector<std::string> found;
  for (const std::string& file : Files()) {
    if (StartsWith(file, "tests/data/") || EndsWith(file, ".csv") || EndsWith(file, ".png"))
      continue;
    const std::vector<std::string> lines = Lines(Read(kRoot / file));
    for (std::size_t i = 0; i < lines.size(); ++i) {
      if (std::regex_search(lines[i], kWords)) {
        found.push_back(file + ":" + std::to_string(i + 1) + ": " + lines[i]);
      }
    }
  }
  EXPECT_THAT(found, IsEmpty());
}

bool Names(const std::string& page, const std::string& word) {
  return page.find(word) != std::string::npos;
}

// Names of programs as CMake builds them.
std::vector<std::string> Programs() {
  std::vector<std::string> programs;
  static const std::regex kParticipant(R"(sinew_add_participant\(\s*(\w+))");
  static const std::regex kProgram(R"(sinew_add_program\(\s*\w+\s+([\w-]+))");
  for (const std::string& file : Files()) {
    if (!EndsWith(file, "CMakeLists.txt")) continue;
    const std::string text = Read(kRoot / file);
    for (std::sregex_iterator it(text.begin(), text.end(), kParticipant), end; it != end; ++it) {
      std::string name = "sinew-" + (*it)[1].str();
      std::replace(name.begin(), name.end(), '_', '-');
      programs.push_back(name);
    }
    for (std::sregex_iterator it(text.begin(), text.end(), kProgram), end; it != end; ++it) {
      programs.push_back((*it)[1]);
    }
  }
  return programs;
}

TEST(Tree, TheReadmeNamesEveryProgram) {
  const std::string readme = Read(kRoot / "README.md");
  ASSERT_FALSE(Programs().empty());
  for (const std::string& program : Programs()) {
    EXPECT_TRUE(Names(readme, "`" + program + "`")) << program;
  }
}

TEST(Tree, EveryParticipantHasAPage) {
  const std::string index = Read(kRoot / "docs/participants/README.md");
  for (const std::string& program : Programs()) {
    if (program == "sinew") continue;
    EXPECT_TRUE(Names(index, "`" + program + "`")) << program;
  }
}

TEST(Tree, TheArchitectureNamesEveryModule) {
  const std::string page = Read(kRoot / "ARCHITECTURE.md");
  for (const std::string& module : Modules()) {
    EXPECT_TRUE(Names(page, fs::path(module).filename())) << module;
  }
}

// The table of idl/README.md is the list of topics; the diagram shows who exchanges which.
TEST(Tree, TheDiagramOfTheDataFlowNamesTopicsThatExist) {
  const std::string page = Read(kRoot / "ARCHITECTURE.md");
  const std::size_t begin = page.find("## Topics and data flow");
  ASSERT_NE(begin, std::string::npos);
  const std::string section = page.substr(begin, page.find("\n## ", begin) - begin);
  EXPECT_TRUE(Names(section, "idl/README.md"));
  static const std::regex kLabel(R"re(\|"?([^|"\n]+)"?\|)re"), kName("[a-z]+(_[a-z]+)+");
  int count = 0;
  for (std::sregex_iterator label(section.begin(), section.end(), kLabel), end; label != end;
       ++label) {
    const std::string text = (*label)[1];
    for (std::sregex_iterator name(text.begin(), text.end(), kName); name != end; ++name) {
      EXPECT_NE(node::FindTopic(name->str()), nullptr) << name->str();
      ++count;
    }
  }
  EXPECT_GE(count, 15);
}

TEST(Tree, EveryDecisionIsListedAndHasItsFourParts) {
  const std::string index = Read(kRoot / "docs/decisions/README.md");
  int count = 0;
  for (const std::string& file : Files("docs/decisions")) {
    if (EndsWith(file, "README.md")) continue;
    ++count;
    EXPECT_THAT(index, HasSubstr(fs::path(file).filename().string()));
    const std::string text = Read(kRoot / file);
    for (const char* part : {"## Problem", "## Choices", "## Choice", "## Cost"}) {
      EXPECT_THAT(text, HasSubstr(std::string(part) + "\n")) << file;
    }
  }
  EXPECT_GE(count, 4);
}

TEST(Tree, TheCommandsAreThereAndCanBeRun) {
  for (const char* name : {"tools/demo", "tools/test", "tools/package", "tools/docs", ".ci/run",
                           ".ci/night", ".ci/bare_root", ".ci/checks"}) {
    ASSERT_TRUE(fs::exists(kRoot / name)) << name;
    const auto permissions = fs::status(kRoot / name).permissions();
    EXPECT_NE(permissions & fs::perms::owner_exec, fs::perms::none) << name;
  }
}

}  // namespace
}  // namespace sinew
