// SPDX-License-Identifier: GPL-3.0-or-later
// EGL without a surface. Displays are tried in this order: the software device (the same pixels on
// every machine), Mesa's surfaceless platform, any device (a graphics card).
#define EGL_NO_X11
#include <EGL/egl.h>
#include <EGL/eglext.h>
#include <dlfcn.h>

#include <array>
#include <vector>

#include "render/gl_provider.h"

namespace swage {

namespace {

struct Egl {
    PFNEGLGETPROCADDRESSPROC get_proc_address = nullptr;
    PFNEGLQUERYSTRINGPROC query_string = nullptr;
    PFNEGLINITIALIZEPROC initialize = nullptr;
    PFNEGLBINDAPIPROC bind_api = nullptr;
    PFNEGLCHOOSECONFIGPROC choose_config = nullptr;
    PFNEGLCREATECONTEXTPROC create_context = nullptr;
    PFNEGLDESTROYCONTEXTPROC destroy_context = nullptr;
    PFNEGLMAKECURRENTPROC make_current = nullptr;
    PFNEGLGETCURRENTCONTEXTPROC get_current_context = nullptr;
    PFNEGLGETPLATFORMDISPLAYEXTPROC get_platform_display = nullptr;
    PFNEGLQUERYDEVICESEXTPROC query_devices = nullptr;
    PFNEGLQUERYDEVICESTRINGEXTPROC query_device_string = nullptr;
};

template <typename Function>
bool find(void* library, const char* name, Function& function) {
    function = reinterpret_cast<Function>(dlsym(library, name));
    return function != nullptr;
}

bool has_word(const char* list, const char* word) {
    if (list == nullptr) return false;
    const std::string padded = std::string(" ") + list + " ";
    return padded.find(std::string(" ") + word + " ") != std::string::npos;
}

class EglProvider final : public GlProvider {
  public:
    ~EglProvider() override {
        // The display is shared by the whole process and stays as it is.
        if (context_ == EGL_NO_CONTEXT) return;
        if (egl_.get_current_context() == context_) {
            egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
        }
        egl_.destroy_context(display_, context_);
    }

    bool create(std::string& why_not) {
        if (!open_library()) {
            why_not = "libEGL is missing";
            return false;
        }
        for (const EGLDisplay display : displays()) {
            if (display != EGL_NO_DISPLAY && create_on(display)) return true;
        }
        why_not = "libEGL provides no OpenGL 3.3 core context without a display";
        return false;
    }

    bool make_current() override {
        return egl_.bind_api(EGL_OPENGL_API) == EGL_TRUE &&
               egl_.make_current(display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context_) == EGL_TRUE;
    }
    GlAddress address(const char* function) override { return egl_.get_proc_address(function); }

  private:
    bool open_library() {
        // Never closed: the library starts threads and keeps global state.
        void* library = dlopen("libEGL.so.1", RTLD_NOW | RTLD_LOCAL);
        if (library == nullptr) return false;
        if (!find(library, "eglGetProcAddress", egl_.get_proc_address) ||
            !find(library, "eglQueryString", egl_.query_string) ||
            !find(library, "eglInitialize", egl_.initialize) ||
            !find(library, "eglBindAPI", egl_.bind_api) ||
            !find(library, "eglChooseConfig", egl_.choose_config) ||
            !find(library, "eglCreateContext", egl_.create_context) ||
            !find(library, "eglDestroyContext", egl_.destroy_context) ||
            !find(library, "eglMakeCurrent", egl_.make_current) ||
            !find(library, "eglGetCurrentContext", egl_.get_current_context)) {
            return false;
        }
        extension("eglGetPlatformDisplayEXT", egl_.get_platform_display);
        extension("eglQueryDevicesEXT", egl_.query_devices);
        extension("eglQueryDeviceStringEXT", egl_.query_device_string);
        return egl_.get_platform_display != nullptr;
    }

    template <typename Function>
    void extension(const char* name, Function& function) {
        function = reinterpret_cast<Function>(egl_.get_proc_address(name));
    }

    std::vector<EGLDisplay> displays() {
        const char* client = egl_.query_string(EGL_NO_DISPLAY, EGL_EXTENSIONS);
        std::vector<EGLDisplay> software, hardware, result;
        if (has_word(client, "EGL_EXT_platform_device") && egl_.query_devices != nullptr &&
            egl_.query_device_string != nullptr) {
            std::array<EGLDeviceEXT, 32> device{};
            EGLint count = 0;
            egl_.query_devices(static_cast<EGLint>(device.size()), device.data(), &count);
            for (EGLint i = 0; i < count; ++i) {
                const EGLDeviceEXT d = device[static_cast<std::size_t>(i)];
                const bool soft = has_word(egl_.query_device_string(d, EGL_EXTENSIONS),
                                           "EGL_MESA_device_software");
                (soft ? software : hardware)
                    .push_back(egl_.get_platform_display(EGL_PLATFORM_DEVICE_EXT, d, nullptr));
            }
        }
        result = software;
        if (has_word(client, "EGL_MESA_platform_surfaceless")) {
            result.push_back(egl_.get_platform_display(EGL_PLATFORM_SURFACELESS_MESA,
                                                       EGL_DEFAULT_DISPLAY, nullptr));
        }
        result.insert(result.end(), hardware.begin(), hardware.end());
        return result;
    }

    bool create_on(EGLDisplay display) {
        EGLint major = 0, minor = 0;
        if (egl_.initialize(display, &major, &minor) != EGL_TRUE) return false;
        if (!has_word(egl_.query_string(display, EGL_EXTENSIONS), "EGL_KHR_surfaceless_context")) {
            return false;
        }
        if (egl_.bind_api(EGL_OPENGL_API) != EGL_TRUE) return false;
        const EGLint wanted[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT,
                                 EGL_NONE};
        EGLConfig config = nullptr;
        EGLint count = 0;
        if (egl_.choose_config(display, wanted, &config, 1, &count) != EGL_TRUE || count == 0) {
            return false;
        }
        const EGLint attributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                     3,
                                     EGL_CONTEXT_MINOR_VERSION,
                                     3,
                                     EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                     EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                     EGL_NONE};
        context_ = egl_.create_context(display, config, EGL_NO_CONTEXT, attributes);
        if (context_ == EGL_NO_CONTEXT) return false;
        display_ = display;
        if (make_current()) return true;
        egl_.destroy_context(display, context_);
        context_ = EGL_NO_CONTEXT;
        return false;
    }

    Egl egl_;
    EGLDisplay display_ = EGL_NO_DISPLAY;
    EGLContext context_ = EGL_NO_CONTEXT;
};

}  // namespace

std::unique_ptr<GlProvider> make_egl_provider(std::string& why_not) {
    auto provider = std::make_unique<EglProvider>();
    if (!provider->create(why_not)) return nullptr;
    return provider;
}

}  // namespace swage
