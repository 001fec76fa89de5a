// SPDX-License-Identifier: GPL-3.0-or-later
// What a source of OpenGL contexts must do. Seen by canvas.cpp and the two providers only.
#pragma once

#include <memory>
#include <string>

namespace swage {

using GlAddress = void (*)();

class GlProvider {
  public:
    virtual ~GlProvider() = default;
    virtual bool make_current() = 0;
    virtual GlAddress address(const char* function) = 0;
};

// A provider whose context is current, or null and the reason in `why_not`.
std::unique_ptr<GlProvider> make_osmesa_provider(std::string& why_not);
std::unique_ptr<GlProvider> make_egl_provider(std::string& why_not);

}  // namespace swage
