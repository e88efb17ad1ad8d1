#include "tools/tune_robot/trial_table.h"

#include <cerrno>
#include <cstring>
#include <nlohmann/json.hpp>
#include <span>

#include "components/base/config/config.h"
#include "components/base/types/fnv1a.h"
#include "components/base/types/json_text.h"

namespace sinew::tune {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kTableSchema = "sinew-tune-trials/1";

Json HeadJson(const TableHead& head) {
  return {{"schema", kTableSchema},
          {"trials", head.trials},
          {"seed", head.seed},
          {"inputs", head.inputs}};
}

struct ScoreField {
  const char* key;
  double ClosedLoopScore::*of;
};
constexpr ScoreField kScore[] = {
    {"mse_rad2", &ClosedLoopScore::mse_rad2},
    {"worst_rad", &ClosedLoopScore::worst_rad},
    {"torque_rms_Nm", &ClosedLoopScore::torque_rms_Nm},
    {"torque_change_rms_Nm", &ClosedLoopScore::torque_change_rms_Nm},
    {"saturated_share", &ClosedLoopScore::saturated_share},
};

std::string LineOf(const GainTrial& trial) {
  const ClosedLoopScore& score = trial.score.value();
  Json json = {{"stage", trial.stage}, {"trial", trial.number}, {"name", trial.name}};
  for (const Gain& gain : kGains) json[gain.key] = trial.pid.*gain.of;
  for (const ScoreField& field : kScore) json[field.key] = score.*field.of;
  json["faulted"] = score.faulted;
  json["fell_at_s"] = nullptr;
  if (score.fell_at_s) json["fell_at_s"] = *score.fell_at_s;
  return types::JsonText(json) + "\n";
}

GainTrial TrialOf(const Json& json) {
  GainTrial trial;
  trial.stage = json.at("stage").get<int>();
  trial.number = json.at("trial").get<int>();
  trial.name = json.at("name").get<std::string>();
  for (const Gain& gain : kGains) trial.pid.*gain.of = json.at(gain.key).get<double>();
  ClosedLoopScore score;
  for (const ScoreField& field : kScore) score.*field.of = json.at(field.key).get<double>();
  score.faulted = json.at("faulted").get<bool>();
  if (!json.at("fell_at_s").is_null()) score.fell_at_s = json.at("fell_at_s").get<double>();
  trial.score = score;
  return trial;
}

// The first difference from the wanted search; empty: none.
std::string Difference(const Json& found, const Json& wanted) {
  for (const char* key : {"schema", "trials", "seed"}) {
    if (!found.contains(key) || found[key] != wanted[key]) {
      return "'" + std::string(key) + "' is " +
             (found.contains(key) ? types::JsonText(found[key]) : std::string("missing")) +
             ", expected " + types::JsonText(wanted[key]);
    }
  }
  const Json inputs = found.value("inputs", Json::object());
  for (const auto& [name, hash] : wanted["inputs"].items()) {
    if (!inputs.contains(name) || inputs[name] != hash) {
      return "'" + name + "' has changed since, expected the files of this table";
    }
  }
  if (inputs.size() != wanted["inputs"].size()) return "it has other inputs";
  return "";
}

}  // namespace

std::string HashOfFile(const std::filesystem::path& path) {
  const std::string text = config::ReadFile(path, config::kLargestData);
  types::Fnv1a hash;
  hash.Add(std::as_bytes(std::span(text)));
  return hash.Text();
}

TrialTable::TrialTable(const std::filesystem::path& path, const TableHead& head)
    : path_(path), head_(types::JsonText(HeadJson(head)) + "\n") {
  const bool there = std::filesystem::exists(path);
  const std::string text = there ? config::ReadFile(path, config::kLargestData) : "";
  const std::size_t whole = text.rfind('\n') + 1;  // 0: not even a first line
  Read(text.substr(0, whole));
  if (there && whole < text.size()) std::filesystem::resize_file(path, whole);
  file_.reset(std::fopen(path.c_str(), "ab"));
  if (!file_) FailToWrite();
  if (whole == 0) Write(head_);
}

void TrialTable::Read(const std::string& text) {
  int line_number = 0;
  for (std::size_t from = 0; from < text.size();) {
    const std::size_t end = text.find('\n', from);
    const std::string line = text.substr(from, end - from);
    from = end + 1;
    const std::string place = path_.string() + ":" + std::to_string(++line_number) + ": ";
    try {
      const auto json = types::ParseJson<Json>(line, "");
      if (line_number > 1) {
        known_.push_back(TrialOf(json));
        continue;
      }
      const std::string difference =
          json.is_object() ? Difference(json, Json::parse(head_)) : "no table of trials";
      if (!difference.empty()) {
        throw UsageError(place + "another search: " + difference +
                         "; remove the file to begin anew");
      }
    } catch (const std::invalid_argument& error) {
      throw UsageError(place + "no line of a table of trials (" + error.what() + ")");
    } catch (const nlohmann::json::exception& error) {
      throw UsageError(place + "no line of a table of trials (" + error.what() + ")");
    }
  }
}

void TrialTable::FailToWrite() const {
  throw UsageError(path_.string() + ": cannot be written: " + std::strerror(errno));
}

void TrialTable::Write(const std::string& line) {
  const bool written = std::fwrite(line.data(), 1, line.size(), file_.get()) == line.size();
  if (!written || std::fflush(file_.get()) != 0) FailToWrite();
}

void TrialTable::Append(const GainTrial& trial) { Write(LineOf(trial)); }

void TrialTable::Finish(const std::vector<GainTrial>& trials) {
  file_.reset();
  std::string text = head_;
  for (const GainTrial& trial : trials) {
    if (trial.score) text += LineOf(trial);
  }
  config::WriteFileAtomically(path_, text);
}

}  // namespace sinew::tune
