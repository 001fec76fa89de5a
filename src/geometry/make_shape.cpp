// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/make_shape.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <utility>

#include "base/error.h"
#include "base/portable_math.h"
#include "geometry/made_shapes.h"

namespace swage {

namespace {

struct Entry {
    ShapeInfo info;
    std::function<TriMesh(const ShapeValues&)> make;  // empty for the painted ones
    std::function<MadeShape(const ShapeValues&)> make_painted;
    SurfaceMaterial material;
    double crease_angle;  // [rad]
};

ShapeParameter length_of(std::string name, double value, std::string help) {
    return {std::move(name), ParameterKind::length, value, 1e-6, 1e3, std::move(help)};
}

ShapeParameter division_of(double value, double low, double high,
                           std::string along = "the length") {
    return {"division", ParameterKind::count, value, low, high, "number of edges along " + along};
}

SurfaceMaterial finish(std::string name, const Vec3& color, double roughness, double metallic) {
    SurfaceMaterial material;
    material.name = std::move(name);
    material.color = color;
    material.roughness = roughness;
    material.metallic = metallic;
    return material;
}

constexpr double kSharp = 35 * kPi / 180;

std::vector<Entry> make_entries() {
    std::vector<Entry> all;
    all.push_back({{"bar",
                    "a bar with rounded edges",
                    {length_of("length", 0.2, "length along x"),
                     length_of("height", 0.02, "size along y"),
                     length_of("width", 0.02, "size along z"),
                     {"rounding", ParameterKind::length, 0.0015, 0, 1e3, "radius of the edges"},
                     division_of(60, 1, 2000)}},
                   make_bar,
                   {},
                   finish("steel", {0.56, 0.57, 0.58}, 0.34, 1.0),
                   kSharp});
    all.push_back({{"rod",
                    "a round rod",
                    {length_of("length", 0.2, "length along x"),
                     length_of("diameter", 0.02, "across"), division_of(64, 1, 2000)}},
                   make_rod,
                   {},
                   finish("brass", {0.84, 0.63, 0.25}, 0.30, 1.0),
                   kSharp});
    all.push_back(
        {{"tube",
          "a hollow rod",
          {length_of("length", 0.2, "length along x"), length_of("diameter", 0.03, "outer"),
           length_of("wall", 0.0035, "thickness of the wall"), division_of(56, 1, 2000)}},
         make_tube,
         {},
         finish("copper", {0.86, 0.47, 0.33}, 0.32, 1.0),
         kSharp});
    all.push_back(
        {{"sheet",
          "a flat sheet",
          {length_of("length", 0.2, "length along x"), length_of("width", 0.1, "size along z"),
           length_of("thickness", 0.004, "size along y"), division_of(52, 1, 1000)}},
         make_sheet,
         {},
         finish("aluminium", {0.80, 0.81, 0.83}, 0.38, 1.0),
         kSharp});
    all.push_back(
        {{"sphere",
          "a ball of even quads",
          {length_of("diameter", 0.1, "across"),
           {"wall", ParameterKind::length, 0, 0, 1e3, "thickness of a hollow one's; 0: solid"},
           division_of(24, 2, 1000, "the diameter")}},
         make_sphere,
         {},
         finish("rubber", {0.55, 0.09, 0.07}, 0.6, 0.0),
         kPi});
    all.push_back({{"wrench",
                    "a wrench with a ring and an open jaw",
                    {length_of("length", 0.18, "length along x"), division_of(100, 40, 400)}},
                   make_wrench,
                   {},
                   finish("chrome steel", {0.66, 0.67, 0.69}, 0.24, 1.0),
                   kPi});
    all.push_back({{"gear",
                    "a spur gear with involute teeth, hub, web and bore, its axis along y",
                    {length_of("diameter", 0.1, "outer diameter, over the teeth"),
                     length_of("bore", 0.02, "diameter of the hole"),
                     length_of("width", 0.016, "size along y"),
                     {"teeth", ParameterKind::count, 18, 8, 200, "number of teeth"},
                     division_of(30, 8, 1000, "the diameter")}},
                   make_gear,
                   {},
                   finish("bronze", {0.62, 0.42, 0.22}, 0.36, 1.0),
                   kSharp});
    all.push_back({{"plate-with-handles",
                    "a shallow tray with a loop at either end",
                    {length_of("length", 0.25, "length along x"), division_of(58, 24, 400)}},
                   make_plate_with_handles,
                   {},
                   finish("enamel", {0.05, 0.20, 0.42}, 0.28, 0.0),
                   kPi});
    all.push_back({{"calf",
                    "a young cow with a painted coat",
                    {length_of("length", 1.0, "length along x"),
                     division_of(38, 20, 200, "its length, on the trunk"),
                     {"texture", ParameterKind::count, 1024, 64, 4096,
                      "texels along each side of the texture"}}},
                   {},
                   make_calf,
                   {},
                   kPi});
    return all;
}

const std::vector<Entry>& entries() {
    static const std::vector<Entry> all = make_entries();
    return all;
}

template <typename Range>
std::string names_of(const Range& range) {
    std::string names;
    for (const auto& item : range) names += (names.empty() ? "" : ", ") + item.name;
    return names;
}

ShapeValues complete(const ShapeInfo& info, const std::map<std::string, double>& given) {
    ShapeValues values;
    for (const ShapeParameter& p : info.parameters) values[p.name] = p.value;
    for (const auto& [name, value] : given) {
        const ShapeParameter* parameter = nullptr;
        for (const ShapeParameter& p : info.parameters)
            if (p.name == name) parameter = &p;
        if (!parameter)
            fail(ExitCode::command_line, "{} has no parameter \"{}\"; it has {}", info.name, name,
                 names_of(info.parameters));
        if (!(value >= parameter->low && value <= parameter->high))
            fail(ExitCode::command_line, "{}: {} = {} is not between {} and {}", info.name, name,
                 value, parameter->low, parameter->high);
        if (parameter->kind == ParameterKind::count && value != std::floor(value))
            fail(ExitCode::command_line, "{}: {} = {} is not a whole number", info.name, name,
                 value);
        values[name] = value;
    }
    // A thin or stretched shape must not be cut into more pieces than a machine can hold.
    double longest = 0;
    for (const ShapeParameter& p : info.parameters)
        if (p.kind == ParameterKind::length) longest = std::max(longest, values[p.name]);
    const double edge = values[info.parameters.front().name] / values["division"];
    if (longest / edge > 4000)
        fail(ExitCode::resources, "{}: edges of {} m would divide {} m into more than 4000",
             info.name, edge, longest);
    return values;
}

// Keeps about seven decimals of the size and four of how thin it is, and one of each texture
// coordinate, so that files are short and read back to the same numbers.
void tidy(TriMesh& mesh) {
    const Vec3 size = box_of(mesh.position).size();
    const auto steps = [](double length, int decimals) {
        return portable::pow(10.0, decimals - std::ceil(portable::log10(length)));
    };
    const double per_unit = std::max(steps(size.maxCoeff(), 7), steps(size.minCoeff(), 4));
    const auto rounded = [](double x, double steps) {
        return std::round(x * steps) / steps + 0.0;  // no negative zero
    };
    for (Vec3& p : mesh.position)
        for (double& x : p) x = rounded(x, per_unit);
    std::map<std::pair<double, double>, int> id;
    std::vector<Vec2> uv;
    for (Corners& corners : mesh.triangle_uv)
        for (int& corner : corners) {
            const Vec2 at(rounded(mesh.uv[corner].x(), 1e6), rounded(mesh.uv[corner].y(), 1e6));
            const auto [entry, is_new] =
                id.try_emplace({at.x(), at.y()}, static_cast<int>(uv.size()));
            if (is_new) uv.push_back(at);
            corner = entry->second;
        }
    mesh.uv = std::move(uv);
}

}  // namespace

const std::vector<ShapeInfo>& shape_catalogue() {
    static const std::vector<ShapeInfo> catalogue = [] {
        std::vector<ShapeInfo> infos;
        for (const Entry& entry : entries()) infos.push_back(entry.info);
        return infos;
    }();
    return catalogue;
}

MadeShape make_shape(const std::string& name, const std::map<std::string, double>& parameters) {
    for (const Entry& entry : entries()) {
        if (entry.info.name != name) continue;
        const ShapeValues values = complete(entry.info, parameters);
        MadeShape made;
        if (entry.make_painted) {
            made = entry.make_painted(values);
        } else {
            made.mesh = entry.make(values);
            if (made.mesh.uv.empty()) unwrap(made.mesh);
            smooth_by_crease_angle(made.mesh, entry.crease_angle);
            made.mesh.material = {entry.material};
            made.mesh.triangle_material.assign(made.mesh.triangle.size(), 0);
        }
        tidy(made.mesh);
        return made;
    }
    fail(ExitCode::command_line, "there is no shape \"{}\"; choose from {}", name,
         names_of(shape_catalogue()));
}

}  // namespace swage
