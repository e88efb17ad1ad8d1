// Compressed parts of a recording: zstd and LZ4 frames; checksums.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace sinew::recording {

enum class Compression { kNone, kLz4, kZstd };

std::string_view CompressionName(
    Compression compression);  // "", "lz4", "zstd": as MCAP writes them

// Appends the compressed bytes. Level 1 is meant for logging while a robot runs.
void Compress(Compression compression, std::span<const std::byte> bytes,
              std::vector<std::byte>* out);

// The most that so many compressed bytes may be said to hold. LZ4 reaches a ratio of 255 (a byte
// more of a match's length is 255 bytes more of output) and zstd 32768 (a block of 128 KiB that
// repeats one byte has 4 bytes), which no message does but a picture of one colour: what is denser
// than LZ4 gets is a chunk of at most 64 MiB, a picture of 4096 x 4096 pixels with 4 bytes each.
constexpr std::uint64_t MostUncompressed(std::uint64_t compressed) {
  constexpr std::uint64_t kRatio = 255, kPicture = std::uint64_t{64} << 20;
  return compressed > kPicture / kRatio ? kRatio * compressed : kPicture;
}

// Fills `out` with exactly `size` bytes. Returns what was wrong, or an empty text. Memory grows
// only with what the data really holds, whatever `size` says, and to MostUncompressed at most.
std::string Decompress(std::string_view compression, std::span<const std::byte> bytes,
                       std::uint64_t size, std::vector<std::byte>* out);

// CRC-32 (IEEE 802.3), as MCAP has it.
std::uint32_t Crc32(std::span<const std::byte> bytes);

}  // namespace sinew::recording
