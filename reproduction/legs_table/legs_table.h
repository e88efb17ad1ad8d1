// Table 6.5: networks for the inverse dynamics of the biped, trained on its chirp squat.
//
// Inputs: position, velocity and acceleration of every joint (measured motion, differentiated
// without phase); targets: the drives' torques at the joints. The first 80 % of the recording train
// and the rest tests. Twice: with all twelve joints (36 inputs, 12 outputs), as the published
// parameter counts demand, and with the six pitch joints (18 and 6), as the source's text says.
//
// Trained as published would be: rate 0.001, 10 epochs, batch 32 (the source gives neither for this
// table; those are of table 6.3), ridge 0.01, the ESN's rho 0.95 and tau 0.066 (of table 6.3 as
// well). And fairly, as in the other tables: every model has the same number of draws of its
// hyper-parameters, assessed by the validation error of one training; then it is trained until
// that error stops falling. Every MSE is of targets normalised by mean and standard deviation of
// the training samples, the mean over the outputs.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "components/model/report/section.h"
#include "reproduction/networks/published.h"
#include "reproduction/networks/samples.h"

namespace sinew::reproduction {

struct LegsTableOptions {
  int seeds = 10;     // trainings of every model, >= 2
  int trials = 16;    // draws of hyper-parameters, >= 1; the first is the published setting
  int epochs = 100;   // most, where the validation error ends the training
  int patience = 10;  // epochs without a better one
  int threads = 2;
  std::uint64_t seed = 1;
};

// Of the recording, for all joints and for the pitch joints.
struct LegsData {
  int joints = 0;
  networks::Samples all;   // every training sample trains
  networks::Samples fair;  // the last fifth of them validates
};

struct LegsScores {
  std::vector<double> train_mse, test_mse, seconds;  // by seed
};

struct LegsModel {
  networks::PublishedModel plan;
  int joints = 0;
  int parameters = 0;
  std::string chosen;  // hyper-parameters, fair
  LegsScores published, fair;
};

// done, total: trainings. Throws std::invalid_argument.
std::vector<LegsModel> FillLegsTable(
    const std::vector<LegsData>& data, const LegsTableOptions& options,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

// data_text: a sentence on the recording. Throws std::invalid_argument without ESN and FFNN of 12
// joints.
report::Section LegsSection(const std::vector<LegsModel>& models, const LegsTableOptions& options,
                            const std::string& data_text);

}  // namespace sinew::reproduction
