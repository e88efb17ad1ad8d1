// MP4 files: boxes by a reader of their own, frames by the decoder.
#include "sim/render/mp4.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <wels/codec_api.h>

#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>

#include "components/base/config/config.h"
#include "sim/render/file/video_file.h"
#include "sim/render/yuv.h"
#include "tests/support/temporary_folder.h"

namespace sinew::render {
namespace {

constexpr int kVideoWidth = 320, kVideoHeight = 240, kVideoRate = 25;

std::uint64_t Number(const std::string& bytes, std::size_t at, int count) {
  std::uint64_t out = 0;
  for (int i = 0; i < count; ++i) {
    out = out << 8 | static_cast<unsigned char>(bytes.at(at + static_cast<std::size_t>(i)));
  }
  return out;
}

// Path of a box ("moov/trak/tkhd") -> its content.
std::map<std::string, std::string> BoxesOf(const std::string& bytes,
                                           const std::string& above = "") {
  std::map<std::string, std::string> out;
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t size = Number(bytes, at, 4);
    const std::string type = bytes.substr(at + 4, 4);
    if (size < 8 || at + size > bytes.size()) {
      ADD_FAILURE() << "box " << type << " of " << size << " bytes at " << at;
      return out;
    }
    const std::string path = above.empty() ? type : above + "/" + type;
    const std::string content = bytes.substr(at + 8, size - 8);
    out[path] = content;
    if (type == "moov" || type == "trak" || type == "mdia" || type == "minf" || type == "stbl") {
      out.merge(BoxesOf(content, path));
    }
    at += size;
  }
  return out;
}

const std::string kTable = "moov/trak/mdia/minf/stbl/";

// Samples with their start codes, as the decoder takes them; parameters before the first.
std::vector<std::string> SamplesOf(const std::string& file) {
  auto boxes = BoxesOf(file);
  std::vector<std::string> samples;
  const std::string offsets = boxes[kTable + "co64"], counts = boxes[kTable + "stsc"];
  const std::string sizes = boxes[kTable + "stsz"];
  std::size_t index = 0;
  for (std::size_t chunk = 0; chunk < Number(offsets, 4, 4); ++chunk) {
    EXPECT_EQ(Number(counts, 8 + 12 * chunk, 4), chunk + 1);
    std::size_t at = Number(offsets, 8 + 8 * chunk, 8);
    for (std::size_t i = 0; i < Number(counts, 12 + 12 * chunk, 4); ++i) {
      const std::size_t size = Number(sizes, 12 + 4 * index++, 4), end = at + size;
      std::string sample;
      while (at < end) {
        const std::size_t length = Number(file, at, 4);
        sample += std::string("\0\0\0\1", 4) + file.substr(at + 4, length);
        at += 4 + length;
      }
      EXPECT_EQ(at, end);
      samples.push_back(sample);
    }
  }
  EXPECT_EQ(index, Number(sizes, 8, 4));
  // avcC: after the head of 'avc1', 8 + 8 + 78 bytes; then 6 bytes to the length of the first set.
  const std::string description = boxes[kTable + "stsd"];
  const std::size_t first = 8 + 8 + 78 + 8 + 6, first_size = Number(description, first, 2);
  const std::size_t second = first + 2 + first_size + 1;
  const std::string start("\0\0\0\1", 4);
  const std::string parameters = start + description.substr(first + 2, first_size) + start +
                                 description.substr(second + 2, Number(description, second, 2));
  if (!samples.empty()) samples[0] = parameters + samples[0];
  return samples;
}

class Decoder {
 public:
  Decoder() {
    EXPECT_EQ(WelsCreateDecoder(&decoder_), 0);
    SDecodingParam parameters{};
    parameters.sVideoProperty.eVideoBsType = VIDEO_BITSTREAM_AVC;
    EXPECT_EQ(decoder_->Initialize(&parameters), cmResultSuccess);
  }
  ~Decoder() {
    decoder_->Uninitialize();
    WelsDestroyDecoder(decoder_);
  }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  // Mean luma of every picture, in the order of the film. The decoder may keep some back.
  std::vector<double> MeanLumas(const std::vector<std::string>& samples) {
    for (const std::string& sample : samples) {
      const auto* bytes = reinterpret_cast<const unsigned char*>(sample.data());
      unsigned char* planes[3] = {};
      SBufferInfo info{};
      EXPECT_EQ(decoder_->DecodeFrameNoDelay(bytes, static_cast<int>(sample.size()), planes, &info),
                dsErrorFree);
      Take(planes, info);
    }
    int kept = 0;
    decoder_->GetOption(DECODER_OPTION_NUM_OF_FRAMES_REMAINING_IN_BUFFER, &kept);
    for (; kept > 0; --kept) {
      unsigned char* planes[3] = {};
      SBufferInfo info{};
      EXPECT_EQ(decoder_->FlushFrame(planes, &info), dsErrorFree);
      Take(planes, info);
    }
    return lumas_;
  }

 private:
  void Take(unsigned char* const planes[3], const SBufferInfo& info) {
    if (info.iBufferStatus != 1) return;
    const SSysMEMBuffer& buffer = info.UsrData.sSystemBuffer;
    EXPECT_EQ(buffer.iWidth, kVideoWidth);
    EXPECT_EQ(buffer.iHeight, kVideoHeight);
    double sum = 0.0;
    for (int y = 0; y < buffer.iHeight; ++y) {
      for (int x = 0; x < buffer.iWidth; ++x) sum += planes[0][y * buffer.iStride[0] + x];
    }
    lumas_.push_back(sum / (kVideoWidth * kVideoHeight));
  }

