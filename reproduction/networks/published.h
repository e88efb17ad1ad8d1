// The models of the published tables: their shapes, how they were trained, and what was published
// of them. Tables 6.1-6.5 and (6.1)-(6.16) of the source. Pure data.
//
// Where the source contradicts itself, `remark` says so and which reading stands here.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "reproduction/networks/architecture.h"
#include "reproduction/networks/reservoir.h"
#include "reproduction/networks/training.h"

namespace sinew::networks {

enum class Method { kLinear, kNet, kReservoir };

struct PublishedModel {
  std::string name;  // as in the table
  Method method = Method::kNet;
  bool wiener = false;    // the linear block's output is one more input
  int linear_inputs = 0;  // of the linear model or block
  int outputs = 1;
  Architecture net;           // kNet; inputs with the linear block's output
  ReservoirConfig reservoir;  // kReservoir
  TrainConfig training;       // kNet: as published
  int published_parameters = 0;
  double train_mse = 0.0, test_mse = 0.0, train_sd = 0.0, test_sd = 0.0;  // published; 0: none
  std::string remark;
};

std::vector<PublishedModel> Table62();                 // SEA: 3 inputs, 1 output
std::vector<PublishedModel> Table64();                 // PEA: 6 inputs, 1 output
std::vector<PublishedModel> Table65(int joints = 12);  // biped: 3 inputs a joint, 12 as counted

// The parameters that such a model has: the sizes of its weights, not the printed formula.
int CountParameters(const PublishedModel& model);

}  // namespace sinew::networks
