#include "reproduction/squat_test/section.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sinew::squat_test {
namespace {

using report::PictureNumber;
using report::Short;
using report::Text;

constexpr double kWindow_s = 1.5;          // (7.7)
constexpr double kFeedForwardGoal = 0.13;  // MSE of PID + ESN over PID: table 6.6
constexpr double kAdaptedGoal = 0.20;      // MSE adapted over computed torque, 4 kg; published 0.29
constexpr double kRecoveryGoal = 0.10;     // squats 5 and 6 against squat 3
constexpr std::size_t kMostRows = 2500;    // of a picture
constexpr std::size_t kLegJoints[] = {2, 3, 4};  // left hip pitch, knee, ankle pitch
constexpr const char* kLegNames[] = {"hip pitch", "knee", "ankle pitch"};

const Squats& Find(const std::vector<Squats>& all, const std::string& arm, Load load) {
  for (const Squats& one : all) {
    if (one.arm->id == arm && one.load == load) return one;
  }
  throw std::invalid_argument("squat test: no run of '" + arm + "'");
}

const Squats* FindOrNull(const std::vector<Squats>& all, const Arm& arm, Load load) {
  for (const Squats& one : all) {
    if (one.arm->id == arm.id && one.load == load) return &one;
  }
  return nullptr;
}

std::string MseText(const Squats* squats) {
  if (squats == nullptr) return "";
  if (squats->fall_s) return Text("fell at %.1f s", *squats->fall_s);
  return Short(squats->mse_rad2);
}

std::string EnergyText(const Squats* squats, double performance::Energies::*energy) {
  if (squats == nullptr || squats->fall_s) return "";
  return Short(squats->session.output.energies.*energy);
}

std::string OrDash(double value) { return value > 0.0 ? Short(value) : ""; }

report::Table MainTable(const std::vector<Squats>& benchmark) {
  report::Table table;
  table.title = "Two squats in 10 s (tables 6.6, 6.7, 7.1)";
  table.caption =
      "MSE of all joints over the squats, rad^2; energies of all joints from arming to the end, J.";
  table.header = {"control",           "simulated MSE, published",
                  "with 4 kg",         "prototype's",
                  "with 4 kg",         "ours",
                  "ours with 4 kg",    "absolute work",
                  "positive work",     "net work",
                  "electrical, drawn", "positive work with 4 kg"};
  for (const Arm& arm : Arms()) {
    const Squats* plain = FindOrNull(benchmark, arm, Load::kNone);
    const Squats* loaded = FindOrNull(benchmark, arm, Load::kFromStart);
    if (plain == nullptr && loaded == nullptr) continue;
    using performance::Energies;
    table.rows.push_back(
        {arm.title, OrDash(arm.simulated.mse), OrDash(arm.simulated.mse_loaded),
         OrDash(arm.prototype.mse), OrDash(arm.prototype.mse_loaded), MseText(plain),
         MseText(loaded), EnergyText(plain, &Energies::absolute_J),
         EnergyText(plain, &Energies::positive_J), EnergyText(plain, &Energies::net_J),
         plain == nullptr || plain->fall_s ? "" : Short(plain->session.output.drawn_J),
         EnergyText(loaded, &Energies::positive_J)});
  }
  return table;
}

report::Comparison Ratio(const std::string& name, const std::string& published,
                         const std::string& source, const Squats& over, const Squats& under,
                         double goal) {
  report::Comparison ratio;
  ratio.name = name;
  ratio.published = published;
  ratio.source = source;
  ratio.target = Text("at most %.2f", goal);
  if (over.fall_s || under.fall_s) {
    ratio.ours = "fell";
    ratio.met = false;
  } else {
    ratio.ours = Text("%.3f", over.mse_rad2 / under.mse_rad2);
    ratio.met = over.mse_rad2 <= goal * under.mse_rad2;
  }
  return ratio;
}

std::size_t Stride(const SquatRecording& recording) {
  return 1 + recording.time_s.size() / kMostRows;
}

// Reference and position of the left leg's three pitch joints.
report::Picture MotionPicture(const Squats& squats) {
  const SquatRecording& r = squats.recording;
  std::string script = report::PictureHead(300) + "$d << EOD\n";
  for (std::size_t k = 0; k < r.time_s.size(); k += Stride(r)) {
    script += PictureNumber(r.time_s[k]);
    for (const std::size_t j : kLegJoints) {
      script +=
          " " + PictureNumber(r.reference_rad[k][j]) + " " + PictureNumber(r.position_rad[k][j]);
    }
    script += "\n";
  }
  script += "EOD\nset xlabel 'time, s'\nset ylabel 'angle, rad'\nplot ";
  for (std::size_t i = 0; i < 3; ++i) {
    const std::string column = std::to_string(2 * i + 2), next = std::to_string(2 * i + 3);
    script += (i == 0 ? "$d" : ", $d") + std::string(" using 1:") + column +
              " with lines linewidth 1.2 dashtype 2 linecolor rgb '" + report::kMeasuredColour +
              "' title '" + (i == 0 ? "reference" : "") + "', $d using 1:" + next +
              " with lines linewidth 1.6 linecolor rgb '" + report::kSeriesColours[i] +
              "' title '" + kLegNames[i] + "'";
  }
  const std::string figure = squats.arm->figure.empty() ? "" : " (" + squats.arm->figure + ")";
  return {squats.arm->title + (squats.load == Load::kNone ? "" : ", 4 kg") + figure,
          squats.fall_s ? Text("Left leg. It fell at %.1f s.", *squats.fall_s) : "Left leg.",
          script + "\n"};
}

report::Picture SlidingPicture(const std::vector<Squats>& six) {
  std::string script = report::PictureHead(340);
  for (std::size_t i = 0; i < six.size(); ++i) {
    const SquatRecording& r = six[i].recording;
    const std::vector<double> sliding = SlidingError(r, kWindow_s);
    script += "$s" + std::to_string(i) + " << EOD\n";
    for (std::size_t k = 0; k < r.time_s.size(); k += Stride(r)) {
      if (six[i].fall_s && r.time_s[k] > *six[i].fall_s) break;
      script += PictureNumber(r.time_s[k]) + " " + PictureNumber(1e3 * sliding[k]) + "\n";
    }
    script += "EOD\n";
  }
  const double put_on_s = kStart_s + kPutOnAfter * kSquat_s;
  script +=
      "set xlabel 'time, s'\nset ylabel 'sliding RMSE, mrad'\nset yrange [0:*]\nset arrow from " +
      PictureNumber(put_on_s) + ", graph 0 to " + PictureNumber(put_on_s) +
      ", graph 1 nohead dashtype 2 linecolor rgb '" + report::kMeasuredColour +
      "'\nset label '4 kg' at " + PictureNumber(put_on_s + 0.2) + ", graph 0.95\nplot ";
  const char* colours[] = {report::kSeriesColours[0], report::kBeforeColour, report::kAfterColour};
  for (std::size_t i = 0; i < six.size(); ++i) {
    script += (i == 0 ? "$s" : ", $s") + std::to_string(i) +
              " using 1:2 with lines linewidth 1.8 linecolor rgb '" + colours[i % 3] + "' title '" +
              six[i].arm->title + "'";
  }
  return {"4 kg put on after the third of six squats (Fig 7.10)",
          "Root mean square error of all joints over the last 1.5 s (7.7).", script + "\n"};
}

report::Table RecoveryTable(const std::vector<Squats>& six) {
  report::Table table;
  table.title = "Error of each of six squats, mrad rms; 4 kg after the third";
  table.caption =
      "Settled: the sliding error stays within a tenth of the last squat's, s after 4 kg.";
  table.header = {"control", "1", "2", "3", "4", "5", "6", "5 against 3", "6 against 3", "settled"};
  for (const Squats& squats : six) {
    std::vector<std::string> row = {squats.arm->title};
    if (squats.fall_s) {
      row.push_back(Text("fell at %.1f s", *squats.fall_s));
      row.resize(table.header.size());
      table.rows.push_back(row);
      continue;
    }
    for (int n = 0; n < kSixSquats; ++n) {
      const double begin_s = kStart_s + n * kSquat_s;
      row.push_back(
          Short(1e3 * std::sqrt(MeanSquareError(squats.recording, begin_s, begin_s + kSquat_s))));
    }
    const Recovery recovery = RecoveryOf(squats);
    for (const std::size_t n : {1u, 2u}) {
      row.push_back(Text("%+.0f %%", 100.0 * (recovery.after_rad[n] / recovery.before_rad - 1.0)));
    }
    row.push_back(recovery.settled_s ? Text("%.1f s", *recovery.settled_s) : "no");
    table.rows.push_back(row);
  }
  return table;
}

}  // namespace

