#include "components/record/recording/compression.h"

#include <lz4frame.h>
#include <zstd.h>

#include <algorithm>
#include <boost/crc.hpp>
#include <memory>
#include <new>
#include <stdexcept>

namespace sinew::recording {
namespace {

constexpr std::size_t kStep = 1u << 16;

std::string Unzstd(std::span<const std::byte> bytes, std::uint64_t size,
                   std::vector<std::byte>* out) {
  const std::unique_ptr<ZSTD_DCtx, decltype(&ZSTD_freeDCtx)> context(ZSTD_createDCtx(),
                                                                     &ZSTD_freeDCtx);
  if (!context) throw std::bad_alloc();
  ZSTD_inBuffer input{bytes.data(), bytes.size(), 0};
  std::size_t written = 0;
  bool frame_ends = false;
  while (!frame_ends || input.pos < input.size) {
    if (out->size() - written < kStep) {
      out->resize(
          std::min<std::uint64_t>(std::max<std::uint64_t>(2 * out->size(), kStep), size + 1));
    }
    ZSTD_outBuffer output{out->data(), out->size(), written};
    const std::size_t before = input.pos;
    const std::size_t result = ZSTD_decompressStream(context.get(), &output, &input);
    if (ZSTD_isError(result)) return std::string("zstd: ") + ZSTD_getErrorName(result);
    frame_ends = result == 0;
    const bool stuck = output.pos == written && input.pos == before;
    written = output.pos;
    if (written > size) return "more data than the chunk declares";
    if (stuck && !frame_ends) return "zstd: the data ends early";
  }
  if (written != size) return "less data than the chunk declares";
  out->resize(written);
  return {};
}

std::string Unlz4(std::span<const std::byte> bytes, std::uint64_t size,
                  std::vector<std::byte>* out) {
  LZ4F_dctx* raw = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&raw, LZ4F_VERSION))) throw std::bad_alloc();
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> context(
      raw, &LZ4F_freeDecompressionContext);
  std::size_t read = 0;
  std::size_t written = 0;
  bool frame_ends = false;
  while (!frame_ends || read < bytes.size()) {
    if (out->size() - written < kStep) {
      out->resize(
          std::min<std::uint64_t>(std::max<std::uint64_t>(2 * out->size(), kStep), size + 1));
    }
    std::size_t taken = bytes.size() - read;
    std::size_t given = out->size() - written;
    const std::size_t result = LZ4F_decompress(context.get(), out->data() + written, &given,
                                               bytes.data() + read, &taken, nullptr);
    if (LZ4F_isError(result)) return std::string("lz4: ") + LZ4F_getErrorName(result);
    frame_ends = result == 0;
    read += taken;
    written += given;
    if (written > size) return "more data than the chunk declares";
    if (taken == 0 && given == 0 && !frame_ends) return "lz4: the data ends early";
  }
  if (written != size) return "less data than the chunk declares";
  out->resize(written);
  return {};
}

}  // namespace

std::string_view CompressionName(Compression compression) {
  switch (compression) {
    case Compression::kNone:
      return "";
    case Compression::kLz4:
      return "lz4";
    case Compression::kZstd:
      return "zstd";
  }
  return "";
}

void Compress(Compression compression, std::span<const std::byte> bytes,
              std::vector<std::byte>* out) {
  const std::size_t start = out->size();
  switch (compression) {
    case Compression::kNone:
      out->insert(out->end(), bytes.begin(), bytes.end());
      return;
    case Compression::kZstd: {
      out->resize(start + ZSTD_compressBound(bytes.size()));
      const std::size_t size = ZSTD_compress(out->data() + start, out->size() - start, bytes.data(),
                                             bytes.size(), /*level=*/1);
      if (ZSTD_isError(size))
        throw std::runtime_error(std::string("zstd: ") + ZSTD_getErrorName(size));
      out->resize(start + size);
      return;
    }
    case Compression::kLz4: {
      out->resize(start + LZ4F_compressFrameBound(bytes.size(), nullptr));
      const std::size_t size = LZ4F_compressFrame(out->data() + start, out->size() - start,
                                                  bytes.data(), bytes.size(), nullptr);
      if (LZ4F_isError(size))
        throw std::runtime_error(std::string("lz4: ") + LZ4F_getErrorName(size));
      out->resize(start + size);
      return;
    }
  }
}

std::string Decompress(std::string_view compression, std::span<const std::byte> bytes,
                       std::uint64_t size, std::vector<std::byte>* out) {
  out->clear();
  if (compression.empty()) {
    if (bytes.size() != size) return "an uncompressed chunk of another size than it declares";
    out->assign(bytes.begin(), bytes.end());
    return {};
  }
  if (size > MostUncompressed(bytes.size())) {
    return std::to_string(bytes.size()) + " compressed bytes are said to hold " +
           std::to_string(size) + ", expected at most " +
           std::to_string(MostUncompressed(bytes.size()));
  }
  if (compression == "zstd") return Unzstd(bytes, size, out);
  if (compression == "lz4") return Unlz4(bytes, size, out);
  return "compression '" + std::string(compression) + "', expected zstd, lz4 or none";
}

std::uint32_t Crc32(std::span<const std::byte> bytes) {
  boost::crc_32_type crc;
  crc.process_bytes(bytes.data(), bytes.size());
  return crc.checksum();
}

}  // namespace sinew::recording
