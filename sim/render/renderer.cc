#include "sim/render/renderer.h"

#define GL_GLEXT_PROTOTYPES
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/glcorearb.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>

#include "sim/render/shaders.h"
#include "sim/render/triangles.h"

namespace sinew::render {

// Parts of Renderer::Impl.
struct UploadedShape {
  GLuint array = 0, buffer = 0;
  GLsizei count = 0;
};

// Colours, and depth with stencil where asked for.
struct PictureTarget {
  GLuint frame = 0, colours = 0, depth = 0;
};

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

// An OpenGL 3.3 core context without a window, an X server or a GPU: EGL on Mesa's software device
// (EGL_EXT_platform_device, EGL_MESA_device_software), so that a machine with a GPU gives the same
// pictures.
//
// Thread: any, one at a time; the calls of OpenGL in between belong to a Current.
class OffScreen {
 public:
  // Throws std::runtime_error naming the step of EGL that failed and the package that gives it.
  OffScreen() {
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
  ~OffScreen() { eglDestroyContext(SoftwareDisplay(), context_); }
  OffScreen(const OffScreen&) = delete;
  OffScreen& operator=(const OffScreen&) = delete;

  // While it lives, the context is the calling thread's. Throws std::runtime_error.
  class Current {
   public:
    explicit Current(const OffScreen& context) {
      // The API that is bound belongs to the thread.
      if (eglBindAPI(EGL_OPENGL_API) != EGL_TRUE ||
          eglMakeCurrent(SoftwareDisplay(), EGL_NO_SURFACE, EGL_NO_SURFACE, context.context_) !=
              EGL_TRUE) {
        FailEgl("eglMakeCurrent");
      }
    }
    ~Current() {
      eglMakeCurrent(SoftwareDisplay(), EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
    }
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;
  };

 private:
  void* context_ = nullptr;  // EGLContext
};

using Eigen::Isometry3d;
using Eigen::Matrix4d;
using Eigen::Vector3d;

constexpr int kSamplesOfPixel = 4;
constexpr int kSmallestPicture = 16;
constexpr std::size_t kShapes = 3;

// sRGB of horizon and ground, one colour, so that the ground has no visible end.
constexpr Colour kBackground = {0.90, 0.92, 0.94};
constexpr double kShadowDarkness = 0.45;
// The ground fades into the background between these distances from the camera's target.
constexpr double kGroundClear_m = 1.2;
constexpr double kGroundEnd_m = 4.0;

void Check(const std::string& step) {
  const GLenum error = glGetError();
  if (error == GL_NO_ERROR) return;
  throw std::runtime_error("rendering: " + step + ": OpenGL error " + std::to_string(error));
}

GLuint Compile(GLenum kind, const char* source) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &source, nullptr);
  glCompileShader(shader);
  GLint ok = GL_FALSE;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok == GL_TRUE) return shader;
  std::array<char, 512> log{};
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw std::runtime_error(std::string("rendering: shader: ") + log.data());
}

GLuint Link(const char* vertex, const char* fragment) {
  const GLuint program = glCreateProgram();
  for (const GLuint shader :
       {Compile(GL_VERTEX_SHADER, vertex), Compile(GL_FRAGMENT_SHADER, fragment)}) {
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program);
  GLint ok = GL_FALSE;
  glGetProgramiv(program, GL_LINK_STATUS, &ok);
  if (ok != GL_TRUE) throw std::runtime_error("rendering: the shaders do not fit together");
  return program;
}

void SetMatrix(GLuint program, const char* name, const Matrix4d& value) {
  const Eigen::Matrix4f narrow = value.cast<float>();
  glUniformMatrix4fv(glGetUniformLocation(program, name), 1, GL_FALSE, narrow.data());
}

void SetVector(GLuint program, const char* name, const Vector3d& value) {
  const Eigen::Vector3f narrow = value.cast<float>();
  glUniform3fv(glGetUniformLocation(program, name), 1, narrow.data());
}

void SetNumber(GLuint program, const char* name, double value) {
  glUniform1f(glGetUniformLocation(program, name), static_cast<float>(value));
}

