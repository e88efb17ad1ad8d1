#include "components/model/trace/event_search.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>
#include <random>

#include "components/model/trace/likelihood_tracer.h"
#include "tests/components/model/identify/synthetic.h"

namespace sinew::trace {
namespace {

using identify::Design;

struct Happens {
  std::string effect;
  double size = 0.0;
  std::vector<std::vector<double>> psi;  // once or several times
};

types::Run Recorded(const std::vector<Happens>& events, std::uint64_t seed) {
  actuator::JointModel truth = identify::SyntheticModel();
  for (const Happens& event : events) {
    for (const std::vector<double>& psi : event.psi) {
      truth.terms.push_back(identify::TermOf(event.effect, {event.size}, truth.constants));
      for (std::size_t i = 0; i < psi.size(); ++i) truth.terms.back().nonlinear[i].value = psi[i];
    }
  }
  return identify::SyntheticRun(truth, {.rate_Hz = 100.0, .seed = seed, .noise_A = 0.05});
}

types::Run Recorded(const Happens& event, std::uint64_t seed) {
  return Recorded(std::vector<Happens>{event}, seed);
}

Design RawDesign(const std::vector<types::Run>& runs) {
  const actuator::JointModel model = identify::SyntheticModel();
  const identify::ProcessingOptions options = identify::FromMotion(runs, model, 0.25);
  return Design(identify::MakeStates(runs, model, options), options);
}

TraceResult TraceRaw(const std::vector<types::Run>& train, const types::Run& held_out) {
  Design design = RawDesign(train);
  Design held_out_design = RawDesign({held_out});
  return TraceByLikelihood(design, held_out_design, identify::SyntheticModel(), {});
}

std::vector<double> StartsIn(const TraceResult& result, const std::string& recording) {
  std::vector<double> out;
  for (const EventTime& event : result.events) {
    if (event.recording == recording) out.push_back(event.start_s);
  }
  return out;
}

TEST(EventSearch, APayloadPutOnAtDifferentTimesIsFoundWithItsMassAndItsTimes) {
  const std::vector<types::Run> train = {Recorded({"payload_step", 0.2, {{17.0}}}, 11),
                                         Recorded({"payload_step", 0.2, {{41.0}}}, 12)};
  const types::Run held_out = Recorded({"payload_step", 0.2, {{29.0}}}, 14);
  const TraceResult result = TraceRaw(train, held_out);
  ASSERT_EQ(result.verdict, Verdict::kEffect);
  ASSERT_EQ(result.effects.size(), 1u);
  EXPECT_EQ(result.effects[0].name, "payload_step");
  EXPECT_EQ(result.effects[0].confirmation.verdict, ConfirmationVerdict::kConfirmed);
  const actuator::ParameterValue& mass = result.corrected.terms.back().linear[0];
  EXPECT_NEAR(mass.value, 0.2, 2.0 * mass.half_width_95.value());
  // Half a second: the resolution of a change of this size in this noise.
  ASSERT_EQ(StartsIn(result, train[0].name).size(), 1u);
  EXPECT_NEAR(StartsIn(result, train[0].name)[0], 17.0, 0.5);
  EXPECT_NEAR(StartsIn(result, train[1].name)[0], 41.0, 0.5);
  EXPECT_NEAR(StartsIn(result, held_out.name)[0], 29.0, 0.5);
}

TEST(EventSearch, PushesAreFoundAsOftenAsTheyCame) {
  const std::vector<types::Run> train = {
      Recorded({"external_bump", 1.2, {{20.0, 0.8}, {44.0, 0.8}}}, 21),
      Recorded({"external_bump", 1.2, {{9.0, 0.8}, {31.0, 0.8}}}, 22)};
  const types::Run held_out = Recorded({"external_bump", 1.2, {{33.0, 0.8}, {51.0, 0.8}}}, 23);
  const TraceResult result = TraceRaw(train, held_out);
  ASSERT_EQ(result.verdict, Verdict::kEffect);
  EXPECT_EQ(result.effects[0].name, "external_bump");
  const std::vector<double> first = StartsIn(result, train[0].name);
  ASSERT_EQ(first.size(), 2u);
  EXPECT_NEAR(first[0], 20.0, 0.3);
  EXPECT_NEAR(first[1], 44.0, 0.3);
  const std::vector<double> held_out_starts = StartsIn(result, held_out.name);
  ASSERT_EQ(held_out_starts.size(), 2u);
  EXPECT_NEAR(held_out_starts[0], 33.0, 0.3);
  EXPECT_NEAR(held_out_starts[1], 51.0, 0.3);
}

TEST(EventSearch, PushesThatReachTheDriveInPartDoNotHideTheOthers) {
  const std::vector<types::Run> train = {
      Recorded({{"external_bump", 1.2, {{20.0, 0.8}}}, {"external_bump", 0.45, {{44.0, 0.8}}}}, 24),
      Recorded({{"external_bump", 1.2, {{9.0, 0.8}}}}, 25),
      Recorded({{"external_bump", 0.45, {{31.0, 0.8}}}}, 26)};
  const types::Run held_out = Recorded({"external_bump", 1.2, {{33.0, 0.8}}}, 27);
  const TraceResult result = TraceRaw(train, held_out);
  ASSERT_EQ(result.verdict, Verdict::kEffect);
  EXPECT_EQ(result.effects[0].name, "external_bump");
  EXPECT_EQ(StartsIn(result, train[0].name).size(), 1u);
  EXPECT_EQ(StartsIn(result, train[1].name).size(), 1u);
  EXPECT_EQ(StartsIn(result, train[2].name).size(), 0u);
}

TEST(EventSearch, APushShorterThanAPeriodOfTheLowPassIsAskedForWhereNoTeethTouch) {
  const Design design = RawDesign({Recorded(Happens{}, 28), Recorded(Happens{}, 29)});
  const double period_s = 1.0 / design.options().state_cutoff_Hz;
  std::mt19937_64 random(30);
  std::normal_distribution<double> noise;
  Eigen::VectorXd residual(design.rows().size());
  for (Eigen::Index i = 0; i < residual.size(); ++i) {
    const double start_s = design.rows().run[static_cast<std::size_t>(i)] == 0 ? 20.0 : 33.0;
    const double s = (design.rows().time_s[i] - start_s) / (0.6 * period_s);
    const double pulse = s > 0.0 && s < 1.0 ? std::sin(M_PI * s) * std::sin(M_PI * s) : 0.0;
    residual[i] = noise(random) + 30.0 * pulse;
  }
  const std::shared_ptr<const effects::Effect> bump =
      effects::MakeEffect("external_bump", identify::SyntheticModel().constants);
  const std::optional<FoundEvent> free = FindPush(design, bump, 0.0, false, residual, {});
  ASSERT_TRUE(free.has_value());
  EXPECT_LT(free->event.length_s, period_s);
  const std::optional<FoundEvent> teeth = FindPush(design, bump, 0.0, true, residual, {});
  EXPECT_TRUE(!teeth || teeth->event.length_s > 1.4 * period_s);
  EXPECT_TRUE(!teeth || teeth->explained < free->explained);
}

TEST(EventSearch, NothingStandsOutInNoise) {
  for (std::uint64_t seed = 31; seed < 36; ++seed) {
    const TraceResult result =
        TraceRaw({Recorded(Happens{}, 10 * seed), Recorded(Happens{}, 10 * seed + 1)},
                 Recorded(Happens{}, 10 * seed + 2));
    EXPECT_EQ(result.verdict, Verdict::kNone) << seed;
    EXPECT_TRUE(result.events.empty()) << seed;
  }
}

TEST(EventSearch, TheClockJumpsHalfwayBetweenTwoInstants) {
  Design design = RawDesign({Recorded(Happens{}, 41), Recorded(Happens{}, 42)});
  const Eigen::VectorXd stamps = design.rows().time_s;
  TimedEffect event;
  event.clock_s = 30.0;
  SetClocksBy(event, {{10.0, 20.0}, {}}, &design);
  EXPECT_EQ((design.rows().time_s - stamps).norm(), 0.0);  // stamps stay
  const Eigen::VectorXd clock =
      design.Variable([](const effects::JointSample& x) { return x.time_s; });
  for (Eigen::Index i = 0; i < clock.size(); ++i) {
    const double t = stamps[i];
    if (design.rows().run[static_cast<std::size_t>(i)] == 1) {
      EXPECT_LT(clock[i], -1e8);
    } else {
      EXPECT_NEAR(clock[i], t <= 15.0 ? t + 20.0 : t + 10.0, 1e-6) << t;
    }
  }
}

}  // namespace
}  // namespace sinew::trace
