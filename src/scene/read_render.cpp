// SPDX-License-Identifier: GPL-3.0-or-later
#include "scene/read_render.h"

#include <algorithm>

#include "base/suggest.h"
#include "base/text.h"
#include "machines/repeat.h"
#include "scene/read_fields.h"

namespace swage {

namespace {

constexpr int kLargestSide = 16384;  // GL_MAX_TEXTURE_SIZE of the software renderers

void read_size(TableReader& table, RenderSettings& settings) {
    const Node* node = table.find("size");
    if (node == nullptr) return;
    const bool is_pair = node->kind == Node::Kind::array && node->item.size() == 2 &&
                         node->item[0].kind == Node::Kind::whole &&
                         node->item[1].kind == Node::Kind::whole;
    if (!is_pair) {
        table.mistake("size", "size must be two whole numbers, such as [1280, 720]");
        return;
    }
    const double width = node->item[0].number, height = node->item[1].number;
    if (width < 1 || height < 1) {
        table.mistake("size", fmt::format("size = [{}, {}] is out of range: both must be 1 to {}",
                                          width, height, kLargestSide));
    } else if (width > kLargestSide || height > kLargestSide) {
        table.mistake(
            "size",
            fmt::format("size = [{}, {}] is more than OpenGL can draw: both must be 1 to {}", width,
                        height, kLargestSide),
            ExitCode::resources);
    } else {
        settings.width = static_cast<int>(width);
        settings.height = static_cast<int>(height);
    }
}

void read_frame_rate(TableReader& table, FrameRate& rate) {
    table.describe("fps", kFrameRateForm, frame_rate_text(rate));
    const Node* node = table.find("fps");
    if (node == nullptr) return;
    std::optional<FrameRate> known;
    std::string said;
    if (node->kind == Node::Kind::text && node->text.find('/') != std::string::npos) {
        known = frame_rate_named(node->text);
        said = '"' + node->text + '"';
    } else {
        double value = 0;
        if (!table.value("fps", *node, Quantity::number, between(1, kMostFramesPerSecond), value)) {
            return;
        }
        known = frame_rate_of(value);
        said = fmt::format("{}", value);
    }
    if (known) {
        rate = *known;
        table.reading().number[node] = rate.value();
    } else {
        table.mistake("fps", fmt::format("fps = {} is no rate of films: it has to be a {}", said,
                                         kFrameRateForm));
    }
}

// Whether the table says it; with `open`, "auto" says nothing.
bool read_angle(TableReader& table, const std::string& key, const Range& range, double& into,
                bool* open) {
    const Node* node = table.find(key);
    const bool is_auto = open && node && node->kind == Node::Kind::text && node->text == "auto";
    const bool says = !is_auto && table.quantity(key, Quantity::angle, range, into);
    if (open) *open = !says;
    return says;
}

// Where the camera stands, from [render.camera] or one of its keys. `open`: of the angles, those
// that are not given; null: all count as given.
void read_view(TableReader& table, CameraKey& key, OpenAngles* open) {
    const Range quarter = between(-kPi / 2 - 1e-12, kPi / 2 + 1e-12);
    const bool orbits[] = {
        read_angle(table, "azimuth", {}, key.azimuth, open ? &open->azimuth : nullptr),
        read_angle(table, "elevation", quarter, key.elevation, open ? &open->elevation : nullptr),
        table.quantity("zoom", Quantity::number, between(0.01, 1000), key.zoom)};
    Vec3 eye = Vec3::Zero(), target = Vec3::Zero();
    const bool has_eye = table.vector("eye", Quantity::length, eye);
    const bool has_target = table.vector("target", Quantity::length, target);
    if (!has_eye && !has_target) return;
    if (!has_eye) {
        key.target = target;
        return;
    }
    if (!has_target) {
        table.mistake("eye", "an eye needs a target to look at");
        return;
    }
    if (orbits[0] || orbits[1] || orbits[2]) {
        table.mistake(
            "eye", "eye and target replace azimuth, elevation and zoom: give one set or the other");
    }
    if (eye == target) table.mistake("eye", "eye and target are the same point");
    key.eye = eye;
    key.target = target;
    if (open) *open = {};
}

void read_light(TableReader& table, LightPlace& light) {
    const Range above_ground = between(5 * kPi / 180 - 1e-12, kPi / 2 + 1e-12);
    table.quantity("azimuth", Quantity::angle, {}, light.azimuth);
    table.quantity("elevation", Quantity::angle, above_ground, light.elevation);
    table.finish();
}

void read_camera(TableReader& table, std::vector<CameraKey>& camera, OpenAngles& open) {
    CameraKey fixed;
    read_view(table, fixed, &open);
    double orbit = 0;
    const bool orbits = table.quantity("orbit", Quantity::angle, {}, orbit);
    if (orbits && fixed.eye) {
        table.mistake("orbit", "an orbit changes the azimuth and cannot be used with an eye");
    }
    const bool has_keys = table.find("keys") != nullptr;
    const std::vector<const Node*> keys = table.tables("keys", "[[render.camera.keys]]");
    if (has_keys && table.has_other_keys({"keys", "follow"})) {
        table.mistake(
            "keys",
            "keys must stand alone in [render.camera], or beside follow: put the other settings "
            "into each key");
    }
    if (!has_keys) {
        camera = {fixed};
        if (orbits) {
            CameraKey last = fixed;
            last.at = 1;
            last.azimuth += orbit;
            camera.push_back(last);
        }
        return;
    }
    camera.clear();
    open = {};
    for (const Node* node : keys) {
        TableReader one(*node, "a key of [render.camera]", table.reading());
        CameraKey key;
        if (!one.quantity("at", Quantity::number, between(0, 1), key.at)) {
            one.missing("at", "the fraction of the film, 0 to 1");
        }
        read_view(one, key, nullptr);
        one.finish();
        camera.push_back(key);
    }
    if (camera.empty()) {
        table.mistake("keys", "keys is empty");
        camera = {fixed};
    }
    std::stable_sort(camera.begin(), camera.end(),
                     [](const CameraKey& a, const CameraKey& b) { return a.at < b.at; });
    for (std::size_t n = 1; n < camera.size(); ++n) {
        if (camera[n].at != camera[n - 1].at) continue;
        table.mistake("keys", fmt::format("two keys are at {}", camera[n].at));
        break;
    }
}

void read_hidden(TableReader& table, const std::vector<StageSpec>& stages,
                 std::vector<std::string>& hide) {
    table.describe("hide", "a list of names, such as [\"plate\"]", "none");
    const Node* node = table.find("hide");
    if (node == nullptr) return;
    if (node->kind != Node::Kind::array) {
        table.mistake("hide", "hide must be a list of names, such as [\"plate\"]");
        return;
    }
    std::vector<std::string> known;
    const auto add = [&](const std::string& name) {
        if (std::ranges::find(known, name) == known.end()) known.push_back(name);
    };
    bool knows_all = true;  // else a machine was not read, which is told
    for (const StageSpec& stage : stages) {
        knows_all = knows_all && !stage.machine.name.empty();
        for (const ToolSpec& tool : stage.machine.tool) add(tool.name);
        for (const GripSpec& grip : stage.machine.grip) add(grip.name);
        for (const BladeSpec& blade : stage.machine.blade) add(blade.name);
    }
    for (const Node& item : node->item) {
        const std::string name = item.kind == Node::Kind::text ? item.text : "";
        const auto is_meant = [&](const std::string& part) { return is_called(part, name); };
        if (!name.empty() && (!knows_all || std::ranges::any_of(known, is_meant))) {
            hide.push_back(name);
            continue;
        }
        table.reading().mistakes.add(
            item.place,
            fmt::format(
                "hide: {} is no tool, grip or blade of any machine of the scene{}",
                name.empty() ? kind_text(item) : '"' + name + '"',
                hint_and(did_you_mean(name, known),
                         known.empty() ? "there are none" : "there are " + joined(known, ", "))));
    }
}

}  // namespace

void read_render(TableReader& table, const std::vector<StageSpec>& stages,
                 RenderSettings& settings) {
    read_size(table, settings);
    read_frame_rate(table, settings.frame_rate);
    table.whole("first_frame", 1, kLargestFirstFrame, settings.first_frame);
    const bool says_film = table.truth("film", settings.film);
    table.truth("tools", settings.tools);
    read_hidden(table, stages, settings.hide);
    table.truth("ground", settings.ground);
    table.truth("legend", settings.legend);
    table.choice<Background>(
        "background", {{"studio", Background::studio}, {"transparent", Background::transparent}},
        settings.background);
    if (settings.background == Background::transparent && says_film && settings.film) {
        table.mistake("film", "a film cannot be transparent, only stills: leave out film");
    }
    table.choice<GlProviderKind>("gl",
                                 {{"auto", GlProviderKind::automatic},
                                  {"osmesa", GlProviderKind::osmesa},
                                  {"egl", GlProviderKind::egl}},
                                 settings.gl);
    std::vector<std::pair<std::string, Up>> ups;
    for (std::size_t n = 0; n < kUpName.size(); ++n)
        ups.emplace_back(kUpName[n], static_cast<Up>(n));
    table.choice<Up>("up", ups, settings.up);
    read_passes(table, settings.passes);
    read_field_color(table, settings);
    table.quantity("field_of_view", Quantity::angle, inside(0, kPi), settings.field_of_view);
    TableReader camera(table.table("camera"), "[render.camera]", table.reading());
    read_camera(camera, settings.camera, settings.open);
    const auto looks_elsewhere = [](const CameraKey& key) { return key.target.has_value(); };
    if (camera.truth("follow", settings.follow) && settings.follow &&
        std::ranges::any_of(settings.camera, looks_elsewhere)) {
        camera.mistake("follow",
                       "follow looks at the bodies, and cannot be used with an eye or a target");
    }
    camera.finish();
    TableReader light(table.table("light"), "[render.light]", table.reading());
    read_light(light, settings.light);
    table.finish();
}

}  // namespace swage
