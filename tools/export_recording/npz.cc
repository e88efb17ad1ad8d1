#include "tools/export_recording/npz.h"

#include <minizip/zip.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <stdexcept>

namespace sinew::export_recording {
namespace {

constexpr std::size_t kNpyAlignment = 64;      // of the data, numpy/lib/format.py ARRAY_ALIGN
constexpr std::size_t kMagicSize = 10;         // magic, version, length of the header
constexpr std::size_t kWriteAtOnce = 1 << 30;  // minizip counts bytes in 32 bits
// 1 January 1980 in the format of DOS, ZIP's first day: equal recordings give equal files.
constexpr unsigned long kFirstDay = (1UL << 21) | (1UL << 16);

}  // namespace

std::string NpyHeader(const std::string& type, const std::vector<std::size_t>& shape) {
  std::string text = "{'descr': '" + type + "', 'fortran_order': False, 'shape': (";
  for (const std::size_t length : shape) text += std::to_string(length) + ",";
  text += "), }";
  const std::size_t unpadded = kMagicSize + text.size() + 1;
  text.append((kNpyAlignment - unpadded % kNpyAlignment) % kNpyAlignment, ' ');
  text += '\n';
  if (text.size() > std::numeric_limits<std::uint16_t>::max()) {
    throw std::invalid_argument("an array of " + std::to_string(shape.size()) +
                                " dimensions, expected fewer");
  }
  std::string out("\x93NUMPY\x01\x00", 8);
  out += static_cast<char>(text.size() & 0xFF);
  out += static_cast<char>(text.size() >> 8);
  return out + text;
}

NpzWriter::NpzWriter(const std::filesystem::path& path) : path_(path), file_(path) {
  zip_ = ::zipOpen64(file_.DescriptorPath().c_str(), APPEND_STATUS_CREATE);
  if (zip_ == nullptr) Fail("cannot be written");
}

NpzWriter::~NpzWriter() {
  if (zip_ != nullptr) ::zipClose(zip_, nullptr);
}

void NpzWriter::Fail(const std::string& what) const {
  const std::string reason = errno != 0 ? std::string(": ") + std::strerror(errno) : "";
  throw std::runtime_error(path_.string() + ": " + what + reason);
}

void NpzWriter::Add(const std::string& name, const std::string& type,
                    const std::vector<std::size_t>& shape, std::span<const std::byte> data) {
  const std::string header = NpyHeader(type, shape);
  zip_fileinfo info{};
  info.dosDate = kFirstDay;
  errno = 0;
  int status = ::zipOpenNewFileInZip64(zip_, (name + ".npy").c_str(), &info, nullptr, 0, nullptr, 0,
                                       nullptr, Z_DEFLATED, Z_BEST_SPEED, 1);
  if (status == ZIP_OK) {
    status = ::zipWriteInFileInZip(zip_, header.data(), static_cast<unsigned>(header.size()));
  }
  while (status == ZIP_OK && !data.empty()) {
    const std::size_t size = std::min(data.size(), kWriteAtOnce);
    status = ::zipWriteInFileInZip(zip_, data.data(), static_cast<unsigned>(size));
    data = data.subspan(size);
  }
  if (status == ZIP_OK) status = ::zipCloseFileInZip(zip_);
  if (status != ZIP_OK) Fail("array '" + name + "' cannot be written");
}

void NpzWriter::Commit() {
  errno = 0;
  const int status = ::zipClose(zip_, nullptr);
  zip_ = nullptr;
  if (status != ZIP_OK) Fail("cannot be written to its end");
  const std::string reason = file_.Commit();
  if (!reason.empty()) throw std::runtime_error(path_.string() + ": cannot be written: " + reason);
}

}  // namespace sinew::export_recording
