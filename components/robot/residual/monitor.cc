#include "components/robot/residual/monitor.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace sinew::residual {
namespace {

constexpr double kLeastTolerance = 0.25;  // of a parameter, as its prior

const MonitorConfig& Checked(const MonitorConfig& c, double period_s) {
  const auto above = [](const char* name, double value, double limit) {
    if (value > limit && std::isfinite(value)) return;
    throw std::invalid_argument(std::string(name) + " = " + std::to_string(value) +
                                ", expected above " + std::to_string(limit));
  };
  above("period_s", period_s, 0.0);
  above("block_s", c.block_s, period_s);
  above("learn_s", c.learn_s, 59.0 * c.block_s);
  above("watch_s", c.watch_s, 3.0 * c.block_s);
  above("false_alarm_h", c.false_alarm_h, 0.01);
  above("rest_velocity_rad_s", c.rest_velocity_rad_s, 0.0);
  above("not_excited_after_s", c.not_excited_after_s, 0.0);
  return c;
}

int Ticks(double time_s, double period_s) {
  return static_cast<int>(std::lround(time_s / period_s));
}

}  // namespace

Monitor::Monitor(const actuator::JointModel& model, const MonitorConfig& config, double period_s)
    : model_(model),
      columns_model_(model),
      config_(Checked(config, period_s)),
      period_s_(period_s),
      states_(period_s, config.window_s),
      guard_ticks_(std::max(Ticks(config.reversal_guard_s, period_s), states_.half_window())),
      block_ticks_(std::max(2, Ticks(config.block_s, period_s))) {
  using effects::Role;
  std::vector<Column> columns;
  bool has_drive = false;
  for (std::size_t t = 0; t < model.terms.size(); ++t) {
    const actuator::Term& term = model.terms[t];
    const effects::EffectInfo& info = term.effect->info();
    if (!model.Counts(term)) continue;
    has_drive = has_drive || info.role == Role::kDrive;
    Cause cause = Cause::kNothing;
    if (info.name == "offset") cause = Cause::kOffset;
    if (info.name == "coulomb") cause = Cause::kDryFriction;
    if (info.name == "viscous" || info.name == "motor_viscous") cause = Cause::kViscousFriction;
    if (info.name == "payload") cause = Cause::kPayload;
    if (info.name == "pneumatic_torque") cause = Cause::kPressure;
    if (info.role == Role::kDrive) cause = Cause::kDrive;
    for (std::size_t i = 0; i < term.linear.size(); ++i) {
      const actuator::ParameterValue& value = term.linear[i];
      if (value.fixed && cause == Cause::kNothing) continue;
      AddColumn(static_cast<int>(t), static_cast<int>(i),
                std::max(actuator::PriorSpread(value), kLeastTolerance * std::abs(value.value)),
                cause, &columns);
    }
  }
  if (!has_drive) {
    throw std::invalid_argument("joint '" + model.name +
                                "' has no drive term, expected drive_current or drive_voltage");
  }
  const auto has_column = [&](Cause cause) {
    return std::any_of(sources_.begin(), sources_.end(),
                       [&](const Source& source) { return source.cause == cause; });
  };
  const bool linear = model.kind == types::JointKind::kPrismatic;
  const auto add = [&](Cause cause, const char* effect) {
    if (has_column(cause)) return;
    columns_model_.terms.push_back(actuator::MakeTerm(effect, model.constants));
    AddColumn(static_cast<int>(columns_model_.terms.size()) - 1, 0, 0.0, cause, &columns);
  };
  add(Cause::kOffset, "offset");
  add(Cause::kDryFriction, "coulomb");
  add(Cause::kViscousFriction, "viscous");
  if (linear || model.constants.link_length_m > 0.0) {
    add(Cause::kPayload, linear ? "inertia" : "payload");
  }

  ChangeTestConfig test;
  test.learn_blocks = static_cast<int>(std::lround(config.learn_s / config.block_s));
  test.window_blocks = static_cast<int>(std::lround(config.watch_s / config.block_s));
  test.run_length_blocks = config.false_alarm_h * 3600.0 / config.block_s;
  test.slack_share = config.slack_share;
  test.slack_Nm = config.slack_Nm;
  test.drift_1_block = config.drift_1_h * config.drift_1_h * config.block_s / 3600.0;
  test_.emplace(test, columns);

  memory_.resize(static_cast<std::size_t>(columns_model_.memory_size()));
  guard_.resize(static_cast<std::size_t>(guard_ticks_) + 1);
  past_.resize(static_cast<std::size_t>(test.window_blocks));
}