Recovery RecoveryOf(const Squats& squats) {
  Recovery recovery;
  const auto rms = [&](int squat) {
    const double begin_s = kStart_s + squat * kSquat_s;
    return std::sqrt(MeanSquareError(squats.recording, begin_s, begin_s + kSquat_s));
  };
  recovery.before_rad = rms(kPutOnAfter - 1);
  for (int n = kPutOnAfter; n < kSixSquats; ++n) recovery.after_rad.push_back(rms(n));
  const SquatRecording& r = squats.recording;
  const std::vector<double> sliding = SlidingError(r, kWindow_s);
  const double put_on_s = kStart_s + kPutOnAfter * kSquat_s;
  const double end_s = kStart_s + kSixSquats * kSquat_s;
  double last = 0.0;
  for (std::size_t k = 0; k < r.time_s.size(); ++k) {
    if (r.time_s[k] >= end_s - kSquat_s && r.time_s[k] < end_s) last = std::max(last, sliding[k]);
  }
  for (std::size_t k = r.time_s.size(); k-- > 0;) {
    if (r.time_s[k] >= end_s) continue;
    if (r.time_s[k] < put_on_s) break;
    if (sliding[k] > 1.1 * last) break;
    recovery.settled_s = r.time_s[k] - put_on_s;
  }
  return recovery;
}

