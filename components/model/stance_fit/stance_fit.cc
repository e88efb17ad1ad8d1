#include "components/model/stance_fit/stance_fit.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "components/model/identify/uniform.h"
#include "components/model/stance_fit/stance_problem.h"
#include "components/model/stance_fit/stance_sizes.h"
#include "components/model/trace/assessment.h"
#include "components/model/trace/facts.h"
#include "components/model/trace/rules.h"
#include "components/model/trace/sensitivity.h"
#include "components/model/trace/set_search.h"

namespace sinew::stance_fit {

namespace {

using trace::EffectSet;
using trace::Hypothesis;
namespace rules = trace::rules;

std::string EffectName(const Hypothesis& h) { return h.effect->info().name; }

actuator::Payload Written(const PlacedPayload& payload) {
  actuator::Payload out;
  out.link = payload.link_name;
  out.mass_kg = payload.mass_kg;
  out.declared = false;
  out.half_width_95 = payload.mass_half_width_95;
  Eigen::Map<Eigen::Vector3d>(out.position_m.data()) = payload.place_m;
  out.position_half_width_95.emplace();
  Eigen::Map<Eigen::Vector3d>(out.position_half_width_95->data()) = payload.place_half_width_95;
  return out;
}

// Adds a term; what the joint has of the effect already grows by it.
void AddTerm(const actuator::Term& term, actuator::JointModel* joint) {
  const int known =
      term.nonlinear.empty() ? joint->Find(term.effect->info().name, joint->balance) : -1;
  if (known < 0) {
    joint->terms.push_back(term);
    return;
  }
  actuator::Term& declared = joint->terms[static_cast<std::size_t>(known)];
  for (std::size_t i = 0; i < declared.linear.size(); ++i) {
    declared.linear[i].value += term.linear[i].value;
    declared.linear[i].half_width_95 = term.linear[i].half_width_95;
  }
}

class Closer {
 public:
  Closer(const StanceModel& model, const StanceOptions& options)
      : model_(model), options_(options) {}

  StanceFitResult Close(const std::vector<StanceRecording>& train,
                        const std::vector<StanceRecording>& held_out) {
    out_.corrected = model_.robot();
    try {
      layout_ = model_.Layout(train);
    } catch (const identify::TooLittleData& error) {
      return TooLittle(error.what());
    }
    for (const StanceRecording& recording : train) rows_.push_back(model_.Rows(recording, layout_));
    for (const StanceRecording& recording : held_out) {
      held_out_rows_.push_back(model_.Rows(recording, layout_));
    }
    regression_ = MakeRegression(model_, layout_, rows_, options_.tolerances);
    regression_.bank.in_force = options_.in_force;
    out_.rows = static_cast<std::size_t>(regression_.time_s.size());
    out_.blocks = regression_.blocks.size();
    out_.channels = layout_.channels();
    out_.low_pass_Hz = layout_.processing.front().state_cutoff_Hz;
    if (static_cast<double>(out_.blocks) < options_.in_force.Limit(rules::kBlocks)) {
      return TooLittle("the recordings have " + std::to_string(out_.blocks) +
                       " blocks of rows in use, expected " +
                       std::to_string(static_cast<int>(options_.in_force.Limit(rules::kBlocks))));
    }
    const int order =
        trace::LongestOrder(layout_.rate_Hz / layout_.processing.front().state_cutoff_Hz);
    const ChannelNoise noise = EstimateNoise(regression_, order);
    const trace::Problem problem = MakeProblem(regression_, noise);
    const trace::BootstrapOptions bootstrap{.seed = options_.seed};
    std::set<std::string> refuted;
    constexpr int kSearches = 3;  // the first, and two without what was dropped or refuted
    for (int search = 0; search < kSearches; ++search) {
      const trace::SetAssessment found =
          trace::AssessSets(problem, regression_.blocks, effects::Balance::kMotion,
                            trace::kLargestSet, bootstrap, refuted);
      if (!out_.p_global) out_.p_global = found.p_global;
      if (search == 0) NoteDetectable(problem, found.least_statistic);
      Describe(problem, found);
      if (DropUncertain(found.chosen, &refuted)) {
        if (search + 1 == kSearches) Finish({});
        continue;
      }
      if (held_out_rows_.empty() || !Confirm(order, problem, found.chosen, &refuted)) {
        Finish(found.chosen);
        break;
      }
      if (search + 1 == kSearches) Finish({});
    }
    NoteNotExcited();
    return std::move(out_);
  }

