// Results of `sinew experiment --json`.
#pragma once

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

namespace sinew::testing {

// Value of one of the quantities; 0 and a failure when it is not there.
inline double ValueOf(const nlohmann::json& result, const std::string& id) {
  for (const nlohmann::json& q : result.value("quantities", nlohmann::json::array())) {
    if (q.value("id", "") == id) return q.value("value", 0.0);
  }
  ADD_FAILURE() << "no " << id << " in " << result.dump();
  return 0.0;
}

}  // namespace sinew::testing
