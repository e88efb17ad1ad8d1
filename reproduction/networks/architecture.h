// The shape of a network that learns by gradients, and how many parameters it has.
//
//   dense  (4.27): layers of sizes inputs * memory, hidden..., outputs; the last one linear. With
//          memory 1 it is the source's FFNN, with a longer one its NNX (4.37), whose inputs are
//          u(t - memory + 1) ... u(t), the outputs not fed back.
//   lstm   (4.28)-(4.32): one layer of hidden[0] units that runs over the last `memory` samples
//          from a state of zero, then a linear layer on its last h.
//   gru    (4.33)-(4.36): the same with gated recurrent units with two biases, the reset gate
//          behind the product: m = tanh(W u + b + r (U h + b')). The source prints U (r h), where a
//          second bias would be the first one over again; its count (6.2) has two.
//
// Pure data; any thread.
#pragma once

#include <string>
#include <vector>

namespace sinew::networks {

enum class Kind { kDense, kLstm, kGru };
enum class Activation { kTanh, kRelu };  // of a dense network's hidden layers

struct Architecture {
  Kind kind = Kind::kDense;
  int inputs = 3;
  int outputs = 1;
  int memory = 1;             // samples that it sees, this one included; at least 1
  std::vector<int> hidden{};  // units; exactly one entry for lstm and gru
  Activation activation = Activation::kTanh;
  double dropout = 0.0;  // share of a dense network's hidden values that is left out in training

  // Throws std::invalid_argument naming the value that cannot be.
  void Check() const;
  // Sum of the sizes of all weight matrices with their biases.
  int ParameterCount() const;
  // "3-20-20-4-1", "lstm 10 over 12".
  std::string Text() const;
};

// One weight matrix, row by row, its bias the last column: out x in.
struct Block {
  int offset = 0;  // in the parameter vector
  int out = 0;
  int in = 0;
  int size() const { return out * in; }
};

// The matrices in the order in which they lie in the parameter vector. dense: one a layer.
// lstm: gates i, f, g, o below each other (4H x (inputs + H + 1)), output layer. gru: gates r, z, m
// of [u, 1], of [h, 1], output layer.
std::vector<Block> Blocks(const Architecture& architecture);

}  // namespace sinew::networks
