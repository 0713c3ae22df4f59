#include "calibrato/simulation/headless_gl.h"

#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <GL/osmesa.h>
#include <dlfcn.h>

#include <array>
#include <cassert>
#include <cstdlib>

#include "calibrato/base/input_error.h"

namespace calibrato {
namespace {

// Why a way does not work.
struct Unavailable {
  std::string why;
};

// A shared library. MuJoCo finds its functions by their names alone: what does not work must be
// closed before the next way is tried, what works stays open, because Mesa's drivers do not survive
// to be closed.
class Library {
 public:
  explicit Library(const char* name) : handle_(dlopen(name, RTLD_LAZY | RTLD_GLOBAL)) {
    if (handle_ == nullptr) throw Unavailable{std::string(name) + " is not installed"};
  }
  ~Library() {
    if (!stays_) dlclose(handle_);
  }
  Library(const Library&) = delete;
  Library& operator=(const Library&) = delete;
  void Stay() { stays_ = true; }

  template <typename Function>
  Function Get(const char* name) const {
    auto function = reinterpret_cast<Function>(dlsym(handle_, name));  // NOLINT
    if (function == nullptr) throw Unavailable{std::string(name) + " is missing from its library"};
    return function;
  }

 private:
  void* handle_;
  bool stays_ = false;
};

}  // namespace

class HeadlessGl::Context {
 public:
  Context() = default;
  virtual ~Context() = default;
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

  virtual bool MakeCurrent() = 0;
};

class HeadlessGl::Egl : public HeadlessGl::Context {
 public:
  Egl() : library_("libEGL.so.1") {
    const auto get_address = library_.Get<decltype(&eglGetProcAddress)>("eglGetProcAddress");
    const auto get_display = reinterpret_cast<PFNEGLGETPLATFORMDISPLAYEXTPROC>(  // NOLINT
        get_address("eglGetPlatformDisplayEXT"));
    // Without any screen where the driver knows how, else the driver's own choice.
    if (get_display != nullptr) {
      display_ = get_display(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
    }
    if (!Initialised()) {
      display_ = library_.Get<decltype(&eglGetDisplay)>("eglGetDisplay")(nullptr);
      if (!Initialised()) throw Unavailable{"EGL finds no driver that draws without a screen"};
    }
    const std::array<EGLint, 15> wanted = {EGL_SURFACE_TYPE,
                                           EGL_PBUFFER_BIT,
                                           EGL_RENDERABLE_TYPE,
                                           EGL_OPENGL_BIT,
                                           EGL_RED_SIZE,
                                           8,
                                           EGL_GREEN_SIZE,
                                           8,
                                           EGL_BLUE_SIZE,
                                           8,
                                           EGL_DEPTH_SIZE,
                                           24,
                                           EGL_STENCIL_SIZE,
                                           8,
                                           EGL_NONE};
    EGLConfig config = nullptr;
    EGLint num_configs = 0;
    library_.Get<decltype(&eglChooseConfig)>("eglChooseConfig")(display_, wanted.data(), &config, 1,
                                                                &num_configs);
    library_.Get<decltype(&eglBindAPI)>("eglBindAPI")(EGL_OPENGL_API);
    if (num_configs > 0) {
      context_ = library_.Get<decltype(&eglCreateContext)>("eglCreateContext")(
          display_, config, EGL_NO_CONTEXT, nullptr);
    }
    if (context_ == EGL_NO_CONTEXT || !MakeCurrent()) {
      throw Unavailable{"EGL's driver has no OpenGL"};
    }
    library_.Stay();
  }
  ~Egl() override {
    (void)Bind(EGL_NO_CONTEXT);
    library_.Get<decltype(&eglDestroyContext)>("eglDestroyContext")(display_, context_);
  }

  bool MakeCurrent() override { return Bind(context_); }

 private:
  bool Initialised() const {
    return display_ != EGL_NO_DISPLAY && library_.Get<decltype(&eglInitialize)>("eglInitialize")(
                                             display_, nullptr, nullptr) == EGL_TRUE;
  }
  bool Bind(EGLContext context) const {
    return library_.Get<decltype(&eglMakeCurrent)>("eglMakeCurrent")(
               display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context) == EGL_TRUE;
  }

  Library library_;
  EGLDisplay display_ = EGL_NO_DISPLAY;
  EGLContext context_ = EGL_NO_CONTEXT;
};

class HeadlessGl::OsMesa : public HeadlessGl::Context {
 public:
  OsMesa() : library_("libOSMesa.so.8") {
    context_ = library_.Get<decltype(&OSMesaCreateContextExt)>("OSMesaCreateContextExt")(
        OSMESA_RGBA, 24, 8, 8, nullptr);
    // Only framebuffer objects are drawn into; the context wants a buffer all the same.
    if (context_ == nullptr || !MakeCurrent()) {
      throw Unavailable{"OSMesa has no OpenGL"};
    }
    library_.Stay();
  }
  ~OsMesa() override {
    library_.Get<decltype(&OSMesaDestroyContext)>("OSMesaDestroyContext")(context_);
  }

  bool MakeCurrent() override {
    return library_.Get<decltype(&OSMesaMakeCurrent)>("OSMesaMakeCurrent")(
               context_, buffer_.data(), GL_UNSIGNED_BYTE, kSize, kSize) == GL_TRUE;
  }

 private:
  static constexpr int kSize = 16;
  Library library_;
  std::array<unsigned char, 4 * kSize * kSize> buffer_{};
  OSMesaContext context_ = nullptr;
};

std::vector<std::string> HeadlessGlWays() {
  const char* chosen = std::getenv("MUJOCO_GL");
  if (chosen == nullptr || std::string(chosen).empty()) return {"egl", "osmesa"};
  if (std::string(chosen) == "off") return {};
  return {chosen};
}

HeadlessGl::HeadlessGl(const std::vector<std::string>& ways) {
  std::string why = ways.empty() ? "MUJOCO_GL is off" : "";
  for (const std::string& way : ways) {
    try {
      if (way == "egl") {
        context_ = std::make_unique<Egl>();
      } else if (way == "osmesa") {
        context_ = std::make_unique<OsMesa>();
      } else {
        throw Unavailable{"MUJOCO_GL is '" + way + "'; there are egl, osmesa and off"};
      }
      way_ = way;
      return;
    } catch (const Unavailable& unavailable) {
      if (!why.empty()) why += "; ";
      why += unavailable.why;
    }
  }
  throw InputError({"cannot render images without a screen", "", why,
                    "install libegl1 and libgl1-mesa-dri, or libosmesa6; --fidelity fast and "
                    "physical need neither"});
}

HeadlessGl::~HeadlessGl() = default;

void HeadlessGl::MakeCurrent() const {
  [[maybe_unused]] const bool is_current = context_->MakeCurrent();
  assert(is_current);
}

}  // namespace calibrato
