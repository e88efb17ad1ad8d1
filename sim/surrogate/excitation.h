// Motions with which the rig is recorded: an operator's plan, made from a seed, and the controller
// that follows it (PD at the motor side with gravity, pressure, inertia and friction fed forward
// from nominal values, in torque mode).
//
// designed: multisines, chirps, ramps, very slow ramps, rest, pressure steps with the valve open
// and shut, a hand on the load cell. task: a 30 degree sine at 0.4 Hz and 4 bar with pauses, nobody
// touching. The plan repeats until the duration is filled. One owner; not for loops in real time.
#pragma once

#include <cstdint>
#include <string_view>
#include <vector>

#include "components/robot/provider/simulated_plant.h"
#include "sim/surrogate/parameters.h"
#include "sim/surrogate/random.h"

namespace sinew::surrogate {

enum class ExcitationKind { kDesigned, kTask, kSea, kPea };

// Throws std::invalid_argument naming what there is.
ExcitationKind ParseExcitation(std::string_view text);

struct ExcitationParameters {
  ExcitationKind kind = ExcitationKind::kDesigned;
  double duration_s = 90.0;
  // The controller's nominal values of the rig.
  double payload_kg = 0.0;
  double pneumatic_Nm_bar = 0.3587;
  double pneumatic_stiffness_Nm_rad_bar = 0.0;
  double largest_angle_rad = 0.75;
  double largest_hand_N = 10.0;
  double lowest_pressure_bar = 1.0;
  double highest_pressure_bar = 5.5;
  std::uint64_t seed = 1;
};

class Excitation {
 public:
  explicit Excitation(const ExcitationParameters& parameters);  // throws std::invalid_argument

  // The command of a cycle (an experiment's CommandFunction).
  void operator()(double time_s, const provider::PlantSensors& sensors,
                  provider::PlantCommand* command, provider::Disturbance* disturbance) const;

  double Reference_rad(double time_s) const;  // designed, task; of the hand in pea
  double Hand_N(double time_s) const;
  // Sets the rig's position and lock at the start of the experiment.
  void Prepare(RigParameters* rig) const;

  double initial_pressure_bar() const { return pressure_[0].target_bar; }

 private:
  enum class Shape { kMultisine, kChirp, kTriangle, kRest };
  struct Sine {
    double amplitude = 0.0;
    double frequency_Hz = 0.0;
    double phase_rad = 0.0;
  };
  struct Segment {
    Shape shape = Shape::kRest;
    double start_s = 0.0;
    double length_s = 0.0;
    double centre_rad = 0.0;
    double amplitude_rad = 0.0;
    double start_Hz = 0.0;  // chirp; triangle
    double end_Hz = 0.0;
    std::vector<Sine> sines{};
    double hand_N = 0.0;  // 0: nobody pushes
    std::vector<Sine> hand_sines{};
  };
  struct PressureStep {
    double start_s = 0.0;
    double target_bar = 0.0;
    bool valve_open = true;
  };

  struct Stroke {  // of the hand: one push in sea, one way down and up in pea
    double start_s = 0.0;
    double length_s = 0.0;
    double size = 0.0;  // N, or rad
  };

  double Planned_s() const;  // where the next segment begins
  void Add(Segment segment);
  void PlanTask(RandomStream* random);
  void PlanDesigned(RandomStream* random);
  void PlanPressure(RandomStream* random);
  void PlanStrokes(RandomStream* random);
  double PeaHand_N(double time_s, const provider::PlantSensors& sensors) const;
  static double ShapeValue(const Segment& segment, double local_s);
  static std::vector<Sine> MakeSines(RandomStream* random, int count, double lowest_Hz,
                                     double highest_Hz, double slope);

  ExcitationParameters parameters_;
  std::vector<Segment> segments_;
  std::vector<PressureStep> pressure_;
  std::vector<Stroke> strokes_;
};

}  // namespace sinew::surrogate