report::Section MakeSection(const std::vector<Squats>& benchmark, const std::vector<Squats>& six) {
  report::Section section;
  section.id = "squats";
  section.title = "Squats of the biped (tables 6.6, 6.7, 7.1; Figs 6.14, 6.20-6.22, 7.5-7.10)";
  const auto& lifted = Find(benchmark, "pid", Load::kNone).session.output;
  section.paragraphs = {
      "Simulated here by another engine and another robot than the source's: ratios and order "
      "count, "
      "absolute values differ. Every run is the real processes in lockstep at 240 Hz.",
      Text("The source gives energies without a formula. By its joint angles the centre of mass "
           "rises by %s m in all, so positive work is at least %s J: 42 J for PID + ESN can be no "
           "positive work, and no electrical energy either. Of these definitions only net work, "
           "which "
           "subtracts what lowering returns, can be as small.",
           Short(lifted.rise_m).c_str(), Short(lifted.lifting_J).c_str()),
      "With the published gains (60, 3.5, 1.0) this robot falls (robots/biped/README.md), so PID "
      "and "
      "PID + ESN have gains tuned on it, and computed torque has stiffer ones (200, 0, 5)."};
  section.comparisons.push_back(Ratio("tracking MSE, PID + ESN / PID", "0.13", "table 6.6",
                                      Find(benchmark, "pid-esn", Load::kNone),
                                      Find(benchmark, "pid", Load::kNone), kFeedForwardGoal));
  section.comparisons.push_back(Ratio("4 kg: tracking MSE, adapted / computed torque", "0.29",
                                      "table 7.1", Find(benchmark, "adapted", Load::kFromStart),
                                      Find(benchmark, "computed-torque", Load::kFromStart),
                                      kAdaptedGoal));
  section.tables.push_back(MainTable(benchmark));
  for (const Squats& squats : six) {
    if (squats.arm->id != "adapted") continue;
    report::Comparison recovery;
    recovery.name = "4 kg put on: error of squats 5 and 6 against squat 3, adapted";
    recovery.published = "back to its plateau";
    recovery.source = "Fig 7.10";
    recovery.target = "within 10 %";
    if (squats.fall_s) {
      recovery.ours = Text("fell at %.1f s", *squats.fall_s);
      recovery.met = false;
    } else {
      const Recovery found = RecoveryOf(squats);
      const double fifth = found.after_rad[1] / found.before_rad - 1.0;
      const double sixth = found.after_rad[2] / found.before_rad - 1.0;
      recovery.ours = Text("%+.0f %%, %+.0f %%", 100.0 * fifth, 100.0 * sixth);
      recovery.met = std::max(fifth, sixth) <= kRecoveryGoal;
    }
    section.comparisons.push_back(recovery);
  }
  if (!six.empty()) {
    section.tables.push_back(RecoveryTable(six));
    section.pictures.push_back(SlidingPicture(six));
  }
  for (const Squats& squats : benchmark) {
    const bool shown = squats.load == Load::kNone || squats.arm->id == "computed-torque";
    if (shown && !squats.arm->figure.empty()) section.pictures.push_back(MotionPicture(squats));
  }
  return section;
}

}  // namespace sinew::squat_test
