// Where the program `sinew` of this build is.
#pragma once

#include <string>

namespace sinew {

inline const std::string kSinew = std::string(SINEW_BIN_DIR) + "/sinew";

}  // namespace sinew
