// An MP4 file with one track of H.264 at a constant rate of frames, as bytes, written from the
// front to the back: FileType, a MediaData for each group of frames, Movie at the end.
//
// ISO/IEC 14496-12:2015 (boxes; the clause of each stands beside it in mp4.cc) and 14496-15:2017,
// 5.3 and 5.4 (H.264 in them). Thread: free functions. They throw std::invalid_argument for what
// does not fit its field.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace sinew::render {

using Octets = std::vector<std::uint8_t>;

struct Mp4Sample {  // an encoded frame
  std::size_t size = 0;
  bool key = false;  // can be shown without the frames before it
};

// Samples that lie one after the other in the file.
struct Mp4Chunk {
  std::uint64_t offset = 0;  // of the first sample's first byte, from the start of the file
  std::vector<Mp4Sample> samples;
};

struct Mp4Track {
  int width = 0;  // pixels
  int height = 0;
  int frames_per_s = 0;
  Octets sequence_parameters, picture_parameters;  // NAL units, without start codes
  std::vector<Mp4Chunk> chunks;
};

// A NAL unit as a part of a sample: its length in 4 bytes, then itself.
void AppendNalUnit(std::span<const std::uint8_t> unit, Octets* sample);

Octets FileType();
// The box around the samples of a chunk. Its first sample begins kMediaDataHeader bytes later.
inline constexpr std::size_t kMediaDataHeader = 8;
Octets MediaData(std::span<const std::uint8_t> samples);
Octets Movie(const Mp4Track& track);

}  // namespace sinew::render
