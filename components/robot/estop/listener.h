// Takes an estop from a Unix socket (press.h says what travels), keeps it in the latch file, and
// never depends on the provider's cycle being on time.
//
// Who sends the frames: the cycle's thread alone, since a plant has one thread. The listener's
// thread receives, counts the press, and calls `wake`, which ends whatever the cycle waits in; the
// cycle takes the press before it does anything else, idles the plant, and says so. Only then, or
// 100 ms later if the cycle does not answer, the thread writes the latch: the disk delays nothing.
// The caller's answer waits for the drives, which report in their own time that they are idle.
//
//     press -> presses_ + 1, wake() -> cycle: TakePress, idle frames, IdleSent -> latch on disk
//                                      drives report idle, IdleConfirmed      -> answer
//
// An estop that came another way is kept by Latch(). A reset is RequestUnlatch(), and counts when
// unlatch() is kDone: until then the robot stays ESTOPPED. The newest of these two calls is what
// the file will say; a press is always followed by the cycle's Latch().
//
// Whoever may open the socket may stop the robot; presser() is who did it. A process without free
// descriptors takes a press all the same, by one that is kept for it, and is not kept busy by what
// it cannot accept.
//
// What the thread does besides is in the answers and in `report`: a latch that cannot be written is
// an error, is tried again once a second, and the robot stays ESTOPPED in memory.
#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "components/base/config/descriptor.h"
#include "components/robot/estop/estop_config.h"
#include "components/robot/estop/latch_file.h"

namespace sinew::estop {

// The time in which the cycle has to send its idle frames before latch and answer go ahead without.
// Longer than any cycle that is not a fault (guard.fault_after_ms, 60 by default).
inline constexpr std::chrono::milliseconds kIdleLimit{100};
// The time in which the drives have to report idle before the answer is that they have not: four
// heartbeats of 100 ms.
inline constexpr std::chrono::milliseconds kConfirmLimit{400};

class Listener {
 public:
  struct Callbacks {
    std::function<void()> wake;  // any thread; ends the waits of the cycle, does not wait itself
    // The listener's thread, and the constructor.
    std::function<void(bool is_error, const std::string&)> report;
  };
  // Reads the latch, opens the socket, starts the thread. `priority`: under SCHED_FIFO, where the
  // process runs so; 0: that of the caller. Throws UsageError: the socket cannot be made, others
  // may write to its folder, another process answers there, or has the latch.
  Listener(const Config& config, Callbacks callbacks, int priority = 0);
  ~Listener();
  Listener(const Listener&) = delete;
  Listener& operator=(const Listener&) = delete;

  // State of the latch file as it was found; latched: the robot starts ESTOPPED.
  const LatchFile::State& at_start() const { return at_start_; }

  // --- the cycle's thread; none of these waits

  // True: pressed since the last call.
  bool TakePress() noexcept;
  // User and process of the last press.
  struct Presser {
    uid_t user = 0;
    pid_t process = 0;
  };
  Presser presser() const noexcept;
  // The presses that have been taken: a command that is made now covers them.
  std::uint64_t taken() const noexcept { return taken_; }
  // The idle frames of a command that covers these presses have been sent.
  void IdleSent(std::uint64_t covered) noexcept;
  // After IdleSent: every drive has reported since then that it is idle.
  void IdleConfirmed(std::uint64_t covered) noexcept;
  void Latch(std::string_view reason);
  void RequestUnlatch() noexcept;
  enum class Unlatch { kPending, kDone, kFailed };
  Unlatch unlatch() const noexcept;  // of the last request

 private:
  struct Client {
    int socket = -1;
    std::uint64_t press = 0;  // 0: has sent nothing yet; else nothing more is read from it
    std::int64_t pressed_ns = 0;
    bool kept = false;  // the latch has this press
    bool idle_said = false;
  };

  void OpenSocket(const Config& config);
  void Run();
  void Accept();
  bool FreeDescriptor();
  void Read(Client* client);
  void TakePressOf(Client* client, std::string_view reason);
  bool AwaitsIdle() const noexcept;
  void AnswerIdle();
  void AnswerLatch();
  void MatchFile();
  std::uint64_t Desire(bool latched) noexcept;  // its generation
  void Say(Client* client, std::string_view line) noexcept;
  void Signal() noexcept;

  Callbacks callbacks_;
  std::optional<LatchFile> latch_;
  config::Descriptor lock_;  // of the latch
  LatchFile::State at_start_;
  std::filesystem::path path_;
  config::Descriptor listener_, signal_;

  std::atomic<bool> stop_{false};
  std::atomic<std::uint64_t> presses_{0};
  std::atomic<std::uint64_t> presser_{0};  // user << 32 | process; written before presses_
  std::atomic<std::uint64_t> idle_{0};     // presses whose idle frames have been sent
  std::atomic<std::uint64_t> confirmed_{0};
  // The state that the file shall have: generation * 2 + latched; and the newest that was done: the
  // same * 2 + success.
  std::atomic<std::uint64_t> desired_{0}, done_{0};
  std::uint64_t taken_ = 0;       // cycle's thread
  std::uint64_t unlatching_ = 0;  // cycle's thread: generation of the request
  std::mutex reason_mutex_;
  std::string reason_;  // of the next latch

  // Members of the listener's thread.
  std::vector<Client> clients_;
  config::Descriptor spare_;    // given up for a press where no other is free
  std::int64_t accept_ns_ = 0;  // nothing is accepted before, since nothing could be
  bool on_disk_ = false;
  std::string problem_;  // with the file, as reported
  std::int64_t pressed_ns_ = 0, retry_ns_ = 0;

  std::thread thread_;  // last: it uses the others
};

}  // namespace sinew::estop
