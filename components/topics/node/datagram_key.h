// The key of a deployment. With it every datagram carries an authentication tag, a keyed BLAKE2b of
// 16 bytes (RFC 7693, libsodium's crypto_generichash), and a datagram without it is not read: what
// a sender without the key sends reaches no parser of the library.
//
// The tag is the last submessage, with a vendor's identifier: a tagged datagram is RTPS, and other
// implementations of DDS skip the tag. It does not say when a datagram was sent: a sender that
// recorded one can send it again, and the sequence number alone marks its sample as old. It does
// not encrypt; DDS security does.
//
// Pure but for Load(); any thread.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <vector>

namespace sinew::node::internal {

class DatagramKey {
 public:
  static constexpr std::size_t kBytes = 32;
  static constexpr std::size_t kTagBytes = 20;  // header of the submessage, then the hash
  using Bytes = std::array<std::uint8_t, kBytes>;

  explicit DatagramKey(const Bytes& bytes);
  // 64 hexadecimal digits. Throws UsageError, with the file: it cannot be read, its contents are
  // something else, or others than its owner may read it.
  static DatagramKey Load(const std::filesystem::path& file);

  // The datagram with its tag, in `tagged`.
  void AddTag(std::span<const std::uint8_t> datagram, std::vector<std::uint8_t>* tagged) const;
  // Whether it looks tagged, by whatever key.
  static bool HasTag(std::span<const std::uint8_t> datagram);
  // The tagged part of `datagram`. Empty: no tag, or one of another key or datagram.
  std::span<const std::uint8_t> Verified(std::span<const std::uint8_t> datagram) const;

 private:
  static constexpr std::size_t kHashBytes = 16;
  std::array<std::uint8_t, kHashBytes> HashOf(std::span<const std::uint8_t> datagram) const;

  Bytes bytes_;
};

}  // namespace sinew::node::internal
