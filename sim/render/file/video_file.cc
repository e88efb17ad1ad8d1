#include "sim/render/file/video_file.h"

#include <wels/codec_api.h>

#include <stdexcept>
#include <string>

#include "components/base/config/config.h"
#include "components/record/recording/file/file_io.h"
#include "sim/render/mp4.h"
#include "sim/render/yuv.h"

namespace sinew::render {

namespace {

// Quantiser of H.264, 0 (exact) to 51: at 22 a picture of even surfaces shows no blocks.
constexpr int kQuantiser = 22;

// Kinds of NAL units, H.264 Table 7-1.
constexpr int kKeySlice = 5, kSequenceParameters = 7, kPictureParameters = 8;

SEncParamExt Parameters(ISVCEncoder* encoder, int width, int height, int frames_per_s) {
  SEncParamExt out;
  encoder->GetDefaultParams(&out);
  out.iUsageType = CAMERA_VIDEO_REAL_TIME;
  out.iPicWidth = width;
  out.iPicHeight = height;
  out.fMaxFrameRate = static_cast<float>(frames_per_s);
  out.iRCMode = RC_OFF_MODE;  // a quantiser instead of a bit rate
  out.bEnableFrameSkip = false;
  out.bEnableAdaptiveQuant = false;
  out.bEnableBackgroundDetection = false;  // leaves specks where something has moved away
  out.bEnableSceneChangeDetect = false;
  out.iComplexityMode = HIGH_COMPLEXITY;
  out.uiIntraPeriod = static_cast<unsigned int>(kKeyPeriod_s * frames_per_s);
  out.eSpsPpsIdStrategy = CONSTANT_ID;
  out.iEntropyCodingModeFlag = 1;  // CABAC
  out.iMultipleThreadIdc = 1;      // none but the caller's
  SSpatialLayerConfig& layer = out.sSpatialLayers[0];
  layer.iVideoWidth = width;
  layer.iVideoHeight = height;
  layer.fFrameRate = out.fMaxFrameRate;
  layer.uiProfileIdc = PRO_MAIN;
  layer.iDLayerQp = kQuantiser;
  layer.sSliceArgument.uiSliceMode = SM_SINGLE_SLICE;
  layer.bVideoSignalTypePresent = true;  // as yuv.h
  layer.uiVideoFormat = VF_UNDEF;
  layer.bFullRange = false;
  layer.bColorDescriptionPresent = true;
  layer.uiColorPrimaries = CP_BT709;
  layer.uiTransferCharacteristics = TRC_BT709;
  layer.uiColorMatrix = CM_BT709;
  return out;
}

// A NAL unit without its start code, 00 00 01 or 00 00 00 01.
std::span<const std::uint8_t> WithoutStartCode(std::span<const std::uint8_t> unit) {
  std::size_t zeros = 0;
  while (zeros < unit.size() && unit[zeros] == 0) ++zeros;
  return unit.subspan(std::min(zeros + 1, unit.size()));
}

}  // namespace

struct VideoFile::Impl {
  struct DeleteEncoder {
    void operator()(ISVCEncoder* made) const {
      made->Uninitialize();
      WelsDestroySVCEncoder(made);
    }
  };

  Impl(const std::filesystem::path& out_path, int width, int height, int frames_per_s)
      : path(out_path), sink(out_path) {
    track.width = width;
    track.height = height;
    track.frames_per_s = frames_per_s;
    if (frames_per_s < 1) throw std::invalid_argument("a video needs a rate of frames above 0");
    ISVCEncoder* made = nullptr;
    if (WelsCreateSVCEncoder(&made) != 0 || made == nullptr) {
      throw std::runtime_error("video: no H.264 encoder");
    }
    encoder.reset(made);
    int quiet = WELS_LOG_QUIET;
    encoder->SetOption(ENCODER_OPTION_TRACE_LEVEL, &quiet);
    const SEncParamExt parameters = Parameters(made, width, height, frames_per_s);
    if (encoder->InitializeExt(&parameters) != cmResultSuccess) {
      throw std::runtime_error("video: the H.264 encoder refuses " + std::to_string(width) + " x " +
                               std::to_string(height) + " pixels");
    }
    Write(FileType());
  }

