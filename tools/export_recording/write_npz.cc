#include <cstring>
#include <limits>

#include "components/record/recording/bytes.h"
#include "tools/export_recording/npz.h"
#include "tools/export_recording/tables.h"

namespace sinew::export_recording {
namespace {

using recording::Bytes;
using Kind = recording::IdlType::Kind;

struct ItemType {
  std::string name;  // NumPy's
  std::size_t size;
};

ItemType ItemTypeOf(const Column& column) {
  switch (column.leaf->kind) {
    case Kind::kBool:
      return {"|b1", 1};
    case Kind::kOctet:
      return {"|u1", 1};
    case Kind::kChar:
      return {"|i1", 1};
    case Kind::kInt16:
      return {"<i2", 2};
    case Kind::kUint16:
      return {"<u2", 2};
    case Kind::kInt32:
      return {"<i4", 4};
    case Kind::kUint32:
    case Kind::kEnum:
      return {"<u4", 4};
    case Kind::kInt64:
      return {"<i8", 8};
    case Kind::kUint64:
      return {"<u8", 8};
    case Kind::kFloat:
      return {"<f4", 4};
    case Kind::kDouble:
      return {"<f8", 8};
    default: {
      const std::size_t size = std::max<std::size_t>(column.text_size, 1);
      return {"|S" + std::to_string(size), size};
    }
  }
}

// The rows of one column, as NumPy has them in memory.
class ArrayOfColumn {
 public:
  ArrayOfColumn(const Column& column, std::size_t rows)
      : column_(column), item_(ItemTypeOf(column)), entries_(column.entries()) {
    data_.resize(rows * entries_ * item_.size);
    const bool real = column.leaf->kind == Kind::kFloat || column.leaf->kind == Kind::kDouble;
    for (std::size_t item = 0; real && item < rows * entries_; ++item) {
      Put(item, std::numeric_limits<double>::quiet_NaN());
    }
  }

  void Set(std::size_t row, std::size_t entry, const Cell& value) {
    Put(row * entries_ + entry, value);
  }
  void WriteTo(NpzWriter* npz, const std::string& name, std::size_t rows) const {
    std::vector<std::size_t> shape = {rows};
    shape.insert(shape.end(), column_.shape.begin(), column_.shape.end());
    npz->Add(name, item_.name, shape, data_);
  }

 private:
  void Put(std::size_t item, const Cell& value) {
    std::byte* at = data_.data() + item * item_.size;
    if (const auto* text = std::get_if<std::string_view>(&value)) {
      std::memcpy(at, text->data(), text->size());
    } else if (const auto* real = std::get_if<double>(&value)) {
      const auto narrow = static_cast<float>(*real);
      std::memcpy(at, column_.leaf->kind == Kind::kFloat ? static_cast<const void*>(&narrow) : real,
                  item_.size);
    } else if (const auto* whole = std::get_if<std::int64_t>(&value)) {
      std::memcpy(at, whole, item_.size);  // little-endian: the low bytes
    } else {
      std::memcpy(at, &std::get<std::uint64_t>(value), item_.size);
    }
  }

  const Column& column_;
  const ItemType item_;
  const std::size_t entries_;
  Bytes data_;
};

void AddTimes(const std::vector<std::int64_t>& times, const std::string& name, NpzWriter* npz) {
  npz->Add(name, "<i8", {times.size()}, std::as_bytes(std::span(times)));
}

void AddLabels(const Column& column, const std::string& name, NpzWriter* npz) {
  std::size_t size = 1;
  for (const std::string& label : column.leaf->enumerators) size = std::max(size, label.size());
  Bytes data(column.leaf->enumerators.size() * size);
  std::size_t at = 0;
  for (const std::string& label : column.leaf->enumerators) {
    std::memcpy(data.data() + at, label.data(), label.size());
    at += size;
  }
  npz->Add(name + ".labels", "|S" + std::to_string(size), {column.leaf->enumerators.size()}, data);
}

}  // namespace

std::vector<Written> WriteNpz(const Tables& tables, const std::filesystem::path& file) {
  NpzWriter npz(file);
  std::vector<Written> written;
  for (std::size_t i = 0; i < tables.list().size(); ++i) {
    const TopicTable& table = *tables.list()[i];
    std::vector<std::int64_t> log_times, publish_times;
    std::vector<ArrayOfColumn> arrays;
    for (const Column& column : table.columns->list()) arrays.emplace_back(column, table.rows);
    tables.Read(
        [&](std::size_t, const recording::McapMessage& message) {
          const std::size_t row = log_times.size();
          log_times.push_back(message.log_time_ns);
          publish_times.push_back(message.publish_time_ns);
          table.columns->ForEach(message.data, [&arrays, row](std::size_t column, std::size_t entry,
                                                              const Cell& value) {
            arrays[column].Set(row, entry, value);
          });
        },
        i);
    Written of_topic{table.topic, table.rows, 2};
    AddTimes(log_times, table.topic + ".log_time_ns", &npz);
    AddTimes(publish_times, table.topic + ".publish_time_ns", &npz);
    for (std::size_t column = 0; column < arrays.size(); ++column) {
      const Column& described = table.columns->list()[column];
      const std::string name = table.topic + "." + described.path;
      arrays[column].WriteTo(&npz, name, table.rows);
      ++of_topic.fields;
      if (described.leaf->kind != Kind::kEnum) continue;
      AddLabels(described, name, &npz);
      ++of_topic.fields;
    }
    written.push_back(of_topic);
  }
  npz.Commit();
  return written;
}

}  // namespace sinew::export_recording
