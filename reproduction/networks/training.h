// Training a network by Adam, a fixed number of epochs or until the validation error stops
// falling.
#pragma once

#include <cstdint>
#include <functional>

#include "reproduction/networks/adam.h"
#include "reproduction/networks/net.h"

namespace sinew::networks {

struct TrainConfig {
  int epochs = 1000;  // at most, when patience is set; >= 1
  int batch = 6600;   // samples an update; >= 1. At or above the training set: all of it
  AdamConfig adam;
  int patience = 0;        // epochs without a better validation error; 0: all epochs are run
  std::uint64_t seed = 1;  // of the order of samples in batches
};

struct TrainProgress {
  int epoch = 0;                // from 1
  double train_mse = 0.0;       // mean over the epoch's batches, normalised
  double validation_mse = 0.0;  // 0 without patience
};

struct TrainOutcome {
  int epochs = 0;               // that were run
  int best_epoch = 0;           // whose weights were kept
  double validation_mse = 0.0;  // of those; 0 without patience
  bool diverged = false;        // an error was not finite: the last good weights were kept
};

// Leaves the weights in net: the last ones, or with patience those of the best validation error.
// `report` is called after every epoch, and may end the training by false; may be empty. Throws
// std::invalid_argument: configuration, patience without validation samples.
TrainOutcome Train(const Samples& samples, const TrainConfig& config, Net<float>* net,
                   const std::function<bool(const TrainProgress&)>& report = {});

}  // namespace sinew::networks
