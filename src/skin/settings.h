// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>

#include "geometry/crease_angle.h"

namespace swage {

enum class SkinKind {
    mount,     // trilinear weights with half frames: smooth, second order (the default)
    frame4,    // the paper's frame of four particles (S2.11)
    boundary,  // drawn round voxels over the particles, anew once they break (S1.12, S1.13)
};

// Of a mesh that is divided, over a cell's: by default, and at the least and most.
inline constexpr double kLongestSkinEdge = 1.5, kLeastSkinEdge = 0.1, kMostSkinEdge = 10;

// More would turn places inside out (skin/warp.cpp).
inline constexpr double kMostRoughness = 0.28;

struct SkinSettings {
    SkinKind kind = SkinKind::mount;
    // To which a mesh is divided before it is mounted, so that it can follow the matter, in
    // spacings; none: it keeps its own edges.
    std::optional<double> longest_edge = kLongestSkinEdge;
    // Beyond which edges are sharp where the file does not say [rad].
    double crease_angle = kCreaseAngle;
    // How far off the planes half-way between particles faces lie where matter broke by load, in
    // spacings; 0: on them.
    double roughness = 0.25;
};

}  // namespace swage
