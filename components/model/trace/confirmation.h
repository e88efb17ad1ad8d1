// Held-out confirmation of an effect, by a test that is fixed before it is run.
//
// The model without the effect and the model with it are fitted to the training recordings. On the
// held-out ones r is what the first leaves and d the change that the second predicts, both
// whitened. The slope of r on d is 1 for an effect that is there with the size that training gave
// it, 0 for one that is not, negative for one that makes the prediction worse:
//
//     s = d'r / d'd,   standard error from the scores d_b'(r_b - s d_b) of blocks b
//
// A fixed share of the training gain would be wrong: the held-out motion may excite the effect
// less. Pure; allocates.
#pragma once

#include <string_view>

#include "components/model/identify/balance.h"
#include "components/model/trace/rules.h"
#include "components/model/trace/whitened_fit.h"

namespace sinew::trace {

enum class ConfirmationVerdict { kNotConfirmed, kConfirmed, kRefuted };

// "confirmed", "not confirmed", "refuted".
std::string_view ConfirmationWord(ConfirmationVerdict verdict);

// The verdict is that of the score (facts.h).
struct Confirmation {
  ConfirmationVerdict verdict = ConfirmationVerdict::kNotConfirmed;
  double slope = 0.0;
  double lower = 0.0, upper = 0.0;  // 95 %
  int blocks = 0;
};

// From whitened left-over and predicted change; no interval from fewer blocks than the rule
// held_out_blocks asks for.
Confirmation ConfirmSlope(const Eigen::Ref<const Eigen::VectorXd>& left_over,
                          const Eigen::Ref<const Eigen::VectorXd>& change,
                          const std::vector<identify::Block>& blocks, const InForce& in_force);

// without, with: fitted to the training recordings, of the same declared terms; the drive of
// held_out must be predicted by `with`.
Confirmation ConfirmSlope(const identify::Design& held_out, const identify::FitResult& without,
                          const identify::FitResult& with, const InForce& in_force);

}  // namespace sinew::trace
