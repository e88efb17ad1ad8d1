#include <algorithm>
#include <nlohmann/json.hpp>

#include "tools/tune_robot/tune_section.h"

namespace sinew::tune {
namespace {

using report::PictureNumber;
using report::Short;

// A data block for gnuplot: the gains and the error of the trials that `take` takes.
template <class Take>
std::string GainBlock(const char* name, const std::vector<GainTrial>& trials, const Take& take) {
  std::string block = std::string("$") + name + " << EOD\n";
  for (const GainTrial& trial : trials) {
    if (!trial.score || !take(trial)) continue;
    for (const Gain& gain : kGains) block += PictureNumber(trial.pid.*gain.of) + " ";
    block += PictureNumber(trial.score->mse_rad2) + "\n";
  }
  return block + "EOD\n";
}

bool Stands(const GainTrial& trial) { return trial.cost() < kDiscarded; }

std::string GainsText(const control::PidConfig& pid) {
  return "(" + Short(pid.proportional_Nm_rad) + ", " + Short(pid.integral_Nm_rad_s) + ", " +
         Short(pid.derivative_Nm_s_rad) + ")";
}

std::string OutcomeText(const GainTrial& trial) {
  if (!trial.score) return "not run";
  if (trial.score->fell_at_s) {
    return std::string(trial.score->faulted ? "fault, falls" : "falls") + " after " +
           Short(*trial.score->fell_at_s) + " s";
  }
  if (trial.score->faulted) return "fault";
  return "MSE " + Short(trial.score->mse_rad2) + " rad2";
}

struct ErrorRange {
  double least = kDiscarded, most = 0.0;
};

// Errors of the trials of a stage that stand.
ErrorRange ErrorsOf(const std::vector<GainTrial>& trials, int stage) {
  ErrorRange range;
  for (const GainTrial& trial : trials) {
    if (trial.stage != stage || !Stands(trial)) continue;
    range.most = std::max(range.most, trial.score->mse_rad2);
    range.least = std::min(range.least, trial.score->mse_rad2);
  }
  return range;
}

struct Axis {
  const char* label;
  int column;
};
constexpr Axis kAxes[] = {{"Kp, N m/rad", 1}, {"Ki, N m/(rad s)", 2}, {"Kd, N m s/rad", 3}};

// Three panels side by side; trials that fell are crosses along the top.
report::Picture StageOne(const std::vector<GainTrial>& trials) {
  report::Picture picture = {
      "Error over each gain, stage 1 (Fig 6.17)",
      "Every point is a trial of the whole benchmark. Crosses along the top: the robot fell or a "
      "fault stopped it.",
      ""};
  const auto first = [](bool stands) {
    return [stands](const GainTrial& t) { return t.stage == 1 && Stands(t) == stands; };
  };
  const ErrorRange range = ErrorsOf(trials, 1);
  const bool any = range.most > 0.0 && range.least > 0.0;
  const double top = any ? 3.0 * range.most : 1.0, bottom = any ? 0.5 * range.least : 0.1;
  picture.script = report::PictureHead(360) + GainBlock("stand", trials, first(true)) +
                   GainBlock("fall", trials, first(false)) +
                   "set multiplot layout 1,3\nset logscale xy\n"
                   "set format y '%.0e'\nset yrange [" +
                   PictureNumber(bottom) + ":" + PictureNumber(top) + "]\nunset key\n";
  for (const Axis& axis : kAxes) {
    const std::string x = std::to_string(axis.column);
    picture.script += "set xlabel '" + std::string(axis.label) + "'\nset ylabel '" +
                      (axis.column == 1 ? "MSE, rad2" : "") + "'\nplot $fall using " + x + ":(" +
                      PictureNumber(0.75 * top) +
                      ") with points pointtype 2 pointsize 0.5 linecolor rgb '" +
                      report::kMeasuredColour + "' title 'fell'";
    if (any) {
      picture.script += ", $stand using " + x +
                        ":4 with points pointtype 7 pointsize 0.5 linecolor rgb '" +
                        report::kAfterColour + "' title 'stood'";
    }
    picture.script += "\n";
  }
  picture.script += "unset multiplot\n";
  return picture;
}

report::Picture StageTwo(const GainSearchResult& result) {
  const GainTrial& best = *result.best;
  const ErrorRange range = ErrorsOf(result.trials, 2);  // gnuplot would take the heights in
  return {"Error over all gains, stage 2 (Fig 6.18)",
          "Draws around the best of stage 1. Best: " + GainsText(best.pid) + ", " +
              OutcomeText(best) + ".",
          report::PictureHead(520) +
              "set xlabel 'Kp, N m/rad'\nset ylabel 'Ki, N m/(rad s)'\nset zlabel 'Kd, N m s/rad' "
              "rotate\n"
              "set cblabel 'MSE, rad2'\nset logscale cb\nset format cb '%.0e'\nset ticslevel "
              "0\nset view "
              "62,38\n"
              "set cbrange [" +
              PictureNumber(range.least) + ":" + PictureNumber(1.01 * range.most) +
              "]\n"
              "set palette defined (0 '#1b7f9e', 1 '#c9a227', 2 '#b5525c')\n" +
              GainBlock("trials", result.trials,
                        [](const GainTrial& t) { return t.stage == 2 && Stands(t); }) +
              GainBlock("best", {best}, [](const GainTrial& t) { return Stands(t); }) +
              "splot $trials using 1:2:3:4 with points pointtype 7 pointsize 0.8 palette notitle, "
              "$best using 1:2:3 with points pointtype 6 pointsize 2.2 linewidth 2 linecolor rgb "
              "'#333333' title 'best'\n"};
}

int Count(const GainSearchResult& result, int stage, bool stands) {
  return static_cast<int>(std::count_if(
      result.trials.begin(), result.trials.end(),
      [&](const GainTrial& t) { return t.stage == stage && t.score && Stands(t) == stands; }));
}

}  // namespace

std::vector<report::Picture> GainPictures(const GainSearchResult& result) {
  std::vector<report::Picture> pictures = {StageOne(result.trials)};
  if (result.best && Count(result, 2, true) > 0) pictures.push_back(StageTwo(result));
  return pictures;
}

report::Section GainSection(const GainSearchResult& result, double seconds) {
  report::Section section = {.id = "tune-pid",
                             .title = "PID gains by two-stage random search (Algorithm 2)"};
  section.paragraphs = {
      "Every trial is the whole benchmark on the robot in simulation, with reference and control "
      "of "
      "the participants. A fall ends a trial and discards its gains.",
      report::Text("Stage 1: %d trials stood, %d fell. Stage 2: %d stood, %d fell.",
                   Count(result, 1, true), Count(result, 1, false), Count(result, 2, true),
                   Count(result, 2, false))};
  section.tables = {
      {.title = "Gains",
       .header = {"", "Kp, N m/rad", "Ki, N m/(rad s)", "Kd, N m s/rad", "outcome",
                  "worst error, rad", "motor torque rms, N m", "its change a tick, rms"}}};
  const auto row = [&section](const std::string& name, const GainTrial& trial) {
    const ClosedLoopScore score = trial.score.value_or(ClosedLoopScore{});
    section.Add({name, Short(trial.pid.proportional_Nm_rad), Short(trial.pid.integral_Nm_rad_s),
                 Short(trial.pid.derivative_Nm_s_rad), OutcomeText(trial), Short(score.worst_rad),
                 Short(score.torque_rms_Nm), Short(score.torque_change_rms_Nm)});
  };
  for (const GainTrial& trial : result.trials) {
    if (trial.stage == 0) row(trial.name, trial);
  }
  if (result.best) row("best", *result.best);
  section.pictures = GainPictures(result);
  section.seconds = seconds;
  return section;
}

nlohmann::ordered_json GainJson(const GainSearchResult& result) {
  const auto outcome = [](const GainTrial& trial) {
    const ClosedLoopScore score = trial.score.value_or(ClosedLoopScore{});
    nlohmann::ordered_json json;
    for (const Gain& gain : kGains) json[gain.key] = trial.pid.*gain.of;
    json["mse_rad2"] = nullptr;
    json["fell_at_s"] = nullptr;
    json["faulted"] = score.faulted;
    if (Stands(trial)) json["mse_rad2"] = score.mse_rad2;
    if (score.fell_at_s) json["fell_at_s"] = *score.fell_at_s;
    return json;
  };
  nlohmann::ordered_json json = {{"trials", result.trials.size()},
                                 {"stood", Count(result, 1, true) + Count(result, 2, true)},
                                 {"fell", Count(result, 1, false) + Count(result, 2, false)},
                                 {"best", nullptr},
                                 {"compared", nlohmann::ordered_json::object()}};
  if (result.best) {
    json["best"] = outcome(*result.best);
    json["best"]["stage"] = result.best->stage;
    json["best"]["trial"] = result.best->number;
  }
  for (const GainTrial& trial : result.trials) {
    if (trial.stage == 0) json["compared"][trial.name] = outcome(trial);
  }
  return json;
}

}  // namespace sinew::tune
