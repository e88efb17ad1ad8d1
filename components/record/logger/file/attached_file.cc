#include "components/record/logger/file/attached_file.h"

#include <openssl/evp.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <stdexcept>
#include <vector>

namespace sinew::logger {

namespace fs = std::filesystem;

namespace {

std::string MediaType(const fs::path& file) {
  static const std::map<std::string, std::string> kTypes = {
      {".yaml", "application/yaml"}, {".yml", "application/yaml"}, {".json", "application/json"},
      {".urdf", "application/xml"},  {".xml", "application/xml"},  {".csv", "text/csv"},
      {".idl", "text/plain"},        {".txt", "text/plain"}};
  const auto found = kTypes.find(file.extension().string());
  return found == kTypes.end() ? "application/octet-stream" : found->second;
}

// Hash of the whole file; its first kLargestAttachment + 1 bytes go to `text`.
std::string HashFile(const fs::path& file, std::string* text, std::uintmax_t* size) {
  std::ifstream in(file, std::ios::binary);
  if (!in || !fs::is_regular_file(file)) {
    throw UsageError("--attach: " + file.string() + ": cannot be read, expected a file");
  }
  const std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context(EVP_MD_CTX_new(),
                                                                        &EVP_MD_CTX_free);
  if (context == nullptr || EVP_DigestInit_ex(context.get(), EVP_sha256(), nullptr) != 1) {
    throw std::runtime_error("OpenSSL has no SHA-256");
  }
  std::vector<char> block(1u << 16);
  *size = 0;
  while (in.read(block.data(), static_cast<std::streamsize>(block.size())) || in.gcount() > 0) {
    const auto got = static_cast<std::size_t>(in.gcount());
    EVP_DigestUpdate(context.get(), block.data(), got);
    if (*size <= kLargestAttachment) text->append(block.data(), got);
    *size += got;
  }
  if (in.bad()) throw UsageError("--attach: " + file.string() + ": cannot be read to its end");
  unsigned char digest[EVP_MAX_MD_SIZE];
  unsigned int digest_size = 0;
  EVP_DigestFinal_ex(context.get(), digest, &digest_size);
  constexpr char kDigits[] = "0123456789abcdef";
  std::string hash;
  for (unsigned int i = 0; i < digest_size; ++i) {
    hash += kDigits[digest[i] >> 4];
    hash += kDigits[digest[i] & 15];
  }
  return hash;
}

}  // namespace

AttachedFile ReadAttachedFile(const std::string& text) {
  fs::path file = text;
  std::string name = file.filename().string();
  const std::size_t equals = text.find('=');
  if (equals != std::string::npos && equals > 0 && !fs::exists(file)) {
    name = text.substr(0, equals);
    file = text.substr(equals + 1);
  }
  AttachedFile attached;
  attached.name = name;
  std::string content;
  attached.sha256 = HashFile(file, &content, &attached.bytes);
  attached.attached = attached.bytes <= kLargestAttachment;
  if (attached.attached) attached.attachment = {name, MediaType(file), 0, std::move(content)};
  return attached;
}

}  // namespace sinew::logger
