// Writes a recording with messages of every topic, and what a reader must find in it, a JSON line
// each, with schema and payload (hexadecimal) for readers of messages alone. Usage:
// idl_write_sample OUT.mcap EXPECTED.jsonl
#include <cstdint>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <random>
#include <string>

#include "components/record/recording/file/file_io.h"
#include "components/record/recording/mcap_writer.h"
#include "components/record/recording/run_import.h"
#include "components/topics/node/topics.h"
#include "tests/support/json_cdr.h"

namespace {

using Json = nlohmann::ordered_json;
using sinew::recording::IdlType;
using Kind = IdlType::Kind;

struct Value {
  Json input;     // for our encoder
  Json expected;  // 64-bit integers as texts: other languages read JSON numbers as doubles
};

Value MakeValue(const IdlType& type, std::mt19937_64* random) {
  const auto whole = [random](std::int64_t lower, std::int64_t upper) {
    return std::uniform_int_distribution<std::int64_t>(lower, upper)(*random);
  };
  const auto same = [](const Json& json) { return Value{json, json}; };
  switch (type.kind) {
    case Kind::kBool: {
      const bool value = whole(0, 1) == 1;
      return same(value);
    }
    case Kind::kOctet:
      return same(whole(0, 255));
    case Kind::kChar:
      return same(whole(32, 126));
    case Kind::kInt16:
      return same(whole(-32768, 32767));
    case Kind::kUint16:
      return same(whole(0, 65535));
    case Kind::kInt32:
      return same(whole(-2147483648LL, 2147483647LL));
    case Kind::kUint32:
      return same(whole(0, 4294967295LL));
    case Kind::kInt64: {
      const auto value = static_cast<std::int64_t>((*random)());
      return {value, std::to_string(value)};
    }
    case Kind::kUint64: {
      const std::uint64_t value = (*random)();
      return {value, std::to_string(value)};
    }
    case Kind::kFloat:
    case Kind::kDouble:
      return same(static_cast<double>(whole(-1000000, 1000000)) / 1024.0);
    case Kind::kEnum:
      return same(whole(0, static_cast<std::int64_t>(type.enumerators.size()) - 1));
    case Kind::kString: {
      std::string text =
          "Gr\xC3\xB6\xC3\x9F"
          "e ";
      const auto size = whole(0, 10);
      for (std::int64_t i = 0; i < size; ++i) text += static_cast<char>(whole('a', 'z'));
      return same(text);
    }
    case Kind::kStruct: {
      Value value{Json::object(), Json::object()};
      for (const sinew::recording::IdlMember& member : type.members) {
        const Value inner = MakeValue(*member.type, random);
        value.input[member.name] = inner.input;
        value.expected[member.name] = inner.expected;
      }
      return value;
    }
    case Kind::kArray:
    case Kind::kSequence: {
      const std::int64_t count = type.kind == Kind::kArray ? type.bound : whole(0, 9);
      Value value{Json::array(), Json::array()};
      for (std::int64_t i = 0; i < count; ++i) {
        const Value inner = MakeValue(*type.element, random);
        value.input.push_back(inner.input);
        value.expected.push_back(inner.expected);
      }
      return value;
    }
  }
  return {};
}

std::string Hex(const sinew::recording::Bytes& bytes) {
  constexpr char kDigits[] = "0123456789abcdef";
  std::string text;
  for (const std::byte byte : bytes) {
    text += kDigits[std::to_integer<unsigned>(byte) >> 4];
    text += kDigits[std::to_integer<unsigned>(byte) & 15];
  }
  return text;
}

int Write(const std::string& path, const std::string& expected_path) {
  using namespace sinew::recording;
  FileSink sink(path, Existing::kReplace);
  McapWriter writer(sink);
  std::ofstream expected(expected_path);
  bool ok = writer.Open().ok();
  ok = ok && writer.WriteMetadata({"sinew.recording", {{"seed", "7"}}}).ok();
  std::mt19937_64 random(7);
  std::int64_t time_ns = 1'700'000'000'123'456'789;
  for (const sinew::node::TopicInfo& topic : sinew::node::AllTopics()) {
    ChannelId channel{};
    ok = ok &&
         AddTopic({topic.name, topic.type_name, topic.idl, topic.idl_hash}, &writer, &channel).ok();
    const IdlSchema schema = IdlSchema::Parse(topic.idl);
    const IdlType& type = schema.Struct(topic.type_name);
    for (int i = 0; i < 20; ++i) {
      const Value value = MakeValue(type, &random);
      time_ns += 7'000'000;
      const Bytes payload = JsonToCdr(type, value.input);
      ok = ok && writer.WriteMessage(channel, time_ns, time_ns - 1, payload).ok();
      expected << Json{{"topic", topic.name},
                       {"log_time", std::to_string(time_ns)},
                       {"publish_time", std::to_string(time_ns - 1)},
                       {"value", value.expected},
                       {"schema_name", topic.type_name},
                       {"schema", topic.idl},
                       {"payload", Hex(payload)}}
                      .dump()
               << '\n';
    }
  }
  ok = ok && writer.Close().ok() && sink.Close().ok() && expected.flush().good();
  return ok ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc != 3) {
    std::cerr << "usage: idl_write_sample OUT.mcap EXPECTED.jsonl\n";
    return 2;
  }
  return Write(argv[1], argv[2]);
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