Vector3d ToVector(const Colour& colour) { return {colour.red, colour.green, colour.blue}; }

// Onto z = 0 along the light: p - (p_z / l_z) l.
Matrix4d ShadowOnGround() {
  const Vector3d light = ToLight();
  Matrix4d out = Matrix4d::Identity();
  out(0, 2) = -light.x() / light.z();
  out(1, 2) = -light.y() / light.z();
  out(2, 2) = 0.0;
  return out;
}

UploadedShape Upload(const std::vector<Vertex>& vertices) {
  UploadedShape out;
  out.count = static_cast<GLsizei>(vertices.size());
  glGenVertexArrays(1, &out.array);
  glBindVertexArray(out.array);
  glGenBuffers(1, &out.buffer);
  glBindBuffer(GL_ARRAY_BUFFER, out.buffer);
  glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(vertices.size() * sizeof(Vertex)),
               vertices.data(), GL_STATIC_DRAW);
  for (const GLuint attribute : {0u, 1u}) {  // position, normal
    glEnableVertexAttribArray(attribute);
    glVertexAttribPointer(
        attribute, 3, GL_FLOAT, GL_FALSE, sizeof(Vertex),
        std::bit_cast<const void*>(std::uintptr_t{attribute} * sizeof(Vertex::position)));
  }
  return out;
}

PictureTarget MakeTarget(int width, int height, int samples, bool has_depth) {
  PictureTarget out;
  glGenFramebuffers(1, &out.frame);
  glBindFramebuffer(GL_FRAMEBUFFER, out.frame);
  glGenRenderbuffers(1, &out.colours);
  glBindRenderbuffer(GL_RENDERBUFFER, out.colours);
  glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_RGBA8, width, height);
  glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, out.colours);
  if (has_depth) {
    glGenRenderbuffers(1, &out.depth);
    glBindRenderbuffer(GL_RENDERBUFFER, out.depth);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_DEPTH24_STENCIL8, width, height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER,
                              out.depth);
  }
  if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE) {
    throw std::runtime_error("rendering: a picture of " + std::to_string(width) + " x " +
                             std::to_string(height) + " is refused");
  }
  return out;
}

}  // namespace

Vector3d ToLight() { return Vector3d(0.25, 0.50, 1.0).normalized(); }

// Objects of OpenGL are freed with their context.
struct Renderer::Impl {
  Impl(const Scene& drawn, int pixels_across, int pixels_down)
      : scene(drawn), width(pixels_across), height(pixels_down) {
    const OffScreen::Current current(context);
    solid = Link(kSolidVertexShader, kSolidFragmentShader);
    shadow = Link(kSolidVertexShader, kShadowFragmentShader);
    ground = Link(kGroundVertexShader, kGroundFragmentShader);
    for (std::size_t i = 0; i < kShapes; ++i) {
      shapes[i] = Upload(Triangles(static_cast<Shape>(i)));
    }
    glGenVertexArrays(1, &no_vertices);
    samples = MakeTarget(width, height, kSamplesOfPixel, true);
    picture = MakeTarget(width, height, 0, false);
    Check("setting up");
  }

  void DrawGround(const Camera& camera, const Matrix4d& clip_from_world) const {
    glUseProgram(ground);
    SetMatrix(ground, "clip_from_world", clip_from_world);
    SetVector(ground, "center", camera.target_m);
    SetVector(ground, "background", ToVector(kBackground));
    SetNumber(ground, "clear_m", kGroundClear_m);
    SetNumber(ground, "end_m", kGroundEnd_m);
    glBindVertexArray(no_vertices);
    glDrawArrays(GL_TRIANGLE_STRIP, 0, 4);
  }

