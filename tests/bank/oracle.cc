#include "tests/bank/oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "components/identify/fit.h"
#include "components/trace/candidates.h"
#include "components/trace/units.h"

namespace sinew::bank {
namespace {

// Terms of the true structure; several where one mechanism has several orders.
std::vector<std::vector<double>> OracleSettings(const std::string& effect) {
  if (effect == "cogging") return {{14.0}, {7.0}, {28.0}};
  if (effect == "gear_eccentricity") return {{2.0}, {1.0}};
  return {};
}

}  // namespace

std::optional<effects::Balance> BalanceOf(const std::string& effect,
                                          const actuator::JointModel& model) {
  std::optional<effects::Balance> out;
  for (const auto& [name, balance] : effects::EffectForms()) {
    if (name != effect || effects::MakeEffect(name, model.constants, balance)->info().event) {
      continue;
    }
    // What bends between the encoders shows between the encoders.
    const bool better = balance == effects::Balance::kKinematic && effect == "gear_compliance";
    if (!out || better) out = balance;
  }
  return out;
}

const actuator::ParameterValue& MainParameter(const actuator::Term& term) {
  return *std::max_element(
      term.linear.begin(), term.linear.end(),
      [](const actuator::ParameterValue& a, const actuator::ParameterValue& b) {
        return std::abs(a.value) < std::abs(b.value);
      });
}

Oracle FitOracle(identify::Design* design, const actuator::JointModel& declared,
                 const std::vector<std::string>& names) {
  const std::vector<identify::Block> blocks = trace::ChooseUnits(*design, 0.5, 20).blocks;
  actuator::JointModel model = identify::FitModel(*design, declared, blocks).model;
  design->PredictDrive(model);
  const std::size_t first = model.terms.size();
  for (const std::string& name : names) {
    actuator::Term term = actuator::MakeTerm(name, model.constants, declared.balance);
    term.declared = false;
    std::vector<std::vector<double>> settings = OracleSettings(name);
    const bool all = !settings.empty();
    if (!all) settings = trace::GridOf(term.effect->info());
    actuator::JointModel best;
    double least = std::numeric_limits<double>::infinity();
    for (const std::vector<double>& psi : settings) {
      for (std::size_t i = 0; i < psi.size(); ++i) term.nonlinear[i].value = psi[i];
      for (std::size_t i = 0; i < psi.size(); ++i) {  // counts stay whole
        term.nonlinear[i].fixed =
            all || term.effect->info().nonlinear[i].dimension == effects::Dimension::kNone;
      }
      if (all) {
        model.terms.push_back(term);
        continue;
      }
      actuator::JointModel trial = model;
      trial.terms.push_back(term);
      const identify::FitResult fit = identify::FitModel(*design, trial, blocks);
      if (fit.rms < least) {
        least = fit.rms;
        best = fit.model;
      }
    }
    if (!all) model = std::move(best);
  }
  identify::FitResult fit = identify::RefineModel(*design, model, blocks);
  design->PredictDrive(fit.model);
  fit = identify::RefineModel(*design, fit.model, blocks);
  Oracle oracle{.model = fit.model, .rms = fit.rms};
  for (std::size_t t = first; t < fit.model.terms.size(); ++t) {
    for (const actuator::ParameterValue& value : fit.model.terms[t].linear) {
      if (value.half_width_95 && std::abs(value.value) > *value.half_width_95) {
        oracle.significant = true;
      }
    }
  }
  oracle.value = MainParameter(fit.model.terms[first]).value;
  return oracle;
}

}  // namespace sinew::bank