void Monitor::AddColumn(int term, int linear, double prior, Cause cause,
                        std::vector<Column>* columns) {
  if (columns->size() == kMaxColumns) {
    throw std::invalid_argument("joint '" + model_.name + "' has more than " +
                                std::to_string(kMaxColumns) +
                                " parameters that are not fixed; fix some of them");
  }
  sources_.push_back({.term = term, .linear = linear, .cause = cause});
  columns->push_back(
      {.prior = prior, .cause = cause != Cause::kNothing, .learnt = cause != Cause::kDrive});
}

void Monitor::Evaluate(const effects::JointSample& x, Sample* sample) noexcept {
  sample->residual_Nm = sample->drive_Nm = 0.0;
  std::array<double, effects::kMaxParameters> psi{}, phi{};
  std::size_t at = 0, source = 0;
  for (std::size_t t = 0; t < columns_model_.terms.size(); ++t) {
    const actuator::Term& term = columns_model_.terms[t];
    const auto size = static_cast<std::size_t>(term.effect->memory_size());
    for (std::size_t i = 0; i < term.nonlinear.size(); ++i) psi[i] = term.nonlinear[i].value;
    term.effect->Regressors(x, {psi.data(), term.nonlinear.size()},
                            std::span<const double>(memory_).subspan(at, size),
                            {phi.data(), term.linear.size()});
    at += size;
    if (t < model_.terms.size() && model_.Counts(term)) {
      double torque = 0.0;
      for (std::size_t i = 0; i < term.linear.size(); ++i) torque += term.linear[i].value * phi[i];
      sample->residual_Nm += torque;
      if (term.effect->info().role == effects::Role::kDrive) sample->drive_Nm += torque;
    }
    // Sources are in the order of the terms.
    while (source < sources_.size() && sources_[source].term == static_cast<int>(t)) {
      sample->column[source] = phi[static_cast<std::size_t>(sources_[source].linear)];
      ++source;
    }
  }
}

bool Monitor::Moving(const effects::JointSample& x) noexcept {
  const double v = x.velocity_rad_s;
  const bool still = std::abs(v) < config_.rest_velocity_rad_s || v * last_velocity_ < 0.0;
  last_velocity_ = v;
  if (still) {
    settled_rad_ = 0.0;
    blocked_ = guard_ticks_;
    for (Sample& sample : guard_) sample.usable = false;
    return false;
  }
  settled_rad_ += std::abs(v) * period_s_;
  if (blocked_ > 0) {
    --blocked_;
    return false;
  }
  return settled_rad_ >= config_.settle_distance_rad;
}

