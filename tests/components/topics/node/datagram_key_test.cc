// Tags of datagrams: which are opened, and which files are keys.
#include "components/topics/node/datagram_key.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <string>

#include "components/base/config/config.h"
#include "components/topics/node/datagram_filter.h"
#include "tests/components/topics/node/datagrams.h"
#include "tests/support/temporary_folder.h"

namespace sinew::node::internal {
namespace {

using namespace sinew::node::testing;
using ::testing::AllOf;
using ::testing::HasSubstr;

DatagramKey KeyOf(std::uint8_t first) {
  DatagramKey::Bytes bytes{};
  for (std::size_t k = 0; k < bytes.size(); ++k) bytes[k] = static_cast<std::uint8_t>(first + k);
  return DatagramKey(bytes);
}

Datagram Message() {
  Datagram out = Header();
  AddSubmessage(&out, kDataId, Data({0, 0, 1, 3}, {0, 1, 0, 0, 7, 7, 7, 7}), kWithPayload);
  return out;
}

Datagram Tagged(const DatagramKey& key, const Datagram& datagram) {
  Datagram out;
  key.AddTag(datagram, &out);
  return out;
}

Datagram Verified(const DatagramKey& key, const Datagram& datagram) {
  const auto out = key.Verified(datagram);
  return {out.begin(), out.end()};
}

TEST(DatagramKey, OpensWhatItTagged) {
  const Datagram tagged = Tagged(KeyOf(1), Message());
  EXPECT_EQ(tagged.size(), Message().size() + DatagramKey::kTagBytes);
  EXPECT_EQ(Verified(KeyOf(1), tagged), Message());
}

// b2sum of GNU coreutils has no keys: the values are of Python's hashlib.blake2b(data, key=bytes
// 1 to 32, digest_size=16).hexdigest() for the bytes 0 to 9.
TEST(DatagramKey, TheTagIsTheKeyedBlake2bOfRfc7693) {
  Datagram data;
  for (std::uint8_t k = 0; k < 10; ++k) data.push_back(k);
  const Datagram tagged = Tagged(KeyOf(1), data);
  const Datagram expected = {0x82, 0x3f, 0x0c, 0x42, 0xb7, 0x8e, 0x2d, 0xf5,
                             0x85, 0x91, 0x4a, 0x6c, 0xe9, 0xda, 0x4c, 0xa7};
  EXPECT_EQ(Datagram(tagged.end() - 16, tagged.end()), expected);
}

TEST(DatagramKey, NoOtherDatagramAndNoOtherKeyHasTheTag) {
  const Datagram tagged = Tagged(KeyOf(1), Message());
  EXPECT_TRUE(Verified(KeyOf(2), tagged).empty());
  EXPECT_TRUE(Verified(KeyOf(1), Message()).empty());
  for (std::size_t at = 0; at < tagged.size(); ++at) {
    for (int bit = 0; bit < 8; ++bit) {
      Datagram changed = tagged;
      changed[at] ^= static_cast<std::uint8_t>(1 << bit);
      EXPECT_TRUE(Verified(KeyOf(1), changed).empty()) << at << " " << bit;
    }
  }
  for (std::size_t size = 0; size < tagged.size(); ++size) {
    const Datagram part(tagged.begin(), tagged.begin() + static_cast<std::ptrdiff_t>(size));
    EXPECT_TRUE(Verified(KeyOf(1), part).empty()) << size;
  }
}

// Other implementations skip it as a submessage of a vendor that they do not know.
TEST(DatagramKey, ATaggedDatagramIsWellFormedAndTheTagIsSkipped) {
  Datagram copy;
  const Datagram tagged = Tagged(KeyOf(1), Message());
  const auto passed = DatagramFilter(Protection::kNone).Pass(tagged, &copy);
  EXPECT_EQ(Datagram(passed.begin(), passed.end()), Message());
}

class KeyFile : public ::testing::Test {
 protected:
  std::filesystem::path Write(const std::string& text, mode_t mode = 0600) {
    const std::filesystem::path file = folder_.Write("robot.key", text);
    ::chmod(file.c_str(), mode);
    return file;
  }
  std::string Refusal(const std::filesystem::path& file) {
    try {
      DatagramKey::Load(file);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "";
  }
  const sinew::testing::TemporaryFolder folder_;
};

TEST_F(KeyFile, OfSixtyFourDigitsIsTheKey) {
  std::string digits;
  for (int k = 1; k <= 32; ++k) {
    digits += "0123456789abcdef"[k / 16];
    digits += "0123456789abcdef"[k % 16];
  }
  const DatagramKey key = DatagramKey::Load(Write(digits + "\n"));
  EXPECT_EQ(Verified(key, Tagged(KeyOf(1), Message())), Message());
}

TEST_F(KeyFile, OfAnythingElseIsRefused) {
  const std::string digits(64, 'a');
  EXPECT_THAT(Refusal(folder_.path() / "none"), HasSubstr("no such file"));
  EXPECT_THAT(Refusal(folder_.path()), HasSubstr("expected a file"));
  EXPECT_THAT(Refusal("/dev/zero"), HasSubstr("expected a file"));
  EXPECT_THAT(Refusal(Write(digits, 0640)), AllOf(HasSubstr("robot.key"), HasSubstr("chmod 600")));
  for (const std::string& text : {digits.substr(1), digits + "a", digits + "\n\nbb",
                                  std::string(63, 'a') + "g", std::string()}) {
    EXPECT_THAT(Refusal(Write(text)), HasSubstr("expected 64 hexadecimal digits")) << text;
  }
}

}  // namespace
}  // namespace sinew::node::internal
