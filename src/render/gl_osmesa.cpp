// SPDX-License-Identifier: GPL-3.0-or-later
// OSMesa draws into memory. Its header pulls in GL/gl.h, whose prototypes clash with a table of
// functions, so the few entry points and constants are declared here.
#include <dlfcn.h>
#include <fmt/format.h>

#include <array>
#include <cstdint>

#include "render/gl_provider.h"

#ifdef __SANITIZE_ADDRESS__
// What the library keeps for good is not ours to give back.
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() { return "leak:libOSMesa\n"; }
#endif

namespace swage {

namespace {

using OsMesaContext = void*;
using CreateContextAttribs = OsMesaContext (*)(const int*, OsMesaContext);
using DestroyContext = void (*)(OsMesaContext);
using MakeCurrent = unsigned char (*)(OsMesaContext, void*, unsigned, int, int);
using GetProcAddress = GlAddress (*)(const char*);

constexpr int kFormat = 0x22, kRgba = 0x1908, kDepthBits = 0x30, kStencilBits = 0x31,
              kAccumBits = 0x32, kProfile = 0x33, kCoreProfile = 0x34, kMajor = 0x36, kMinor = 0x37;
constexpr unsigned kUnsignedByte = 0x1401;

// We draw into framebuffers of our own; this one only makes the context current.
constexpr int kSide = 16;

class OsMesaProvider final : public GlProvider {
  public:
    ~OsMesaProvider() override {
        if (context_ != nullptr) destroy_(context_);
    }

    bool create(std::string& why_not) {
        // Never closed: the library starts threads and keeps global state.
        void* library = nullptr;
        for (const char* name : {"libOSMesa.so.8", "libOSMesa.so.6", "libOSMesa.so"}) {
            if (library == nullptr) library = dlopen(name, RTLD_NOW | RTLD_LOCAL);
        }
        if (library == nullptr) {
            const char* reason = dlerror();
            why_not = fmt::format("libOSMesa cannot be loaded ({})",
                                  reason != nullptr ? reason : "it is missing");
            return false;
        }
        const auto create =
            reinterpret_cast<CreateContextAttribs>(dlsym(library, "OSMesaCreateContextAttribs"));
        destroy_ = reinterpret_cast<DestroyContext>(dlsym(library, "OSMesaDestroyContext"));
        make_current_ = reinterpret_cast<MakeCurrent>(dlsym(library, "OSMesaMakeCurrent"));
        address_ = reinterpret_cast<GetProcAddress>(dlsym(library, "OSMesaGetProcAddress"));
        if (create == nullptr || destroy_ == nullptr || make_current_ == nullptr ||
            address_ == nullptr) {
            why_not = "libOSMesa is too old";
            return false;
        }
        const std::array<int, 16> attributes = {
            kFormat,  kRgba,        kDepthBits, 0, kStencilBits, 0, kAccumBits, 0,
            kProfile, kCoreProfile, kMajor,     3, kMinor,       3, 0,          0};
        context_ = create(attributes.data(), nullptr);
        if (context_ == nullptr || !make_current()) {
            why_not = "libOSMesa provides no OpenGL 3.3 core context";
            return false;
        }
        return true;
    }

    bool make_current() override {
        return make_current_(context_, pixels_.data(), kUnsignedByte, kSide, kSide) != 0;
    }
    GlAddress address(const char* function) override { return address_(function); }

  private:
    OsMesaContext context_ = nullptr;
    DestroyContext destroy_ = nullptr;
    MakeCurrent make_current_ = nullptr;
    GetProcAddress address_ = nullptr;
    std::array<std::uint32_t, kSide * kSide> pixels_{};
};

}  // namespace

std::unique_ptr<GlProvider> make_osmesa_provider(std::string& why_not) {
    auto provider = std::make_unique<OsMesaProvider>();
    if (!provider->create(why_not)) return nullptr;
    return provider;
}

}  // namespace swage
