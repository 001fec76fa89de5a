// SPDX-License-Identifier: GPL-3.0-or-later
// OFF, after the manual of Geomview 1.9, "OFF: Object File Format". Not read through assimp, which
// takes what the letters of STCNOFF announce in another order, forgets the colours of faces, and
// moves indices that are out of range to the last vertex.
#include <algorithm>
#include <map>

#include "base/error.h"
#include "base/srgb.h"
#include "base/text.h"
#include "geometry/mesh_read_child.h"
#include "geometry/text_scan.h"

namespace swage {

namespace {

using Color = std::array<double, 3>;  // as the file has it

class OffReader {
  public:
    explicit OffReader(MeshSource& source) : source_(source), text_(source.bytes) {}

    RawMesh read() {
        read_head();
        for (long long v = 0; v < vertices_; ++v) read_vertex(v);
        for (long long f = 0; f < faces_; ++f) read_face(f);
        std::size_t more = 0;
        while (next()) ++more;
        paint();
        mesh_.at_vertices = 1;
        const auto say = [&](bool is_so, const char* what) {
            if (is_so) source_.finding.emplace_back(what);
        };
        if (more > 0)
            source_.finding.push_back(counted(more, "line", "lines") +
                                      " beyond the count in its header left out");
        say(has_more_, "further values of its vertices were left out");
        say(has_color_numbers_, "colours given as indices into a colour map were left out");
        say(has_two_colors_, "its faces' colours were left out: its vertices have their own");
        add_polygons(polygons_, mesh_);
        return std::move(mesh_);
    }

  private:
    // The next line that says something.
    bool next() {
        while (next_line(text_, line_)) {
            line_ = trimmed(line_.substr(0, line_.find('#')));
            if (!line_.empty()) return true;
        }
        return false;
    }

    void read_head() {
        constexpr const char* kNoCounts = "no line with the numbers of vertices and faces";
        if (!next()) fail(ExitCode::mesh, kNoCounts);
        std::string_view words = line_;
        std::string_view head = next_word(words);
        if (head.ends_with("OFF")) {
            head.remove_suffix(3);
            const auto announces = [&](std::string_view letters) {
                const bool so = head.starts_with(letters);
                if (so) head.remove_prefix(letters.size());
                return so;
            };
            has_uv_ = announces("ST");
            has_color_ = announces("C");
            has_normal_ = announces("N");
            is_weighted_ = announces("4");
            if (announces("n"))
                fail(ExitCode::mesh, "vertices of arbitrary dimension (nOFF) cannot be read");
            if (!head.empty()) fail(ExitCode::mesh, "'{}OFF' is not known", head.substr(0, 40));
            if (trimmed(words).empty()) {
                if (!next()) fail(ExitCode::mesh, kNoCounts);
                words = line_;
            }
            head = next_word(words);
        }
        if (head == "BINARY") fail(ExitCode::mesh, "binary OFF cannot be read");
        if (!to_integer(head, vertices_) || !to_integer(next_word(words), faces_))
            fail(ExitCode::mesh, kNoCounts);
        if (vertices_ < 0 || faces_ < 0)
            fail(ExitCode::mesh, "its header gives {} vertices and {} faces", vertices_, faces_);
    }

    // Of vertex or face `id`, the numbers that are left on its line.
    void read_values(const char* what, long long id) {
        value_.clear();
        for (std::string_view word; !(word = next_word(line_)).empty();) {
            double value = 0;
            if (!to_number(word, value))
                fail(ExitCode::mesh, "{} {}: '{}' is not a number", what, id, word.substr(0, 40));
            value_.push_back(value);
        }
    }

    void read_vertex(long long v) {
        if (!next()) fail(ExitCode::mesh, "the file ends early, at vertex {} of {}", v, vertices_);
        read_values("vertex", v);
        const std::size_t before = 3 + is_weighted_ + (has_normal_ ? 3 : 0);
        const std::size_t after = has_uv_ ? 2 : 0;
        if (value_.size() < before + after)
            fail(ExitCode::mesh, "vertex {} has {} values, not {}", v, value_.size(),
                 before + after);
        const double* at = value_.data();
        Vec3 position(at[0], at[1], at[2]);
        if (is_weighted_) position /= at[3];
        mesh_.position.push_back(position);
        at += 3 + is_weighted_;
        if (has_normal_) mesh_.normal.push_back(Vec3(at[0], at[1], at[2]).cast<float>());
        const std::size_t colors = value_.size() - before - after;
        if (has_color_ && (colors == 3 || colors == 4)) {
            at = value_.data() + before;
            vertex_color_.push_back({at[0], at[1], at[2]});
        } else if (has_color_ && colors == 1) {
            has_color_numbers_ = true;
        } else if (has_color_) {
            fail(ExitCode::mesh, "vertex {} has a colour of {} values", v, colors);
        } else {
            has_more_ = has_more_ || colors > 0;
        }
        at = value_.data() + value_.size() - after;
        if (has_uv_) mesh_.uv.push_back({at[0], at[1]});
    }

