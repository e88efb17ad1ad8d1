// Configuration that is wrong ends a program at once, with a message that names what is wrong.
#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <memory>
#include <optional>
#include <system_error>

#include "components/base/config/config.h"
#include "tools/conform/checks.h"
#include "tools/conform/real_time_run.h"
#include "tools/launch/program.h"

namespace sinew::conform {

namespace {

namespace fs = std::filesystem;
using launch::Program;

constexpr char kOption[] = "--config";
constexpr char kUnknownKey[] = "conform_unknown_key";
constexpr char kAbsentFile[] = "conform-no-such-file.yaml";

// The arguments that name a configuration: the file, and how to name another one.
struct ConfigArgument {
  fs::path file;
  std::size_t first = 0, count = 0;  // arguments that it takes
};

std::optional<ConfigArgument> FindConfig(const std::vector<std::string>& arguments) {
  const std::string with_value = std::string(kOption) + "=";
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    if (arguments[i].rfind(with_value, 0) == 0) {
      return ConfigArgument{arguments[i].substr(with_value.size()), i, 1};
    }
    if (arguments[i] == kOption && i + 1 < arguments.size()) {
      return ConfigArgument{arguments[i + 1], i, 2};
    }
  }
  return std::nullopt;
}

// The options with another configuration, or with none.
Options WithConfig(Options options, const std::optional<ConfigArgument>& given,
                   const std::optional<fs::path>& file) {
  if (given) {
    const auto first = options.arguments.begin() + static_cast<std::ptrdiff_t>(given->first);
    options.arguments.erase(first, first + static_cast<std::ptrdiff_t>(given->count));
  }
  if (file) options.arguments.insert(options.arguments.end(), {kOption, file->string()});
  return options;
}

// A copy of a configuration beside links to everything that lies beside the original, and one
// folder up, so that paths in it still lead somewhere.
class ChangedCopy {
 public:
  ChangedCopy(const fs::path& original, const std::string& added_line) {
    std::string pattern = (fs::temp_directory_path() / "sinew-conform-XXXXXX").string();
    if (::mkdtemp(pattern.data()) == nullptr) {
      throw std::system_error(errno, std::generic_category(), pattern);
    }
    root_ = pattern;
    const fs::path folder = fs::absolute(original).lexically_normal().parent_path();
    const fs::path copies = root_ / folder.filename();
    LinkAll(folder.parent_path(), root_, folder.filename());
    fs::create_directory(copies);
    LinkAll(folder, copies, original.filename());
    file_ = copies / original.filename();
    std::ofstream(file_) << config::ReadFile(original) << '\n' << added_line << '\n';
  }
  ~ChangedCopy() {
    std::error_code ignored;
    fs::remove_all(root_, ignored);  // links are removed, not what they lead to
  }
  ChangedCopy(const ChangedCopy&) = delete;
  ChangedCopy& operator=(const ChangedCopy&) = delete;
  const fs::path& file() const { return file_; }

 private:
  static void LinkAll(const fs::path& from, const fs::path& to, const fs::path& except) {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(from, error)) {
      const fs::path name = entry.path().filename();
      if (name != except) fs::create_symlink(entry.path(), to / name, error);
    }
  }

  fs::path root_, file_;
};

std::unique_ptr<Program> StartWith(const Options& options) {
  return std::make_unique<Program>(
      SubjectCommandLine(options, "conform_configuration", node::TimeMode::kRealtime));
}

// A program that runs on leaves the domain in order before the other checks begin.
void EndInOrder(Program& program) {
  program.Signal(SIGTERM);
  (void)program.Wait(kEnd);
}

// Refused with a message that holds one of the words.
void CheckRefused(const std::string& check, Program& program, const std::vector<std::string>& words,
                  Report* report) {
  const int exit_code = program.Wait(kStart);
  const std::string said = program.output() + program.error();
  const bool named = std::any_of(words.begin(), words.end(), [&said](const std::string& word) {
    return said.find(word) != std::string::npos;
  });
  report->Add(check, exit_code > 0 && named,
              "exit code above 0 within " + std::to_string(kStart.count()) +
                  " ms and a message that names '" + words.front() + "'",
              EndText(exit_code, kStart) + ": " + LastLine(program));
  if (exit_code == Program::kTimeout) EndInOrder(program);
}

}  // namespace

void CheckConfiguration(const Options& options, const Role& /*role*/, Report* report) {
  const auto given = FindConfig(options.arguments);
  if (given && !fs::is_regular_file(given->file)) {
    throw UsageError(given->file.string() + ": no such file, expected a good configuration");
  }
  // All at once: each ends before it joins the domain.
  const auto absent = StartWith(WithConfig(options, given, kAbsentFile));
  std::unique_ptr<Program> unknown, without;
  std::unique_ptr<ChangedCopy> copy;
  const std::string extension = given ? given->file.extension().string() : "";
  const bool yaml = extension == ".yaml" || extension == ".yml";
  if (given) without = StartWith(WithConfig(options, given, std::nullopt));
  if (yaml) {
    copy = std::make_unique<ChangedCopy>(given->file, std::string(kUnknownKey) + ": 1");
    unknown = StartWith(WithConfig(options, given, copy->file()));
  }

  // A program without a configuration refuses the option.
  CheckRefused("config_absent_file", *absent, {kAbsentFile, kOption}, report);
  if (unknown) {
    CheckRefused("config_unknown_key", *unknown, {kUnknownKey}, report);
  } else {
    report->Skip("config_unknown_key",
                 given ? "the configuration is not YAML" : "the program has no configuration");
  }
  if (!without) {
    report->Skip("config_missing", "the program has no configuration");
    return;
  }
  // Either it needs one and says so, or it runs with its defaults.
  const int exit_code = without->Wait(kEnd);
  if (exit_code == Program::kTimeout) {
    report->Add("config_missing", true, "", "runs without a configuration");
    EndInOrder(*without);
  } else {
    CheckRefused("config_missing", *without, {kOption}, report);
  }
}

}  // namespace sinew::conform
