// An encoder that reports what is not so: a fault that is planted, to see it found.
//
// From its begin on, in the unit of the encoder:
//
//     kFrozen   the reading of the begin, velocity 0
//     kOffset   size is added: a small one slipped, a large one jumped
//     kScaled   turns (1 + size) times as far as it should
//
// Pure; one thread; allocates nothing.
#pragma once

namespace sinew::virtual_axes {

enum class EncoderFaultKind { kNone, kFrozen, kOffset, kScaled };

struct EncoderFault {
  EncoderFaultKind kind = EncoderFaultKind::kNone;
  double after_s = 0.0;  // since the start of the axes
  double size = 0.0;     // kOffset: revolutions of a motor, radians of an output; kScaled: share
};

class FalseEncoder {
 public:
  struct Reading {
    double position = 0.0;
    double velocity = 0.0;
  };

  explicit FalseEncoder(const EncoderFault& fault = {}) : fault_(fault) {}

  // Another fault, from the last right reading on.
  void Plant(const EncoderFault& fault) { fault_ = fault; }

  // The reported reading for this true one, at a time since the start of the axes.
  Reading Of(const Reading& truth, double time_s) {
    if (fault_.kind == EncoderFaultKind::kNone || time_s < fault_.after_s) {
      begin_ = truth;
      return truth;
    }
    switch (fault_.kind) {
      case EncoderFaultKind::kFrozen:
        return {begin_.position, 0.0};
      case EncoderFaultKind::kOffset:
        return {truth.position + fault_.size, truth.velocity};
      case EncoderFaultKind::kScaled:
        return {truth.position + fault_.size * (truth.position - begin_.position),
                truth.velocity * (1.0 + fault_.size)};
      case EncoderFaultKind::kNone:
        break;
    }
    return truth;
  }

 private:
  EncoderFault fault_;
  Reading begin_;  // the last one that was right
};

}  // namespace sinew::virtual_axes
