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

// Fills `out` with exactly `size` bytes. Returns what was wrong, or an empty text. Memory grows
// only with what the data really holds, whatever `size` says.
std::string Decompress(std::string_view compression, std::span<const std::byte> bytes,
                       std::uint64_t size, std::vector<std::byte>* out);

// CRC-32 (IEEE 802.3), as MCAP has it.
std::uint32_t Crc32(std::span<const std::byte> bytes);

}  // namespace sinew::recording
