// The files of the page, read once at the start: what is not among them is not served.
//
// Set-up only; afterwards any thread may read.
#pragma once

#include <filesystem>
#include <map>
#include <string>

#include "tools/view/server.h"

namespace sinew::live {

class Page {
 public:
  // Reads that folder and the ones below. Throws UsageError when there is no index.html in it.
  explicit Page(const std::filesystem::path& folder);

  // "/" is index.html, in which @TOKEN@ becomes the token. Status 404: no such file.
  HttpReply Get(const std::string& path, const std::string& token) const;
  std::size_t size() const { return files_.size(); }

 private:
  std::map<std::string, HttpReply> files_;  // by path, "/main.js"
};

// "text/javascript" for "main.js"; application/octet-stream for what is not known.
std::string ContentType(const std::filesystem::path& file);

}  // namespace sinew::live
