#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <iostream>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "components/base/config/config.h"
#include "components/base/types/did_you_mean.h"
#include "components/base/types/joined.h"
#include "components/record/recording/cdr.h"
#include "components/record/recording/session_clock.h"
#include "components/topics/node/time_option.h"
#include "tools/export_recording/tables.h"
#include "tools/inspect/message_text.h"
#include "tools/sinew/commands.h"
#include "tools/sinew/echo_plot.h"
#include "tools/sinew/printed.h"
#include "tools/sinew/recordings.h"

namespace sinew::tools {

namespace {

using export_recording::Tables;

constexpr const char* kClockTopic = "joint_state";

struct PlotOptions {
  std::vector<std::string> words;  // recordings, then fields
  double from_s = -std::numeric_limits<double>::infinity();
  double to_s = std::numeric_limits<double>::infinity();
  std::filesystem::path png, svg;
  int width = 0, height = 0;  // 0: as large as usual
};

// An entry of a field that was asked for.
struct PickedEntry {
  std::size_t table;
  std::string path;  // "position_rad[0]"
};

struct PlotRow {
  std::uint64_t session = 0, tick = 0;
  std::int64_t stamp_ns = 0;
  std::vector<double> values;  // of the entries picked from its table
};

// NaN where a list of the message is too short; it was decoded before.
double ValueOf(const recording::CdrField& field, std::span<const std::byte> payload) {
  try {
    return field.AsDouble(payload);
  } catch (const recording::CdrError&) {
    return std::numeric_limits<double>::quiet_NaN();
  }
}

// Entries of a field: the one with its indices, or all in use. Throws UsageError naming what is
// there.
std::vector<PickedEntry> EntriesOf(const Tables& tables, const std::string& file,
                                   const inspect::TopicField& asked) {
  std::vector<PickedEntry> picked;
  std::vector<std::string> fields, entries;
  for (std::size_t t = 0; t < tables.list().size(); ++t) {
    if (tables.list()[t]->topic != asked.topic) continue;
    for (const export_recording::Column& column : tables.list()[t]->columns->list()) {
      if (!column.leaf->is_number()) continue;
      fields.push_back(column.path);
      if (column.path != asked.field.substr(0, asked.field.find('['))) continue;
      for (std::size_t e = 0; e < column.entries(); ++e) {
        entries.push_back(column.EntryName(e));
        if ((entries.back() + "[").starts_with(asked.field + "[")) {
          picked.push_back({t, entries.back()});
        }
      }
    }
  }
  if (!picked.empty()) return picked;
  if (fields.empty()) throw UsageError(file + ": no message of '" + asked.topic + "'");
  throw UsageError(file + ": " + asked.topic + ": " +
                   types::NoSuch("field", asked.field, entries.empty() ? fields : entries));
}

// Rows of each table, as they were received. A message without a header counts to the session and
// the tick of the one before.
std::vector<std::vector<PlotRow>> RowsOf(const Tables& tables,
                                         const std::vector<PickedEntry>& picked) {
  struct Source {
    std::optional<recording::CdrField> session, tick;
    std::vector<recording::CdrField> fields;
  };
  std::vector<Source> sources(tables.list().size());
  for (std::size_t t = 0; t < sources.size(); ++t) {
    const recording::IdlType& type = *tables.list()[t]->type.type;
    if (!recording::HasField(type, "header.session_id")) continue;
    sources[t].session.emplace(type, "header.session_id");
    sources[t].tick.emplace(type, "header.tick");
  }
  for (const PickedEntry& one : picked) {
    sources[one.table].fields.emplace_back(*tables.list()[one.table]->type.type, one.path);
  }
  std::vector<std::vector<PlotRow>> rows(sources.size());
  std::uint64_t session = 0, tick = 0;
  tables.Read([&](std::size_t t, const recording::McapMessage& message) {
    if (sources[t].tick) {
      session = static_cast<std::uint64_t>(sources[t].session->AsInt(message.data));
      tick = static_cast<std::uint64_t>(sources[t].tick->AsInt(message.data));
    }
    rows[t].push_back({session, tick, message.publish_time_ns, {}});
    for (const recording::CdrField& field : sources[t].fields) {
      rows[t].back().values.push_back(ValueOf(field, message.data));
    }
  });
  return rows;
}

// The curve of the entry number `index` of the rows, by session and tick; sessions are apart.
void Fill(const recording::SessionTimes& times, const std::vector<PlotRow>& rows, std::size_t index,
          const PlotOptions& options, inspect::Curve* curve) {
  for (const std::uint64_t session : times.sessions()) {
    std::vector<const PlotRow*> ordered;
    for (const PlotRow& row : rows) {
      if (row.session == session) ordered.push_back(&row);
    }
    std::stable_sort(ordered.begin(), ordered.end(),
                     [](const PlotRow* a, const PlotRow* b) { return a->tick < b->tick; });
    if (!curve->time_s.empty()) {
      curve->time_s.push_back(curve->time_s.back());
      curve->value.push_back(std::numeric_limits<double>::quiet_NaN());
    }
    for (const PlotRow* row : ordered) {
      const std::int64_t time_ns =
          row->stamp_ns + times.ShiftOf(session, row->tick) - times.start_ns();
      const double time_s = 1e-9 * static_cast<double>(time_ns);
      if (time_s < options.from_s || time_s > options.to_s) continue;
      curve->time_s.push_back(time_s);
      curve->value.push_back(row->values[index]);
    }
  }
}

void AddCurves(const std::string& file, const std::vector<inspect::TopicField>& fields,
               const std::string& prefix, const PlotOptions& options,
               std::vector<inspect::Curve>* curves) {
  std::set<std::string> topics;
  for (const inspect::TopicField& field : fields) topics.insert(field.topic);
  const Tables tables(recording::ParseRecordingPath(file), topics, {kClockTopic});
  if (!tables.cut_off().empty()) {
    std::cerr << file << ": cut off (" << tables.cut_off() << "), drawn is what is whole\n";
  }
  std::vector<PickedEntry> picked;
  for (const inspect::TopicField& field : fields) {
    const std::vector<PickedEntry> entries = EntriesOf(tables, file, field);
    picked.insert(picked.end(), entries.begin(), entries.end());
  }
  const std::vector<std::vector<PlotRow>> rows = RowsOf(tables, picked);
  // Without joint_state the clock is what was asked for.
  const bool has_clock = std::any_of(tables.list().begin(), tables.list().end(),
                                     [](const auto& one) { return one->topic == kClockTopic; });
  std::vector<recording::SessionTimes::Tick> ticks;
  for (std::size_t t = 0; t < rows.size(); ++t) {
    if (has_clock && tables.list()[t]->topic != kClockTopic) continue;
    for (const PlotRow& row : rows[t]) ticks.push_back({row.session, row.tick, row.stamp_ns});
  }
  const recording::SessionTimes times(ticks);
  std::map<std::size_t, std::size_t> taken;  // entries by table
  for (const PickedEntry& one : picked) {
    const std::string& topic = tables.list()[one.table]->topic;
    curves->push_back(inspect::CurveOf(prefix + topic + "." + one.path, one.path));
    Fill(times, rows[one.table], taken[one.table]++, options, &curves->back());
  }
}

void PlotRecordings(const PlotOptions& options) {
  std::vector<std::string> files;
  std::vector<inspect::TopicField> fields;
  for (const std::string& word : options.words) {
    if (files.empty() || IsRecording(word)) {
      files.push_back(word);
      continue;
    }
    fields.push_back(inspect::SplitField(word));
    if (fields.back().field.empty()) {
      throw UsageError("'" + word + "': expected TOPIC.FIELD, e.g. joint_state.position_rad[0]");
    }
  }
  if (fields.empty()) {
    throw UsageError("no field, expected TOPIC.FIELD, e.g. joint_state.position_rad[0]");
  }
  std::vector<inspect::Curve> curves;
  for (const std::string& file : files) {
    AddCurves(file, fields, files.size() > 1 ? file + ": " : "", options, &curves);
  }
  if (std::all_of(curves.begin(), curves.end(),
                  [](const inspect::Curve& curve) { return curve.time_s.empty(); })) {
    throw UsageError(types::Joined(files) +
                     ": no message of a session between --from and --to, expected some");
  }
  const std::pair<const char*, const std::filesystem::path&> pictures[] = {{"png", options.png},
                                                                           {"svg", options.svg}};
  for (const auto& [format, path] : pictures) {
    if (path.empty()) continue;
    config::WriteFileAtomically(
        path, inspect::DrawnPicture(curves, format, options.width, options.height));
  }
  if (!options.png.empty() || !options.svg.empty()) return;
  Unfiltered(std::cout) << DrawnHere(curves, options.width, options.height) << std::flush;
}

}  // namespace

void AddPlotCommand(CLI::App& app) {
  auto options = std::make_shared<PlotOptions>();
  CLI::App* command =
      app.add_subcommand("plot", "Draw fields of recordings over time, here or as a picture");
  command->add_option("what", options->words, "Recordings, then fields")
      ->required()
      ->type_name("FILE.mcap... TOPIC.FIELD...");
  command->add_option("--from", options->from_s, "Begin, s since the recording's start")
      ->check(node::IsTime(node::Zero::kAllowed));
  command->add_option("--to", options->to_s, "End, s since the recording's start")
      ->check(node::IsTime(node::Zero::kAllowed));
  command->add_option("--png", options->png, "Write this PNG file")->type_name("FILE.png");
  command->add_option("--svg", options->svg, "Write this SVG file")->type_name("FILE.svg");
  command->add_option("--width", options->width, "Pixels of a picture, columns of a terminal")
      ->check(CLI::Range(40, 20000));
  command->add_option("--height", options->height, "Pixels of a picture, rows of a terminal")
      ->check(CLI::Range(10, 20000));
  command->footer(
      "Without --png and --svg, in the terminal. A list without an index is all its entries in "
      "use: the joints.\nTime is that of the messages, simulated in lockstep, from the first "
      "joint_state on; sessions follow each other.\n\nExamples:\n"
      "  sinew plot run.mcap joint_state.position_rad\n"
      "  sinew plot run.mcap joint_state.position_rad[0] reference.position_rad[0] --from 2 --to "
      "4\n"
      "  sinew plot before.mcap after.mcap joint_state.torque_Nm[0] --png torque.png --svg "
      "torque.svg");
  command->callback([options] { PlotRecordings(*options); });
}

}  // namespace sinew::tools
