#include <cmath>
#include <nlohmann/json.hpp>

#include "components/base/types/joined.h"
#include "components/base/types/json_text.h"
#include "components/model/close_loop/builders.h"
#include "components/model/report/file/report_file.h"

namespace sinew::close_loop {

namespace {

using Json = nlohmann::ordered_json;
using report::Section;
using report::Short;

Json ErrorJson(const arm::ArmError& error) {
  return {{"nrms_percent", error.nrms_percent},
          {"relative_percent", error.all_relative_percent},
          {"joints_rms", error.rms_Nm},
          {"joints_relative_percent", error.relative_percent}};
}

Json LoadJson(const std::optional<arm::LoadOnLink>& load) {
  if (!load) return nullptr;
  return {{"link", load->link},
          {"mass_kg", load->mass_kg},
          {"mass_half_width_95_kg", load->half_width_95},
          {"position_m", std::vector<double>(load->position_m.begin(), load->position_m.end())},
          {"share", load->share}};
}

Json ArmJson(const arm::ArmLoop& loop) {
  Json base = Json::array();
  for (std::size_t i = 0; i < loop.before.base.size(); ++i) {
    const arm::BaseParameter& before = loop.before.base[i];
    const arm::BaseParameter& after = loop.after.base[i];
    base.push_back({{"name", before.name},
                    {"nominal", before.nominal},
                    {"before", before.value},
                    {"before_half_width_95", before.half_width_95},
                    {"after", after.value},
                    {"after_half_width_95", after.half_width_95}});
  }
  return {
      {"train", {{"before", ErrorJson(loop.before.train)}, {"after", ErrorJson(loop.after.train)}}},
      {"held_out",
       {{"nominal", ErrorJson(loop.held_out_nominal)},
        {"before", ErrorJson(loop.held_out_before)},
        {"after", ErrorJson(loop.held_out_after)}}},
      {"load", LoadJson(loop.load)},
      {"held_out_load", LoadJson(loop.held_out_load)},
      {"base_parameters", base}};
}

std::string LoadText(const arm::LoadOnLink& load) {
  return (load.mass_kg < 0.0 ? "a mass taken from link '" : "a mass on link '") + load.link +
         "': " + Short(std::abs(load.mass_kg)) + " +- " + Short(load.half_width_95) + " kg at (" +
         Short(load.position_m.x()) + ", " + Short(load.position_m.y()) + ", " +
         Short(load.position_m.z()) + ") m of its frame";
}

Section ArmSection(const arm::ArmLoop& loop) {
  Section out = report::TableSection("The arm, held-out recordings",
                                     {"error, %", "declared", "refitted", "with the effects"},
                                     std::to_string(loop.before.base.size()) + " base parameters.");
  const auto add = [&](const char* what, double arm::ArmError::*error) {
    out.Add({what, Short(loop.held_out_nominal.*error), Short(loop.held_out_before.*error),
             Short(loop.held_out_after.*error)});
  };
  add("of the torques", &arm::ArmError::all_relative_percent);
  add("rms over twice the effort limit", &arm::ArmError::nrms_percent);
  if (loop.load) {
    out.paragraphs.push_back(Short(100.0 * loop.load->share) +
                             " % of what the refit of the bodies changes is " +
                             LoadText(*loop.load) + ".");
  }
  if (loop.held_out_load) {
    out.paragraphs.push_back("The held-out recordings differ from the training ones by " +
                             LoadText(*loop.held_out_load) +
                             ". Declare it there, else the size of no effect can be confirmed.");
  }
  return out;
}

// The robot's verdict is the first of these that a joint has.
constexpr const char* kFalling[] = {"data_fault", "effect", "unexplained", "too_little_data",
                                    "none"};

// "effect: joint_1, joint_2. none: joint_3."
std::string Verdicts(const std::vector<report::Report>& joints) {
  std::string out;
  for (const std::string word : kFalling) {
    std::vector<std::string> names;
    for (const report::Report& one : joints) {
      if (report::VerdictWord(one) == word) names.push_back(one.joint);
    }
    if (!names.empty()) out += (out.empty() ? "" : " ") + word + ": " + types::Joined(names) + ".";
  }
  return out;
}

}  // namespace

void ReportRobot(std::vector<report::Page> pages, Result* out) {
  Json joints = Json::array();
  Section sentences = report::TableSection("The joints", {"joint", "verdict", "what was found"});
  for (std::size_t i = 0; i < out->joints.size(); ++i) {
    const report::Report& one = out->joints[i];
    const std::string word = report::VerdictWord(one);
    const Json json = report::ReportJson(one);
    Json entry = {{"joint", one.joint}};
    entry.update(json);
    joints.push_back(std::move(entry));
    sentences.Add({one.joint, word, report::VerdictSentence(one)});
    out->parts.push_back({one.joint, std::move(pages[i]), types::JsonText(json, 2) + "\n"});
  }
  const std::string sentence = Verdicts(out->joints),
                    verdict = sentence.substr(0, sentence.find(':'));
  Json json = {{"robot", out->model.robot.name}, {"verdict", verdict}};
  if (out->arm) json["arm"] = ArmJson(*out->arm);
  json["joints"] = std::move(joints);
  out->json = types::JsonText(json, 2) + "\n";
  out->page = {.title = "Closing the loop: " + out->model.robot.name,
               .meta = "Each joint has a report in a folder of its name. Model " +
                       out->joints.front().model_file + ".",
               .verdict = verdict,
               .outcome = verdict,
               .sentence = sentence,
               .sections = {std::move(sentences)}};
  if (out->arm) out->page.sections.push_back(ArmSection(*out->arm));
}

}  // namespace sinew::close_loop
