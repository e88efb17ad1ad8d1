// sinew-frozen-readout: stands in for sinew-rls: readouts that do not change, with the same
// configuration: as trained, or as another rls left them that this one has taken over from.
#include <sinew_idl/learning.h>

#include <array>
#include <optional>
#include <utility>

#include "components/learn/rls/file/rls_config.h"
#include "components/topics/node/node.h"
#include "components/topics/node/other_owner.h"
#include "components/topics/node/tick_loop.h"
#include "sim/stand_ins/participant/stands_in.h"

namespace {

using namespace sinew;

using Readouts = std::array<std::optional<msg::Readout>, 2>;  // SEA, PEA

// Version 0 is the readout as trained (docs/participants/rls.md).
msg::Readout ToReadout(const esn::Weights& weights, std::size_t network) {
  msg::Readout message;
  message.network = static_cast<std::uint8_t>(network);
  message.output_count = static_cast<std::uint8_t>(weights.readout.rows());
  message.feature_count = static_cast<std::uint16_t>(weights.readout.cols());
  for (Eigen::Index o = 0; o < weights.readout.rows(); ++o) {
    for (Eigen::Index i = 0; i < weights.readout.cols(); ++i) {
      message.weight.push_back(weights.readout(o, i));
    }
  }
  return message;
}

// The owner's, if it is of the same network.
void Adopt(msg::Readout&& owner, Readouts* readouts) {
  if (owner.network >= readouts->size()) return;
  std::optional<msg::Readout>& here = (*readouts)[owner.network];
  if (!here || here->weight.size() != owner.weight.size() ||
      here->output_count != owner.output_count || here->feature_count != owner.feature_count) {
    return;
  }
  here = std::move(owner);
}

}  // namespace

int main(int argc, char** argv) {
  esn::WeightsPaths given;
  const auto body = [&given](const node::Options& options, node::StopFlag& stop) {
    const rls::RlsConfig config = rls::LoadRlsConfig(options.config_path, given);
    Readouts trained;
    if (config.sea) trained[0] = ToReadout(*config.sea, 0);
    if (config.pea) trained[1] = ToReadout(*config.pea, 1);
    Readouts readouts = trained;

    node::Node node(stand_ins::StandsInFor("rls", options));
    node::TickLoop loop(node, stop);
    auto& state = loop.AddInput(node::kJointState);
    auto& reservoir = loop.AddInput(node::kReservoirState, {.delay_ticks = 1});
    auto output = node.MakeWriter(node::kReadout);
    auto report = node.MakeWriter(node::kAdaptationState);
    node::OtherOwner owner(node, node::kReadout);
    std::uint64_t session_id = 0;
    std::size_t network = readouts[0] ? 0 : 1;
    while (const auto tick = loop.Next()) {
      if (tick->session_id != session_id) {
        session_id = tick->session_id;
        readouts = trained;
      }
      while (auto other = owner.TakeNext(*tick)) Adopt(std::move(*other), &readouts);
      (void)owner.StandsBy(*tick);
      const bool counts = reservoir.fresh() && reservoir.value().feature_count > 0;
      const std::size_t asked = counts ? reservoir.value().network : network;
      if (asked < readouts.size() && readouts[asked]) network = asked;
      if (!readouts[network]) continue;  // the configuration names one network at least
      msg::AdaptationState adaptation;
      adaptation.state_tick = state.tick();
      adaptation.stale = tick->any_stale;
      adaptation.frozen = true;
      adaptation.output_count = readouts[network]->output_count;
      loop.Publish(output, *readouts[network], *tick);
      loop.Publish(report, adaptation, *tick);
    }
  };
  return node::RunParticipant(
      argc, argv, "frozen-readout", "Stands in for sinew-rls: the readouts as trained.", body,
      [&given](CLI::App& app) {
        node::AddOption(app, "--sea-weights", &given.sea,
                        "Weights of the network inside the backlash");
        node::AddOption(app, "--pea-weights", &given.pea, "Weights of the network outside");
      });
}
