#include "reproduction/networks/architecture.h"

#include <stdexcept>

namespace sinew::networks {

void Architecture::Check() const {
  const auto require = [](bool good, const std::string& name, const std::string& expected) {
    if (!good) throw std::invalid_argument(name + ": expected " + expected);
  };
  require(inputs >= 1, "inputs: " + std::to_string(inputs), "at least 1");
  require(outputs >= 1, "outputs: " + std::to_string(outputs), "at least 1");
  require(memory >= 1, "memory: " + std::to_string(memory), "at least 1");
  for (const int units : hidden) {
    require(units >= 1, "hidden: " + std::to_string(units), "at least 1");
  }
  require(kind == Kind::kDense || hidden.size() == 1,
          "hidden: " + std::to_string(hidden.size()) + " layers", "one in a recurrent network");
  require(dropout >= 0.0 && dropout < 1.0, "dropout: " + std::to_string(dropout),
          "0 up to below 1");
  require(dropout == 0.0 || kind == Kind::kDense, "dropout: " + std::to_string(dropout),
          "0 in a recurrent network");
}

std::vector<Block> Blocks(const Architecture& a) {
  std::vector<Block> blocks;
  int offset = 0;
  const auto add = [&](int out, int in) {
    blocks.push_back({offset, out, in});
    offset += out * in;
  };
  if (a.kind == Kind::kDense) {
    int in = a.inputs * a.memory;
    for (const int units : a.hidden) {
      add(units, in + 1);
      in = units;
    }
    add(a.outputs, in + 1);
    return blocks;
  }
  const int h = a.hidden.front();
  if (a.kind == Kind::kLstm) {
    add(4 * h, a.inputs + h + 1);
  } else {
    add(3 * h, a.inputs + 1);
    add(3 * h, h + 1);
  }
  add(a.outputs, h + 1);
  return blocks;
}

int Architecture::ParameterCount() const {
  Check();
  int count = 0;
  for (const Block& block : Blocks(*this)) count += block.size();
  return count;
}

std::string Architecture::Text() const {
  if (kind != Kind::kDense) {
    return std::string(kind == Kind::kLstm ? "lstm " : "gru ") + std::to_string(hidden.front()) +
           " over " + std::to_string(memory);
  }
  std::string text = std::to_string(inputs);
  if (memory > 1) text += "x" + std::to_string(memory);
  for (const int units : hidden) text += "-" + std::to_string(units);
  return text + "-" + std::to_string(outputs);
}

}  // namespace sinew::networks
