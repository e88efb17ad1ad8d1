// Malformed, unknown and flooding frames into the bridge's plant of twelve joints on two buses: no
// crash, and no joint moved that must not or otherwise than commanded. Every frame that leaves is
// assessed (tests/fuzz/plant_watch.h). Exit code 1 when a rule was broken.
//   build/release/bin/can_fuzz_soak [frames] [seed]       default 100000000 frames
// Half of them with the joints of one bus behind a gateway.
//
// The buses are in memory and hand out what they are fed, without the filters that a real transport
// has: the plant sees everything. Episodes of 120 cycles at 240 Hz, each with commands of its own
// (about a third of the joints idle) and one kind of trouble:
//   noise    unknown identifiers, extended, remote and error frames, impossible lengths, wrong
//            lengths with identifiers of our nodes: no effect; no fault, every setpoint as
//            commanded
//   flood    the same as bursts of up to 1500 frames a cycle on each bus, many times what 1 Mbit/s
//            carries: no effect either
//   forged   whole answers with any content with identifiers of some joints, also as bursts: these
//            may have faults and must keep the rules; the other joints are not affected
//   mutated  what our nodes really sent, with bits turned, bytes changed, cut or repeated
//   storm    all of it, with commands that are not finite and resets of faults at any time
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <memory>
#include <vector>

#include "components/base/types/control_mode.h"
#include "tests/fuzz/watched_plant.h"

namespace {

using namespace sinew;
using types::ControlMode;

constexpr int kJoints = 12;
constexpr int kBuses = 2;
constexpr std::uint32_t kGatewayNode = 48;  // of fuzz::FuzzedRobot
constexpr int kCycles = 120;                // of an episode
constexpr int kArmingCycles = 15;           // until every joint that shall move does

enum class Trouble { kNoise, kFlood, kForged, kMutated, kStorm };
constexpr std::array kNames = {"noise", "flood", "forged", "mutated", "storm"};

// xorshift64*: the generator must not be what takes the time.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed * 2654435761U + 1) {}
  std::uint64_t operator()() {
    state_ ^= state_ >> 12;
    state_ ^= state_ << 25;
    state_ ^= state_ >> 27;
    return state_ * 0x2545F4914F6CDD1DU;
  }
  std::uint32_t Below(std::uint32_t n) {
    return static_cast<std::uint32_t>(((*this)() >> 32) * n >> 32);
  }
  double Within(double most) {
    return most * (static_cast<double>((*this)() >> 11) * 0x1p-52 - 1.0);
  }

 private:
  std::uint64_t state_;
};

void FillData(Random& random, can::Frame* frame) {
  std::uint64_t bits = random();
  if (random.Below(4) == 0) bits &= random() & random();  // many zeros
  if (random.Below(8) == 0) bits = 0x7F8000007F800000U;   // infinities
  if (random.Below(8) == 0) bits |= 0x7FC000007FC00000U;  // NaN
  for (std::size_t i = 0; i < 8; ++i) frame->data[i] = static_cast<std::uint8_t>(bits >> (8 * i));
}

class Soak {
 public:
  Soak(std::uint64_t seed, bool gateway)
      : random_(seed), fed_(fuzz::FuzzedRobot(kJoints, gateway)) {
    for (const bridge::JointConfig& c : fed_.config.joints) {
      ours_[std::size_t(c.bus)][std::size_t(c.node)] = true;
      nodes_[std::size_t(c.bus)].push_back(static_cast<std::uint32_t>(c.node));
      if (c.output) {
        ours_[std::size_t(c.bus)][std::size_t(c.output->node)] = true;
        nodes_[std::size_t(c.bus)].push_back(static_cast<std::uint32_t>(c.output->node));
      }
    }
    for (const bridge::GatewayConfig& c : fed_.config.gateways) {
      ours_[std::size_t(c.bus)][std::size_t(c.node)] = true;
      nodes_[std::size_t(c.bus)].push_back(static_cast<std::uint32_t>(c.node));
    }
    fed_.robot.frequency_rad_s = 2.3;  // 3.68 rad/s at most: into the taper, not beyond the limit
    fed_.Start();
  }

  bool Run(std::uint64_t frames) {
    const auto began = std::chrono::steady_clock::now();
    for (std::uint64_t episode = 0; fuzzed_ < frames && bad_ == 0; ++episode) {
      Episode(static_cast<Trouble>(episode % kNames.size()));
      if (fuzzed_ / 10'000'000 != printed_) {
        printed_ = fuzzed_ / 10'000'000;
        std::printf("%llu frames\n", static_cast<unsigned long long>(fuzzed_));
        std::fflush(stdout);
      }
    }
    const double seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
    Report(seconds);
    return bad_ == 0 && fed_.watch.counts().violations == 0 && moved_as_commanded_ > 0;
  }

