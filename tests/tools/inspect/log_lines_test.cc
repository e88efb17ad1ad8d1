#include "tools/inspect/log_lines.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

#include "idl/embedded_idl.h"
#include "tests/support/json_cdr.h"

namespace sinew::inspect {
namespace {

recording::IdlSchema SchemaOfLines() {
  for (const idl::EmbeddedType& type : idl::EmbeddedTypes()) {
    if (type.type_name == "sinew::msg::LogLine") {
      return recording::IdlSchema::Parse(std::string(type.text));
    }
  }
  throw std::logic_error("no type of the log");
}

TEST(LogReader, GivesPrintableTextsOfALine) {
  const recording::IdlSchema schema = SchemaOfLines();
  const recording::IdlType& type = schema.Struct("sinew::msg::LogLine");
  const LogText line = LogReader(type).Read(recording::JsonToCdr(
      type,
      {{"time_ns", -3}, {"level", "LOG_LEVEL_ERROR"}, {"name", "a\nb"}, {"text", "\x1b[2J"}}));
  EXPECT_EQ(line.time_ns, -3);
  EXPECT_EQ(line.level, msg::LogLevel::kError);
  EXPECT_EQ(line.name, "a\\nb");
  EXPECT_EQ(line.text, "\\u001b[2J");
}

TEST(LogReader, RefusesEveryPayloadThatEndsEarlyAndAnotherType) {
  const recording::IdlSchema schema = SchemaOfLines();
  const recording::IdlType& type = schema.Struct("sinew::msg::LogLine");
  const recording::Bytes whole = recording::ZeroCdr(type);
  const LogReader reader(type);
  for (std::size_t size = 0; size + 1 < whole.size(); ++size) {
    EXPECT_THROW(reader.Read(std::span(whole).first(size)), recording::CdrError) << size;
  }
  const auto other = recording::IdlSchema::Parse("@final struct Line { string<9> text; };");
  EXPECT_THROW(LogReader(other.Struct("Line")), recording::CdrError);
}

}  // namespace
}  // namespace sinew::inspect
