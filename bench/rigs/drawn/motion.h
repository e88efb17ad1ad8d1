// The commands of one recording of a rig: reference, pressure, hand, payload.
#pragma once

#include <string>
#include <vector>

#include "bench/rigs/drawn/random.h"
#include "bench/rigs/drawn/rig.h"

namespace sinew::rigs {

enum class Excitation { kDesigned, kTask, kLocked };
const char* WordOf(Excitation excitation);

// Recordings 0 to 2 are for training, 3 is held out: another motion.
inline constexpr int kRecordings = 4;

class Motion {
 public:
  Motion(const Rig& rig, Excitation excitation, int recording);

  double Reference(double t) const;   // raw; the servo smooths it
  double Pressure(double t) const;    // bar, of the regulator
  bool Valve(double t) const;         // chamber joined to the regulator
  double Hand(double t) const;        // N at the load cell, presses down
  double HandTarget(double t) const;  // locked: position that the hand follows
  double payload_kg() const { return payload_kg_; }
  double ambient_degC() const { return ambient_degC_; }
  double start_degC() const { return start_degC_; }
  double duration_s() const { return duration_s_; }
  bool locked() const { return locked_; }
  int recording() const { return recording_; }

 private:
  struct Sine {
    double amplitude, omega, phase;
  };
  struct Part {
    enum { kSines, kChirp, kRamps, kPoints, kRest } kind = kSines;
    double begin = 0.0, end = 0.0;
    std::vector<Sine> sines;
    double low = 0.0, high = 0.0;    // of ramps; Hz of a chirp
    double period = 1.0;             // of ramps
    std::vector<double> points;      // kPoints: a move and a dwell each
    double move = 0.0, dwell = 0.0;  // s
  };
  struct Push {
    double begin, length, force;
  };
  enum Piece { kFast, kSweep, kSlow, kCreep, kStop, kAgain };  // of a designed motion

  double Of(const Part& part, double t) const;
  void DrawDesigned(const Rig& rig, bool held_out, Random& random);
  Part DrawPart(const Rig& rig, Piece piece, double begin, double end, bool held_out,
                Random& random) const;
  // The task's only part; what is the same in every recording comes from `task`.
  Part DrawTask(const Rig& rig, bool held_out, Random& task, Random& random) const;

  bool locked_ = false;
  int recording_ = 0;
  double centre_ = 0.0, amplitude_ = 1.0, duration_s_ = 0.0, fade_s_ = 1.0;
  double payload_kg_ = 0.0, ambient_degC_ = 22.0, start_degC_ = 22.0;
  std::vector<Part> parts_;
  std::vector<double> pressures_;  // equal spells
  std::vector<Push> pushes_;
  std::vector<Sine> hand_;
};

}  // namespace sinew::rigs