 private:
  void Command(bool wild) {
    for (std::size_t j = 0; j < kJoints; ++j) {
      const std::uint32_t choice = random_.Below(6);
      fed_.command.mode[j] = choice < 2 ? ControlMode::kIdle : static_cast<ControlMode>(choice - 2);
      Demand(j, wild);
      fed_.command.valve_open[j] = random_.Below(2) == 0;
      fed_.command.compressor_on[j] = random_.Below(2) == 0;
      fed_.command.vent_open[j] = random_.Below(2) == 0;
    }
  }
  void Demand(std::size_t j, bool wild) {
    fed_.command.motor_torque_Nm[j] = random_.Within(0.5);
    fed_.command.position_rad[j] = random_.Within(2.0);
    fed_.command.velocity_rad_s[j] = random_.Within(6.0);
    if (!wild || random_.Below(64) != 0) return;
    constexpr std::array kWild = {std::numeric_limits<double>::quiet_NaN(),
                                  std::numeric_limits<double>::infinity(), 1e300, -1e300, 1e-300};
    fed_.command.motor_torque_Nm[j] = kWild[random_.Below(kWild.size())];
    fed_.command.position_rad[j] = kWild[random_.Below(kWild.size())];
    fed_.command.velocity_rad_s[j] = kWild[random_.Below(kWild.size())];
  }

  void Episode(Trouble trouble) {
    const bool harmless = trouble == Trouble::kNoise || trouble == Trouble::kFlood;
    ++episodes_[std::size_t(trouble)];
    // All idle, all well.
    fed_.command = {};
    for (int i = 0; i < 4; ++i) Cycle(trouble, 0);
    fed_.plant.ClearFault();
    for (int i = 0; i < 4; ++i) Cycle(trouble, 0);
    fed_.plant.ClearFault();
    Command(trouble == Trouble::kStorm);
    ChooseVictims(trouble);
    for (int cycle = 0; cycle < kCycles && bad_ == 0; ++cycle) {
      for (std::size_t j = 0; j < kJoints; ++j) Demand(j, trouble == Trouble::kStorm);
      if (!harmless && random_.Below(16) == 0) fed_.plant.ClearFault();
      if (trouble == Trouble::kStorm && random_.Below(16) == 0) Command(true);
      Cycle(trouble, Burst(trouble));
      if (!harmless) {
        for (int j = 0; j < kJoints; ++j) ++faults_[std::size_t(fed_.plant.fault(j))];
      }
      if (!harmless && trouble != Trouble::kForged) continue;
      for (int j = 0; j < kJoints; ++j) {
        if (trouble == Trouble::kForged && victim_[std::size_t(j)]) continue;
        if (fed_.plant.fault(j) != types::FaultCause::kNone) {
          return Bad("a fault though nothing was wrong: " + fed_.sensors.message);
        }
        const bool moves = fed_.command.mode[std::size_t(j)] != ControlMode::kIdle;
        if (!moves || cycle < kArmingCycles) continue;
        if (!fed_.watch.moved_as_commanded(j)) return Bad("a joint did not get its command");
        ++moved_as_commanded_;
      }
    }
  }

  void ChooseVictims(Trouble trouble) {
    for (auto& nodes : forged_) nodes.clear();
    for (std::size_t j = 0; j < kJoints; ++j) {
      victim_[j] = trouble != Trouble::kForged || random_.Below(3) == 0;
    }
    for (const bridge::GatewayConfig& gateway : fed_.config.gateways) {
      if (trouble == Trouble::kForged && random_.Below(2) == 0) continue;
      forged_[std::size_t(gateway.bus)].push_back(static_cast<std::uint32_t>(gateway.node));
      for (const int j : gateway.joints) victim_[std::size_t(j)] = true;
    }
    for (std::size_t j = 0; j < kJoints; ++j) {
      if (!victim_[j]) continue;
      const bridge::JointConfig& c = fed_.config.joints[j];
      forged_[std::size_t(c.bus)].push_back(static_cast<std::uint32_t>(c.node));
      if (c.output) {
        forged_[std::size_t(c.bus)].push_back(static_cast<std::uint32_t>(c.output->node));
      }
    }
  }