    void read_face(long long f) {
        if (!next()) fail(ExitCode::mesh, "the file ends early, at face {} of {}", f, faces_);
        long long corners = 0, index = 0;
        if (!to_integer(next_word(line_), corners) || corners < 0)
            fail(ExitCode::mesh, "face {}: the number of corners is missing", f);
        for (; corners > 0; --corners) {
            const std::string_view word = next_word(line_);
            if (!to_integer(word, index) || index < 0 || index >= vertices_)
                fail(ExitCode::mesh, "face {}: '{}' is not a vertex (there are {})", f,
                     word.substr(0, 40), vertices_);
            const int v = static_cast<int>(index);
            polygons_.add_corner(v, has_uv_ ? v : -1, has_normal_ ? v : -1);
        }
        polygons_.end_polygon(-1, -1, 0);
        read_values("face", f);
        face_color_.emplace_back();
        if (value_.size() == 1) has_color_numbers_ = true;
        if (value_.size() >= 3) face_color_.back() = Color{value_[0], value_[1], value_[2]};
    }

    static Eigen::Vector3f light_of(const Color& color, double most) {
        Eigen::Vector3f light;
        for (std::size_t i = 0; i < 3; ++i)
            light[static_cast<int>(i)] =
                static_cast<float>(linear_from_srgb(std::clamp(color[i] / most, 0.0, 1.0)));
        return light;
    }

    void paint() {
        // Counted to 1 or to 255: the file does not say.
        double most = 1;
        const auto look_at = [&](const Color& color) {
            if (*std::max_element(color.begin(), color.end()) > 1) most = 255;
        };
        for (const Color& color : vertex_color_) look_at(color);
        for (const auto& color : face_color_)
            if (color) look_at(*color);
        const bool has_face_colors =
            std::any_of(face_color_.begin(), face_color_.end(),
                        [](const auto& color) { return color.has_value(); });
        if (!vertex_color_.empty()) {
            has_two_colors_ = has_face_colors;
            if (vertex_color_.size() != mesh_.position.size())
                fail(ExitCode::mesh, "some vertices have a colour and others have none");
            for (const Color& color : vertex_color_) mesh_.color.push_back(light_of(color, most));
        } else if (has_face_colors) {
            paint_faces(most);
        }
    }

    // A vertex where faces of several colours meet becomes several.
    void paint_faces(double most) {
        const std::size_t given = mesh_.position.size();
        std::vector<char> is_taken(given, 0);
        mesh_.color.assign(given, Eigen::Vector3f::Ones());
        std::map<std::pair<int, Color>, int> painted;
        for (std::size_t f = 0; f < face_color_.size(); ++f) {
            const Color color = face_color_[f].value_or(Color{most, most, most});
            for (int c = polygons_.first[f]; c < polygons_.first[f + 1]; ++c) {
                const int v = polygons_.position[static_cast<std::size_t>(c)];
                const auto [at, is_new] = painted.try_emplace({v, color}, v);
                if (is_new && is_taken[static_cast<std::size_t>(v)]) {
                    at->second = static_cast<int>(mesh_.position.size());
                    mesh_.position.push_back(mesh_.position[static_cast<std::size_t>(v)]);
                    mesh_.color.push_back(Eigen::Vector3f::Ones());
                }
                if (is_new)
                    mesh_.color[static_cast<std::size_t>(at->second)] = light_of(color, most);
                is_taken[static_cast<std::size_t>(v)] = 1;
                polygons_.position[static_cast<std::size_t>(c)] = at->second;
            }
        }
    }

    MeshSource& source_;
    std::string_view text_, line_;
    RawMesh mesh_;
    PolygonList polygons_;
    std::vector<Color> vertex_color_;
    std::vector<std::optional<Color>> face_color_;
    std::vector<double> value_;
    long long vertices_ = 0, faces_ = 0;
    bool has_uv_ = false, has_color_ = false, has_normal_ = false, is_weighted_ = false;
    bool has_more_ = false, has_color_numbers_ = false, has_two_colors_ = false;
};

}  // namespace

RawMesh read_off(MeshSource& source) { return OffReader(source).read(); }

}  // namespace swage
