// Destination of a recording: one file, or several one after another. Files: file/file_series.h;
// tests use memory.
#pragma once

#include "components/record/recording/io.h"

namespace sinew::logger {

// Bytes that are written belong to the file begun last. Thread: one at a time.
class RecordingSink : public recording::ByteSink {
 public:
  virtual recording::IoStatus Begin(int number) = 0;  // 0, 1, ...; the one before has ended
  virtual recording::IoStatus Sync() = 0;             // what was written outlives a power cut
  virtual recording::IoStatus End() = 0;              // the file is complete, and on disk
};

}  // namespace sinew::logger
