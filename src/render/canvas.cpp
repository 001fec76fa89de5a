// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/canvas.h"

#include <cstdlib>
#include <cstring>
#include <mutex>

#include "base/error.h"
#include "render/gl_provider.h"

namespace swage {

namespace {

// Read by Mesa's software rasteriser when the first context of the process is made.
void prepare_environment(int threads) {
    static std::once_flag once;
    std::call_once(once, [threads] {
        // NOTE vectors of 512 bits crash the shaders that LLVM 15 compiles for llvmpipe.
        const char* bits = std::getenv("LP_NATIVE_VECTOR_WIDTH");
        if (bits != nullptr && std::strcmp(bits, "512") == 0) {
            ::setenv("LP_NATIVE_VECTOR_WIDTH", "256", 1);
        }
        if (threads > 0) ::setenv("LP_NUM_THREADS", std::to_string(threads).c_str(), 0);
    });
}

bool load_table(Gl& gl, GlProvider& provider, std::string& missing) {
#define SWAGE_GL_LOAD(type, name)                                   \
    gl.name = reinterpret_cast<type>(provider.address("gl" #name)); \
    if (gl.name == nullptr) missing = "gl" #name;
    SWAGE_GL_FUNCTIONS(SWAGE_GL_LOAD)
#undef SWAGE_GL_LOAD
    return missing.empty();
}

}  // namespace

Canvas::Canvas(GlProviderKind kind, int threads) {
    prepare_environment(threads);
    std::string reasons;
    if (kind != GlProviderKind::egl && try_kind(GlProviderKind::osmesa, reasons)) return;
    if (kind != GlProviderKind::osmesa && try_kind(GlProviderKind::egl, reasons)) return;
    const char* packages = kind == GlProviderKind::osmesa ? "libosmesa6"
                           : kind == GlProviderKind::egl  ? "libegl1 and libgl1-mesa-dri"
                                                          : "libosmesa6, or libegl1 and "
                                                            "libgl1-mesa-dri";
    fail(ExitCode::output,
         "no OpenGL 3.3 to draw with: {}. Install the Debian package {}, or run with --no-render",
         reasons, packages);
}

Canvas::~Canvas() = default;

bool Canvas::try_kind(GlProviderKind kind, std::string& reasons) {
    std::string why_not;
    provider_ =
        kind == GlProviderKind::osmesa ? make_osmesa_provider(why_not) : make_egl_provider(why_not);
    if (provider_ && !load_table(gl_, *provider_, why_not)) {
        why_not += " is missing";
        provider_.reset();
    }
    if (!provider_) {
        reasons += (reasons.empty() ? "" : "; ") + why_not;
        return false;
    }
    kind_ = kind;
    const auto text = [&](GLenum name) {
        const GLubyte* bytes = gl_.GetString(name);
        return std::string(bytes != nullptr ? reinterpret_cast<const char*>(bytes) : "unknown");
    };
    renderer_string_ = fmt::format("{}, {} ({})", text(GL_RENDERER), text(GL_VERSION),
                                   kind == GlProviderKind::osmesa ? "OSMesa" : "EGL");
    return true;
}

void Canvas::make_current() {
    if (!provider_->make_current()) {
        fail(ExitCode::output, "the OpenGL context was lost ({})", renderer_string_);
    }
}

}  // namespace swage
