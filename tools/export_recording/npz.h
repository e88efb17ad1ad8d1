// NumPy's .npz: a ZIP file with one array a member, each in the NPY format
// (numpy/lib/format.py, version 1.0). Written beside its place and renamed when it is whole.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "components/base/config/whole_file.h"

namespace sinew::export_recording {

// The bytes before the data of an array. type: NumPy's, "<f8", "|b1", "|S5"; shape: rows first,
// C order. Throws std::invalid_argument for a header beyond the 65 535 bytes of version 1.0.
std::string NpyHeader(const std::string& type, const std::vector<std::size_t>& shape);

// Throws std::runtime_error naming the file when it cannot be written (no access, a full disk);
// what was written is then removed. One thread.
class NpzWriter {
 public:
  explicit NpzWriter(const std::filesystem::path& path);
  ~NpzWriter();  // removes what was not committed
  NpzWriter(const NpzWriter&) = delete;
  NpzWriter& operator=(const NpzWriter&) = delete;

  // name: the key in numpy.load, without ".npy". data: as many bytes as type and shape say.
  void Add(const std::string& name, const std::string& type, const std::vector<std::size_t>& shape,
           std::span<const std::byte> data);
  void Commit();

 private:
  void Fail(const std::string& what) const;

  std::filesystem::path path_;
  config::WholeFile file_;
  void* zip_ = nullptr;  // of minizip
};

}  // namespace sinew::export_recording
