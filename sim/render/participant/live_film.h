// A film of a simulation while it runs: the simulation offers poses, a thread of its own draws them
// and writes the video.
//
// The queue between the two is made in the constructor and holds queued_frames. Offer copies a pose
// into it once for every frame that is due and returns: it allocates nothing and takes no lock. The
// drawing thread is a helper of the process (components/topics/node/helper_thread.h), out of
// SCHED_FIFO, so that the cycle does not wait for it. When it is behind by the whole queue, frames
// are left out and counted; in lockstep, where nothing is late, Offer waits for it instead.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>

#include "sim/render/file/film.h"
#include "sim/render/scene.h"

namespace sinew::render {

// At 25 frames in a second 80 s of simulation, about 1 MB.
inline constexpr std::size_t kQueuedFrames = 2000;

// Sets the base's pose, and the positions of joints in the order of LiveFilmOptions::joint_names.
// `pose->joint_rad` has that size. Must not throw.
using ReadPose = std::function<void(RobotPose* pose)>;

struct LiveFilmOptions {
  FilmOptions film;
  // Joints whose positions are given, by their name in the URDF; all others stay at 0.
  std::vector<std::string> joint_names;
  bool waits = false;                         // lockstep
  std::size_t queued_frames = kQueuedFrames;  // above 0
};

class LiveFilm {
 public:
  // Thread: before the threads of the process are raised (node::BeginRealtime). Throws UsageError
  // as Film, std::invalid_argument for a joint that the scene does not have.
  LiveFilm(const Scene& scene, const LiveFilmOptions& options);
  ~LiveFilm();  // draws nothing more; without Finish there is no video
  LiveFilm(const LiveFilm&) = delete;
  LiveFilm& operator=(const LiveFilm&) = delete;

  // Thread: one, the loop's. time_s rises; read is called when a frame is due, in this thread.
  void Offer(double time_s, const ReadPose& read);

  // Waits until all that was offered is drawn and ends the film. Throws what drawing threw.
  void Finish();
  std::size_t drawn() const;
  std::size_t left_out() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace sinew::render
