// SPDX-License-Identifier: GPL-3.0-or-later
// Where the maps of the shadows stand: each about what is seen in one range of depth, and no larger
// than that and what throws shadows on it. Mathematics only.
// After A. Lauritzen, M. Salvi and A. Lefohn, "Sample Distribution Shadow Maps", I3D 2011: the
// depths that are really seen tell how the view is parted.
#pragma once

#include <array>
#include <vector>

#include "geometry/box.h"
#include "render/glm_bridge.h"

namespace swage {

inline constexpr int kShadowMapSide = 2048, kMostShadowMaps = 3;
inline constexpr double kLampSize = 0.12;  // tangent of the key lamp's half angle: soft shadows

struct ShadowMap {
    glm::dmat4 map_from_stage = glm::dmat4(0);  // to 0..1, for one without shadows all to 0
    double side = 0, depth = 0;                 // [stage]; 0: no shadow falls there
    Box lit;                                    // the same, along the light's axes [stage]
};

// Map i holds depths of nearest * exp(i / per_log) to nearest * exp((i + 1) / per_log) before the
// eye, and of its neighbours' as much as kSeam of that.
struct ShadowMaps {
    std::vector<ShadowMap> map;
    double nearest = 1, per_log = 1;
};
inline constexpr double kSeam = 0.1;

// Fits them to points that are seen.
class ShadowFit {
  public:
    // Boxes of what casts shadows, in the stage; the light's third axis points towards the lamp.
    ShadowFit(const Mat3& stage_from_light, const std::vector<Box>& casting);

    // A point along the light's axes, at that depth before the eye.
    void see(const Vec3& point, double depth);
    ShadowMaps maps() const;

  private:
    ShadowMap fitted(const Box& seen) const;

    Mat3 stage_from_light_;
    std::vector<Box> casting_;  // along the light's axes
    static constexpr int kBinsAnOctave = 8, kLeastOctave = -24, kMostOctave = 16;
    std::array<Box, kBinsAnOctave*(kMostOctave - kLeastOctave)> bin_;  // of depth
};

// The box along other axes.
Box turned_box(const Box& box, const Mat3& turn);

}  // namespace swage
