// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/shaders.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>

#include "base/error.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

std::vector<fs::path> shader_folders() {
    std::vector<fs::path> folders;
    if (const char* named = std::getenv("SWAGE_SHADERS"); named != nullptr && *named != '\0') {
        folders.emplace_back(named);
    }
    std::error_code error;
    const fs::path program = fs::read_symlink("/proc/self/exe", error);
    if (!error) {
        folders.push_back(program.parent_path().parent_path() / "share/swage/shaders");
    }
    return folders;
}

std::string file_text(const std::string& name) {
    for (const fs::path& folder : shader_folders()) {
        std::ifstream in(folder / name, std::ios::binary);
        if (!in) continue;
        std::ostringstream text;
        text << in.rdbuf();
        return text.str();
    }
    for (const EmbeddedShader& shader : embedded_shaders()) {
        if (name == shader.name) return shader.text;
    }
    fail(ExitCode::output, "there is no shader {}", name);
}

void append(const std::string& name, std::vector<std::string>& files, std::string& out) {
    const std::size_t number = files.size();
    files.push_back(name);
    std::istringstream lines(file_text(name));
    static const std::regex include(R"(\s*#include\s+"([^"]+)\"\s*)");
    std::smatch match;
    int line_number = 0;
    for (std::string line; std::getline(lines, line);) {
        ++line_number;
        if (!std::regex_match(line, match, include)) {
            out += line + "\n";
            // Only after #version may anything else stand.
            if (line.rfind("#version", 0) == 0)
                out += fmt::format("#line {} {}\n", line_number + 1, number);
            continue;
        }
        const std::string inner = match[1];
        if (std::find(files.begin(), files.end(), inner) == files.end()) {
            out += fmt::format("#line 1 {}\n", files.size());
            append(inner, files, out);
        }
        out += fmt::format("#line {} {}\n", line_number + 1, number);
    }
}

GlHandle compiled(const Gl& gl, GLenum kind, const std::string& name, const std::string& define) {
    std::vector<std::string> files;
    std::string text = shader_text(name, files);
    if (!define.empty()) text.insert(text.find('\n') + 1, "#define " + define + "\n");
    GlHandle shader(gl, gl.CreateShader(kind), [](const Gl& g, GLuint i) { g.DeleteShader(i); });
    const char* source = text.c_str();
    gl.ShaderSource(shader.id(), 1, &source, nullptr);
    gl.CompileShader(shader.id());
    GLint good = 0;
    gl.GetShaderiv(shader.id(), GL_COMPILE_STATUS, &good);
    if (good != 0) return shader;
    std::string log(8192, '\0');
    GLsizei length = 0;
    gl.GetShaderInfoLog(shader.id(), static_cast<GLsizei>(log.size()), &length, log.data());
    log.resize(static_cast<std::size_t>(length));
    fail(ExitCode::output, "shader {} does not compile:\n{}", name, with_file_names(log, files));
}

}  // namespace

std::string shader_text(const std::string& name, std::vector<std::string>& files) {
    std::string out;
    append(name, files, out);
    return out;
}

std::string with_file_names(const std::string& log, const std::vector<std::string>& files) {
    static const std::regex place(R"((\d+):(\d+)\((\d+)\))");
    std::string out;
    std::size_t done = 0;
    for (std::sregex_iterator it(log.begin(), log.end(), place), end; it != end; ++it) {
        const std::size_t number = std::stoul((*it)[1]);
        out += log.substr(done, static_cast<std::size_t>(it->position()) - done);
        out += number < files.size()
                   ? fmt::format("{}:{}:{}", files[number], (*it)[2].str(), (*it)[3].str())
                   : it->str();
        done = static_cast<std::size_t>(it->position() + it->length());
    }
    return out + log.substr(done);
}

Shader::Shader(const Gl& gl, const std::string& vertex, const std::string& fragment,
               const std::vector<const char*>& samplers, const std::string& define)
    : gl_(&gl),
      program_(gl, gl.CreateProgram(), [](const Gl& g, GLuint i) { g.DeleteProgram(i); }) {
    const GlHandle v = compiled(gl, GL_VERTEX_SHADER, vertex, define);
    const GlHandle f = compiled(gl, GL_FRAGMENT_SHADER, fragment, define);
    gl.AttachShader(program_.id(), v.id());
    gl.AttachShader(program_.id(), f.id());
    gl.LinkProgram(program_.id());
    GLint good = 0;
    gl.GetProgramiv(program_.id(), GL_LINK_STATUS, &good);
    if (good == 0) {
        std::string log(8192, '\0');
        GLsizei length = 0;
        gl.GetProgramInfoLog(program_.id(), static_cast<GLsizei>(log.size()), &length, log.data());
        log.resize(static_cast<std::size_t>(length));
        fail(ExitCode::output, "shaders {} and {} do not link: {}", vertex, fragment, log);
    }
    const GLuint block = gl.GetUniformBlockIndex(program_.id(), "Frame");
    if (block != GL_INVALID_INDEX) gl.UniformBlockBinding(program_.id(), block, 0);
    use();
    for (std::size_t i = 0; i < samplers.size(); ++i) set(samplers[i], static_cast<int>(i));
}

void Shader::use() const { gl_->UseProgram(program_.id()); }

GLint Shader::location(const char* uniform) const {
    const auto found = locations_.find(uniform);
    if (found != locations_.end()) return found->second;
    const GLint location = gl_->GetUniformLocation(program_.id(), uniform);
    locations_[uniform] = location;
    return location;
}

void Shader::set(const char* uniform, int value) const { gl_->Uniform1i(location(uniform), value); }
void Shader::set4(const char* uniform, const float* value) const {
    gl_->Uniform4fv(location(uniform), 1, value);
}
void Shader::set_matrix(const char* uniform, const float* column_major) const {
    gl_->UniformMatrix4fv(location(uniform), 1, GL_FALSE, column_major);
}

}  // namespace swage
