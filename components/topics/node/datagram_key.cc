#include "components/topics/node/datagram_key.h"

#include <sodium.h>
#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <string>

#include "components/base/config/config.h"

namespace sinew::node::internal {

namespace {

// A submessage of a vendor (RTPS 2.5, 9.4.5.1.1: 0x80 to 0xff), little endian, with its length.
constexpr std::array<std::uint8_t, 4> kTagHeader = {0xf5, 0x01, 16, 0};

}  // namespace

DatagramKey::DatagramKey(const Bytes& bytes) : bytes_(bytes) {
  if (sodium_init() < 0) throw std::runtime_error("libsodium cannot be used on this machine");
}

DatagramKey DatagramKey::Load(const std::filesystem::path& file) {
  const auto refuse = [&file](const std::string& why) {
    throw UsageError(file.string() + ": " + why);
  };
  struct stat status {};
  if (::stat(file.c_str(), &status) != 0)
    refuse("no such file, expected the key of the deployment");
  if (!S_ISREG(status.st_mode)) refuse("expected a file with 64 hexadecimal digits");
  if ((status.st_mode & (S_IRWXG | S_IRWXO)) != 0) {
    refuse("a key that others may read or write is none, expected mode 0600 (chmod 600)");
  }
  std::string text = config::ReadFile(file, 1024);  // with what an editor puts behind it
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  Bytes bytes{};
  std::size_t count = 0;
  if (text.size() != 2 * kBytes ||
      sodium_hex2bin(bytes.data(), bytes.size(), text.data(), text.size(), nullptr, &count,
                     nullptr) != 0 ||
      count != kBytes) {
    refuse("expected 64 hexadecimal digits, the 32 bytes of a key");
  }
  return DatagramKey(bytes);
}

void DatagramKey::AddTag(std::span<const std::uint8_t> datagram,
                         std::vector<std::uint8_t>* tagged) const {
  const auto hash = HashOf(datagram);
  tagged->assign(datagram.begin(), datagram.end());
  tagged->insert(tagged->end(), kTagHeader.begin(), kTagHeader.end());
  tagged->insert(tagged->end(), hash.begin(), hash.end());
}

bool DatagramKey::HasTag(std::span<const std::uint8_t> datagram) {
  return datagram.size() > kTagBytes &&
         std::equal(kTagHeader.begin(), kTagHeader.end(), datagram.last(kTagBytes).begin());
}

std::span<const std::uint8_t> DatagramKey::Verified(std::span<const std::uint8_t> datagram) const {
  if (!HasTag(datagram)) return {};
  const auto content = datagram.first(datagram.size() - kTagBytes);
  const auto hash = HashOf(content);
  const auto expected = datagram.last(kHashBytes);
  if (sodium_memcmp(hash.data(), expected.data(), kHashBytes) != 0) return {};
  return content;
}

std::array<std::uint8_t, DatagramKey::kHashBytes> DatagramKey::HashOf(
    std::span<const std::uint8_t> datagram) const {
  std::array<std::uint8_t, kHashBytes> hash{};
  crypto_generichash(hash.data(), hash.size(), datagram.data(), datagram.size(), bytes_.data(),
                     bytes_.size());
  return hash;
}

}  // namespace sinew::node::internal
