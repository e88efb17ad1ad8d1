#include "sim/render/off_screen.h"

#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>

#include <array>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

namespace sinew::render {

namespace {

[[noreturn]] void FailEgl(const std::string& step) {
  std::ostringstream text;
  text << "off-screen rendering: " << step << " failed, EGL error 0x" << std::hex << eglGetError()
       << "; Debian's packages libegl1 and libgl1-mesa-dri give it";
  throw std::runtime_error(text.str());
}

template <typename Function>
Function EglExtension(const char* name) {
  const auto function = reinterpret_cast<Function>(eglGetProcAddress(name));
  if (function == nullptr) FailEgl(name);
  return function;
}

EGLDeviceEXT SoftwareDevice() {
  const auto query_devices = EglExtension<PFNEGLQUERYDEVICESEXTPROC>("eglQueryDevicesEXT");
  const auto query_string = EglExtension<PFNEGLQUERYDEVICESTRINGEXTPROC>("eglQueryDeviceStringEXT");
  std::array<EGLDeviceEXT, 64> devices{};
  EGLint count = 0;
  if (query_devices(static_cast<EGLint>(devices.size()), devices.data(), &count) != EGL_TRUE) {
    FailEgl("eglQueryDevicesEXT");
  }
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    const char* extensions = query_string(devices[i], EGL_EXTENSIONS);
    if (extensions != nullptr &&
        std::string_view(extensions).find("EGL_MESA_device_software") != std::string_view::npos) {
      return devices[i];
    }
  }
  FailEgl("finding a device with EGL_MESA_device_software");
}

// One of the process, never ended: eglTerminate would end it for every context.
EGLDisplay SoftwareDisplay() {
  static const EGLDisplay kDisplay = [] {
    const auto get_display =
        EglExtension<PFNEGLGETPLATFORMDISPLAYEXTPROC>("eglGetPlatformDisplayEXT");
    const EGLDisplay made = get_display(EGL_PLATFORM_DEVICE_EXT, SoftwareDevice(), nullptr);
    if (made == EGL_NO_DISPLAY) FailEgl("eglGetPlatformDisplayEXT");
    if (eglInitialize(made, nullptr, nullptr) != EGL_TRUE) FailEgl("eglInitialize");
    return made;
  }();
  return kDisplay;
}

}  // namespace

OffScreen::OffScreen() {
  const EGLDisplay display = SoftwareDisplay();
  if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE) FailEgl("eglBindAPI");
  constexpr std::array<EGLint, 7> kAttributes = {EGL_CONTEXT_MAJOR_VERSION,
                                                 3,
                                                 EGL_CONTEXT_MINOR_VERSION,
                                                 3,
                                                 EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                                 EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                                 EGL_NONE};
  context_ = eglCreateContext(display, EGL_NO_CONFIG_KHR, EGL_NO_CONTEXT, kAttributes.data());
  if (context_ == EGL_NO_CONTEXT) FailEgl("eglCreateContext");
}

OffScreen::~OffScreen() { eglDestroyContext(SoftwareDisplay(), context_); }

OffScreen::Current::Current(const OffScreen& context) {
  // The API that is bound belongs to the thread.
  if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE ||
      eglMakeCurrent(SoftwareDisplay(), EGL_NO_SURFACE, EGL_NO_SURFACE, context.context_) !=
          EGL_TRUE) {
    FailEgl("eglMakeCurrent");
  }
}

OffScreen::Current::~Current() {
  eglMakeCurrent(SoftwareDisplay(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
}

}  // namespace sinew::render
