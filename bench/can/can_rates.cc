// How many cycles a second the buses carry, from bit-true frames: the planned exchange of twelve
// joints is played through the bus model (bridge/can/bus_model.h) and the rate raised until a cycle
// is no longer over when the next begins.
//   build/release/bin/can_rates [seconds of bus time per try]     default 5
//
// Every cycle starts with everything that is due in it; answers are offered the moment their
// question ended. Heartbeats are in all of it, 10 Hz from each of the twelve controllers,
// behind the gateway as well.
//
//   random   plausible content; each heartbeat in a cycle of its own
//   worst    for each frame the data with the most stuff bits that a search finds
//   together the same, and all heartbeats of a bus in one cycle, as after a common switch-on
//   bound    WorstFrameBits of every frame, which no content exceeds; one heartbeat in the fullest
//            cycle
//
// Rates: setpoints and estimates of every cycle over before the next begins ("set, est"), with Iq
// ("all"), and the mean over many cycles that fills the bus ("full bus").
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <tuple>
#include <vector>

#include "bridge/can/bit_timing.h"
#include "bridge/can/body_node.h"
#include "bridge/can/bus_model.h"
#include "bridge/can/codec.h"
#include "bridge/can/compact.h"

namespace {

using namespace sinew::can;

constexpr double kBitrate_bit_s = 1e6;
constexpr double kHeartbeat_Hz = 10.0;
constexpr int kJoints = 12;
constexpr int kGatewayNode = 0;
// Of body nodes: the first numbers behind those of twelve controllers and their sensor nodes.
constexpr int kFootNode = 60;
constexpr int kImuNode = 61;

enum class Content { kRandom, kWorst };

// What one bus carries in a cycle.
struct Plan {
  const char* name;
  int axes = 0;            // controllers with heartbeats on this bus
  bool compact = false;    // all joints through one gateway
  bool requested = false;  // estimates are asked for, else sent by themselves once a cycle
  int iq_every = 0;        // of an axis; 0: never
  bool iq_spread = false;  // a part of the axes each cycle, else all in the same one
  bool iq_asked = true;    // else sent by the controllers themselves
  bool foot = false;       // a foot and the IMU as nodes of their own on this bus
  bool imu = false;
};

// The data that take longest: hill climbing from several starts, repeatable.
Frame Worst(Frame frame) {
  if (frame.remote || frame.length == 0) return frame;
  static std::map<std::pair<std::uint32_t, int>, Frame> found;
  const auto key = std::make_pair(frame.id, static_cast<int>(frame.length));
  if (const auto it = found.find(key); it != found.end()) return it->second;
  std::mt19937 random(frame.id);
  Frame best = frame;
  for (int start = 0; start < 12; ++start) {
    Frame now = frame;
    // 0x3C and 0xC3: runs of four, which the stuff bits lengthen; 0x00 and 0xFF; anything.
    constexpr std::uint8_t kStarts[] = {0x00, 0xFF, 0x0F, 0xF0, 0x3C, 0xC3, 0x1E, 0x87};
    for (std::size_t i = 0; i < frame.length; ++i) {
      now.data[i] = start < 8 ? kStarts[start] : static_cast<std::uint8_t>(random());
    }
    int bits = FrameBits(now);
    for (int step = 0; step < 400; ++step) {
      Frame next = now;
      for (unsigned flips = 1 + random() % 3; flips > 0; --flips) {
        next.data[random() % frame.length] ^= static_cast<std::uint8_t>(1U << random() % 8);
      }
      const int next_bits = FrameBits(next);
      if (next_bits < bits) continue;
      now = next;
      bits = next_bits;
    }
    if (bits > FrameBits(best)) best = now;
  }
  return found[key] = best;
}

struct Played {
  double load_percent = 0.0;
  double exchange_bits = 0.0;     // of a cycle, mean; heartbeats are not in it
  double heartbeat_bits_s = 0.0;  // a second
  // From the start of a cycle to the last bit of its last frame: of setpoints and estimates, and of
  // everything but heartbeats.
  double fast_p50_ms = 0.0;
  double fast_max_ms = 0.0;
  double all_p50_ms = 0.0;
  double all_max_ms = 0.0;
  bool refused = false;
};

class Player {
 public:
  Player(const Plan& plan, Content content, bool together)
      : plan_(plan), content_(content), together_(together) {}

