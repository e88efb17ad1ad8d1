// Between the topics and the predictor.
#pragma once

#include <sinew_idl/actuator.h>
#include <sinew_idl/joint.h>
#include <sinew_idl/learning.h>
#include <sinew_idl/reference.h>
#include <sinew_idl/regime.h>

#include "components/base/types/regime.h"
#include "components/learn/esn/predictor.h"

namespace sinew::esn {

// Signals of a message into the frame. Values of a joint that its message calls lost are its last
// known ones and are taken; the caller marks the prediction stale. False: some joint was lost.
bool FillFrom(const msg::JointState& message, Frame* frame);
bool FillFrom(const msg::ActuatorState& message, Frame* frame);
bool FillFrom(const msg::Reference& message, Frame* frame);
// The play angle is known while the regime is.
bool FillFrom(const msg::RegimeState& message, Frame* frame);

// Regime of the first joint.
types::Regime RegimeOf(const msg::RegimeState& message);

// Takes the readout of a message unless it is the one in use. False: it does not fit the network.
bool TakeReadout(const msg::Readout& message, Predictor* predictor);

msg::TorquePrediction ToMessage(const Prediction& prediction);
// Features of the network that counted; feature_count 0: none did.
msg::ReservoirState ReservoirMessage(const Prediction& prediction, const Predictor& predictor);

}  // namespace sinew::esn
