// The search for the reservoir's hyper-parameters (Fig 6.7): size N, spectral radius rho, leak tau.
//
// Grid: the published ranges in equal steps, N 100-550, rho 0.75-1.25, tau 0.05-0.15. Random: the
// same ranges widened, drawn from the seed. Every point is a network with the published input
// variance and density, its readout fitted to the training samples; points are compared by their
// error on validation samples (the last fifth of every training piece), and the test error of the
// best is reported. Points that a file holds already are not computed again.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "components/model/report/picture.h"
#include "reproduction/network_tables/comparison.h"

namespace sinew::reproduction {

struct SearchOptions {
  networks::Task task = networks::Task::kSea;
  bool random = false;
  int steps = 10;    // of each axis of the grid, >= 2
  int points = 200;  // random
  int seeds = 1;     // reservoirs a point
  bool gcv = false;  // ridge strength by cross-validation instead of the published 0.01
  double duration_s = 0.0;
  int threads = 2;
  std::uint64_t seed = 1;  // of the data set, the draws and the first reservoir
};

struct SearchPoint {
  int neurons = 0;
  double spectral_radius = 0.0;
  double leak = 0.0;
  double validation_mse = -1.0;  // mean over the reservoirs; below 0: not computed yet
  double test_mse = -1.0;
  bool done() const { return validation_mse >= 0.0; }
};

// All points, in a fixed order, none computed. Throws std::invalid_argument.
std::vector<SearchPoint> PlanSearch(const SearchOptions& options);

// Computes what is not done yet. `save` is called in the calling thread about once a second and at
// the end. Throws std::invalid_argument.
void RunSearch(const SearchOptions& options, std::vector<SearchPoint>* points,
               const Progress& progress, const std::function<void()>& save);

// The best by validation error; nullptr when nothing is done.
const SearchPoint* Best(const std::vector<SearchPoint>& points);

// The state as text: a first line with the options, then CSV. Parsing throws std::invalid_argument
// with the line when the text is of other options or broken.
std::string FormatSearch(const SearchOptions& options, const std::vector<SearchPoint>& points);
void ResumeSearch(const SearchOptions& options, const std::string& text, const std::string& name,
                  std::vector<SearchPoint>* points);

// Fig 6.7: the error as colour over N, rho and tau.
report::Picture SearchPicture(const std::vector<SearchPoint>& points);

}  // namespace sinew::reproduction