  Played Play(double rate_Hz, double seconds) {
    std::mt19937 random(11);
    random_ = &random;
    sequence_ = 0;
    const auto period_ns = static_cast<std::int64_t>(std::llround(1e9 / rate_Hz));
    const auto cycles = static_cast<std::int64_t>(seconds * rate_Hz);
    Run run(plan_, together_, static_cast<std::size_t>(cycles));
    const std::function<void(const Delivery&)> deliver = [&](const Delivery& d) {
      Deliver(run, d);
    };
    for (std::int64_t cycle = 0; cycle < cycles && !run.refused; ++cycle) {
      AdvanceWithAnswers(run.bus, cycle * period_ns, deliver);
      OfferCycle(run, cycle, cycle * period_ns);
    }
    AdvanceWithAnswers(run.bus, cycles * period_ns + 1'000'000'000, deliver);
    Played played;
    played.refused = run.refused;
    const double time_ns = static_cast<double>(cycles * period_ns);
    played.load_percent = 100.0 * static_cast<double>(run.bus.counters().busy_ns) / time_ns;
    played.exchange_bits = static_cast<double>(run.exchange_bits) / static_cast<double>(cycles);
    played.heartbeat_bits_s = static_cast<double>(run.heartbeat_bits) / (1e-9 * time_ns);
    const auto latencies = [&](const std::vector<std::int64_t>& end_ns, double* p50, double* most) {
      std::vector<double> ms;
      for (std::size_t c = 0; c < end_ns.size(); ++c) {
        ms.push_back(1e-6 * static_cast<double>(end_ns[c] - std::int64_t(c) * period_ns));
      }
      std::sort(ms.begin(), ms.end());
      *p50 = ms[ms.size() / 2];
      *most = ms.back();
    };
    latencies(run.fast_end_ns, &played.fast_p50_ms, &played.fast_max_ms);
    latencies(run.all_end_ns, &played.all_p50_ms, &played.all_max_ms);
    return played;
  }

  // The highest whole rate at which every cycle is over before the next: all of it, or setpoints
  // and estimates.
  int HighestRate(double seconds, bool all) {
    int low = 50, high = 1000;
    while (high - low > 1) {
      const int middle = (low + high) / 2;
      const Played played = Play(middle, seconds);
      const double last_ms = all ? played.all_max_ms : played.fast_max_ms;
      (!played.refused && last_ms <= 1e3 / middle ? low : high) = middle;
    }
    return low;
  }

 private:
  // The bus with its nodes, and what one play has counted on it.
  struct Run {
    struct Beating {  // sends heartbeats
      int node, number;
      double next_s;
    };

    BusModel bus{{.bitrate_bit_s = kBitrate_bit_s, .queue_frames = 4096}};
    int master, gateway, foot, imu;
    std::vector<int> axes;
    std::vector<Beating> beating;
    std::vector<std::int64_t> fast_end_ns, all_end_ns;  // of each cycle
    // Frames of one identifier come in the order they were offered: their cycles.
    std::map<std::pair<std::uint32_t, bool>, std::deque<std::int64_t>> waiting;
    bool refused = false;
    std::int64_t exchange_bits = 0, heartbeat_bits = 0;
    int references_received = 0;

    Run(const Plan& plan, bool together, std::size_t cycles)
        : fast_end_ns(cycles), all_end_ns(cycles) {
      master = bus.Attach();
      gateway = bus.Attach();
      for (int a = 0; a < plan.axes; ++a) axes.push_back(bus.Attach());
      foot = bus.Attach();
      imu = bus.Attach();
      for (int a = 0; a < plan.axes; ++a) beating.push_back({axes[std::size_t(a)], a + 1, 0.0});
      if (plan.foot) beating.push_back({foot, kFootNode, 0.0});
      if (plan.imu) beating.push_back({imu, kImuNode, 0.0});
      for (std::size_t a = 0; a < beating.size() && !together; ++a) {
        beating[a].next_s =
            static_cast<double>(a) / (static_cast<double>(beating.size()) * kHeartbeat_Hz);
      }
    }
  };

  void Offer(Run& run, int node, const Frame& frame, std::int64_t cycle, std::int64_t now_ns) {
    run.waiting[{frame.id, frame.remote}].push_back(cycle);
    if (!run.bus.Offer(node, content_ == Content::kWorst ? Worst(frame) : frame, now_ns)) {
      run.refused = true;
    }
  }

  // Counts a frame that is over, and answers it.
  void Deliver(Run& run, const Delivery& d) {
    auto& queue = run.waiting[{d.frame.id, d.frame.remote}];
    const std::int64_t cycle = queue.front();
    queue.pop_front();
    if (IsHeartbeat(d.frame)) {
      run.heartbeat_bits += FrameBits(d.frame);
      return;
    }
    run.exchange_bits += FrameBits(d.frame);
    const auto c = static_cast<std::size_t>(cycle);
    run.all_end_ns[c] = std::max(run.all_end_ns[c], d.end_ns);
    if (!IsIq(d.frame)) run.fast_end_ns[c] = std::max(run.fast_end_ns[c], d.end_ns);
    if (d.senders.front() != run.master) return;
    if (plan_.compact) {
      if (++run.references_received % kCompactReferenceFrames != 0) return;
      for (const Frame& frame : State()) Offer(run, run.gateway, frame, cycle, d.end_ns);
    } else if (d.frame.remote) {
      const auto address = AddressOf(d.frame);
      Offer(run, run.axes[std::size_t(address->node - 1)], Answer(*address), cycle, d.end_ns);
    }
  }

  // Offers everything that is due in a cycle.
  void OfferCycle(Run& run, std::int64_t cycle, std::int64_t start_ns) {
    for (Run::Beating& beating : run.beating) {
      if (1e-9 * static_cast<double>(start_ns) < beating.next_s) continue;
      beating.next_s += 1.0 / kHeartbeat_Hz;
      const Frame heartbeat =
          beating.number >= kFootNode
              ? Encode(beating.number, NodeHeartbeat{})
              : Encode(beating.number, Heartbeat{0, AxisState::kClosedLoopControl});
      Offer(run, beating.node, heartbeat, cycle, start_ns);
    }
    if (plan_.foot) Offer(run, run.foot, Foot(), cycle, start_ns);
    if (plan_.imu) {
      for (const Frame& frame : Imu()) Offer(run, run.imu, frame, cycle, start_ns);
    }
    if (plan_.compact) {
      for (const Frame& frame : References()) Offer(run, run.master, frame, cycle, start_ns);
      return;
    }
    for (int a = 0; a < plan_.axes; ++a) {
      const bool iq =
          plan_.iq_every > 0 && (cycle + (plan_.iq_spread ? a : 0)) % plan_.iq_every == 0;
      Offer(run, run.master, Trim(Encode(a + 1, SetInputTorque{Uniform(0.3)})), cycle, start_ns);
      for (const auto& [due, asked, command] :
           {std::tuple{true, plan_.requested, Command::kGetEncoderEstimates},
            std::tuple{iq, plan_.iq_asked, Command::kGetIq}}) {
        if (!due) continue;
        if (asked) {
          Offer(run, run.master, EncodeRequest(a + 1, command), cycle, start_ns);
        } else {
          Offer(run, run.axes[std::size_t(a)], Answer({a + 1, command}), cycle, start_ns);
        }
      }
    }
  }

  bool IsHeartbeat(const Frame& frame) const {
    // The gateway's node is 0, and 0x01 there are references.
    const auto address = AddressOf(frame);
    return address->command == Command::kHeartbeat && address->node > 0;
  }
  bool IsIq(const Frame& frame) const {
    return !plan_.compact && AddressOf(frame)->command == Command::kGetIq;
  }
  // Answers are offered when their question ends, so time must not pass beyond that.
  static void AdvanceWithAnswers(BusModel& bus, std::int64_t until_ns,
                                 const std::function<void(const Delivery&)>& deliver) {
    std::vector<Delivery> done;
    for (auto end = bus.NextEnd(); end && *end <= until_ns; end = bus.NextEnd()) {
      done.clear();
      bus.Advance(*end, [&done](const Delivery& d) { done.push_back(d); });
      for (const Delivery& d : done) deliver(d);
    }
    bus.Advance(until_ns, deliver);
  }

  double Uniform(double most) {
    return std::uniform_real_distribution<double>(-most, most)(*random_);
  }
  Frame Answer(const Address& address) {
    if (address.command == Command::kGetIq) {
      const double iq_A = Uniform(20.0);
      return Encode(address.node, Iq{iq_A + Uniform(0.5), iq_A});
    }
    return Encode(address.node, EncoderEstimates{Uniform(30.0), Uniform(40.0)});
  }
  Frame Foot() {
    FootForces forces;
    for (double& force_N : forces.force_N) force_N = 200.0 + Uniform(200.0);
    forces.valid.fill(true);
    forces.sequence = ++sequence_;
    return Encode(kFootNode, forces);
  }
  std::array<Frame, 3> Imu() {
    ImuForce force{{Uniform(15.0), Uniform(15.0), Uniform(15.0)}, ++sequence_, true, true, true};
    const ImuRate rate{{Uniform(5.0), Uniform(5.0), Uniform(5.0)}, sequence_, 40};
    const ImuOrientation orientation{{Uniform(0.2), Uniform(0.2), Uniform(0.2)}, sequence_, 0};
    return {Encode(kImuNode, force), Encode(kImuNode, rate), Encode(kImuNode, orientation)};
  }
  std::array<Frame, kCompactReferenceFrames> References() {
    CompactReferences references;
    for (double& turns : references.position_turns) turns = Uniform(30.0);
    return EncodeReferences(kGatewayNode, references);
  }
  std::array<Frame, kCompactStateFrames> State() {
    CompactState state;
    for (double& turns : state.position_turns) turns = Uniform(30.0);
    for (double& turns_s : state.velocity_turns_s) turns_s = Uniform(40.0);
    for (double& iq_A : state.iq_A) iq_A = Uniform(20.0);
    for (double& force_N : state.force_N) force_N = 200.0 + Uniform(200.0);
    for (double& a : state.acceleration_m_s2) a = Uniform(15.0);
    for (double& w : state.angular_velocity_rad_s) w = Uniform(5.0);
    for (double& angle : state.roll_pitch_yaw_rad) angle = Uniform(0.5);
    state.sequence = ++sequence_;
    return EncodeState(kGatewayNode, state);
  }

  Plan plan_;
  Content content_;
  bool together_;
  std::mt19937* random_ = nullptr;
  std::uint8_t sequence_ = 0;
};

// Bits of a cycle at worst stuffing, without heartbeats; `with_iq` for the fullest cycle.
int BoundBits(const Plan& plan, bool fullest) {
  if (plan.compact) {
    return (kCompactReferenceFrames + kCompactStateFrames - 1) * WorstFrameBits(8) +
           WorstFrameBits(4);
  }
  int bits = plan.axes * (WorstFrameBits(4) + WorstFrameBits(8));
  if (plan.requested) bits += plan.axes * WorstFrameBits(0);
  if (plan.foot) bits += WorstFrameBits(8);
  if (plan.imu) bits += 3 * WorstFrameBits(8);
  if (plan.iq_every == 0) return bits;
  const int asked = plan.iq_spread ? (plan.axes + plan.iq_every - 1) / plan.iq_every : plan.axes;
  const double count = fullest ? asked : static_cast<double>(plan.axes) / plan.iq_every;
  return bits + static_cast<int>(std::lround(
                    count * (WorstFrameBits(8) + (plan.iq_asked ? WorstFrameBits(0) : 0))));
}

void PrintPlan(const Plan& plan, int goal_Hz, double seconds) {
  std::printf("\n%s\n", plan.name);
  std::printf("  %-16s | %10s %8s | %21s | %21s | %s\n", "", "", "", "setpoints, estimates",
              "with Iq", "highest rate, Hz");
  std::printf("  %-16s | %10s %8s | %10s %10s | %10s %10s | %9s %9s %9s\n", "content", "bits/cycle",
              "load", "p50 ms", "max ms", "p50 ms", "max ms", "set, est", "all", "full bus");
  const auto row = [&](const char* name, Content content, bool together) {
    Player player(plan, content, together);
    const Played p = player.Play(goal_Hz, seconds);
    std::printf("  %-16s | %10.0f %6.1f %% | %10.3f %10.3f | %10.3f %10.3f | %9d %9d %9.0f\n", name,
                p.exchange_bits, p.load_percent, p.fast_p50_ms, p.fast_max_ms, p.all_p50_ms,
                p.all_max_ms, player.HighestRate(seconds, false), player.HighestRate(seconds, true),
                (kBitrate_bit_s - p.heartbeat_bits_s) / p.exchange_bits);
  };
  row("random", Content::kRandom, false);
  row("worst", Content::kWorst, false);
  row("worst, together", Content::kWorst, true);
  const int beating = plan.axes + (plan.foot ? 1 : 0) + (plan.imu ? 1 : 0);
  const double heartbeat_bits_s = kHeartbeat_Hz * beating * WorstFrameBits(8);
  const int mean_bits = BoundBits(plan, false);
  // One heartbeat in the fullest cycle.
  const int full_bits = BoundBits(plan, true) + WorstFrameBits(8);
  std::printf("  %-16s | %10d %6.1f %% | %10s %10s | %10s %10.3f | %9s %9.0f %9.0f\n", "bound",
              mean_bits, 100.0 * (goal_Hz * mean_bits + heartbeat_bits_s) / kBitrate_bit_s, "", "",
              "", 1e3 * full_bits / kBitrate_bit_s, "", kBitrate_bit_s / full_bits,
              (kBitrate_bit_s - heartbeat_bits_s) / mean_bits);
}

}  // namespace

int main(int argc, char** argv) {
  const double seconds = argc > 1 ? std::atof(argv[1]) : 5.0;
  std::printf("load and times at the goal's rate, from the start of a cycle\n");
  std::printf("\n== twelve joints through a gateway on one bus of 1 Mbit/s, goal 400 Hz\n");
  PrintPlan({.name = "compact frames; the gateway answers the third of the references",
             .axes = kJoints,
             .compact = true},
            400, seconds);

  std::printf("\n== twelve joints on two buses of 1 Mbit/s, CANSimple: six on each, goal 500 Hz\n");
  const int per_bus = kJoints / 2;
  PrintPlan({.name = "estimates by themselves; Iq of all asked for in every fourth cycle",
             .axes = per_bus,
             .iq_every = 4},
            500, seconds);
  PrintPlan({.name = "estimates by themselves; Iq of one or two asked for in each cycle",
             .axes = per_bus,
             .iq_every = 4,
             .iq_spread = true},
            500, seconds);
  PrintPlan({.name = "estimates by themselves; Iq by themselves in every fourth cycle",
             .axes = per_bus,
             .iq_every = 4,
             .iq_asked = false},
            500, seconds);
  PrintPlan({.name = "estimates asked for; Iq of all asked for in every fourth cycle",
             .axes = per_bus,
             .requested = true,
             .iq_every = 4},
            500, seconds);
  PrintPlan({.name = "estimates asked for; Iq of one or two asked for in each cycle",
             .axes = per_bus,
             .requested = true,
             .iq_every = 4,
             .iq_spread = true},
            500, seconds);
  PrintPlan({.name = "estimates and Iq by themselves in each cycle",
             .axes = per_bus,
             .iq_every = 1,
             .iq_asked = false},
            500, seconds);

  std::printf("\n== the same two buses, each foot on its leg's bus, the IMU on one, goal 400 Hz\n");
  PrintPlan({.name = "bus with a foot and the IMU; estimates by themselves, no Iq",
             .axes = per_bus,
             .foot = true,
             .imu = true},
            400, seconds);
  PrintPlan({.name = "bus with a foot and the IMU; Iq of one or two asked for in each cycle",
             .axes = per_bus,
             .iq_every = 4,
             .iq_spread = true,
             .foot = true,
             .imu = true},
            400, seconds);
  PrintPlan({.name = "bus with a foot only; Iq of one or two asked for in each cycle",
             .axes = per_bus,
             .iq_every = 4,
             .iq_spread = true,
             .foot = true},
            400, seconds);
}
