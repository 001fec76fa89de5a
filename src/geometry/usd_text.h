// SPDX-License-Identifier: GPL-3.0-or-later
// USD as text (.usda; openusd.org, "USD File Format", and UsdGeom, UsdShade, UsdPreviewSurface),
// written as it is made: a value that changes holds all its samples in one place, so that who
// writes it goes over the motion once a value.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "base/atomic_file.h"
#include "base/math.h"

namespace swage {

// Letters, digits and _, not beginning with a digit, and none that is taken already (`_2`, `_3`).
std::string usd_identifier(std::string_view name, std::set<std::string>& taken);
std::string usd_string(std::string_view text);  // with its quotes
std::string usd_asset(std::string_view path);   // with its @

// What a prim begins with. It keeps its name where that is no identifier; `about`: more of the
// kind.
std::string usd_prim(std::string_view kind, const std::string& name, const std::string& identifier,
                     std::string_view about = {});

class UsdText {
  public:
    // `later`: by which the time codes of all values are beyond the times that they are given at.
    explicit UsdText(const std::filesystem::path& file, int later = 0)
        : file_(file), later_(later) {}

    void line(std::string_view text);  // one or more, each put in
    void open(std::string_view head);  // of a prim; what follows is in it until
    void close();
    void finish();

    // A value that is what `write(t)` puts from each time t on; of one time, all along.
    // `interpolation`: from corners or vertices, empty where that goes without saying.
    template <typename Write>
    void value(const std::string& declaration, const std::string& interpolation,
               const std::vector<int>& time, const Write& write) {
        indent();
        put(declaration);
        const std::string told = "interpolation = \"" + interpolation + "\"";
        // NOTE: on lines of its own there, on one line here; three.js reads either only so.
        if (time.size() == 1) {
            put(" = ");
            write(time[0]);
            put(interpolation.empty() ? "\n" : " (\n");
            if (!interpolation.empty()) line("    " + told + "\n)");
            return;
        }
        if (!interpolation.empty()) {
            put(" (" + told + ")\n");
            indent();
            put(declaration);
        }
        put(".timeSamples = {\n");
        ++depth_;
        for (const int t : time) {
            indent();
            number(t + later_);
            put(": ");
            write(t);
            put(",\n");
        }
        --depth_;
        line("}");
    }
    // What stands in one: [put(0), put(1), ...].
    template <typename Put>
    void list(std::size_t count, const Put& put_one) {
        put("[");
        for (std::size_t i = 0; i < count; ++i) {
            if (i > 0) put(", ");
            put_one(i);
        }
        put("]");
    }
    void number(int value);
    void number(float value);  // the shortest that reads back to it
    void word(std::string_view text) { put(usd_string(text)); }
    void place(const Vec3& exact);  // in double precision
    template <int Size>
    void vector(const Eigen::Matrix<float, Size, 1>& value) {
        put("(");
        for (int k = 0; k < Size; ++k) {
            if (k > 0) put(", ");
            number(value[k]);
        }
        put(")");
    }

  private:
    void put(std::string_view text) {
        bytes_.append(text);
        if (bytes_.size() >= kHeld) flush();
    }
    void indent() { bytes_.append(4 * static_cast<std::size_t>(depth_), ' '); }
    void flush();

    static constexpr std::size_t kHeld = 1 << 20;
    WholeFile file_;
    const int later_;
    std::string bytes_;
    int depth_ = 0;
};

}  // namespace swage