  void DrawShapes(GLuint program, const Matrix4d& clip_from_world, const RobotPose& pose,
                  const std::vector<Isometry3d>& links) const {
    glUseProgram(program);
    SetMatrix(program, "clip_from_world", clip_from_world);
    for (const Visual& visual : scene.visuals) {
      const Isometry3d frame =
          (visual.body < 0 ? pose.world_from_base : links[static_cast<std::size_t>(visual.body)]) *
          visual.link_from_visual;
      SetMatrix(program, "world_from_visual", frame.matrix());
      SetVector(program, "size", visual.size_m);
      SetVector(program, "colour", ToVector(visual.colour));
      const UploadedShape& shape = shapes[static_cast<std::size_t>(visual.shape)];
      glBindVertexArray(shape.array);
      glDrawArrays(GL_TRIANGLES, 0, shape.count);
    }
  }

  Image Draw(const RobotPose& pose, const Camera& camera) const {
    const std::vector<Isometry3d> links = LinkFrames(scene.chain, pose);
    const OffScreen::Current current(context);
    const Matrix4d clip_from_world = ClipFromWorld(camera, static_cast<double>(width) / height);
    glBindFramebuffer(GL_FRAMEBUFFER, samples.frame);
    glViewport(0, 0, width, height);
    const Eigen::Vector3f sky = ToVector(kBackground).cast<float>();
    glClearColor(sky.x(), sky.y(), sky.z(), 1.0f);
    glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
    glEnable(GL_DEPTH_TEST);
    DrawGround(camera, clip_from_world);

    // Each sample of the ground is darkened once, however many shapes shade it.
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_STENCIL_TEST);
    glStencilFunc(GL_EQUAL, 0, 0xff);
    glStencilOp(GL_KEEP, GL_KEEP, GL_INCR);
    glEnable(GL_BLEND);
    glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
    glUseProgram(shadow);
    SetVector(shadow, "center", camera.target_m);
    SetNumber(shadow, "darkness", kShadowDarkness);
    SetNumber(shadow, "clear_m", kGroundClear_m);
    SetNumber(shadow, "end_m", kGroundEnd_m);
    SetMatrix(shadow, "shadow_from_world", ShadowOnGround());
    DrawShapes(shadow, clip_from_world, pose, links);
    glDisable(GL_BLEND);
    glDisable(GL_STENCIL_TEST);

    glEnable(GL_DEPTH_TEST);
    glUseProgram(solid);
    SetMatrix(solid, "shadow_from_world", Matrix4d::Identity());
    SetVector(solid, "to_light", ToLight());
    DrawShapes(solid, clip_from_world, pose, links);
    return ReadPicture();
  }

  Image ReadPicture() const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, samples.frame);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, picture.frame);
    glBlitFramebuffer(0, 0, width, height, 0, 0, width, height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
    glBindFramebuffer(GL_READ_FRAMEBUFFER, picture.frame);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    const std::size_t row = kBytesOfPixel * static_cast<std::size_t>(width);
    Image out{width, height, {}};
    out.rgb.resize(row * static_cast<std::size_t>(height));
    std::vector<std::uint8_t> upwards(out.rgb.size());  // OpenGL begins with the lowest row
    glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, upwards.data());
    Check("drawing");
    for (std::size_t y = 0; y < static_cast<std::size_t>(height); ++y) {
      const std::size_t from = (static_cast<std::size_t>(height) - 1 - y) * row;
      std::copy_n(&upwards[from], row, &out.rgb[y * row]);
    }
    return out;
  }

  Scene scene;
  int width, height;
  OffScreen context;
  GLuint solid = 0, shadow = 0, ground = 0;
  std::array<UploadedShape, kShapes> shapes;
  GLuint no_vertices = 0;  // of the ground, whose corners are computed
  PictureTarget samples, picture;
};

Renderer::Renderer(const Scene& scene, int width, int height) {
  for (const int pixels : {width, height}) {
    if (pixels < kSmallestPicture || pixels > kLargestPicture) {
      throw std::invalid_argument("picture of " + std::to_string(width) + " x " +
                                  std::to_string(height) + " pixels, expected from 16 to " +
                                  std::to_string(kLargestPicture));
    }
  }
  impl_ = std::make_unique<Impl>(scene, width, height);
}

Renderer::~Renderer() = default;

Image Renderer::Render(const RobotPose& pose, const Camera& camera) const {
  return impl_->Draw(pose, camera);
}

}  // namespace sinew::render
