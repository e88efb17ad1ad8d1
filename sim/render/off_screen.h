// An OpenGL 3.3 core context without a window, an X server or a GPU: EGL on Mesa's software device
// (EGL_EXT_platform_device, EGL_MESA_device_software), so that a machine with a GPU gives the same
// pictures.
//
// Thread: any, one at a time; the calls of OpenGL in between belong to a Current.
#pragma once

namespace sinew::render {

class OffScreen {
 public:
  // Throws std::runtime_error naming the step of EGL that failed and the package that gives it.
  OffScreen();
  ~OffScreen();
  OffScreen(const OffScreen&) = delete;
  OffScreen& operator=(const OffScreen&) = delete;

  // While it lives, the context is the calling thread's. Throws std::runtime_error.
  class Current {
   public:
    explicit Current(const OffScreen& context);
    ~Current();
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;
  };

 private:
  void* context_ = nullptr;  // EGLContext
};

}  // namespace sinew::render
