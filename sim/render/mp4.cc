#include "sim/render/mp4.h"

#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>

namespace sinew::render {

namespace {

// Numbers are big-endian (14496-12, 4.2).
void Put(std::uint64_t value, int bytes, Octets* out) {
  for (int shift = 8 * (bytes - 1); shift >= 0; shift -= 8) {
    out->push_back(static_cast<std::uint8_t>(value >> shift));
  }
}
void Put16(std::uint64_t value, Octets* out) { Put(value, 2, out); }
void Put32(std::uint64_t value, Octets* out) { Put(value, 4, out); }
void PutText(std::string_view text, Octets* out) {
  out->insert(out->end(), text.begin(), text.end());
}
void PutZeros(std::size_t count, Octets* out) { out->insert(out->end(), count, 0); }
void PutAll(const Octets& octets, Octets* out) {
  out->insert(out->end(), octets.begin(), octets.end());
}

std::uint64_t Fitting(std::uint64_t value, std::uint64_t largest, const char* what) {
  if (value > largest) {
    throw std::invalid_argument(std::string("MP4: ") + what + " is " + std::to_string(value) +
                                ", expected at most " + std::to_string(largest));
  }
  return value;
}

constexpr std::uint64_t kLargest16 = std::numeric_limits<std::uint16_t>::max();
constexpr std::uint64_t kLargest32 = std::numeric_limits<std::uint32_t>::max();

Octets Box(std::string_view type, const Octets& content) {
  Octets out;
  Put32(Fitting(content.size() + 8, kLargest32, "a box"), &out);
  PutText(type, &out);
  PutAll(content, &out);
  return out;
}

// A box whose content begins with version 0 and flags.
Octets FullBox(std::string_view type, std::uint32_t flags, const Octets& content) {
  Octets out;
  Put32(flags, &out);
  PutAll(content, &out);
  return Box(type, out);
}

void PutIdentityMatrix(Octets* out) {  // 16.16, 16.16, 2.30 in each row
  for (const std::uint32_t value : {0x10000u, 0u, 0u, 0u, 0x10000u, 0u, 0u, 0u, 0x40000000u}) {
    Put32(value, out);
  }
}

std::size_t SampleCount(const Mp4Track& track) {
  std::size_t count = 0;
  for (const Mp4Chunk& chunk : track.chunks) count += chunk.samples.size();
  return count;
}

constexpr std::uint32_t kTrack = 1;

// The time scale of movie and media is the rate of frames: a frame lasts 1.
void PutDuration(const Mp4Track& track, Octets* out) {
  Put32(Fitting(SampleCount(track), kLargest32, "the number of frames"), out);
}

Octets MovieHeader(const Mp4Track& track) {  // 8.2.2
  Octets out;
  PutZeros(8, &out);  // when made and changed: not stated
  Put32(static_cast<std::uint32_t>(track.frames_per_s), &out);
  PutDuration(track, &out);
  Put32(0x10000, &out);  // rate 1
  Put16(0x100, &out);    // volume 1
  PutZeros(10, &out);
  PutIdentityMatrix(&out);
  PutZeros(24, &out);
  Put32(kTrack + 1, &out);  // the next track would be this one
  return FullBox("mvhd", 0, out);
}

Octets TrackHeader(const Mp4Track& track) {  // 8.3.2
  constexpr std::uint32_t kEnabledInMovie = 3;
  Octets out;
  PutZeros(8, &out);
  Put32(kTrack, &out);
  PutZeros(4, &out);
  PutDuration(track, &out);
  PutZeros(16, &out);  // reserved, layer, alternate group, volume of a picture
  PutIdentityMatrix(&out);
  Put32(static_cast<std::uint64_t>(track.width) << 16, &out);
  Put32(static_cast<std::uint64_t>(track.height) << 16, &out);
  return FullBox("tkhd", kEnabledInMovie, out);
}

Octets MediaHeader(const Mp4Track& track) {        // 8.4.2
  constexpr std::uint32_t kUndetermined = 0x55c4;  // language "und", 5 bits a letter
  Octets out;
  PutZeros(8, &out);
  Put32(static_cast<std::uint32_t>(track.frames_per_s), &out);
  PutDuration(track, &out);
  Put16(kUndetermined, &out);
  PutZeros(2, &out);
  return FullBox("mdhd", 0, out);
}

Octets Handler() {  // 8.4.3
  Octets out;
  PutZeros(4, &out);
  PutText("vide", &out);
  PutZeros(13, &out);  // reserved, an empty name
  return FullBox("hdlr", 0, out);
}

// 14496-15, 5.3.3.1.2.
Octets DecoderConfiguration(const Mp4Track& track) {
  if (track.sequence_parameters.size() < 4 || track.picture_parameters.empty()) {
    throw std::invalid_argument("MP4: the parameters of the H.264 stream are missing");
  }
  Octets out = {1};  // version
  // Profile, compatibility and level: the bytes after the head of the sequence parameters.
  out.insert(out.end(), track.sequence_parameters.begin() + 1,
             track.sequence_parameters.begin() + 4);
  Put(0xff, 1, &out);  // lengths of NAL units have 4 bytes
  Put(0xe1, 1, &out);  // one set of sequence parameters
  Put16(Fitting(track.sequence_parameters.size(), kLargest16, "the sequence parameters"), &out);
  PutAll(track.sequence_parameters, &out);
  Put(1, 1, &out);
  Put16(Fitting(track.picture_parameters.size(), kLargest16, "the picture parameters"), &out);
  PutAll(track.picture_parameters, &out);
  return Box("avcC", out);
}

Octets SampleDescription(const Mp4Track& track) {  // 8.5.2, 12.1.3
  constexpr std::uint32_t kDotsPerInch = 72u << 16;
  Octets entry;
  PutZeros(6, &entry);
  Put16(1, &entry);  // the data are where 'dref' says
  PutZeros(16, &entry);
  Put16(Fitting(static_cast<std::uint64_t>(track.width), kLargest16, "the width"), &entry);
  Put16(Fitting(static_cast<std::uint64_t>(track.height), kLargest16, "the height"), &entry);
  Put32(kDotsPerInch, &entry);
  Put32(kDotsPerInch, &entry);
  PutZeros(4, &entry);
  Put16(1, &entry);  // frames in a sample
  PutZeros(32, &entry);
  Put16(24, &entry);      // colours without transparency
  Put16(0xffff, &entry);  // as the standard asks for
  PutAll(DecoderConfiguration(track), &entry);
  Octets out;
  Put32(1, &out);
  PutAll(Box("avc1", entry), &out);
  return FullBox("stsd", 0, out);
}

Octets TimeToSample(const Mp4Track& track) {  // 8.6.1.2
  Octets out;
  Put32(1, &out);
  Put32(SampleCount(track), &out);
  Put32(1, &out);
  return FullBox("stts", 0, out);
}

Octets KeySamples(const Mp4Track& track) {  // 8.6.2
  Octets numbers;
  std::uint32_t number = 0, count = 0;
  for (const Mp4Chunk& chunk : track.chunks) {
    for (const Mp4Sample& sample : chunk.samples) {
      ++number;
      if (!sample.key) continue;
      ++count;
      Put32(number, &numbers);
    }
  }
  Octets out;
  Put32(count, &out);
  PutAll(numbers, &out);
  return FullBox("stss", 0, out);
}

Octets SampleSizes(const Mp4Track& track) {  // 8.7.3
  Octets out;
  Put32(0, &out);  // they differ
  Put32(SampleCount(track), &out);
  for (const Mp4Chunk& chunk : track.chunks) {
    for (const Mp4Sample& sample : chunk.samples) {
      Put32(Fitting(sample.size, kLargest32, "a frame"), &out);
    }
  }
  return FullBox("stsz", 0, out);
}

Octets SamplesToChunks(const Mp4Track& track) {  // 8.7.4
  Octets out;
  Put32(track.chunks.size(), &out);
  for (std::size_t i = 0; i < track.chunks.size(); ++i) {
    Put32(i + 1, &out);
    Put32(track.chunks[i].samples.size(), &out);
    Put32(1, &out);  // the sample description
  }
  return FullBox("stsc", 0, out);
}

Octets ChunkOffsets(const Mp4Track& track) {  // 8.7.5
  Octets out;
  Put32(track.chunks.size(), &out);
  for (const Mp4Chunk& chunk : track.chunks) Put(chunk.offset, 8, &out);
  return FullBox("co64", 0, out);
}

Octets Joined(std::initializer_list<Octets> parts) {
  Octets out;
  for (const Octets& part : parts) PutAll(part, &out);
  return out;
}

Octets DataInformation() {  // 8.7.1, 8.7.2: the data are in this file
  constexpr std::uint32_t kSameFile = 1;
  Octets references;
  Put32(1, &references);
  PutAll(FullBox("url ", kSameFile, {}), &references);
  return Box("dinf", FullBox("dref", 0, references));
}

}  // namespace

void AppendNalUnit(std::span<const std::uint8_t> unit, Octets* sample) {
  Put32(Fitting(unit.size(), kLargest32, "a NAL unit"), sample);
  sample->insert(sample->end(), unit.begin(), unit.end());
}

Octets FileType() {  // 4.3
  Octets out;
  PutText("isom", &out);
  Put32(0x200, &out);
  PutText("isomiso2avc1mp41", &out);
  return Box("ftyp", out);
}

Octets MediaData(std::span<const std::uint8_t> samples) {  // 8.1.1
  return Box("mdat", Octets(samples.begin(), samples.end()));
}

Octets Movie(const Mp4Track& track) {  // 8.2.1
  if (track.width < 1 || track.height < 1 || track.frames_per_s < 1) {
    throw std::invalid_argument("MP4: size and rate of frames must be above 0");
  }
  const Octets table =
      Box("stbl", Joined({SampleDescription(track), TimeToSample(track), KeySamples(track),
                          SamplesToChunks(track), SampleSizes(track), ChunkOffsets(track)}));
  Octets video_header;  // 12.1.2
  PutZeros(8, &video_header);
  const Octets information =
      Box("minf", Joined({FullBox("vmhd", 1, video_header), DataInformation(), table}));
  const Octets media = Box("mdia", Joined({MediaHeader(track), Handler(), information}));
  return Box("moov",
             Joined({MovieHeader(track), Box("trak", Joined({TrackHeader(track), media}))}));
}

}  // namespace sinew::render
