// Names, units and ranges of the undeclared effects.
#include <cmath>
#include <cstdlib>
#include <stdexcept>
#include <string>

#include "sim/surrogate/undeclared.h"

namespace sinew::surrogate {
namespace {

constexpr bool kIn = true;
constexpr bool kOutside = false;

// name, unit, default, smallest, largest, from_s, in the catalogue, mechanism
constexpr EffectInfo kEffects[] = {
    {"stribeck", "N m", 0.07, 0.0, 2.0, 0.0, kIn,
     "extra dry friction of the output at creep, lost as a film builds up (table over speed)"},
    {"direction_dependent_viscous", "N m s/rad", 0.09, -2.0, 2.0, 0.0, kIn,
     "seal lip drags more going up than down: viscous coefficient +size/2 up, -size/2 down"},
    {"cogging", "N m", 1.9e-3, -0.02, 0.02, 0.0, kIn,
     "motor torque ripple of 14 magnets over 12 slots (table over one turn), peak at the rotor"},
    {"seal_hysteresis", "N m/bar", 0.012, 0.0, 1.0, 0.0, kIn,
     "seal lip of slip elements, 0.01 to 0.24 rad, pressed on by the chamber's pressure"},
    {"payload", "kg", 0.5, 0.0, 5.0, 0.0, kIn,
     "undeclared mass at the load cell; from the start it is absorbed by refitting inertia and "
     "gravity, so give it a time: payload=0.5@30"},
    {"quadratic_viscous", "N m s2/rad2", 0.1, -1.0, 1.0, 0.0, kIn,
     "gear oil churned by the rotor: torque grows with speed squared (size at 1 rad/s of "
     "output)"},
    {"direction_dependent_coulomb", "N m", 0.06, -0.4, 0.4, 0.0, kIn,
     "seal lip bent one way: dry friction +size/2 going up, -size/2 going down"},
    {"load_dependent_friction", "1", 0.05, 0.0, 1.0, 0.0, kIn,
     "dry friction of the rotor grows with the force on the teeth"},
    {"drive_efficiency_direction", "1", 0.1, -0.5, 0.5, 0.0, kIn,
     "the gear passes on this share more of the torque when the load drives the motor"},
    {"temperature_friction", "N m", 0.06, 0.0, 0.5, 0.0, kIn,
     "grease thins as the motor warms: dry and viscous friction by a table over temperature "
     "(size: change of the dry part from 25 to about 13 degC)"},
    {"torque_constant_gain", "1", 0.2, -0.5, 0.5, 0.0, kIn,
     "magnets stronger than declared: more torque per ampere by this share"},
    {"torque_constant_saturation", "1", 0.5, 0.0, 0.9, 0.0, kIn,
     "iron saturates: share of the torque lost at 25 A (table over current)"},
    {"current_offset", "A", 0.2, -5.0, 5.0, 0.0, kIn,
     "zero of the current sensor is off, in the log and in the current loop"},
    {"gear_eccentricity", "N m", 0.08, -2.0, 2.0, 0.0, kIn,
     "output wheel oval and pressed on by a spring: torque from a table over one output turn"},
    {"encoder_eccentricity", "rad", 3e-3, -0.05, 0.05, 0.0, kIn,
     "output encoder's magnet off the axis: its angle errs once per turn (geometry)"},
    {"backlash_width", "rad", 5e-3, -0.04, 0.1, 0.0, kIn, "teeth worn: the play is wider"},
    {"gear_compliance", "rad/(N m)", 1e-3, 0.0, 0.05, 0.0, kIn,
     "wheels and shafts twist under the tooth torque, behind the play"},
    {"flexible_link", "rad/(N m)", 0.04, 0.0, 0.5, 0.0, kIn,
     "link bends: 60 % of it, the payload and the hand sit on a spring"},
    {"transport_delay", "s", 4e-3, 0.0, 0.03, 0.0, kIn,
     "encoder telegrams come late: a row's angles are those of this time ago"},
    {"link_inertia", "kg m2", 0.02, 0.0, 0.5, 0.0, kIn,
     "a balanced ring on the shaft: inertia without weight"},
    {"payload_step", "kg", 0.1, 0.0, 5.0, 20.0, kIn,
     "mass hung on the load cell during the run, at 20 s"},
    {"external_bump", "N", 6.0, -100.0, 100.0, 20.0, kIn,
     "a person pushes the link beside the load cell for 0.8 s, at 20 s"},
    {"gravity_phase", "rad", 0.12, -0.5, 0.5, 0.0, kIn, "the rig stands tilted"},
    {"load_cell_gain", "1", 0.1, -0.5, 0.5, 0.0, kIn, "load cell reads this share too much"},
    {"load_cell_misalignment", "rad", 0.15, -0.6, 0.6, 0.0, kIn,
     "load cell rotated in its seat: the measured part of a vertical push depends on the angle"},
    {"pressure_offset", "bar", 0.1, -1.0, 1.0, 0.0, kIn, "zero of the pressure sensor is off"},
    {"pressure_gain", "1", 0.2, -0.5, 0.5, 0.0, kIn, "pressure sensor reads this share too much"},
    {"pressure_lag", "s", 0.1, 0.0, 2.0, 0.0, kIn,
     "pressure sensor behind a thin hose: its reading follows with this time constant"},
    {"gas_heat_exchange", "K/W", 2.0, 0.0, 1000.0, 0.0, kIn,
     "still air along the chamber's wall: a resistance to heat, so that compression warms"},
    {"leak", "m3/(s Pa)", 4e-12, 0.0, 1e-9, 0.0, kIn,
     "worn seal: a wider orifice from the chamber to the surroundings"},
    {"valve_dead_time", "s", 0.1, 0.0, 2.0, 0.0, kIn,
     "sticky solenoid: the valve opens and shuts later by this time"},
    {"presliding", "N m", 0.08, 0.0, 1.0, 0.0, kIn,
     "bearing grease bends before it slides: slip elements of 0.01 to 0.12 rad"},
    {"stiffness_collapse", "1", 0.3, 0.0, 1.0, 0.0, kIn,
     "vane folds at low pressure: share of its torque lost at 0 bar, none above 2.6 bar (table)"},
    {"cable_drag", "N m", 0.15, 0.0, 2.0, 0.0, kOutside,
     "a cable drags on the link past 0.25 rad: slip elements pressed on more and more"},
    {"bad_tooth", "N m", 8e-3, -0.05, 0.05, 0.0, kOutside,
     "one bad tooth of the first stage's wheel (ten motor turns): a bump once per turn of it, at "
     "the rotor"},
    {"supply_sag", "1", 0.94, 0.0, 0.99, 0.0, kOutside,
     "another load pulls the supply down by this share for 1.5 s of every 7; the reported "
     "current is "
     "true"},
    {"slow_tilt", "rad/min", 0.15, -0.5, 0.5, 0.0, kOutside,
     "the rig's base tilts slowly, at an even rate"},
    {"slipping_magnet", "rad", 1e-3, -0.02, 0.02, 0.0, kOutside,
     "output encoder's magnet slips by this much each time the link passes 0.7 rad/s upward"},
};

const EffectInfo& Find(const std::string& name) {
  std::string names;
  for (const EffectInfo& info : kEffects) {
    if (info.name == name) return info;
    names += (names.empty() ? "" : ", ") + std::string(info.name);
  }
  throw std::invalid_argument("effect '" + name +
                              "' is not known, expected none or one of: " + names);
}

// The number behind a separator; both are taken off the text.
std::optional<double> CutNumber(std::string* text, char separator, const std::string& what) {
  const std::size_t at = text->find(separator);
  if (at == std::string::npos) return std::nullopt;
  const std::string number = text->substr(at + 1);
  text->resize(at);
  char* end = nullptr;
  const double value = std::strtod(number.c_str(), &end);
  if (number.empty() || end != number.c_str() + number.size() || !std::isfinite(value)) {
    throw std::invalid_argument(what + " '" + number + "' is not a finite number");
  }
  return value;
}

}  // namespace

std::span<const EffectInfo> UndeclaredEffects() { return kEffects; }

std::optional<EffectSpec> ParseEffect(std::string_view text) {
  std::string name(text);
  const std::optional<double> from_s = CutNumber(&name, '@', "start time of an effect");
  if (from_s && *from_s < 0.0) {
    throw std::invalid_argument("start time of an effect is negative");
  }
  const std::optional<double> size = CutNumber(&name, '=', "size of an effect");
  if (name == "none" || name.empty()) return std::nullopt;
  const EffectInfo& info = Find(name);
  const EffectSpec spec{name, size.value_or(info.default_size),
                        from_s.value_or(info.default_from_s)};
  if (spec.size < info.smallest_size || spec.size > info.largest_size) {
    throw std::invalid_argument("size of effect '" + name + "' is " + std::to_string(spec.size) +
                                ", expected " + std::to_string(info.smallest_size) + " to " +
                                std::to_string(info.largest_size) + " " + std::string(info.unit));
  }
  return spec;
}

}  // namespace sinew::surrogate
