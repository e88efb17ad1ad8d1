#include "tools/inspect/log_lines.h"

#include "components/base/types/printable.h"

namespace sinew::inspect {

LogReader::LogReader(const recording::IdlType& type)
    : time_ns_(type, "time_ns"), level_(type, "level"), name_(type, "name"), text_(type, "text") {}

LogText LogReader::Read(std::span<const std::byte> payload) const {
  return {time_ns_.AsInt(payload), static_cast<msg::LogLevel>(level_.AsInt(payload)),
          types::Printable(name_.AsText(payload)), types::Printable(text_.AsText(payload))};
}

}  // namespace sinew::inspect
