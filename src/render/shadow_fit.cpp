// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/shadow_fit.h"

#include <algorithm>
#include <cmath>

#include "render/camera.h"

namespace swage {

namespace {

// More are taken as one: each point that is seen asks all of them.
constexpr std::size_t kMostCasting = 16;
// A map that holds more of depth than this is parted [octaves]: its nearest points would have
// fewer of its texels than pixels.
constexpr double kMostOctaves = 2.25;
// Sides of maps go in steps, and their corners in parts of a side, so that what stands still has
// the same texels in the next still where not much more or less is seen.
constexpr double kStepsAnOctave = 8, kPartsOfSide = 64;
constexpr double kTexels = 2;  // kept free at the rim

// How far to the side of a box its half shadow reaches on what lies at that height.
double half_shadow(const Box& casting, double height) {
    return kLampSize * std::max(casting.high.z() - height, 0.0);
}

bool within(const Box& box, const Vec3& point, double room) {
    return point.x() >= box.low.x() - room && point.x() <= box.high.x() + room &&
           point.y() >= box.low.y() - room && point.y() <= box.high.y() + room;
}

}  // namespace

Box turned_box(const Box& box, const Mat3& turn) {
    Box turned;
    if (box.empty()) return turned;
    for (int c = 0; c < 8; ++c) turned.grow(turn * box.corner(c));
    return turned;
}

ShadowFit::ShadowFit(const Mat3& stage_from_light, const std::vector<Box>& casting)
    : stage_from_light_(stage_from_light) {
    for (const Box& box : casting) {
        const Box lit = turned_box(box, stage_from_light.transpose());
        if (lit.empty()) continue;
        if (casting.size() > kMostCasting && !casting_.empty()) {
            casting_.front().grow(lit);
        } else {
            casting_.push_back(lit);
        }
    }
}

void ShadowFit::see(const Vec3& point, double depth) {
    for (const Box& box : casting_) {
        if (point.z() > box.high.z() || !within(box, point, half_shadow(box, point.z()))) continue;
        const double octave = std::log2(depth) - kLeastOctave;
        const int last = static_cast<int>(bin_.size()) - 1;
        const int bin = std::clamp(static_cast<int>(octave * kBinsAnOctave), 0, last);
        bin_[static_cast<std::size_t>(bin)].grow(point);
        return;
    }
}

ShadowMaps ShadowFit::maps() const {
    const auto is_seen = [](const Box& bin) { return !bin.empty(); };
    const auto first = std::find_if(bin_.begin(), bin_.end(), is_seen);
    if (first == bin_.end()) return {};
    const auto last = std::find_if(bin_.rbegin(), bin_.rend(), is_seen).base();
    const double start = static_cast<double>(first - bin_.begin());
    const double bins = static_cast<double>(last - first);
    const int count = std::clamp(static_cast<int>(std::ceil(bins / kBinsAnOctave / kMostOctaves)),
                                 1, kMostShadowMaps);
    ShadowMaps maps;
    maps.nearest = std::exp2(start / kBinsAnOctave + kLeastOctave);
    maps.per_log = count * kBinsAnOctave / (bins * std::log(2.0));
    for (int i = 0; i < count; ++i) {
        const auto from = first + static_cast<long>(std::max(0.0, (i - kSeam) * bins / count));
        const auto to =
            first + static_cast<long>(std::min(bins, std::ceil((i + 1 + kSeam) * bins / count)));
        Box seen;
        std::for_each(from, to, [&](const Box& bin) { seen.grow(bin); });
        maps.map.push_back(seen.empty() ? ShadowMap() : fitted(seen));
    }
    return maps;
}

ShadowMap ShadowFit::fitted(const Box& seen) const {
    Box above;  // what casts shadows there
    for (const Box& box : casting_) {
        Box reach = box.widened(half_shadow(box, seen.low.z()));
        reach.low.z() = seen.low.z();
        if (reach.overlaps(seen)) above.grow(box);
    }
    if (above.empty()) return {};
    // Around what is seen, as far as what hides the lamp from it may stand aside; but a map is not
    // spent on what hangs far above a small part of the view.
    const double across = std::max(seen.size().x(), seen.size().y());
    const double room = std::min(half_shadow(above, seen.low.z()), 0.5 * across);
    Box held = seen.widened(room);
    for (int i = 0; i < 2; ++i) {
        const double low = std::max(held.low[i], above.low[i]);
        const double high = std::min(held.high[i], above.high[i]);
        if (low < high) held.low[i] = low, held.high[i] = high;
    }
    const double least = std::max(held.size().x(), held.size().y());
    const double needed =
        std::max(least, 1e-6) * (1 + 1 / kPartsOfSide + 2 * kTexels / kShadowMapSide);
    ShadowMap map;
    map.side = std::exp2(std::ceil(std::log2(needed) * kStepsAnOctave) / kStepsAnOctave);
    const double part = map.side / kPartsOfSide, rim = 4 * map.side / kShadowMapSide;
    map.lit.low.z() = std::min(seen.low.z(), above.high.z()) - rim;
    map.lit.high.z() = above.high.z() + rim;
    map.depth = map.lit.high.z() - map.lit.low.z();
    for (int i = 0; i < 2; ++i) {
        const double low = held.center()[i] - 0.5 * (map.side - part);
        map.lit.low[i] = std::floor(low / part) * part;
        map.lit.high[i] = map.lit.low[i] + map.side;
    }
    const Box& lit = map.lit;
    const glm::dmat4 clip = glm::ortho(lit.low.x(), lit.high.x(), lit.low.y(), lit.high.y(),
                                       -lit.high.z(), -lit.low.z());
    // OpenGL's cube of -1 to 1 becomes 0 to 1, as textures are addressed.
    const glm::dmat4 half =
        glm::scale(glm::translate(glm::dmat4(1), glm::dvec3(0.5)), glm::dvec3(0.5));
    map.map_from_stage = half * clip * view_from_world({Vec3::Zero(), stage_from_light_});
    return map;
}

}  // namespace swage
