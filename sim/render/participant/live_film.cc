#include "sim/render/participant/live_film.h"

#include <pthread.h>

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <exception>
#include <system_error>
#include <vector>

#include "components/base/config/config.h"
#include "components/topics/node/helper_thread.h"

namespace sinew::render {

namespace {

// A real-time process bounds its threads' stacks for cycles that call nothing deep; Mesa compiles
// its shaders on the stack of the thread that draws.
constexpr std::size_t kDrawingStackBytes = std::size_t{8} << 20;

// A frame is due a millionth of a period early, so that sums of a cycle's period may round.
constexpr double kDueSlack = 1e-6;

}  // namespace

struct LiveFilm::Impl {
  struct QueuedPose {
    double time_s = 0.0;
    RobotPose pose;  // joints as LiveFilmOptions::joint_names
  };

  Impl(const Scene& drawn_scene, const LiveFilmOptions& live_options)
      : scene(drawn_scene),
        options(live_options),
        indices(JointIndices(scene.chain, options.joint_names)),
        moving(MovingJoints(scene.chain).size()),
        queue(std::max<std::size_t>(1, options.queued_frames)) {
    for (QueuedPose& slot : queue) slot.pose.joint_rad.assign(indices.size(), 0.0);
    // Mesa's software renderer would start a thread for every core, and those are no helpers.
    if (::setenv("LP_NUM_THREADS", "0", 1) != 0) {
      throw std::system_error(errno, std::generic_category(), "LP_NUM_THREADS");
    }
    const Film refuses_here(scene, options.film);  // what it would refuse in the thread
    pthread_attr_t attributes;
    ::pthread_attr_init(&attributes);
    ::pthread_attr_setstacksize(&attributes, kDrawingStackBytes);
    const int error = ::pthread_create(
        &thread, &attributes,
        [](void* self) -> void* {
          static_cast<Impl*>(self)->Draw();
          return nullptr;
        },
        this);
    ::pthread_attr_destroy(&attributes);
    if (error != 0) {
      throw std::system_error(error, std::generic_category(), "the thread that draws");
    }
  }

  ~Impl() {
    cancelled.store(true);
    Join();
  }

  void Draw() {
    node::internal::BecomeHelper("sinew-view");
    try {
      Film film(scene, options.film);
      RobotPose pose;
      while (TakeNext(&film, &pose)) {
      }
      if (!cancelled.load()) film.Finish();
    } catch (...) {
      failure = std::current_exception();
      broken.store(true);
    }
    freed.Give();
  }

  // False: nothing comes any more.
  bool TakeNext(Film* film, RobotPose* pose) {
    while (taken.load() == offered.load()) {
      if (cancelled.load()) return false;
      if (finished.load()) {
        // Poses that were offered before the end are seen after it.
        if (taken.load() == offered.load()) return false;
        continue;
      }
      given.Wait();
    }
    if (cancelled.load()) return false;
    const QueuedPose& slot = queue[taken.load() % queue.size()];
    const double time_s = slot.time_s;
    pose->world_from_base = slot.pose.world_from_base;
    pose->joint_rad.assign(moving, 0.0);
    for (std::size_t i = 0; i < indices.size(); ++i) {
      pose->joint_rad[indices[i]] = slot.pose.joint_rad[i];
    }
    film->Add(time_s, *pose);
    taken.fetch_add(1);
    freed.Give();
    return true;
  }

  void Offer(double time_s, const ReadPose& read) {
    const double frame = time_s * options.film.frames_per_s;
    if (frame + kDueSlack < static_cast<double>(due)) return;
    due = static_cast<std::size_t>(frame + kDueSlack) + 1;
    while (offered.load() - taken.load() == queue.size()) {
      if (!options.waits || broken.load()) {
        left_out.fetch_add(1);
        return;
      }
      freed.Wait();
    }
    QueuedPose& slot = queue[offered.load() % queue.size()];
    slot.time_s = time_s;
    read(&slot.pose);
    offered.fetch_add(1);
    given.Give();
  }

  void Join() {
    if (joined) return;
    joined = true;
    finished.store(true);
    given.Give();
    ::pthread_join(thread, nullptr);
  }

  Scene scene;
  LiveFilmOptions options;
  std::vector<std::size_t> indices;  // of the given joints in the scene's poses
  std::size_t moving;
  // One writes at `offered`, the other reads at `taken`.
  std::vector<QueuedPose> queue;
  std::atomic<std::size_t> offered{0}, taken{0}, left_out{0};
  std::atomic<bool> finished{false}, cancelled{false}, broken{false};
  node::internal::WakeUp given, freed;
  std::size_t due = 0;  // the next frame
  pthread_t thread{};
  bool joined = false;
  std::exception_ptr failure;  // of the thread, read after it has ended
};

LiveFilm::LiveFilm(const Scene& scene, const LiveFilmOptions& options)
    : impl_(std::make_unique<Impl>(scene, options)) {}

LiveFilm::~LiveFilm() = default;

void LiveFilm::Offer(double time_s, const ReadPose& read) { impl_->Offer(time_s, read); }

void LiveFilm::Finish() {
  impl_->Join();
  if (impl_->failure) std::rethrow_exception(impl_->failure);
}

std::size_t LiveFilm::drawn() const { return impl_->taken.load(); }

std::size_t LiveFilm::left_out() const { return impl_->left_out.load(); }

}  // namespace sinew::render
