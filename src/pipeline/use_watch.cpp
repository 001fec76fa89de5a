// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/use_watch.h"

#include <algorithm>

#include "base/text.h"
#include "geometry/mesh_check.h"

namespace swage {

namespace {

Json peak_json(const Used& peak, const Json& frame) {
    Json json = {{"share", peak.share}, {"place_m", nullptr}, {"frame", nullptr}};
    if (!(peak.share > 0)) return json;
    json["place_m"] = {peak.place.x(), peak.place.y(), peak.place.z()};
    json["frame"] = frame;
    return json;
}

std::string peak_text(const Json& peak) {
    const Json& place = peak.at("place_m");
    if (!place.is_array()) return {};
    const auto at = [&](int axis) {
        return length_text(place.at(static_cast<std::size_t>(axis)).get<double>());
    };
    return fmt::format(" (frame {}, at {}, {}, {})", peak.at("frame").get<int>(), at(0), at(1),
                       at(2));
}

// Less than what it stands for is not told as that, and what is next to nothing not to its digits.
std::string percent(double share) {
    constexpr double kNextToNothing = 1e-4;
    if (share > 0 && share < kNextToNothing) return "less than 0.01 %";
    const double shown = share < 1 ? std::min(share, 0.9994) : share;
    return fmt::format("{:.3g} %", 100 * shown);
}

}  // namespace

UseWatch::UseWatch(const std::vector<WorkPiece>& bodies) {
    for (const WorkPiece& body : bodies) body_.push_back({StrengthUse(body.matter), {}, {}});
}

void UseWatch::look(int frame, const std::vector<WorkPiece>& bodies) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        OfBody& of = body_[b];
        const StrengthUse::Most most =
            of.use.beyond(bodies[b].matter, of.yield.share, of.strength.share);
        if (most.yield.share > 0) of.yield = {most.yield, frame};
        if (most.strength.share > 0) of.strength = {most.strength, frame};
    }
}

Json UseWatch::json(const std::vector<WorkPiece>& bodies) const {
    Json json = Json::object();
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const OfBody& of = body_[b];
        Json one = Json::object();
        if (of.use.may_flow()) {
            one["yield"] = peak_json(of.yield, of.yield.frame);
            const Used flowed = most_flowed(bodies[b].matter);
            one["plastic_strain"] = {{"most", flowed.share}, {"place_m", nullptr}};
            if (flowed.share > 0) {
                one["plastic_strain"]["place_m"] = {flowed.place.x(), flowed.place.y(),
                                                    flowed.place.z()};
            }
        }
        if (of.use.has_strength()) one["strength"] = peak_json(of.strength, of.strength.frame);
        if (!one.empty()) json[bodies[b].name] = one;
    }
    return json;
}

std::vector<std::string> use_texts(const Json& stage) {
    std::vector<std::string> texts;
    const Json& use = stage.value("use", Json::object());
    for (const auto& [name, of] : use.items()) {
        std::vector<std::string> parts;
        if (of.contains("yield")) {
            const double share = of.at("yield").at("share");
            const double flowed = of.at("plastic_strain").at("most");
            std::string text =
                fmt::format("{} of its yield stress{}", percent(share), peak_text(of.at("yield")));
            if (flowed > 0) {
                text += fmt::format(", plastic strain of up to {:.3g}", flowed);
            } else if (share >= 1) {
                text += ", at its surface; no cell flows yet";
            }
            parts.push_back(std::move(text));
        }
        if (of.contains("strength")) {
            const double share = of.at("strength").at("share");
            parts.push_back(fmt::format("{} of its strength{}{}", percent(share),
                                        share >= 1 ? ": it broke" : "",
                                        peak_text(of.at("strength"))));
        }
        const std::string who = use.size() > 1 ? ", " + name : "";
        texts.push_back(fmt::format("{}{}: used {}", stage.at("name").get<std::string>(), who,
                                    joined(parts, "; ")));
    }
    return texts;
}

}  // namespace swage
