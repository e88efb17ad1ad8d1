// Inputs that stop, come from a recording, from another session, or are damaged.
#include <algorithm>

#include "components/topics/node/topics.h"
#include "tools/conform/real_time_run.h"

namespace sinew::conform {

namespace {

using std::chrono::milliseconds;

constexpr milliseconds kCounted(1500);  // component_status comes once a second
constexpr int kRounds = 2;
constexpr std::uint64_t kOtherSession = 2;
constexpr int kRecovery = 5;      // ticks until what came back is used
constexpr int kGoesStale = 5;     // ticks until what stopped is reported
constexpr std::size_t kCut = 10;  // bytes: shorter than a header
constexpr std::uint32_t kNoOrigin = 77;

bool IsStale(const Facts& facts) { return facts.stale.value_or(false); }
bool IsFresh(const Facts& facts) { return !IsStale(facts); }
bool IsReplayed(const Facts& facts) { return facts.origin == msg::Origin::kReplay; }
bool IsLive(const Facts& facts) { return facts.origin == msg::Origin::kLive; }

// Inputs of the role's rules that this program reads.
std::vector<StaleRule> RulesOf(const RealTimeRun& run) {
  std::vector<StaleRule> rules;
  for (const StaleRule& rule : StaleRules()) {
    if (rule.role == run.role.name && run.stage.SubjectReads(rule.input)) rules.push_back(rule);
  }
  return rules;
}

// The greatest share of outputs with the condition that a window has.
double BestShare(RealTimeRun& run, const Moment& like, const std::string& output,
                 bool (*condition)(const Facts&)) {
  double best = 0.0;
  (void)PlayWindows(run, like, [&](const Window& window) {
    best = std::max(best, ShareOf(window.Of(output), condition));
    return best >= kMostTicks;
  });
  return best;
}

// Topics that are played and that the program reads.
std::vector<std::string> PlayedInputs(const RealTimeRun& run) {
  std::vector<std::string> inputs;
  for (const std::string_view topic : PlayedTopics()) {
    if (!run.role.Writes(topic) && run.stage.SubjectReads(topic)) inputs.emplace_back(topic);
  }
  return inputs;
}

}  // namespace

void CheckLostInputs(RealTimeRun& run) {
  const std::vector<StaleRule> rules = RulesOf(run);
  std::string silent, unmarked, stuck, marked;
  for (const std::string& input : PlayedInputs(run)) {
    if (input == node::kJointState.name) continue;  // it makes the ticks
    (void)run.stage.Play(run.Armed(), kRecovery);
    Moment without = run.Armed();
    without.withheld = input;
    (void)run.stage.Play(without, kGoesStale);
    const Window window =
        PlayWindows(run, without, [&](const Window& w) { return AnsweredMost(run.role, w); });
    if (!AnsweredMost(run.role, window)) {
      silent += " without " + input + ": " + AnsweredText(run.role, window) + ";";
    }
    for (const StaleRule& rule : rules) {
      if (rule.input != input) continue;
      const std::string output(rule.output);
      const double share = BestShare(run, without, output, &IsStale);
      if (share < kMostTicks) {
        unmarked += " without " + input + ": " + output + " stale in " + Percent(share) + ";";
      }
      marked += " " + input;
      (void)run.stage.Play(run.Armed(), kRecovery);
      // An output that settles only after a while may stay unsettled.
      if (output == node::kPneumaticState.name) continue;
      const double back = BestShare(run, run.Armed(), output, &IsFresh);
      if (back < kMostTicks) {
        stuck += " " + input + " is back: " + output + " fresh in " + Percent(back) + ";";
      }
    }
  }
  run.report.Add("goes_on_without_inputs", silent.empty(),
                 "answers " + Percent(kMostTicks) + " of the ticks while an input does not come",
                 silent.empty() ? "every tick answered" : silent.substr(1));
  if (rules.empty()) {
    run.report.Skip("marks_lost_inputs", "no input whose loss the role reports");
    run.report.Skip("recovers", "no input whose loss the role reports");
    run.report.Skip("refuses_other_sessions", "no input whose loss the role reports");
    return;
  }
  run.report.Add("marks_lost_inputs", unmarked.empty(),
                 "the output is stale in " + Percent(kMostTicks) + " of the ticks",
                 unmarked.empty() ? "reported:" + marked : unmarked.substr(1));
  run.report.Add("recovers", stuck.empty(), "the output is not stale when the input has come back",
                 stuck.empty() ? "all inputs" : stuck.substr(1));

  std::string mixed;
  for (const StaleRule& rule : rules) {
    (void)run.stage.Play(run.Armed(), kRecovery);
    Moment foreign = run.Armed();
    foreign.foreign = std::string(rule.input);
    (void)run.stage.Play(foreign, kGoesStale);
    const double share = BestShare(run, foreign, std::string(rule.output), &IsStale);
    if (share < kMostTicks) {
      mixed += " " + foreign.foreign + ": stale in " + Percent(share) + ";";
    }
  }
  run.report.Add("refuses_other_sessions", mixed.empty(),
                 "an input with another session_id counts as lost",
                 mixed.empty() ? "refused" : mixed.substr(1));
}

void CheckOrigins(RealTimeRun& run) {
  (void)run.stage.Play(run.Armed(), kRecovery);
  const Window simulated = run.stage.Play(run.Armed(), kWindowTicks);
  std::string laundered;
  for (const node::TopicInfo& topic : run.role.must_write) {
    const double live = ShareOf(simulated.Of(topic.name), &IsLive);
    if (live > 0.0) laundered += " " + topic.name + " says ORIGIN_LIVE in a simulation;";
  }
  std::vector<std::string> inputs{std::string(node::kJointState.name)};
  for (const StaleRule& rule : RulesOf(run)) inputs.emplace_back(rule.input);
  for (const std::string& input : inputs) {
    Moment replayed = run.Armed();
    replayed.replayed = input;
    (void)run.stage.Play(replayed, kGoesStale);
    for (const node::TopicInfo& topic : run.role.must_write) {
      const double share = BestShare(run, replayed, topic.name, &IsReplayed);
      if (share < kMostTicks) {
        laundered +=
            " " + input + " replayed: " + topic.name + " says so in " + Percent(share) + ";";
      }
    }
    (void)run.stage.Play(run.Armed(), kRecovery);
  }
  run.report.Add("origin", laundered.empty(),
                 "what is computed from a recording has ORIGIN_REPLAY, nothing ORIGIN_LIVE",
                 laundered.empty() ? std::to_string(inputs.size()) + " inputs replayed in turn"
                                   : laundered.substr(1));
}

void CheckSessions(RealTimeRun& run) {
  const std::uint64_t before = run.stage.session_id();
  run.stage.StartSession(kOtherSession);
  const Window window = run.stage.Play(run.Armed(), kWindowTicks);
  std::string mixed;
  for (const node::TopicInfo& topic : run.role.must_write) {
    const auto outputs = window.outputs.find(topic.name);
    if (outputs == window.outputs.end()) continue;
    bool followed = false;
    for (const Output& output : outputs->second) {
      if (!output.facts) continue;
      followed = followed || output.facts->session_id == kOtherSession;
      if (followed && output.facts->session_id == before) {
        mixed += " " + topic.name + ": an output of the session before after one of the new one;";
      }
    }
  }
  const Window settled =
      PlayWindows(run, run.Armed(), [&](const Window& w) { return AnsweredMost(run.role, w); });
  run.report.Add("new_session", AnsweredMost(run.role, settled) && mixed.empty(),
                 "follows a new session_id, whose ticks begin at 0",
                 mixed.empty() ? AnsweredText(run.role, settled) : mixed.substr(1));
}

namespace {

// Damages that DDS may find itself, or a decoder. A count beyond its array is any octet for DDS:
// that the program finds, and counts.
const std::vector<Stage::Damaging>& Damages() {
  static const std::vector<Stage::Damaging> kDamages = {
      [](const node::Bytes& good) { return node::Bytes(good.begin(), good.begin() + kCut); },
      [](const node::Bytes& good) {
        return node::Bytes(good.begin(),
                           good.begin() + static_cast<std::ptrdiff_t>(good.size() / 2));
      },
      [](const node::Bytes& good) {
        node::Bytes nameless = good;
        (void)node::PokeOrigin(nameless.data(), nameless.size(), kNoOrigin);
        return nameless;
      }};
  return kDamages;
}

std::uint64_t MalformedCount(RealTimeRun& run) {
  const auto status = run.stage.status();
  return status ? status->malformed_samples : 0;
}

}  // namespace

void CheckMalformed(RealTimeRun& run) {
  const std::vector<std::string> inputs = PlayedInputs(run);
  std::vector<std::string> counted;
  for (const std::string& input : inputs) {
    if (!WithImpossibleCount(input, PlayedMessage(input, run.Armed())).empty()) {
      counted.push_back(input);
    }
  }
  // One of each input, so that the number shows that none is left out; again when one was lost.
  std::uint64_t before = MalformedCount(run), more = 0;
  for (int i = 0; i < kRounds && more < counted.size(); ++i) {
    before = MalformedCount(run);
    for (const std::string& input : counted) {
      run.stage.Damage(
          input, [&input](const node::Bytes& good) { return WithImpossibleCount(input, good); });
      (void)run.stage.Play(run.Armed(), 1);
    }
    (void)run.stage.PlayUntil(
        run.Armed(),
        [&] {
          more = MalformedCount(run) - before;
          return more >= counted.size();
        },
        kCounted);
  }
  for (const std::string& input : inputs) {
    for (const Stage::Damaging& damage : Damages()) {
      run.stage.Damage(input, damage);
      (void)run.stage.Play(run.Armed(), 1);
    }
  }
  const Window window =
      PlayWindows(run, run.Armed(), [&](const Window& w) { return AnsweredMost(run.role, w); });
  run.report.Add("malformed_goes_on", AnsweredMost(run.role, window),
                 "answers " + Percent(kMostTicks) + " of the ticks after damaged messages",
                 AnsweredText(run.role, window));
  run.report.Add("malformed_counted", more >= counted.size(),
                 "component_status.malformed_samples grows by " + std::to_string(counted.size()) +
                     ", one for each input whose joint_count was damaged",
                 "by " + std::to_string(more));
}

}  // namespace sinew::conform