  std::uint32_t Burst(Trouble trouble) {
    switch (trouble) {
      case Trouble::kFlood:
        return random_.Below(4) == 0 ? 1500 : 20;
      case Trouble::kForged:
      case Trouble::kStorm:
        return random_.Below(200) == 0 ? 3000 : 5 + random_.Below(60);
      case Trouble::kNoise:
      case Trouble::kMutated:
        break;
    }
    return 100;
  }

  void Cycle(Trouble trouble, std::uint32_t frames) {
    fed_.Advance();
    fed_.SendMessages(false);
    for (std::size_t bus = 0; frames > 0 && bus < kBuses; ++bus) {
      honest_ = fed_.buses[bus].feed;
      std::vector<can::Frame>& feed = fed_.buses[bus].feed;
      const bool before = random_.Below(2) == 0;  // the trouble comes before or after the truth
      if (before) feed.clear();
      const bool same = frames >= 1000;  // a flood is one frame again and again, or two
      can::Frame frame = Make(trouble, bus);
      for (std::uint32_t i = 0; i < frames; ++i) {
        feed.push_back(frame);
        if (!same || random_.Below(700) == 0) frame = Make(trouble, bus);
      }
      if (before) feed.insert(feed.end(), honest_.begin(), honest_.end());
      fuzzed_ += frames;
      by_trouble_[std::size_t(trouble)] += frames;
    }
    unread_ += fed_.Cycle();
    ++cycles_;
    longest_message_ = std::max(longest_message_, fed_.sensors.message.size());
    if (fed_.watch.counts().violations > 0) Bad(fed_.watch.first_violation());
  }

  can::Frame Make(Trouble trouble, std::size_t bus) {
    switch (trouble) {
      case Trouble::kNoise:
      case Trouble::kFlood:
        return Noise(bus);
      case Trouble::kForged:
        return Forged(bus);
      case Trouble::kMutated:
        return Mutated(bus);
      case Trouble::kStorm:
        break;
    }
    switch (random_.Below(3)) {
      case 0:
        return Noise(bus);
      case 1:
        return Forged(bus);
      default:
        return Mutated(bus);
    }
  }

  // Nothing that a node of ours could have said.
  can::Frame Noise(std::size_t bus) {
    can::Frame frame;
    FillData(random_, &frame);
    const std::uint64_t bits = random_();
    frame.length = static_cast<std::uint8_t>(bits % 16 < 9 ? bits % 16 : bits >> 8);
    frame.id = static_cast<std::uint32_t>(bits >> 32);
    switch (bits >> 16 & 7) {
      case 0:  // extended, possible or not
        frame.extended = true;
        break;
      case 1:
        frame.error = true;
        frame.id = OurId(bus);
        break;
      case 2:  // somebody asks our nodes
        frame.remote = true;
        frame.id = OurId(bus);
        break;
      case 3:
      case 4:  // in our nodes' names, too short or too long for any message the bridge reads
        frame.id = OurId(bus);
        if (frame.length >= 4 && frame.length <= 8) frame.length = frame.length % 2 == 0 ? 3 : 9;
        break;
      case 5:  // an identifier that no bus can carry
        frame.id |= 0x800;
        break;
      default:
        frame.id &= 0x7FF;
        if (ours_[bus][frame.id >> 5]) frame.id = (frame.id & 31) | 0x7E0;  // node 63 is not used
        break;
    }
    return frame;
  }

  std::uint32_t OurId(std::size_t bus) {
    const auto& nodes = nodes_[bus];
    return nodes[random_.Below(static_cast<std::uint32_t>(nodes.size()))] << 5 | random_.Below(32);
  }

  can::Frame Forged(std::size_t bus) {
    const auto& nodes = forged_[bus];
    if (nodes.empty()) return Noise(bus);
    static constexpr std::array<std::uint32_t, 8> kKinds = {0x01, 0x03, 0x04, 0x09,
                                                            0x0A, 0x14, 0x1D, 0x01};
    can::Frame frame;
    frame.id = nodes[random_.Below(static_cast<std::uint32_t>(nodes.size()))] << 5 |
               kKinds[random_.Below(8)];
    if (frame.id >> 5 == kGatewayNode) frame.id = kGatewayNode << 5 | (1 + random_.Below(18));
    frame.length = random_.Below(8) == 0 ? static_cast<std::uint8_t>(random_.Below(10)) : 8;
    FillData(random_, &frame);
    if ((frame.id & 31) == 0x01 && random_.Below(2) == 0) {  // a heartbeat that could be true
      frame.data = {};
      frame.data[4] = static_cast<std::uint8_t>(random_.Below(2) == 0 ? 8 : random_.Below(14));
      if (random_.Below(4) == 0) frame.data[random_.Below(3)] = 1 << random_.Below(8);
    }
    return frame;
  }

