// Recordings on the command line, alike in all commands: positional arguments, beside the options
// that they replace, which stay; and a span of their time.
#pragma once

#include <CLI/CLI.hpp>
#include <cmath>
#include <filesystem>
#include <functional>
#include <iostream>
#include <limits>
#include <string>
#include <system_error>
#include <vector>

#include "components/base/config/config.h"
#include "components/topics/node/time_option.h"

namespace sinew::tools {

// Option of former releases that names recordings: it adds to `files`, in place of `positional`
// where there is one, and is not in the help.
template <class Path>
void AddReplaced(CLI::App& command, const std::string& option, std::vector<Path>* files,
                 CLI::Option* positional = nullptr) {
  const auto add = [files, positional](const std::vector<std::string>& more) {
    files->insert(files->end(), more.begin(), more.end());
    if (positional != nullptr) positional->required(false);
  };
  command.add_option_function<std::vector<std::string>>(option, add, "Recordings")->group("");
}

// Recordings as positional arguments; `replaced`: the option of former releases, "--recording", or
// empty. CLI11 reads options in the order in which they were added: those that add follow.
template <class Path>
CLI::Option* AddRecordings(CLI::App& command, const std::string& replaced, std::vector<Path>* files,
                           const std::string& help) {
  CLI::Option* positional = command.add_option("recordings", *files, help)->type_name("FILE");
  if (!replaced.empty()) AddReplaced(command, replaced, files, positional);
  return positional;
}

// Words are recordings by their ending, or because they are there.
inline bool IsRecording(const std::string& word) {
  std::error_code ignored;
  return word.ends_with(".mcap") || word.find(".mcap@") != std::string::npos ||
         std::filesystem::exists(word, ignored);
}

// Words that are no names but recordings go to `files`.
template <class Path>
void TakeRecordings(const std::function<bool(const std::string&)>& is_name,
                    std::vector<std::string>* words, std::vector<Path>* files) {
  std::vector<std::string> names;
  for (const std::string& word : *words) {
    if (!is_name(word) && IsRecording(word)) {
      files->push_back(word);
    } else {
      names.push_back(word);
    }
  }
  *words = names;
}

// The recording of a command that takes one; empty: none. Throws UsageError.
template <class Path>
Path OnlyOne(const std::vector<Path>& files) {
  if (files.size() > 1) {
    throw UsageError(std::filesystem::path(files[1]).string() + ": a second recording after " +
                     std::filesystem::path(files[0]).string() + ", expected one");
  }
  return files.empty() ? Path() : files.front();
}

// Recordings and a span of their time, s from the start of each (span_messages.h).
struct RecordedSpan {
  std::vector<std::string> files;
  double from_s = -std::numeric_limits<double>::infinity();
  double to_s = std::numeric_limits<double>::infinity();

  bool IsWhole() const { return std::isinf(from_s) && std::isinf(to_s); }
  // Throws UsageError: a span without a recording.
  void Check() const {
    if (files.empty() && !IsWhole()) {
      throw UsageError("--from and --to are times of a recording, expected one (FILE.mcap)");
    }
  }
};

// --from SECONDS, --to SECONDS. A value of --from that is no number is a recording, as in former
// releases; `form` is how that is written now: "sinew hz FILE.mcap".
inline void AddSpan(CLI::App& command, RecordedSpan* span, const std::string& form) {
  const CLI::Validator is_time = node::IsTime(node::Zero::kAllowed);
  const auto from = [span, form, is_time](const std::string& text) {
    double seconds = 0.0;
    if (!CLI::detail::lexical_cast(text, seconds)) {
      std::cerr << "warning: --from " << text << ": --from is a time now, a recording is given as `"
                << form << "`\n";
      span->files.push_back(text);
      return;
    }
    const std::string wrong = is_time(text);
    if (!wrong.empty()) throw CLI::ValidationError("--from", wrong);
    span->from_s = seconds;
  };
  command.add_option_function<std::string>("--from", from, "Begin, s since the recording's start")
      ->type_name("SECONDS");
  command.add_option("--to", span->to_s, "End, s since the recording's start")
      ->check(is_time)
      ->type_name("SECONDS");
}

}  // namespace sinew::tools