 private:
  StanceFitResult TooLittle(const std::string& why) {
    out_.verdict = trace::Verdict::kTooLittleData;
    out_.too_little = why;
    return std::move(out_);
  }

  const Hypothesis& Of(const EffectSet& set, std::size_t k) const {
    return regression_.bank.hypotheses[set.members[k]];
  }

  std::string PlaceOf(const Subject& subject) const {
    if (subject.kind == Subject::Kind::kPayload) return layout_.groups[subject.index].name;
    if (subject.kind == Subject::Kind::kJoint) return model_.robot().joints[subject.index].name;
    return "feet";
  }

  PlainFit Fit(const std::vector<std::size_t>& members) const {
    trace::Columns columns;
    std::vector<PlacePrior> places;
    for (const std::size_t member : members) {
      const Subject& subject = regression_.subjects[member];
      if (subject.kind == Subject::Kind::kPayload) {
        const RigidGroup& group = layout_.groups[subject.index];
        places.push_back({static_cast<Eigen::Index>(columns.size()), group.excited, group.size_m});
      }
      const trace::Columns& own = regression_.bank.hypotheses[member].columns;
      columns.insert(columns.end(), own.begin(), own.end());
    }
    return FitPlain(regression_, columns, places);
  }

  void Describe(const trace::Problem& problem, const trace::SetAssessment& found) {
    out_.effects.clear();
    out_.unexplained = found.unexplained.variable;
    const PlainFit fit = Fit(found.chosen.members);
    Eigen::Index at = regression_.bank.declared.cols();
    for (std::size_t k = 0; k < found.chosen.members.size(); ++k) {
      const Hypothesis& h = Of(found.chosen, k);
      const Subject& subject = regression_.subjects[found.chosen.members[k]];
      StanceEffect effect;
      effect.name = EffectName(h);
      effect.place = PlaceOf(subject);
      effect.posterior = found.posteriors[k];
      effect.p = found.p_global;
      const EffectSet without = trace::WithoutMember(problem.choices(), found.chosen, k);
      effect.gain_share = (found.chosen.net - without.net) / problem.evidence.misfit();
      if (subject.kind == Subject::Kind::kPayload) {
        effect.payload = PayloadOf(fit, at, layout_.groups[subject.index]);
      } else {
        actuator::Term term =
            actuator::MakeTerm(effect.name, subject.kind == Subject::Kind::kJoint
                                                ? model_.robot().joints[subject.index].constants
                                                : effects::JointConstants{});
        term.declared = false;
        const std::vector<double>& psi = h.settings.front().psi;
        for (std::size_t i = 0; i < psi.size(); ++i) term.nonlinear[i].value = psi[i];
        for (std::size_t i = 0; i < term.linear.size(); ++i) {
          term.linear[i].value = fit.b[at + static_cast<Eigen::Index>(i)];
          term.linear[i].half_width_95 = fit.HalfWidth(at + static_cast<Eigen::Index>(i));
        }
        effect.term = std::move(term);
      }
      at += static_cast<Eigen::Index>(h.columns.size());
      out_.effects.push_back(std::move(effect));
    }
  }

  // Rule interval: what may as well be zero is no correction. True: the search goes on without it.
  bool DropUncertain(const EffectSet& set, std::set<std::string>* refuted) const {
    bool any = false;
    for (std::size_t k = 0; k < set.members.size(); ++k) {
      const StanceEffect& effect = out_.effects[k];
      double most = 0.0;
      if (effect.payload) most = effect.payload->mass_kg / effect.payload->mass_half_width_95;
      if (effect.term) {
        for (const actuator::ParameterValue& value : effect.term->linear) {
          most = std::max(most, std::abs(value.value) / value.half_width_95.value_or(HUGE_VAL));
        }
      }
      if (most > options_.in_force.Limit(rules::kInterval)) continue;
      refuted->insert(Of(set, k).name);
      any = true;
    }
    return any;
  }

