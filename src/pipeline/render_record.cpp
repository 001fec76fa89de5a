// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/render_record.h"

#include <algorithm>

#include "base/error.h"

namespace swage {

namespace {

Json vector_json(const Vec3& v) { return {v.x(), v.y(), v.z()}; }

Json camera_key_json(const CameraKey& key) {
    Json json = {
        {"at", key.at}, {"azimuth", key.azimuth}, {"elevation", key.elevation}, {"zoom", key.zoom}};
    if (key.eye) json["eye"] = vector_json(*key.eye);
    if (key.target) json["target"] = vector_json(*key.target);
    return json;
}

Vec3 vector_of(const Json& json) {
    return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

CameraKey camera_key_of(const Json& json) {
    CameraKey key;
    key.at = json.at("at").get<double>();
    key.azimuth = json.at("azimuth").get<double>();
    key.elevation = json.at("elevation").get<double>();
    key.zoom = json.at("zoom").get<double>();
    if (json.contains("eye")) key.eye = vector_of(json.at("eye"));
    if (json.contains("target")) key.target = vector_of(json.at("target"));
    return key;
}

}  // namespace

Json passes_json(const std::vector<PicturePass>& passes) {
    Json names = Json::array();
    for (const PicturePass pass : passes) names.push_back(kPassName[std::size_t(pass)]);
    return names;
}

std::optional<PicturePass> pass_named(const std::string& name) {
    const auto at = std::find(kPassName.begin(), kPassName.end(), name);
    if (at == kPassName.end()) return std::nullopt;
    return static_cast<PicturePass>(at - kPassName.begin());
}

Json render_json(const RenderSettings& settings) {
    Json camera = Json::array();
    for (const CameraKey& key : settings.camera) camera.push_back(camera_key_json(key));
    const FrameRate& rate = settings.frame_rate;
    Json json = {
        {"size", {settings.width, settings.height}},
        {"field_of_view", settings.field_of_view},
        {"camera", camera},
        {"frames_per_second", rate.is_whole() ? Json(rate.frames) : Json(rate.value())},
        {"film", settings.film},
        {"tools", settings.tools},
        {"ground", settings.ground},
        {"legend", settings.legend},
        {"background", kBackgroundName[static_cast<std::size_t>(settings.background)]},
        {"light", {{"azimuth", settings.light.azimuth}, {"elevation", settings.light.elevation}}},
        {"gl", kGlName[static_cast<std::size_t>(settings.gl)]},
        {"up", kUpName[static_cast<std::size_t>(settings.up)]}};
    if (!rate.is_whole()) json["frame_rate"] = {rate.frames, rate.seconds};
    if (settings.follow) json["camera_follow"] = true;
    if (settings.first_frame != 1) json["first_frame"] = settings.first_frame;
    if (settings.open.any()) {
        Json& open = json["camera_auto"] = Json::array();
        if (settings.open.azimuth) open.push_back("azimuth");
        if (settings.open.elevation) open.push_back("elevation");
    }
    if (!settings.hide.empty()) json["hide"] = settings.hide;
    if (!settings.passes.empty()) json["passes"] = passes_json(settings.passes);
    if (settings.color) json["color"] = words_of(*settings.color).name;
    if (settings.color_range) json["color_range"] = *settings.color_range;
    return json;
}

Up up_named(const std::string& name) {
    const auto at = std::find(kUpName.begin(), kUpName.end(), name);
    return at != kUpName.end() ? static_cast<Up>(at - kUpName.begin()) : Up::automatic;
}

GlProviderKind gl_named(const std::string& name) {
    const auto at = std::find(kGlName.begin(), kGlName.end(), name);
    return at != kGlName.end() ? static_cast<GlProviderKind>(at - kGlName.begin())
                               : GlProviderKind::automatic;
}

Background background_named(const std::string& name) {
    return name == kBackgroundName[1] ? Background::transparent : Background::studio;
}

RenderSettings render_settings_of(const Json& record) {
    RenderSettings settings;
    try {
        const Json& json = record.at("render");
        settings.width = json.at("size").at(0).get<int>();
        settings.height = json.at("size").at(1).get<int>();
        settings.field_of_view = json.at("field_of_view").get<double>();
        if (settings.width < 1 || settings.height < 1) {
            fail(ExitCode::output, "run.json: size is none of pictures");
        }
        if (!(settings.field_of_view > 0 && settings.field_of_view < kPi)) {
            fail(ExitCode::output, "run.json: field_of_view is no angle of a camera");
        }
        const auto rate = frame_rate_of(json.at("frames_per_second").get<double>());
        if (!rate) fail(ExitCode::output, "run.json: frames_per_second is no rate of films");
        settings.frame_rate = *rate;
        settings.first_frame = json.value("first_frame", 1);
        settings.film = json.at("film").get<bool>();
        settings.tools = json.at("tools").get<bool>();
        settings.hide = json.value("hide", std::vector<std::string>());
        settings.ground = json.at("ground").get<bool>();
        settings.up = up_named(json.at("up").get<std::string>());
        settings.gl = gl_named(json.at("gl").get<std::string>());
        settings.color = skin_field_named(json.value("color", ""));
        if (json.contains("color_range")) {
            settings.color_range = json.at("color_range").get<std::array<double, 2>>();
        }
        for (const Json& name : json.value("passes", Json::array())) {
            if (const auto pass = pass_named(name.get<std::string>())) {
                settings.passes.push_back(*pass);
            }
        }
        settings.legend = json.at("legend").get<bool>();
        settings.background = background_named(json.at("background").get<std::string>());
        settings.light.azimuth = json.at("light").at("azimuth").get<double>();
        settings.light.elevation = json.at("light").at("elevation").get<double>();
        settings.camera.clear();
        for (const Json& key : json.at("camera")) settings.camera.push_back(camera_key_of(key));
        settings.follow = json.value("camera_follow", false);
        for (const Json& angle : json.value("camera_auto", Json::array())) {
            settings.open.azimuth |= angle == "azimuth";
            settings.open.elevation |= angle == "elevation";
        }
    } catch (const Json::exception&) {
        fail(ExitCode::output,
             "run.json does not say how the run was drawn; run it again with --fresh");
    }
    return settings;
}

}  // namespace swage