  void Write(const Octets& octets) {
    const recording::IoStatus status = sink.Write(std::as_bytes(std::span(octets)));
    if (!status.ok()) throw UsageError(path.string() + ": " + status.message());
    written += octets.size();
  }

  void WriteChunk() {
    if (chunk.samples.empty()) return;
    chunk.offset = written + kMediaDataHeader;
    Write(MediaData(chunk_octets));
    track.chunks.push_back(std::move(chunk));
    chunk = {};
    chunk_octets.clear();
  }

  void Encode(const Image& image) {
    if (image.width != track.width || image.height != track.height) {
      throw std::invalid_argument("a frame of " + std::to_string(image.width) + " x " +
                                  std::to_string(image.height) + " pixels, expected " +
                                  std::to_string(track.width) + " x " +
                                  std::to_string(track.height));
    }
    ToYuv(image, &yuv);
    SSourcePicture source{};
    source.iColorFormat = videoFormatI420;
    source.iPicWidth = yuv.width;
    source.iPicHeight = yuv.height;
    source.iStride[0] = yuv.width;
    source.iStride[1] = source.iStride[2] = yuv.width / 2;
    source.pData[0] = yuv.y.data();
    source.pData[1] = yuv.cb.data();
    source.pData[2] = yuv.cr.data();
    source.uiTimeStamp = 1000 * frames / track.frames_per_s;  // ms
    SFrameBSInfo encoded{};
    if (encoder->EncodeFrame(&source, &encoded) != cmResultSuccess) {
      throw std::runtime_error("video: frame " + std::to_string(frames) + " is not encoded");
    }
    ++frames;
    TakeFrame(encoded);
  }

  void TakeFrame(const SFrameBSInfo& encoded) {
    Octets sample;
    bool key = false;
    for (int i = 0; i < encoded.iLayerNum; ++i) {
      const SLayerBSInfo& layer = encoded.sLayerInfo[i];
      const std::uint8_t* at = layer.pBsBuf;
      for (int k = 0; k < layer.iNalCount; ++k) {
        const auto length = static_cast<std::size_t>(layer.pNalLengthInByte[k]);
        const std::span<const std::uint8_t> unit = WithoutStartCode({at, length});
        at += length;
        if (unit.empty()) continue;
        const int kind = unit[0] & 0x1f;
        if (kind == kSequenceParameters) {
          track.sequence_parameters.assign(unit.begin(), unit.end());
        } else if (kind == kPictureParameters) {
          track.picture_parameters.assign(unit.begin(), unit.end());
        } else {
          key = key || kind == kKeySlice;
          AppendNalUnit(unit, &sample);
        }
      }
    }
    if (key) WriteChunk();  // a chunk begins with a key frame
    chunk.samples.push_back({sample.size(), key});
    chunk_octets.insert(chunk_octets.end(), sample.begin(), sample.end());
  }

  std::filesystem::path path;
  recording::WholeFileSink sink;
  std::unique_ptr<ISVCEncoder, DeleteEncoder> encoder;
  Mp4Track track;
  Mp4Chunk chunk;  // not yet written
  Octets chunk_octets;
  std::uint64_t written = 0;
  long long frames = 0;
  YuvPicture yuv;
};

VideoFile::VideoFile(const std::filesystem::path& path, int width, int height, int frames_per_s)
    : impl_(std::make_unique<Impl>(path, width, height, frames_per_s)) {}

VideoFile::~VideoFile() = default;

void VideoFile::Add(const Image& image) { impl_->Encode(image); }

void VideoFile::Finish() {
  if (impl_->frames == 0) throw std::invalid_argument("video: no frame");
  impl_->WriteChunk();
  impl_->Write(Movie(impl_->track));
  const recording::IoStatus status = impl_->sink.Commit();
  if (!status.ok()) throw UsageError(impl_->path.string() + ": " + status.message());
}

}  // namespace sinew::render
