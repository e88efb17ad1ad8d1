#include "components/model/trace/balances.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "components/model/identify/gas.h"
#include "components/model/identify/kinematic.h"
#include "components/model/identify/statistics.h"
#include "components/model/trace/likelihood_tracer.h"

namespace sinew::trace {

namespace {

constexpr std::size_t kFewestTrainRows = 200;
constexpr std::size_t kFewestHeldOutRows = 50;

constexpr int kFewestWindows = 4;

// A signal that a balance cannot do without, and how a recording that lacks it is described.
struct Need {
  effects::Balance balance;
  types::Signal signal;
  const char* lack;
};
constexpr Need kNeeds[] = {
    {effects::Balance::kKinematic, types::Signal::kPosition, " has no output angle"},
    {effects::Balance::kKinematic, types::Signal::kMotorPosition, " has no motor angle"},
    {effects::Balance::kGas, types::Signal::kChamberPressure, " has no chamber pressure"},
    {effects::Balance::kGas, types::Signal::kValveOpen,
     " does not contain when the valve was open"}};

std::string LackOf(const std::vector<types::Run>& runs, effects::Balance balance) {
  for (const types::Run& run : runs) {
    for (const Need& need : kNeeds) {
      if (need.balance == balance && !run.Has(need.signal)) return run.name + need.lack;
    }
  }
  return "";
}

// The rows of a balance; none, and why, where the recordings show nothing of it.
struct BalanceDesigns {
  std::optional<identify::Design> train, held_out;
  std::string why_not;  // empty: there is something to see
};

// model: fitted in the motion balance. motion: options of the torque balance, resolved.
BalanceDesigns MakeBalanceDesigns(effects::Balance balance, const std::vector<types::Run>& train,
                                  const std::vector<types::Run>& held_out,
                                  const actuator::JointModel& model,
                                  const identify::ProcessingOptions& motion) {
  BalanceDesigns out;
  for (const auto* runs : {&train, &held_out}) {
    out.why_not = LackOf(*runs, balance);
    if (!out.why_not.empty()) return out;
  }
  identify::StateSet of_train, of_held_out;
  if (balance == effects::Balance::kGas) {
    identify::GasWindows first = identify::MakeGasStates(train, model, motion);
    identify::GasWindows second = identify::MakeGasStates(held_out, model, motion);
    if (first.shut < kFewestWindows) out.why_not = "the valve is hardly ever shut in training";
    if (second.shut < 1) out.why_not = "the valve is never shut in the held-out recordings";
    if (!out.why_not.empty()) return out;
    of_train = std::move(first.states);
    of_held_out = std::move(second.states);
  } else {
    of_train = identify::MakeKinematicStates(train, model, motion);
    // The torque that exceeds the torque balance's error is determined on the training recordings.
    of_held_out = identify::MakeKinematicStates(held_out, model, motion,
                                                identify::RawResidualTorque(of_train, model));
  }
  const identify::ProcessingOptions options = identify::Unfiltered(motion, of_train.rate_Hz);
  out.train.emplace(std::move(of_train), options);
  out.held_out.emplace(std::move(of_held_out), options);
  if (balance == effects::Balance::kKinematic &&
      (out.train->rows().UsedRows().size() < kFewestTrainRows ||
       out.held_out->rows().UsedRows().size() < kFewestHeldOutRows)) {
    out.why_not = "the teeth are hardly ever surely in contact";
  }
  return out;
}

// Rows of the encoders as they are, not freed of each recording's mean.
identify::Design AsMeasured(const identify::Design& design) {
  identify::StateSet states = design.states();
  for (identify::StateSegment& segment : states.segments) segment.window.clear();
  return {std::move(states), design.options()};
}

// Sets the middle of the play, which does not show in rows that are freed of each recording's mean:
// the mean over the recordings of what the model leaves of the angles as they are, and, of several,
// the half width of its 95 % interval by how they differ.
void SetEncoderOffset(const identify::Design& as_measured, actuator::JointModel* model) {
  const int at = model->Find("encoder_offset", effects::Balance::kKinematic);
  if (at < 0) return;
  actuator::ParameterValue& offset = model->terms[static_cast<std::size_t>(at)].linear.front();
  if (offset.fixed) return;
  const Eigen::VectorXd left = identify::ErrorOf(as_measured, *model).residual;
  std::map<std::size_t, std::pair<double, double>> sums;  // by recording: sum, rows
  for (const Eigen::Index i : as_measured.rows().UsedRows()) {
    auto& [sum, rows] = sums[as_measured.rows().RunOf(i)];
    sum += left[i];
    rows += 1.0;
  }
  const auto count = static_cast<double>(sums.size());
  double mean = 0.0, squares = 0.0;
  for (const auto& [run, of_run] : sums) mean += of_run.first / of_run.second / count;
  for (const auto& [run, of_run] : sums)
    squares += std::pow(of_run.first / of_run.second - mean, 2);
  offset.value += mean;
  offset.half_width_95.reset();
  if (count < 2.0) return;
  offset.half_width_95 =
      identify::StudentQuantile(0.975, count - 1.0) * std::sqrt(squares / (count - 1.0) / count);
}

}  // namespace

std::vector<effects::Balance> OtherBalances(const actuator::JointModel& model) {
  std::vector<effects::Balance> out;
  for (const effects::Balance balance : {effects::Balance::kKinematic, effects::Balance::kGas}) {
    if (model.Declares(balance)) out.push_back(balance);
  }
  return out;
}

TraceResult TraceBalance(effects::Balance balance, const std::vector<types::Run>& train,
                         const std::vector<types::Run>& held_out,
                         const actuator::JointModel& corrected,
                         const identify::ProcessingOptions& motion, const TraceOptions& options) {
  actuator::JointModel model = corrected;
  model.balance = balance;
  BalanceDesigns sight = MakeBalanceDesigns(balance, train, held_out, model, motion);
  try {
    if (sight.why_not.empty()) {
      TraceResult out = TraceByLikelihood(*sight.train, *sight.held_out, model, options);
      if (balance == effects::Balance::kKinematic) {
        const identify::Design as_measured = AsMeasured(*sight.train);
        for (auto* fitted : {&out.declared, &out.corrected}) SetEncoderOffset(as_measured, fitted);
      }
      return out;
    }
  } catch (const identify::TooLittleData& error) {
    sight.why_not = error.what();
  }
  TraceResult out;
  out.nominal = out.declared = out.corrected = std::move(model);
  for (const auto& form : effects::EffectForms()) {
    if (form.balance != balance || out.corrected.Find(form.name, balance) >= 0) continue;
    out.not_excited.push_back({form.name, sight.why_not});
  }
  out.unseen = sight.why_not;
  return out;
}

TraceResult WithBalance(TraceResult motion, TraceResult other) {
  const effects::Balance balance = other.corrected.balance;
  if (motion.p_global && other.p_global) {
    motion.p_global = std::min(*motion.p_global, *other.p_global);
  }
  BalanceSummary summary{std::move(static_cast<Assessment&>(other)), balance,
                         std::string(effects::BalanceUnit(balance, other.corrected.kind))};

  // Declared terms stand at the same places in all models.
  std::vector<actuator::Term>& mine = motion.declared.terms;
  const std::vector<actuator::Term>& theirs = other.declared.terms;
  for (std::size_t t = 0; t < mine.size() && t < theirs.size(); ++t) {
    if (mine[t].effect->info().balance == balance) mine[t] = theirs[t];
  }
  other.corrected.balance = motion.corrected.balance;
  motion.corrected = std::move(other.corrected);
  for (auto list : {&TraceResult::effects, &TraceResult::open, &TraceResult::refuted}) {
    for (FoundEffect& effect : other.*list) (motion.*list).push_back(std::move(effect));
    SortByGain(&(motion.*list));
  }
  for (DetectableSize& size : other.detectable) motion.detectable.push_back(std::move(size));
  for (ParameterShift& shift : other.shifts) motion.shifts.push_back(std::move(shift));
  // An effect with a form in both balances is seen when either shows it, and listed once.
  for (NotExcited& hidden : other.not_excited) {
    const bool known =
        std::count(motion.assessed.begin(), motion.assessed.end(), hidden.effect) != 0 ||
        std::any_of(motion.not_excited.begin(), motion.not_excited.end(),
                    [&](const NotExcited& listed) { return listed.effect == hidden.effect; });
    if (!known) motion.not_excited.push_back(std::move(hidden));
  }
  for (const std::string& name : other.assessed) {
    std::erase_if(motion.not_excited,
                  [&](const NotExcited& hidden) { return hidden.effect == name; });
    motion.assessed.push_back(name);
  }
  std::stable_sort(motion.not_excited.begin(), motion.not_excited.end(),
                   [](const NotExcited& a, const NotExcited& b) { return a.effect < b.effect; });
  if (summary.verdict == Verdict::kEffect) motion.verdict = Verdict::kEffect;
  if (motion.verdict == Verdict::kNone && summary.verdict == Verdict::kUnexplained) {
    motion.verdict = Verdict::kUnexplained;
    motion.unexplained = summary.unexplained;
  }
  motion.balances.push_back(std::move(summary));
  return motion;
}

}  // namespace sinew::trace
