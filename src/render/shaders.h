// SPDX-License-Identifier: GPL-3.0-or-later
// GLSL programs by the names of their files in shaders/. A file is taken from the first of: the
// folder in the environment variable SWAGE_SHADERS, ../share/swage/shaders beside the running
// program, the copy built in.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "render/canvas.h"
#include "render/gl_handle.h"

namespace swage {

struct EmbeddedShader {
    const char* name;
    const char* text;
};
const std::vector<EmbeddedShader>& embedded_shaders();  // made at build time

// A file's text with its `#include "name"` lines filled in. `files` collects the names met, in
// the order of the numbers that #line gives them. Throws Error(output) for an unknown name.
std::string shader_text(const std::string& name, std::vector<std::string>& files);

// What the driver says of "1:12(3)", said of the file that has the number 1: "light.glsl:12:3".
std::string with_file_names(const std::string& log, const std::vector<std::string>& files);

// A linked program. Uniforms that the shaders do not use are ignored.
class Shader {
  public:
    // Texture samplers are bound to units in the order of `samplers`; the uniform block Frame, if
    // there is one, to binding 0. `define`, if not empty, is defined in both. Throws
    // Error(output) with file and line.
    Shader(const Gl& gl, const std::string& vertex, const std::string& fragment,
           const std::vector<const char*>& samplers = {}, const std::string& define = {});

    void use() const;
    void set(const char* uniform, int value) const;
    void set4(const char* uniform, const float* value) const;
    void set_matrix(const char* uniform, const float* column_major) const;

  private:
    GLint location(const char* uniform) const;

    const Gl* gl_;
    GlHandle program_;
    mutable std::map<std::string, GLint> locations_;
};

}  // namespace swage
