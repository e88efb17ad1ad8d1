#include "bench/rigs/drawn/sensors.h"

#include <cmath>

#include "bench/rigs/drawn/random.h"
#include "components/base/types/angle.h"

namespace sinew::rigs {
namespace {

using types::kTwoPi;

class Source {
 public:
  Source(const Noise& noise, double share, std::uint64_t seed, std::uint64_t stream)
      : noise_{share * noise.rms, noise.correlation, share * noise.step},
        random_(seed, stream),
        state_(random_.Normal()) {}
  double Read(double x) {
    const double c = noise_.correlation;
    state_ = c * state_ + std::sqrt(1.0 - c * c) * random_.Normal();
    return Round(x + noise_.rms * state_, noise_.step);
  }
  static double Round(double x, double step) {
    return step > 0.0 ? step * std::round(x / step) : x;
  }

 private:
  Noise noise_;
  Random random_;
  double state_;
};

Reading Exact(const Rig& rig, const TrueRow& row) {
  Reading out;
  out.time_s = row.time_s;
  out.motor_rad = row.motor * rig.gear_ratio;
  out.motor_velocity_rad_s = row.motor_velocity * rig.gear_ratio;
  out.position = row.position;
  out.velocity = row.velocity;
  out.drive = row.drive;
  out.supply_V = row.supply_V;
  out.pressure_bar = row.pressure_bar;
  out.load_force_N = row.load_force_N;
  out.payload_kg = row.payload_kg;
  out.temperature_degC = row.temperature_degC;
  out.reference = row.reference;
  out.valve_open = row.valve_open;
  out.tooth_force = row.tooth_force;
  return out;
}

}  // namespace

std::vector<Reading> ReadExactly(const Rig& rig, const std::vector<TrueRow>& rows) {
  std::vector<Reading> out;
  out.reserve(rows.size());
  for (const TrueRow& row : rows) {
    out.push_back(Exact(rig, row));
    out.back().index = static_cast<int>(out.size()) - 1;
    out.back().time_s = out.back().index / rig.rate_Hz;
  }
  return out;
}

std::vector<Reading> ReadWithNoise(const Rig& rig, const std::vector<TrueRow>& rows,
                                   int recording) {
  const std::uint64_t seed =
      rig.number * 16 + static_cast<std::uint64_t>(recording) + (rig.noise_draw << 40);
  const double share = rig.noise_share;
  Source drive(rig.drive == Drive::kSensor ? rig.torque : rig.current, share, seed, 11);
  Source pressure(rig.pressure_noise, share, seed, 12);
  Source force(rig.force, share, seed, 13);
  Random motor(seed, 14), output(seed, 15), stamps(seed, 16), losses(seed, 17), supply(seed, 18);
  const double motor_step = share * kTwoPi / std::exp2(rig.motor_bits);
  const double output_step =
      share * (rig.position_step > 0.0 ? rig.position_step : kTwoPi / std::exp2(rig.output_bits));
  // The controller's observer: a first-order lag behind the encoder's difference.
  const double observer = 1.0 - std::exp(-2.0 * kTwoPi * rig.bandwidth_Hz / rig.rate_Hz);
  Random homing(seed, 19);
  const double motor_zero = share * rig.homing * rig.gear_ratio * homing.Normal();
  const double zero = share * rig.homing * homing.Normal();
  double motor_velocity = 0.0, velocity = 0.0;
  std::vector<Reading> out;
  out.reserve(rows.size());
  Reading last;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    Reading reading = Exact(rig, rows[i]);
    reading.index = static_cast<int>(i);
    reading.time_s = (static_cast<double>(i) +
                      share * rig.stamp_jitter * std::tanh(stamps.Normal() / 3.0) * 3.0) /
                     rig.rate_Hz;
    reading.motor_rad = Source::Round(
        reading.motor_rad + motor_zero + rig.encoder_jitter * motor_step * motor.Normal(),
        motor_step);
    reading.position = Source::Round(
        reading.position + zero + rig.encoder_jitter * output_step * output.Normal(), output_step);
    if (!rig.output_encoder && rig.motor_encoder) {
      reading.position = reading.motor_rad / rig.gear_ratio;  // the same encoder
    }
    reading.drive = drive.Read(reading.drive);
    reading.pressure_bar = pressure.Read(reading.pressure_bar);
    reading.load_force_N = force.Read(reading.load_force_N);
    const double step_V = 0.01 * share;
    reading.supply_V = Source::Round(reading.supply_V + step_V * supply.Normal(), step_V);
    reading.temperature_degC = Source::Round(reading.temperature_degC, 0.1 * share);
    if (i > 0) {
      motor_velocity +=
          observer * ((reading.motor_rad - last.motor_rad) * rig.rate_Hz - motor_velocity);
      velocity += observer * ((reading.position - last.position) * rig.rate_Hz - velocity);
    }
    reading.motor_velocity_rad_s = motor_velocity;
    reading.velocity = velocity;
    last = reading;
    if (losses.Uniform() >= rig.lost_rows) out.push_back(reading);
  }
  return out;
}

}  // namespace sinew::rigs
