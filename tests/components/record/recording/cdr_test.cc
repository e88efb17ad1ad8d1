// Oracle: bytes that the DDS library's own serializer makes of the generated types.
#include "components/record/recording/cdr.h"

#include <gtest/gtest.h>
#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/learning.h>
#include <sinew_idl/operator.h>
#include <sinew_idl/status.h>

#include <cmath>
#include <limits>
#include <random>

#include "components/record/recording/file/cdr_json.h"
#include "components/topics/node/codec.h"
#include "components/topics/node/topics.h"
#include "tests/support/json_cdr.h"

namespace sinew::recording {
namespace {

struct Topic {
  explicit Topic(std::string_view name)
      : info(*node::FindTopic(name)),
        schema(IdlSchema::Parse(info.idl)),
        type(schema.Struct(info.type_name)) {}
  const node::TopicInfo& info;
  IdlSchema schema;
  const IdlType& type;
};

msg::JointState MakeJointState() {
  msg::JointState message;
  message.header.session_id = 0xfedcba9876543210u;
  message.header.tick = 77;
  message.header.stamp_ns = -5;
  message.header.origin = msg::Origin::kSim;
  message.robot_state = msg::RobotState::kFault;
  message.last_tick = true;
  message.period_s = 1.0 / 240.0;
  message.joint_count = 2;
  message.joint_kind[1] = msg::JointKind::kPrismatic;
  for (std::size_t j = 0; j < 12; ++j) {
    message.position_rad[j] = 0.1 * static_cast<double>(j) - 0.3;
    message.velocity_rad_s[j] = 1e-3 * static_cast<double>(j);
    message.torque_Nm[j] = -1.0 / (1.0 + static_cast<double>(j));
    message.age_us[j] = static_cast<std::int32_t>(j) - 3;
    message.valid[j] = j % 2 == 0;
  }
  return message;
}

msg::Readout MakeReadout() {
  msg::Readout message;
  message.header.tick = 3;
  message.version = 9;
  message.network = 1;
  message.feature_count = 5;
  for (int i = 0; i < 5; ++i) message.weight.push_back(0.5 * i);
  return message;
}

msg::ComponentStatus MakeStatus() {
  msg::ComponentStatus message;
  message.name = "logger";
  message.header.tick = 12;
  message.host = "rig \xC3\xA4";
  message.state = msg::ComponentState::kActive;
  message.resident_MB = 31.5;
  message.message = "two \"quoted\" words";
  return message;
}

template <class Message>
Bytes Encoded(const Message& message) {
  Bytes bytes;
  EXPECT_TRUE(node::Encode(message, &bytes));
  return bytes;
}

TEST(CdrField, ReadsWhatTheDdsLibraryWrote) {
  const Topic topic("joint_state");
  const msg::JointState message = MakeJointState();
  const Bytes bytes = Encoded(message);
  const auto real = [&](const std::string& path) {
    return CdrField(topic.type, path).AsDouble(bytes);
  };
  EXPECT_EQ(static_cast<std::uint64_t>(CdrField(topic.type, "header.session_id").AsInt(bytes)),
            0xfedcba9876543210u);
  EXPECT_EQ(CdrField(topic.type, "header.tick").AsInt(bytes), 77);
  EXPECT_EQ(CdrField(topic.type, "header.stamp_ns").AsInt(bytes), -5);
  EXPECT_EQ(CdrField(topic.type, "header.origin").AsText(bytes), "ORIGIN_SIM");
  EXPECT_EQ(CdrField(topic.type, "robot_state").AsText(bytes), "ROBOT_FAULT");
  EXPECT_EQ(real("period_s"), message.period_s);
  EXPECT_EQ(CdrField(topic.type, "joint_kind[1]").AsText(bytes), "JOINT_PRISMATIC");
  for (std::size_t j = 0; j < 12; ++j) {
    const std::string index = std::string("[").append(std::to_string(j)).append("]");
    EXPECT_EQ(real("position_rad" + index), message.position_rad[j]);
    EXPECT_EQ(real("velocity_rad_s" + index), message.velocity_rad_s[j]);
    EXPECT_EQ(real("torque_Nm" + index), message.torque_Nm[j]);
    EXPECT_EQ(CdrField(topic.type, "age_us" + index).AsInt(bytes), message.age_us[j]);
    EXPECT_EQ(real("valid" + index), message.valid[j] ? 1.0 : 0.0);
  }
}

TEST(CdrField, FindsFieldsBehindTextsAndSequences) {
  const Topic status("component_status");
  const Bytes bytes = Encoded(MakeStatus());
  EXPECT_EQ(CdrField(status.type, "name").AsText(bytes), "logger");
  EXPECT_EQ(CdrField(status.type, "header.tick").AsInt(bytes), 12);
  EXPECT_EQ(CdrField(status.type, "host").AsText(bytes), "rig \xC3\xA4");
  EXPECT_EQ(CdrField(status.type, "resident_MB").AsDouble(bytes), 31.5);
  EXPECT_EQ(CdrField(status.type, "message").AsText(bytes), "two \"quoted\" words");
  const Topic readout("readout");
  const Bytes weights = Encoded(MakeReadout());
  EXPECT_EQ(CdrField(readout.type, "weight[4]").AsDouble(weights), 2.0);
  EXPECT_THROW((void)CdrField(readout.type, "weight[5]").AsDouble(weights), CdrError);
}

TEST(CdrField, SetsInPlaceWhatTheDdsLibraryReadsBack) {
  const Topic topic("joint_state");
  Bytes bytes = ZeroCdr(topic.type);
  const msg::JointState expected = MakeJointState();
  CdrField(topic.type, "header.tick").SetInt(bytes, 77);
  CdrField(topic.type, "header.origin").SetInt(bytes, 1);
  CdrField(topic.type, "period_s").Set(bytes, expected.period_s);
  CdrField(topic.type, "valid[2]").SetInt(bytes, 1);
  CdrField(topic.type, "age_us[0]").SetInt(bytes, -3);
  for (std::size_t j = 0; j < 12; ++j) {
    CdrField(topic.type, std::string("position_rad[").append(std::to_string(j)).append("]"))
        .Set(bytes, expected.position_rad[j]);
  }
  msg::JointState message;
  ASSERT_TRUE(node::Decode(bytes, &message));
  EXPECT_EQ(message.header.tick, 77u);
  EXPECT_EQ(message.header.origin, msg::Origin::kSim);
  EXPECT_EQ(message.period_s, expected.period_s);
  EXPECT_EQ(message.position_rad, expected.position_rad);
  EXPECT_EQ(message.age_us[0], -3);
  EXPECT_TRUE(message.valid[2]);
  EXPECT_FALSE(message.valid[1]);
}

TEST(CdrField, NamesTheFieldsThereAre) {
  const Topic topic("joint_state");
  const auto error_of = [&](const std::string& path) -> std::string {
    try {
      const CdrField field(topic.type, path);
    } catch (const CdrError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(
      error_of("header.tack"),
      "no field 'tack' in sinew::msg::Header, expected one of: session_id, tick, stamp_ns, origin");
  EXPECT_EQ(error_of("position_rad[12]"),
            "path 'position_rad[12]': index 12 of 'position_rad', expected 0 to 11");
  EXPECT_EQ(error_of("position_rad"),
            "path 'position_rad' ends at a list, expected an index such as [0]");
  EXPECT_EQ(error_of("header"), "path 'header' ends at a struct, expected one of its members");
  EXPECT_NE(error_of("period_s[0]"), "");
  EXPECT_NE(error_of("period_s.x"), "");
  EXPECT_NE(error_of("position_rad[x]"), "");
  EXPECT_NE(error_of("position_rad["), "");
  EXPECT_NE(error_of(""), "");
}

// Every topic: zeros, our encoder and the DDS library agree byte by byte.
TEST(Cdr, ZeroMessagesAreThoseOfTheDdsLibrary) {
  const auto check = [](std::string_view name, const Bytes& encoded) {
    const Topic topic(name);
    Bytes theirs = encoded;
    CanonicalizeCdr(topic.type, &theirs);
    EXPECT_EQ(ZeroCdr(topic.type), theirs) << name;
    EXPECT_EQ(JsonToCdr(topic.type, nlohmann::ordered_json::object()), theirs) << name;
  };
  check("joint_state", Encoded(msg::JointState()));
  check("actuator_state", Encoded(msg::ActuatorState()));
  check("readout", Encoded(msg::Readout()));
  check("reservoir_state", Encoded(msg::ReservoirState()));
  check("component_status", Encoded(msg::ComponentStatus()));
  check("motion_request", Encoded(msg::MotionRequest()));
  check("operator_command", Encoded(msg::OperatorCommand()));
}

TEST(Cdr, GoesThroughJsonAndBackWithoutChange) {
  const auto check = [](std::string_view name, Bytes bytes) {
    const Topic topic(name);
    CanonicalizeCdr(topic.type, &bytes);
    const nlohmann::ordered_json json = CdrToJson(topic.type, bytes);
    EXPECT_EQ(JsonToCdr(topic.type, nlohmann::ordered_json::parse(json.dump())), bytes)
        << json.dump(1);
  };
  check("joint_state", Encoded(MakeJointState()));
  check("readout", Encoded(MakeReadout()));
  check("component_status", Encoded(MakeStatus()));
  msg::ActuatorState strange;
  strange.motor_current_A[0] = std::numeric_limits<double>::quiet_NaN();
  strange.motor_current_A[1] = std::numeric_limits<double>::infinity();
  strange.motor_current_A[2] = -std::numeric_limits<double>::infinity();
  strange.motor_current_A[3] = -0.0;
  strange.motor_current_A[4] = std::numeric_limits<double>::denorm_min();
  check("actuator_state", Encoded(strange));
}

TEST(Cdr, JsonHasLabelsAndNames) {
  const Topic topic("component_status");
  const nlohmann::ordered_json json = CdrToJson(topic.type, Encoded(MakeStatus()));
  EXPECT_EQ(json["state"], "COMPONENT_ACTIVE");
  EXPECT_EQ(json["header"]["tick"], 12);
  EXPECT_EQ(json.begin().key(), "name");
}

TEST(Cdr, RefusesJsonThatDoesNotFit) {
  const Topic topic("joint_state");
  const auto error_of = [&](const char* text) -> std::string {
    try {
      JsonToCdr(topic.type, nlohmann::ordered_json::parse(text));
    } catch (const CdrError& error) {
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(error_of(R"({"position": [1]})"),
            "member 'position' is not known in sinew::msg::JointState");
  EXPECT_EQ(error_of(R"({"joint_count": 300})"), "member 'joint_count': 300 does not fit");
  EXPECT_EQ(error_of(R"({"header": {"origin": "ORIGIN_MOON"}})"),
            "member 'header.origin': no label 'ORIGIN_MOON'");
  EXPECT_NE(error_of(R"({"position_rad": [0,0,0,0,0,0,0,0,0,0,0,0,0]})"), "");
  EXPECT_NE(error_of(R"({"period_s": "long"})"), "");
  EXPECT_EQ(error_of(R"({"position_rad": [1.5], "joint_kind": ["JOINT_PRISMATIC"]})"), "");
}

TEST(Cdr, ReadsBigEndianMessages) {
  const IdlSchema schema =
      IdlSchema::Parse("struct A { octet a; unsigned long b; double c; short d[2]; };");
  const IdlType& type = schema.Struct("A");
  Bytes bytes;
  for (const int byte :
       {0, 0, 0, 0, 7, 0, 0, 0, 0, 0, 1, 2, 0x3f, 0xf8, 0, 0, 0, 0, 0, 0, 0xff, 0xfe, 0, 3}) {
    bytes.push_back(static_cast<std::byte>(byte));
  }
  EXPECT_EQ(CdrField(type, "a").AsInt(bytes), 7);
  EXPECT_EQ(CdrField(type, "b").AsInt(bytes), 258);
  EXPECT_EQ(CdrField(type, "c").AsDouble(bytes), 1.5);
  EXPECT_EQ(CdrField(type, "d[0]").AsInt(bytes), -2);
  EXPECT_EQ(CdrField(type, "d[1]").AsInt(bytes), 3);
  CdrField(type, "b").SetInt(bytes, 1);
  EXPECT_EQ(bytes[11], std::byte{1});
}

TEST(Cdr, CanonicalBytesDoNotDependOnPaddingOrTail) {
  const Topic topic("joint_state");
  Bytes clean = Encoded(MakeJointState());
  CanonicalizeCdr(topic.type, &clean);
  // Whatever is put between the members or behind them, the canonical bytes are the same.
  Bytes noisy = clean;
  std::size_t padding = 0;
  for (std::size_t at = 4; at < clean.size(); ++at) {
    Bytes changed = clean;
    changed[at] ^= std::byte{0x5a};
    Bytes canonical = changed;
    CanonicalizeCdr(topic.type, &canonical);
    if (canonical == clean) {
      noisy[at] = std::byte{0x5a};
      ++padding;
    }
  }
  // 3 before fault.value, 7 before period_s, 3 before joint_kind, 4 before position_rad
  EXPECT_EQ(padding, 17u);
  noisy.resize(noisy.size() + 3, std::byte{1});
  CanonicalizeCdr(topic.type, &noisy);
  EXPECT_EQ(noisy, clean);
}

// Every length and many random bytes: an error or a value, never a read outside.
TEST(Cdr, NeverReadsOutsideThePayload) {
  std::mt19937_64 random(7);
  for (const std::string name : {"joint_state", "readout", "component_status", "motion_request"}) {
    const Topic topic(name);
    Bytes whole = name == "readout"            ? Encoded(MakeReadout())
                  : name == "component_status" ? Encoded(MakeStatus())
                                               : ZeroCdr(topic.type);
    CanonicalizeCdr(topic.type, &whole);
    for (std::size_t length = 0; length < whole.size(); ++length) {
      Bytes part(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length));
      part.shrink_to_fit();
      EXPECT_THROW(CdrToJson(topic.type, part), CdrError) << name << " " << length;
      EXPECT_THROW(CanonicalizeCdr(topic.type, &part), CdrError) << name << " " << length;
    }
    for (int round = 0; round < 2000; ++round) {
      Bytes noise(random() % 400);
      for (std::byte& byte : noise) byte = static_cast<std::byte>(random());
      if (noise.size() > 1) {
        noise[0] = std::byte{0};
        noise[1] = static_cast<std::byte>(round % 3);
      }
      try {
        CdrToJson(topic.type, noise);
        CanonicalizeCdr(topic.type, &noise);
      } catch (const CdrError&) {
      }
    }
  }
}

TEST(Cdr, RefusesOtherEncodings) {
  const Topic topic("joint_state");
  Bytes bytes = ZeroCdr(topic.type);
  bytes[1] = std::byte{7};  // XCDR2
  EXPECT_THROW(CdrToJson(topic.type, bytes), CdrError);
}

}  // namespace
}  // namespace sinew::recording
