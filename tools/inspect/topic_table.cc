#include "tools/inspect/topic_table.h"

#include <algorithm>
#include <array>
#include <string_view>

#include "components/topics/node/topics.h"

namespace sinew::inspect {

namespace {

constexpr std::size_t kGap = 2;  // between columns
// Two names a line: "pneumatics, performance,", the longest ones of robots/.
constexpr std::size_t kLeastForReaders = 24;
constexpr std::string_view kNamespace = "sinew::msg::";

// Topic, type, writer, QoS: as wide as their longest entry.
using Fields = std::array<std::string, 4>;
using Widths = std::array<std::size_t, 4>;

std::string Padded(const Fields& fields, const Widths& widths) {
  std::string line;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    line += fields[i];
    line.append(widths[i] + kGap - std::min(fields[i].size(), widths[i]), ' ');
  }
  return line;
}

// Words with ", " between them, in lines of at most `width` characters; at least one line.
std::vector<std::string> Wrapped(const std::vector<std::string>& words, std::size_t width) {
  std::vector<std::string> lines(1);
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string word = words[i] + (i + 1 < words.size() ? "," : "");
    std::string& line = lines.back();
    if (line.empty()) {
      line = word;
    } else if (line.size() + 1 + word.size() <= width) {
      line += " " + word;
    } else {
      lines.push_back(word);
    }
  }
  return lines;
}

void AppendLine(std::string line, std::string* text) {
  line.erase(line.find_last_not_of(' ') + 1);
  *text += line + '\n';
}

}  // namespace

std::string DisplayedType(const std::string& topic, const std::string& registered_type) {
  const node::TopicInfo* info = node::FindTopic(topic);
  if (info == nullptr || info->dds_type_name != registered_type) return registered_type;
  const std::string& name = info->type_name;
  return name.starts_with(kNamespace) ? name.substr(kNamespace.size()) : name;
}

std::string FormatTopicTable(const std::vector<TopicRow>& rows, std::size_t width) {
  std::vector<Fields> table = {{"topic", "type", "writer", "QoS"}};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const TopicRow& row = rows[i];
    const bool repeats = i > 0 && rows[i - 1].topic == row.topic && rows[i - 1].type == row.type;
    table.push_back({row.topic, repeats ? "" : row.type, row.writer, row.qos});
  }
  Widths widths{};
  std::size_t used = 0;
  for (std::size_t i = 0; i < widths.size(); ++i) {
    for (const Fields& fields : table) widths[i] = std::max(widths[i], fields[i].size());
    used += widths[i] + kGap;
  }
  const std::size_t for_readers = std::max(width, used + kLeastForReaders) - used;

  std::string text;
  AppendLine(Padded(table.front(), widths) + "readers", &text);
  const Fields nothing;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const std::vector<std::string> readers = Wrapped(rows[i].readers, for_readers);
    for (std::size_t line = 0; line < readers.size(); ++line) {
      AppendLine(Padded(line == 0 ? table[i + 1] : nothing, widths) + readers[line], &text);
    }
    for (const TopicRow::Unmatched& unmatched : rows[i].unmatched) {
      for (const std::string& reason : unmatched.reasons) {
        AppendLine("  not matched: " + unmatched.reader + ": " + reason, &text);
      }
    }
  }
  return text;
}

}  // namespace sinew::inspect
