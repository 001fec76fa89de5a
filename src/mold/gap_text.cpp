// SPDX-License-Identifier: GPL-3.0-or-later
#include "mold/gap_text.h"

#include <fmt/format.h>

#include <cmath>

#include "base/text.h"
#include "geometry/mesh_check.h"
#include "mold/caps.h"
#include "mold/prepare.h"

namespace swage {

std::string about(double length, int digits) {
    return length_text(std::stod(fmt::format("{:.{}g}", length, digits)));
}

std::string at_most(double length) {
    const std::string all = fmt::format("{:.9e}", length);
    return length_text(std::stod(all.substr(0, all.find('.') + 2) + all.substr(all.find('e'))));
}

std::string gap_text(const std::vector<FilledGap>& gaps, double spacing) {
    const FilledGap& largest = gaps[0];
    const auto at = [&](int axis) {
        const double place = largest.place[axis];
        return length_text(std::abs(place) > 1e-6 * spacing ? place : 0);
    };
    const std::string what =
        largest.width > 0
            ? fmt::format(
                  "a gap in the mesh of about {} is too narrow for cells of {}, which hold "
                  "its sides",
                  about(largest.width, 2), length_text(spacing))
            : fmt::format("the sides of a gap in the mesh touch, and cells of {} hold them",
                          length_text(spacing));
    return fmt::format(
        "{} together over {} about [{}, {}, {}] of the mesh{}{}", what, area_text(largest.area),
        at(0), at(1), at(2),
        gaps.size() > 1 ? fmt::format(", as they do at {}",
                                      counted(gaps.size() - 1, "other place", "other places"))
                        : "",
        largest.spacing > 0
            ? fmt::format("; spacing = \"{}\" keeps it open", at_most(largest.spacing))
            : "");
}

std::string filled_gap_text(const TriMesh& mesh, const MoldSettings& settings) {
    if (settings.kind == MoldKind::block) return "";
    const HoleCaps caps = caps_over_holes(mesh);
    if (!caps.apex.empty()) return filled_gap_text(with_caps(mesh, caps), settings);
    const MoldFrame frame = frame_over(surface_box(mesh), spacing_for(mesh, settings));
    std::vector<CellLayer> layers = share_cells(mesh, frame);
    drop_slivers(layers);
    const std::vector<FilledGap> gaps = filled_gaps(mesh, layers, frame);
    return gaps.empty() ? "" : gap_text(gaps, frame.spacing);
}

}  // namespace swage
