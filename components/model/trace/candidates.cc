#include "components/model/trace/candidates.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "components/model/identify/statistics.h"
#include "components/model/trace/nuisances.h"

namespace sinew::trace {

std::vector<std::vector<double>> GridOf(const effects::EffectInfo& info) {
  std::vector<std::vector<double>> grid = {{}};
  for (const effects::ParameterInfo& parameter : info.nonlinear) {
    std::vector<std::vector<double>> next;
    const std::vector<double> values =
        parameter.grid.empty() ? std::vector<double>{parameter.default_value} : parameter.grid;
    for (const std::vector<double>& point : grid) {
      for (const double value : values) {
        next.push_back(point);
        next.back().push_back(value);
      }
    }
    grid = std::move(next);
  }
  return grid;
}

namespace {

// The catalogue's grids are those of a joint that turns a radian either way, at half a radian per
// second: lengths and speeds of another motion are as much longer and quicker.
constexpr double kSpeedOfGrid = 0.5;  // rad/s
// Sliding lengths, share of half of the motion's range, up to all of it. What is shorter than some
// counts of the encoder is a nuisance (nuisances.h) and no effect.
constexpr double kNarrowestShare = 0.003, kWidestShare = 2.0;

// Resonances well within the band of the angles (beyond half of it their low-pass looks like one),
// as close as half the width of the sharpest (2 z of flexible_link's grid).
constexpr double kLowestResonance = 0.1, kHighestResonance = 0.6, kDensity = 1.06;

// Terms that state a quantity of the machine which another term states already: where a model
// declares that one, the first is no cause. It moves inertia or friction to the other side of the
// gear, or is a part of whatever depends on the angle. By none: it has no cause of its own; a
// constant is a current_offset or direction_dependent_coulomb.
struct Stated {
  const char* effect;
  std::vector<const char*> by;
};
const Stated kStated[] = {
    {"inertia", {"rotor_inertia", "link_inertia", "rigid_body"}},
    {"rotor_inertia", {"inertia", "link_inertia", "rigid_body"}},
    {"link_inertia", {"inertia", "rotor_inertia", "rigid_body"}},
    {"viscous", {"motor_viscous"}},
    {"motor_viscous", {"viscous"}},
    {"spring", {"gravity", "pneumatic_stiffness", "rigid_body"}},
    {"offset", {}},
    {"rigid_body", {}},
};

// Effects of what hangs on the link. Where both torques of a gear are measured, its motor's and its
// link's, the balance is that of the gear alone: they are in neither.
constexpr const char* kOfLink[] = {"gravity", "gravity_phase", "payload", "payload_step"};

bool IsStated(const std::string& effect, const actuator::JointModel& model) {
  const auto declared = [&](const char* term) { return model.Find(term, model.balance) >= 0; };
  if (declared("drive_torque") && declared("load_force") &&
      std::ranges::find(kOfLink, effect) != std::end(kOfLink)) {
    return true;
  }
  return std::any_of(std::begin(kStated), std::end(kStated), [&](const Stated& stated) {
    return effect == stated.effect &&
           (stated.by.empty() || std::any_of(stated.by.begin(), stated.by.end(), declared));
  });
}

// Share of a quantity's range below which it did not change.
constexpr double kNoChange = 0.2;
// As many independent recordings are evidence without one that repeats a value (Cameron, Miller
// 2015, section VI).
constexpr std::size_t kConvincingRecordings = 6;

}  // namespace

bool DiffersBetweenFewRecordings(const identify::Design& design, std::string_view variable) {
  using effects::JointSample;
  if (variable != "temperature_degC" && variable != "payload_kg") return false;
  const Eigen::VectorXd values = design.Variable([&](const JointSample& x) {
    return variable == "payload_kg" ? x.payload_kg : x.temperature_degC;
  });
  struct Span {
    double least, largest;
    double Middle() const { return 0.5 * (least + largest); }
  };
  std::map<std::size_t, Span> of_run;
  for (const Eigen::Index i : design.rows().UsedRows()) {
    Span& span =
        of_run.try_emplace(design.rows().RunOf(i), Span{values[i], values[i]}).first->second;
    span = {std::min(span.least, values[i]), std::max(span.largest, values[i])};
  }
  if (of_run.empty() || of_run.size() >= kConvincingRecordings) return false;
  std::vector<double> middles;
  double widest = 0.0;
  for (const auto& [run, span] : of_run) {
    middles.push_back(span.Middle());
    widest = std::max(widest, span.largest - span.least);
  }
  std::sort(middles.begin(), middles.end());
  const double no_change = kNoChange * (middles.back() - middles.front());
  if (!(no_change > 0.0) || widest > no_change) return false;
  // A value that comes twice shows what else differs.
  for (std::size_t k = 1; k < middles.size(); ++k) {
    if (middles[k] - middles[k - 1] <= no_change) return false;
  }
  return true;
}

std::vector<std::vector<double>> GridFor(const identify::Design& design,
                                         const effects::JointConstants& constants,
                                         const effects::EffectInfo& info) {
  if (!design.options().raw) return GridOf(info);
  using effects::JointSample;
  const std::vector<Eigen::Index> used = design.rows().UsedRows();
  if (used.empty()) return GridOf(info);
  const auto of_used = [&](const Eigen::VectorXd& x) -> Eigen::VectorXd { return x(used); };
  effects::EffectInfo scaled = info;
  for (effects::ParameterInfo& parameter : scaled.nonlinear) {
    double scale = 1.0;
    if (parameter.dimension == effects::Dimension::kAngle) {
      const Eigen::VectorXd q =
          of_used(design.Variable([](const JointSample& x) { return x.position_rad; }));
      scale = 0.5 * (q.maxCoeff() - q.minCoeff());
      if (parameter.lower > 0.0) {  // a length, not a place
        parameter.grid.clear();
        const double seen = GivingLength(constants);
        for (double share = kNarrowestShare; share < kWidestShare; share *= 2.0) {
          if (share * scale >= seen) parameter.grid.push_back(share);
        }
      }
    } else if (parameter.dimension == effects::Dimension::kVelocity) {
      const Eigen::VectorXd v =
          of_used(design.Variable([](const JointSample& x) { return x.velocity_rad_s; }));
      const Eigen::VectorXd speed = v.cwiseAbs();
      scale =
          identify::Quantile(std::vector<double>(speed.begin(), speed.end()), 0.75) / kSpeedOfGrid;
    } else if (parameter.dimension == effects::Dimension::kFrequency) {
      parameter.grid.clear();
      const double band_Hz = design.options().state_cutoff_Hz;
      for (double f = kLowestResonance; f < kHighestResonance; f *= kDensity) {
        parameter.grid.push_back(f * band_Hz);
      }
    }
    for (double& value : parameter.grid) {
      value = std::clamp(scale * value, parameter.lower, parameter.upper);
    }
    std::sort(parameter.grid.begin(), parameter.grid.end());
    parameter.grid.erase(std::unique(parameter.grid.begin(), parameter.grid.end()),
                         parameter.grid.end());
  }
  return GridOf(scaled);
}

CandidateSet MakeCandidates(const identify::Design& design, const actuator::JointModel& model,
                            const InForce& in_force) {
  CandidateSet out;
  for (const auto& [name, balance] : effects::EffectForms()) {
    if (balance != model.balance || !in_force.Has(name)) continue;
    std::shared_ptr<const effects::Effect> effect =
        effects::MakeEffect(name, model.constants, balance);
    const effects::EffectInfo& info = effect->info();
    if (info.role == effects::Role::kDrive || info.event) continue;
    if (info.rotary_only && model.kind != types::JointKind::kRevolute) continue;
    const int present = model.Find(name, balance);
    if (present >= 0 && info.nonlinear.empty()) continue;
    if (present >= 0 && model.terms[static_cast<std::size_t>(present)].declared) continue;
    std::string missing;
    for (const auto* fields : {&info.needs, &info.hardware}) {
      for (const std::string& field : *fields) {
        if (design.states().measured.contains(field)) continue;
        missing += (missing.empty() ? "" : ", ") + field;
      }
    }
    const bool stated = IsStated(name, model);
    if (!missing.empty()) {
      if (!stated) out.untestable.push_back({name, "not recorded: " + missing});
      continue;
    }
    if (info.needs_pneumatics && model.constants.pneumatic_torque_Nm_bar == 0.0 &&
        model.constants.pneumatic_stiffness_Nm_rad_bar == 0.0) {
      out.untestable.push_back({name, "the model declares no torque of the pressure"});
      continue;
    }
    const bool of_winding = std::ranges::any_of(info.linear, [](const auto& parameter) {
      return parameter.dimension == effects::Dimension::kPerCurrentSquared;
    });
    if (of_winding && model.Find("drive_torque", balance) >= 0) {
      out.untestable.push_back({name, "the drive is a torque sensor, which has no winding"});
      continue;
    }
    const auto differs = std::find_if(
        info.needs.begin(), info.needs.end(),
        [&](const std::string& field) { return DiffersBetweenFewRecordings(design, field); });
    if (differs != info.needs.end()) {
      out.untestable.push_back({name, *differs + " differs between the recordings only, and no two "
                                                 "of them have the same: whatever else was not "
                                                 "the same in them looks like it"});
      continue;
    }
    // An unloaded load cell contains only its own noise; a gain of -1 would remove that noise.
    const bool reads_load = std::count(info.needs.begin(), info.needs.end(), "load_force_N") != 0;
    if (reads_load && (design.states().silent_load || design.states().locked)) {
      out.untestable.push_back(
          {name, design.states().locked ? "the motor is locked: the load cell is what is explained"
                                        : "load_force_N contains only noise"});
      continue;
    }
    Candidate candidate;
    candidate.stated = stated;
    for (std::vector<double>& psi : GridFor(design, model.constants, info)) {
      bool taken = false;
      for (const actuator::Term& term : model.terms) {
        if (!model.Counts(term) || term.effect->info().name != name) continue;
        bool same = true;
        for (std::size_t i = 0; i < psi.size(); ++i) {
          same = same && std::abs(term.nonlinear[i].value - psi[i]) <= 1e-9 * std::abs(psi[i]);
        }
        taken = taken || same;
      }
      if (taken) continue;
      GridPoint point;
      point.columns = design.Columns(*effect, psi);
      point.psi = std::move(psi);
      if (point.columns.allFinite()) candidate.grid.push_back(std::move(point));
    }
    candidate.effect = std::move(effect);
    if (!candidate.grid.empty()) out.candidates.push_back(std::move(candidate));
  }
  return out;
}

std::vector<Candidate> EventCandidates(const actuator::JointModel& model, const InForce& in_force) {
  std::vector<Candidate> out;
  for (const std::string& name : effects::EffectNames()) {
    if (!in_force.Has(name) || IsStated(name, model)) continue;
    Candidate candidate;
    candidate.effect = effects::MakeEffect(name, model.constants);
    const effects::EffectInfo& info = candidate.effect->info();
    if (!info.event || (info.rotary_only && model.kind != types::JointKind::kRevolute)) continue;
    out.push_back(std::move(candidate));
  }
  return out;
}

}  // namespace sinew::trace
