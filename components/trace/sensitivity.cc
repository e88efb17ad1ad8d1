#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>

#include "components/identify/statistics.h"
#include "components/trace/judgement.h"
#include "components/trace/rules.h"

namespace sinew::trace {

namespace {

// Quantile of the normal distribution that 80 % lie below.
constexpr double kPower = 0.8416;

struct Shown {
  double detectable = std::numeric_limits<double>::infinity();  // rms, share of the measured side
  double free = 0.0;  // part of its power that the declared terms do not carry
};

}  // namespace

Sensitivity FindSensitivity(const Problem& problem) {
  Sensitivity out;
  for (const MissingSignals& missing : problem.bank.missing) {
    out.not_excited.push_back({missing.effect, "not recorded: " + missing.fields});
  }
  for (const MissingSignals& silent : problem.bank.silent) {
    out.not_excited.push_back({silent.effect, silent.fields + " contains only noise"});
  }
  const Evidence& evidence = problem.evidence;
  const double target_rms = identify::Rms(problem.bank.target);
  const double limit = rules::kExplainedShare.limit * evidence.misfit();
  // Gain that exceeds the limit in 80 % of recordings: it scatters by twice its square root
  // (noncentral chi-square).
  const double needed = limit + 2.0 * kPower * std::sqrt(limit);
  std::map<std::string, Shown> shown;
  for (const Hypothesis& h : problem.hypotheses()) {
    if (!h.physical() || h.settings.size() > 1) continue;  // lines are there when they are found
    Shown& of = shown[h.name];
    for (const Eigen::Index j : h.columns) {
      of.free = std::max(of.free, evidence.FreeShare(j));
      const double reduced = evidence.reduced()(j, j);
      if (!(reduced > 0.0) || !(target_rms > 0.0)) continue;
      const double size = std::sqrt(needed / reduced);
      of.detectable =
          std::min(of.detectable, size * identify::Rms(problem.bank.columns.col(j)) / target_rms);
    }
  }
  for (const auto& [name, of] : shown) {
    if (of.free < rules::kAbsorbed.limit) {
      out.not_excited.push_back(
          {name, "the declared terms carry all of it: only a shift of parameters shows"});
    } else if (of.detectable > rules::kDetectable.limit) {
      char text[120];
      std::snprintf(text, sizeof text,
                    "up to %.2g %% of the measured side could hide in this motion",
                    100.0 * of.detectable);
      out.not_excited.push_back({name, text});
    } else {
      out.judged.push_back(name);
    }
  }
  std::sort(out.not_excited.begin(), out.not_excited.end(),
            [](const NotExcited& a, const NotExcited& b) { return a.effect < b.effect; });
  return out;
}

}  // namespace sinew::trace