  ISVCDecoder* decoder_ = nullptr;
  std::vector<double> lumas_;
};

// Grey, another one than in the frame before by 7 or more.
std::uint8_t GreyOf(int index) { return static_cast<std::uint8_t>(40 + 7 * index % 200); }

Image GreyFrame(int index) {
  Image image{kVideoWidth, kVideoHeight, {}};
  image.rgb.assign(kBytesOfPixel * kVideoWidth * kVideoHeight, GreyOf(index));
  return image;
}

std::string WriteVideo(const std::filesystem::path& path, int frames) {
  VideoFile video(path, kVideoWidth, kVideoHeight, kVideoRate);
  for (int i = 0; i < frames; ++i) video.Add(GreyFrame(i));
  video.Finish();
  return config::ReadFile(path);
}

TEST(VideoFile, EveryFrameIsDecodedInItsOrder) {
  constexpr int kFrames = 120;
  constexpr double kHalfStep = 4.0;  // of the quantiser 22 (H.264, 8.5.9: 8)
  const testing::TemporaryFolder folder;
  const std::string file = WriteVideo(folder.path() / "grey.mp4", kFrames);
  const std::vector<std::string> samples = SamplesOf(file);
  ASSERT_EQ(samples.size(), static_cast<std::size_t>(kFrames));
  const std::vector<double> lumas = Decoder().MeanLumas(samples);
  ASSERT_EQ(lumas.size(), static_cast<std::size_t>(kFrames));
  for (int i = 0; i < kFrames; ++i) {
    const double expected = 16.0 + 219.0 * GreyOf(i) / 255.0;
    EXPECT_NEAR(lumas[static_cast<std::size_t>(i)], expected, kHalfStep) << i;
  }
}

TEST(VideoFile, StatesSizeRateDurationAndKeyFrames) {
  constexpr int kFrames = 120;
  const testing::TemporaryFolder folder;
  auto boxes = BoxesOf(WriteVideo(folder.path() / "grey.mp4", kFrames));
  EXPECT_EQ(boxes["ftyp"].substr(0, 4), "isom");
  EXPECT_EQ(Number(boxes["moov/mvhd"], 12, 4), static_cast<std::uint64_t>(kVideoRate));
  EXPECT_EQ(Number(boxes["moov/mvhd"], 16, 4), static_cast<std::uint64_t>(kFrames));
  const std::string& track = boxes["moov/trak/tkhd"];
  EXPECT_EQ(Number(track, track.size() - 8, 2), static_cast<std::uint64_t>(kVideoWidth));
  EXPECT_EQ(Number(track, track.size() - 4, 2), static_cast<std::uint64_t>(kVideoHeight));
  const std::string& keys = boxes[kTable + "stss"];
  ASSERT_EQ(Number(keys, 4, 4), 3u);  // frames 1, 51, 101
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(Number(keys, 8 + 4 * i, 4), 1 + i * kKeyPeriod_s * kVideoRate);
  }
}

TEST(VideoFile, IsThereAsAWholeOrNotAtAll) {
  const testing::TemporaryFolder folder;
  const std::filesystem::path path = folder.path() / "grey.mp4";
  {
    VideoFile video(path, kVideoWidth, kVideoHeight, kVideoRate);
    video.Add(GreyFrame(0));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
  VideoFile video(path, kVideoWidth, kVideoHeight, kVideoRate);
  EXPECT_THROW(video.Finish(), std::invalid_argument);
  EXPECT_THROW(video.Add(Image{2, 2, std::vector<std::uint8_t>(12)}), std::invalid_argument);
  EXPECT_THROW(VideoFile("/no/such/folder/a.mp4", kVideoWidth, kVideoHeight, kVideoRate),
               UsageError);
}

TEST(Mp4, RefusesATrackThatCannotBe) {
  Mp4Track track{kVideoWidth, kVideoHeight, kVideoRate, {0x67, 1, 2, 3}, {0x68}, {}};
  EXPECT_NO_THROW((void)Movie(track));
  track.sequence_parameters.clear();
  EXPECT_THROW((void)Movie(track), std::invalid_argument);
  track = {0, kVideoHeight, kVideoRate, {0x67, 1, 2, 3}, {0x68}, {}};
  EXPECT_THROW((void)Movie(track), std::invalid_argument);
}

// Known values of BT.709: white, black, grey, and the primaries (rounded from the formula's own
// printed examples, BT.709-6 Table 3 item 3.4).
TEST(Yuv, ColoursHaveTheValuesOfBt709) {
  struct Known {
    std::uint8_t r, g, b;
    int y, cb, cr;
  };
  for (const Known& known : {Known{255, 255, 255, 235, 128, 128}, Known{0, 0, 0, 16, 128, 128},
                             Known{255, 0, 0, 63, 102, 240}, Known{0, 255, 0, 173, 42, 26},
                             Known{0, 0, 255, 32, 240, 118}}) {
    Image image{2, 2, {}};
    for (int i = 0; i < 4; ++i) image.rgb.insert(image.rgb.end(), {known.r, known.g, known.b});
    YuvPicture picture;
    ToYuv(image, &picture);
    EXPECT_EQ(picture.y, std::vector<std::uint8_t>(4, static_cast<std::uint8_t>(known.y)));
    EXPECT_EQ(picture.cb[0], known.cb);
    EXPECT_EQ(picture.cr[0], known.cr);
  }
  YuvPicture picture;
  EXPECT_THROW(ToYuv(Image{3, 2, std::vector<std::uint8_t>(18)}, &picture), std::invalid_argument);
}

}  // namespace
}  // namespace sinew::render
