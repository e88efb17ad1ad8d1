// The topics of a domain as a table for people. Pure.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace sinew::inspect {

// A writer with its readers; or the readers of a topic without writers.
struct TopicRow {
  std::string topic;
  std::string type;
  std::string writer;  // "-": none
  std::string qos;
  std::vector<std::string> readers;  // that match
  struct Unmatched {
    std::string reader;
    std::vector<std::string> reasons;
  };
  std::vector<Unmatched> unmatched;
};

// The type as idl/README.md names it ("JointState") when it is the one that this build uses for the
// topic; else all of its registered name.
std::string DisplayedType(const std::string& topic, const std::string& registered_type);

// Headings and a row for each entry; the type only where it differs from the row above of the same
// topic. Readers that do not match follow in lines of their own, with the reasons. Lines are at
// most `width` characters long, unless a single word or reason is longer.
std::string FormatTopicTable(const std::vector<TopicRow>& rows, std::size_t width);

}  // namespace sinew::inspect