  // Slope of what is left without an effect on what it predicts, of the fitted model: declared
  // values that a refit without the effect would move far beyond their tolerances stay. By the
  // score of the facts. True: an effect was refuted, and the search goes on without it.
  bool Confirm(int order, const trace::Problem& problem, const EffectSet& set,
               std::set<std::string>* refuted) {
    const Regression held_out =
        MakeRegression(model_, layout_, held_out_rows_, options_.tolerances);
    if (held_out.bank.hypotheses.size() != regression_.bank.hypotheses.size()) return false;
    const PlainFit with = Fit(set.members);
    const Eigen::VectorXd rest = Left(held_out, with, set.columns);
    const ChannelNoise noise = NoiseOf(held_out, rest, order);
    const double curve = trace::CurveBeside(problem, set);
    bool any = false;
    for (std::size_t k = 0; k < set.members.size(); ++k) {
      const trace::Columns& own = Of(set, k).columns;
      Eigen::Index first = held_out.bank.declared.cols();
      for (std::size_t i = 0; i < k; ++i) {
        first += static_cast<Eigen::Index>(Of(set, i).columns.size());
      }
      const Eigen::VectorXd part = held_out.bank.columns(Eigen::all, own) *
                                   with.b.segment(first, static_cast<Eigen::Index>(own.size()));
      StanceEffect& effect = out_.effects[k];
      effect.confirmation = trace::ConfirmSlope(Whiten(held_out, noise, rest + part).col(0),
                                                Whiten(held_out, noise, part).col(0),
                                                held_out.blocks, options_.in_force);
      trace::Facts facts;
      facts.curve = curve;
      facts.SetSlope(effect.confirmation);
      const double score = facts.Score();
      effect.confirmation.verdict = score >= options_.in_force.Limit(rules::kScore)
                                        ? trace::ConfirmationVerdict::kConfirmed
                                    : score < options_.in_force.Limit(rules::kOpen)
                                        ? trace::ConfirmationVerdict::kRefuted
                                        : trace::ConfirmationVerdict::kNotConfirmed;
      if (effect.confirmation.verdict != trace::ConfirmationVerdict::kRefuted) continue;
      refuted->insert(Of(set, k).name);
      out_.refuted.push_back(effect);
      any = true;
    }
    return any;
  }

  void Finish(const EffectSet& set) {
    trace::Columns kept;
    std::vector<std::size_t> kept_members;
    if (set.empty()) out_.effects.clear();
    for (std::size_t k = 0; k < set.members.size(); ++k) {
      StanceEffect& effect = out_.effects[k];
      const Hypothesis& h = Of(set, k);
      effect.in_model = held_out_rows_.empty() ||
                        effect.confirmation.verdict == trace::ConfirmationVerdict::kConfirmed;
      if (!effect.in_model) continue;
      kept.insert(kept.end(), h.columns.begin(), h.columns.end());
      kept_members.push_back(set.members[k]);
      const Subject& subject = regression_.subjects[set.members[k]];
      if (effect.payload) {
        out_.payloads.push_back(*effect.payload);
        out_.corrected.payloads.push_back(Written(*effect.payload));
      }
      if (effect.term && subject.kind == Subject::Kind::kJoint) {
        AddTerm(*effect.term, &out_.corrected.joints[subject.index]);
      }
    }
    const PlainFit after = Fit(kept_members);
    PlainFit before;  // as declared
    before.b = Eigen::VectorXd::Zero(regression_.bank.declared.cols());
    for (std::size_t c = 0; c < regression_.parameters.size(); ++c) {
      const Regression::Parameter& which = regression_.parameters[c];
      if (which.joint < 0) continue;
      actuator::ParameterValue& value = out_.corrected.joints[static_cast<std::size_t>(which.joint)]
                                            .terms[static_cast<std::size_t>(which.term)]
                                            .linear[static_cast<std::size_t>(which.linear)];
      value.value += after.b[static_cast<Eigen::Index>(c)];
      value.half_width_95 = std::hypot(value.half_width_95.value_or(0.0),
                                       after.HalfWidth(static_cast<Eigen::Index>(c)));
    }
    out_.train_before = ErrorOf(layout_, rows_, Left(regression_, before, {}));
    out_.train_after = ErrorOf(layout_, rows_, Left(regression_, after, kept));
    if (!held_out_rows_.empty()) {
      const Regression held_out =
          MakeRegression(model_, layout_, held_out_rows_, options_.tolerances);
      const Eigen::VectorXd rest_before = Left(held_out, before, {});
      const Eigen::VectorXd rest_after = Left(held_out, after, kept);
      out_.held_out_before = ErrorOf(layout_, held_out_rows_, rest_before);
      out_.held_out_after = ErrorOf(layout_, held_out_rows_, rest_after);
      NoteHeldOut(rest_before, rest_after);
    }
    if (!out_.effects.empty()) {
      out_.verdict = trace::Verdict::kEffect;
    } else if (!out_.unexplained.empty()) {
      out_.verdict = trace::Verdict::kUnexplained;
    }
  }

