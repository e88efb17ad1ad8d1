#include "components/base/types/printable.h"

#include <boost/nowide/utf/convert.hpp>

namespace sinew::types {

namespace {

// Bytes of the control character at the beginning of the text; 0: there is none.
std::size_t ControlSize(std::string_view text, Lines lines) {
  const auto first = static_cast<unsigned char>(text.front());
  if (lines == Lines::kMany && (first == '\n' || first == '\t')) return 0;
  if (first < 0x20 || first == 0x7f) return 1;
  // U+0080 to U+009F in UTF-8.
  const bool c1 = first == 0xc2 && text.size() > 1 && static_cast<unsigned char>(text[1]) < 0xa0;
  return c1 ? 2 : 0;
}

void AppendName(unsigned char control, std::string* out) {
  constexpr char kDigits[] = "0123456789abcdef";
  switch (control) {
    case '\n':
      *out += "\\n";
      return;
    case '\r':
      *out += "\\r";
      return;
    case '\t':
      *out += "\\t";
      return;
    default:
      *out += {'\\', 'u', '0', '0', kDigits[control >> 4], kDigits[control & 15]};
  }
}

}  // namespace

bool IsPrintable(std::string_view text, Lines lines) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (ControlSize(text.substr(i), lines) > 0) return false;
  }
  return true;
}

std::string Printable(std::string_view text, Lines lines) {
  std::string out;
  out.reserve(text.size());
  while (!text.empty()) {
    const std::size_t size = ControlSize(text, lines);
    if (size > 0) {
      AppendName(static_cast<unsigned char>(text[size - 1]), &out);
    } else {
      out += text.front();
    }
    text.remove_prefix(size > 0 ? size : 1);
  }
  return out;
}

std::string Utf8(std::string_view text) {
  return boost::nowide::utf::convert_string<char>(text.data(), text.data() + text.size());
}

std::string Entities(std::string_view text) {
  std::string out;
  for (const char c : text) {
    switch (c) {
      case '&':
        out += "&amp;";
        break;
      case '<':
        out += "&lt;";
        break;
      case '>':
        out += "&gt;";
        break;
      case '"':
        out += "&quot;";
        break;
      default:
        out += c;
    }
  }
  return out;
}

}  // namespace sinew::types