  can::Frame Mutated(std::size_t bus) {
    if (honest_.empty()) return Noise(bus);
    can::Frame frame = honest_[random_.Below(static_cast<std::uint32_t>(honest_.size()))];
    for (std::uint32_t n = random_.Below(3); n-- > 0;) {
      const std::uint32_t where = random_.Below(88);
      if (where < 64) {
        frame.data[where / 8] ^= static_cast<std::uint8_t>(1U << where % 8);
      } else if (where < 75) {
        frame.id ^= 1U << (where - 64);
      } else if (where < 80) {
        frame.length = static_cast<std::uint8_t>(random_.Below(10));
      } else if (where < 82) {
        frame.remote = !frame.remote;
      } else if (where < 83) {
        frame.extended = !frame.extended;
      } else {
        frame.data[where - 80] = static_cast<std::uint8_t>(random_());
      }
    }
    return frame;
  }

  void Bad(const std::string& what) {
    if (bad_++ == 0) std::printf("BROKEN in cycle %ld: %s\n", cycles_, what.c_str());
  }

  void Report(double seconds) const {
    const fuzz::WatchCounts& counts = fed_.watch.counts();
    const auto number = [](const char* name, std::uint64_t value) {
      std::printf("%-34s %12llu\n", name, static_cast<unsigned long long>(value));
    };
    number("fuzzed frames", fuzzed_);
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      std::printf("  %-8s %8ld episodes %16llu\n", kNames[i], episodes_[i],
                  static_cast<unsigned long long>(by_trouble_[i]));
    }
    number("frames the plant took", counts.received);
    number("never read, a flood's rest", unread_);
    number("counted as malformed", fed_.plant.malformed());
    number("cycles of 12 joints", static_cast<std::uint64_t>(cycles_));
    number("frames sent, every one assessed", counts.sent);
    number("setpoints", counts.setpoints);
    number("  that ask for motion", counts.moving);
    number("  checked to be the command", moved_as_commanded_);
    std::printf("joint-cycles by fault, where trouble can make one:");
    for (std::size_t i = 0; i < faults_.size(); ++i) {
      std::printf("%s %s %llu", i == 0 ? "" : ",",
                  types::TermsOf(static_cast<types::FaultCause>(i)).name.data(),
                  static_cast<unsigned long long>(faults_[i]));
    }
    std::printf("\nlongest message of a fault: %zu characters\n", longest_message_);
    std::printf("%.1f s, %.0f ns per frame\n", seconds,
                1e9 * seconds / static_cast<double>(std::max<std::uint64_t>(fuzzed_, 1)));
    std::printf("%llu rules broken: %s\n", static_cast<unsigned long long>(counts.violations),
                bad_ == 0 ? "no wrong joint moved" : "FAILED");
  }

  Random random_;
  fuzz::WatchedPlant fed_;
  std::array<std::array<bool, 64>, kBuses> ours_{};
  std::array<std::vector<std::uint32_t>, kBuses> nodes_;
  std::array<std::vector<std::uint32_t>, kBuses> forged_;  // nodes that are forged in an episode
  std::array<bool, kJoints> victim_{};
  std::vector<can::Frame> honest_;

  std::uint64_t fuzzed_ = 0;
  std::uint64_t printed_ = 0;
  std::uint64_t unread_ = 0;
  std::uint64_t moved_as_commanded_ = 0;
  std::array<std::uint64_t, kNames.size()> by_trouble_{};
  std::array<long, kNames.size()> episodes_{};
  std::array<std::uint64_t, types::kFaultCauses> faults_{};
  std::size_t longest_message_ = 0;
  long cycles_ = 0;
  int bad_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  const std::uint64_t frames = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 100'000'000;
  const std::uint64_t seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 1;
  std::printf("seed %llu\n", static_cast<unsigned long long>(seed));
  bool good = true;
  for (const bool gateway : {false, true}) {
    std::printf("\n%s\n",
                gateway ? "six of the joints behind a gateway" : "every joint for itself");
    good = std::make_unique<Soak>(seed, gateway)->Run(frames / 2) && good;
  }
  return good ? 0 : 1;
}
