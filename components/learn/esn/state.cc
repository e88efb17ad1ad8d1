// The fields that are an object's state, once for both ways (types/state_archive.h).
#include "components/base/types/state_archive.h"
#include "components/learn/esn/predictor.h"

namespace sinew::esn {

void Frame::Exchange(types::StateArchive& archive) { archive(value_); }

// The rest is of the weights, or made anew in every step.
void Network::Exchange(types::StateArchive& archive) { archive(features_, readout_, prediction_); }

void Predictor::Slot::Exchange(types::StateArchive& archive) {
  archive(network, u, version, good, settled);
}

void Predictor::Exchange(types::StateArchive& archive) { archive(slots_); }

}  // namespace sinew::esn