  void NoteHeldOut(const Eigen::VectorXd& before, const Eigen::VectorXd& after) {
    BalanceSeries& series = out_.held_out;
    series.before = RestOfRows(layout_, held_out_rows_, before).leftCols<3>();
    series.after = RestOfRows(layout_, held_out_rows_, after).leftCols<3>();
    series.time_s.resize(series.before.rows());
    Eigen::Index at = 0;
    for (const StanceRows& rows : held_out_rows_) {
      series.time_s.segment(at, rows.size()) = rows.time_s;
      at += rows.size();
    }
  }

  void NoteDetectable(const trace::Problem& problem, double statistic) {
    for (const Hypothesis& h : regression_.bank.hypotheses) {
      if (!h.physical()) continue;
      const std::optional<double> size =
          trace::DetectableCoefficient(problem, h, h.columns.front(), statistic, HUGE_VAL, 0.0);
      if (!size) continue;
      const auto known =
          std::find_if(out_.detectable.begin(), out_.detectable.end(),
                       [&](const SmallestSize& entry) { return entry.effect == h.name; });
      const std::string parameter =
          effects::ParameterKey(h.effect->info().linear.front(), types::JointKind::kRevolute);
      if (known == out_.detectable.end()) {
        out_.detectable.push_back({h.name, parameter, *size});
      } else {
        known->size = std::min(known->size, *size);
      }
    }
  }

  void NoteNotExcited() {
    for (std::size_t j = 0; j < layout_.moves.size(); ++j) {
      const std::string& name = model_.robot().joints[j].name;
      if (layout_.moves[j]) out_.moving_joints.push_back(name);
      if (layout_.moves[j]) continue;
      out_.not_excited.push_back({"friction of " + model_.robot().joints[j].name,
                                  "the joint stands: friction has any value up to breakaway"});
    }
    for (const StanceEffect& effect : out_.effects) {
      if (!effect.payload) continue;
      static constexpr std::array<const char*, 3> kAxes = {"x", "y", "z"};
      for (std::size_t axis = 0; axis < kAxes.size(); ++axis) {
        if (effect.payload->excited[axis]) continue;
        out_.not_excited.push_back(
            {std::string("place of the payload along ") + kAxes[axis] + " of " + effect.place,
             "its interval is wider than 20 mm: the link hardly turns against the vertical there"});
      }
    }
  }

  const StanceModel& model_;
  const StanceOptions& options_;
  StanceLayout layout_;
  std::vector<StanceRows> rows_, held_out_rows_;
  Regression regression_;
  StanceFitResult out_;
};

}  // namespace

StanceFitResult FitStance(const StanceModel& model, const std::vector<StanceRecording>& train,
                          const std::vector<StanceRecording>& held_out,
                          const StanceOptions& options) {
  return Closer(model, options).Close(train, held_out);
}

}  // namespace sinew::stance_fit
