#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fstream>
#include <stdexcept>

#include "tools/export_recording/tables.h"

namespace sinew::export_recording {
namespace {

using Kind = recording::IdlType::Kind;

template <class Number>
void AppendNumber(Number value, std::string* out) {
  std::array<char, 32> text;  // the longest double has 24 characters, a 64-bit integer 20
  const auto end = std::to_chars(text.data(), text.data() + text.size(), value).ptr;
  out->append(text.data(), end);
}

// RFC 4180: quoted where it has to be, quotes doubled.
void AppendText(std::string_view text, std::string* out) {
  if (text.find_first_of(",\"\r\n#") == std::string_view::npos) {
    out->append(text);
    return;
  }
  *out += '"';
  for (const char letter : text) {
    if (letter == '"') *out += '"';
    *out += letter;
  }
  *out += '"';
}

void AppendCell(const recording::IdlType& leaf, const Cell& cell, std::string* out) {
  if (const auto* text = std::get_if<std::string_view>(&cell)) return AppendText(*text, out);
  if (const auto* real = std::get_if<double>(&cell)) {
    if (leaf.kind == Kind::kFloat) return AppendNumber(static_cast<float>(*real), out);
    return AppendNumber(*real, out);
  }
  if (const auto* whole = std::get_if<std::int64_t>(&cell)) return AppendNumber(*whole, out);
  const std::uint64_t value = std::get<std::uint64_t>(cell);
  if (leaf.kind == Kind::kEnum && value < leaf.enumerators.size()) {
    return AppendText(leaf.enumerators[static_cast<std::size_t>(value)], out);
  }
  AppendNumber(value, out);
}

class CsvFile {
 public:
  CsvFile(const TopicTable& table, const std::filesystem::path& path)
      : columns_(*table.columns), path_(path), stream_(path, std::ios::binary) {
    std::string line = "log_time_ns,publish_time_ns";
    for (const Column& column : columns_.list()) {
      first_.push_back(cells_.size());
      for (std::size_t entry = 0; entry < column.entries(); ++entry) {
        line += "," + column.EntryName(entry);
        cells_.emplace_back();
      }
    }
    Write(line + "\n");
  }

  std::size_t columns() const { return cells_.size() + 2; }

  void Add(const recording::McapMessage& message) {
    for (std::string& cell : cells_) cell.clear();
    columns_.ForEach(
        message.data, [this](std::size_t column, std::size_t entry, const Cell& value) {
          AppendCell(*columns_.list()[column].leaf, value, &cells_[first_[column] + entry]);
        });
    line_.clear();
    AppendNumber(message.log_time_ns, &line_);
    line_ += ',';
    AppendNumber(message.publish_time_ns, &line_);
    for (const std::string& cell : cells_) line_.append(",").append(cell);
    Write(line_ += '\n');
  }
  void Close() {
    stream_.close();
    if (!stream_) Fail();
  }

 private:
  [[noreturn]] void Fail() const {
    throw std::runtime_error(path_.string() + ": cannot be written: " + std::strerror(errno));
  }
  void Write(const std::string& text) {
    if (!stream_.write(text.data(), static_cast<std::streamsize>(text.size()))) Fail();
  }

  const Columns& columns_;
  std::filesystem::path path_;
  std::ofstream stream_;
  std::vector<std::size_t> first_;  // cell of each column's first entry
  std::vector<std::string> cells_;
  std::string line_;
};

}  // namespace

std::vector<Written> WriteCsv(const Tables& tables, const std::filesystem::path& folder) {
  std::vector<std::unique_ptr<CsvFile>> files;
  for (const auto& table : tables.list()) {
    files.push_back(std::make_unique<CsvFile>(*table, folder / (table->topic + ".csv")));
  }
  tables.Read([&files](std::size_t table, const recording::McapMessage& message) {
    files[table]->Add(message);
  });
  std::vector<Written> written;
  for (std::size_t i = 0; i < files.size(); ++i) {
    files[i]->Close();
    written.push_back({tables.list()[i]->topic, tables.list()[i]->rows, files[i]->columns()});
  }
  return written;
}

}  // namespace sinew::export_recording