void Monitor::CloseBlock(double time_s) noexcept {
  const bool used = 2 * sum_count_ >= block_ticks_;
  if (used) {
    const double n = sum_count_;
    sum_.residual_Nm /= n;
    sum_.drive_Nm = std::sqrt(sum_.drive_Nm / n);
    for (double& column : sum_.column) column /= n;
    sum_.follows_last = last_block_used_;
    past_[static_cast<std::size_t>(past_at_)] = {time_s, sum_.residual_Nm * sum_.residual_Nm,
                                                 sum_.drive_Nm * sum_.drive_Nm};
    past_at_ = (past_at_ + 1) % static_cast<int>(past_.size());
    past_count_ = std::min(past_count_ + 1, static_cast<int>(past_.size()));

    double squares = 0.0, drive_squares = 0.0;
    for (int i = 0; i < past_count_; ++i) {
      squares += past_[static_cast<std::size_t>(i)].squares;
      drive_squares += past_[static_cast<std::size_t>(i)].drive_squares;
    }
    const bool before = output_.alarm;
    const ChangeResult result = test_->Step(sum_);
    output_.learnt = result.learnt;
    output_.rms_Nm = std::sqrt(squares / past_count_);
    output_.explained = drive_squares > 0.0 ? 1.0 - squares / drive_squares : 0.0;
    output_.change_rms_Nm = result.innovation_rms;
    output_.noise_Nm = result.learning ? 0.0 : test_->noise_Nm();
    output_.statistic = result.statistic / test_->threshold();
    output_.alarm = result.alarm;
    const auto cause = [&](int column) {
      return column < 0 ? Cause::kNothing : sources_[static_cast<std::size_t>(column)].cause;
    };
    output_.follows = cause(result.cause);
    output_.rival = cause(result.rival);
    output_.change = result.change;
    output_.change_error = result.change_error;
    output_.follows_share = result.explained;
    if (result.alarm && !before) {
      const int blocks = std::clamp(result.blocks_since, 1, past_count_);
      const auto size = static_cast<int>(past_.size());
      since_s_ = past_[static_cast<std::size_t>((past_at_ - blocks + size) % size)].end_s -
                 config_.block_s;
    }
    output_.since_s = result.alarm ? since_s_ : 0.0;
    last_used_s_ = time_s;
    used_any_ = true;
  }
  last_block_used_ = used;
  sum_ = {};
  sum_count_ = sum_ticks_ = 0;
}

MonitorOutput Monitor::Step(double time_s, const JointReading& reading) noexcept {
  effects::JointSample x;
  const bool known = states_.Push(reading, time_s, &x);
  if (!started_) {
    started_ = true;
    last_used_s_ = time_s;
  }
  Sample& sample = guard_[static_cast<std::size_t>(guard_at_)];  // the oldest is replaced
  const bool full = guard_count_ == static_cast<int>(guard_.size());
  if (full && sample.usable) {
    sum_.residual_Nm += sample.residual_Nm;
    sum_.drive_Nm += sample.drive_Nm * sample.drive_Nm;
    for (std::size_t i = 0; i < sources_.size(); ++i) sum_.column[i] += sample.column[i];
    ++sum_count_;
  }
  sample.usable = false;
  output_.residual_Nm = 0.0;
  if (known) {
    if (!memory_known_) {
      columns_model_.ResetMemory(x, memory_);
      memory_known_ = true;
    } else {
      columns_model_.Advance(x, period_s_, memory_);
    }
    Evaluate(x, &sample);
    output_.residual_Nm = std::isfinite(sample.residual_Nm) ? sample.residual_Nm : 0.0;
    const bool moving = Moving(x);
    sample.usable = moving && std::isfinite(sample.residual_Nm) && std::isfinite(sample.drive_Nm);
  } else {
    blocked_ = guard_ticks_;
    settled_rad_ = 0.0;
    memory_known_ = false;
  }
  guard_at_ = (guard_at_ + 1) % static_cast<int>(guard_.size());
  guard_count_ = std::min(guard_count_ + 1, static_cast<int>(guard_.size()));
  if (++sum_ticks_ >= block_ticks_) {
    CloseBlock(time_s - states_.delay_s() - guard_ticks_ * period_s_);
  }

  const double assessed_s = time_s - states_.delay_s() - guard_ticks_ * period_s_;
  const bool excited = used_any_ && assessed_s - last_used_s_ < config_.not_excited_after_s;
  if (!reading.valid) {
    output_.state = State::kLost;
  } else if (output_.alarm) {
    output_.state = State::kAlarm;
  } else if (!excited) {
    output_.state = State::kNotExcited;
  } else {
    output_.state = output_.learnt < 1.0 ? State::kLearning : State::kWatching;
  }
  return output_;
}

}  // namespace sinew::residual
