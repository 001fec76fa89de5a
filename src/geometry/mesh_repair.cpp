// SPDX-License-Identifier: GPL-3.0-or-later
// Repair of surfaces: from duplicates to holes. What bodies do to each other is in mesh_bodies.cpp.
#include "geometry/mesh_repair.h"

#include <algorithm>

#include "base/error.h"
#include "base/log.h"
#include "base/text.h"
#include "geometry/edges.h"
#include "geometry/mesh_bodies.h"
#include "geometry/mesh_check.h"
#include "geometry/mesh_edit.h"
#include "geometry/mesh_holes.h"
#include "geometry/mesh_repair_cgal.h"
#include "geometry/mesh_shells.h"
#include "geometry/mesh_stitch.h"

namespace swage {

namespace {

struct EdgeCount {
    std::size_t odd = 0;         // edges with an odd number of triangles
    std::size_t unbalanced = 0;  // edges not run along equally often in both directions
};

EdgeCount count_edges(const TriMesh& mesh) {
    EdgeCount count;
    for_each_edge(edge_uses(mesh.triangle, mesh.position.size()), [&](auto uses) {
        count.odd += uses.size() % 2;
        count.unbalanced += excess(uses) != 0;
    });
    return count;
}

// Normals that groups were given look out of triangles that were turned over, too.
void turn_normals(TriMesh& mesh) {
    std::vector<Vec3>& normal = mesh.smooth_normal;
    if (normal.empty()) return;
    std::vector<Vec3> out(mesh.smooth_group_count, Vec3::Zero());
    for (std::size_t t = 0; t < mesh.triangle.size(); ++t)
        for (const int g : mesh.triangle_smooth[t])
            out[g] += area_vector(mesh.position, mesh.triangle[t]);
    for (std::size_t g = 0; g < normal.size(); ++g)
        if (normal[g].dot(out[g]) < 0) normal[g] = -normal[g];
}

class Repairer {
  public:
    Repairer(const TriMesh& input, double crease_angle)
        : mesh_(input), crease_angle_(crease_angle) {}

    Repair run() {
        Repair repair = repaired();
        turn_normals(repair.mesh);
        return repair;
    }

  private:
    Repair repaired() {
        if (mesh_.triangle.empty()) fail(ExitCode::mesh, "the mesh has no triangles");
        const double size = box_of(mesh_.position).size().norm();
        const double volume = signed_volume(mesh_);
        const bool encloses =
            count_edges(mesh_).unbalanced == 0 && std::abs(volume) > 1e-12 * size * size * size;
        if (encloses) drop_copies();
        if (encloses && volume > 0) return settled();
        drop_repeated_corners();
        if (!encloses) {
            drop_duplicates();
            if (count_edges(mesh_).odd > 0) stitch();
            orient();
            if (count_edges(mesh_).odd > 0) close_holes();
        }
        if (mesh_.triangle.empty())
            fail(ExitCode::mesh,
                 "this mesh cannot be given a volume: all of it is as thin as a gap");
        if (count_edges(mesh_).unbalanced > 0) {
            wrap("its surface cannot be oriented, or more than two triangles meet at an edge");
        } else if (const auto reason = settle_bodies(mesh_, crease_angle_, account_)) {
            wrap(*reason);
        }
        if (!account_.empty()) drop_unused_positions(mesh_);
        const MeshReport report = check_mesh(mesh_);
        if (!report.bounds_a_volume())
            fail(ExitCode::mesh, "this mesh cannot be given a volume ({})", summary_line(report));
        return {std::move(mesh_), std::move(account_)};
    }

    void say(std::string sentence) { account_.push_back(std::move(sentence)); }

    // Of a mesh that bounds a volume: only where its bodies make that another one than it should be
    // is there anything to repair.
    Repair settled() {
        TriMesh input = mesh_;
        std::vector<std::string> told = account_;
        const double volume = signed_volume(input);
        drop_repeated_corners();
        if (const auto reason = settle_bodies(mesh_, crease_angle_, account_)) {
            log_warning("repair: the mesh is left as it is: {}", *reason);
            return {std::move(input), std::move(told)};
        }
        if (std::abs(signed_volume(mesh_) - volume) <= 1e-9 * volume) {
            return {std::move(input), std::move(told)};
        }
        drop_unused_positions(mesh_);
        return {std::move(mesh_), std::move(account_)};
    }

    void drop_repeated_corners() {
        std::vector<char> keep(mesh_.triangle.size(), 1);
        for (std::size_t t = 0; t < keep.size(); ++t) {
            keep[t] = !has_repeated_corner(mesh_.triangle[t]);
        }
        const auto dropped = static_cast<std::size_t>(std::count(keep.begin(), keep.end(), 0));
        if (dropped == 0) return;
        keep_triangles(mesh_, keep);
        say(fmt::format("left out {} with repeated corners",
                        counted(dropped, "triangle", "triangles")));
        if (mesh_.triangle.empty()) fail(ExitCode::mesh, "all triangles have repeated corners");
    }

    // Triangles on the same corners stand together, the first of the mesh first.
    std::vector<std::pair<Corners, int>> by_corners() const {
        std::vector<std::pair<Corners, int>> sorted;
        for (std::size_t t = 0; t < mesh_.triangle.size(); ++t) {
            Corners c = mesh_.triangle[t];
            std::sort(c.begin(), c.end());
            sorted.emplace_back(c, static_cast<int>(t));
        }
        std::sort(sorted.begin(), sorted.end());
        return sorted;
    }

    bool ascends(int t) const { return corners_ascend(mesh_.triangle[t]); }

    // Of a closed surface that was given more than once each triangle stays once.
    void drop_copies() {
        const auto sorted = by_corners();
        std::vector<char> keep(mesh_.triangle.size(), 1);
        for (std::size_t begin = 0, end; begin < sorted.size(); begin = end) {
            int facing = 0;  // more times this way than the other
            for (end = begin; end < sorted.size() && sorted[end].first == sorted[begin].first;
                 ++end)
                facing += ascends(sorted[end].second) ? 1 : -1;
            if (std::abs(facing) < 2) continue;
            bool one = false;
            for (std::size_t i = begin; i < end; ++i) {
                const int t = sorted[i].second;
                keep[t] = !one && ascends(t) == (facing > 0);
                one = one || keep[t];
            }
        }
        if (std::count(keep.begin(), keep.end(), 0) == 0) return;
        // Where that would open a shell its copies stay: two bodies share those triangles.
        const std::vector<int> shell = shells_of(mesh_);
        const std::vector<EdgeUse> all_uses = edge_uses(mesh_.triangle, mesh_.position.size());
        std::vector<char> opens(mesh_.triangle.size(), 0);
        for (bool more = true; more;) {
            more = false;
            for_each_edge(all_uses, [&](auto uses) {
                int sum = 0;
                for (const EdgeUse& use : uses)
                    if (keep[use.triangle]) sum += use.forward ? 1 : -1;
                if (sum == 0) return;
                for (const EdgeUse& use : uses) {
                    more = more || opens[shell[use.triangle]] == 0;
                    opens[shell[use.triangle]] = 1;
                }
            });
            for (std::size_t t = 0; t < keep.size(); ++t) keep[t] = keep[t] || opens[shell[t]];
        }
        const auto dropped = static_cast<std::size_t>(std::count(keep.begin(), keep.end(), 0));
        if (dropped == 0) return;
        keep_triangles(mesh_, keep);
        say(fmt::format("left out {}: closed surfaces were given more than once",
                        counted(dropped, "duplicate triangle", "duplicate triangles")));
    }

    // Of triangles on the same corners one stays; a pair facing both ways is an inner wall and
    // goes, unless that takes most of the mesh: then every face was given twice.
    void drop_duplicates() {
        const auto sorted = by_corners();
        std::vector<char> without_walls(mesh_.triangle.size(), 1),
            one_each(mesh_.triangle.size(), 1);
        std::size_t walls = 0;
        for (std::size_t begin = 0, end; begin < sorted.size(); begin = end) {
            end = begin + 1;
            while (end < sorted.size() && sorted[end].first == sorted[begin].first) ++end;
            bool both_ways = false;
            for (std::size_t i = begin + 1; i < end; ++i) {
                without_walls[sorted[i].second] = one_each[sorted[i].second] = 0;
                both_ways = both_ways || ascends(sorted[i].second) != ascends(sorted[begin].second);
            }
            if (both_ways) {
                without_walls[sorted[begin].second] = 0;
                walls += end - begin;
            }
        }
        if (std::count(one_each.begin(), one_each.end(), 0) == 0) return;
        const bool doubled = 2 * walls > mesh_.triangle.size();
        const std::vector<char>& keep = doubled ? one_each : without_walls;
        const auto dropped = static_cast<std::size_t>(std::count(keep.begin(), keep.end(), 0));
        keep_triangles(mesh_, keep);
        if (doubled || walls == 0)
            say(fmt::format("left out {}",
                            counted(dropped, "duplicate triangle", "duplicate triangles")));
        else
            say(fmt::format("left out {} of inner walls and duplicates",
                            counted(dropped, "triangle", "triangles")));
    }

    void stitch() {
        const Stitching done = stitch_borders(mesh_);
        if (done.merged == 0) return;
        say(fmt::format("stitched {} within {} of another: {} border edges became {}",
                        counted(done.merged, "vertex", "vertices"), length_text(done.gap),
                        done.odd_before, done.odd_after));
    }

    // Turns triangles so that neighbours agree, in each sheet the smaller number of them.
    void orient() {
        const std::size_t count = mesh_.triangle.size();
        struct Link {
            int from, to;
            bool agrees;
        };
        std::vector<Link> links;
        for_each_edge(edge_uses(mesh_.triangle, mesh_.position.size()), [&](auto uses) {
            if (uses.size() != 2) return;
            const bool agrees = uses[0].forward != uses[1].forward;
            links.push_back({uses[0].triangle, uses[1].triangle, agrees});
            links.push_back({uses[1].triangle, uses[0].triangle, agrees});
        });
        std::sort(links.begin(), links.end(), [](const Link& a, const Link& b) {
            return a.from != b.from ? a.from < b.from : a.to < b.to;
        });
        std::vector<std::size_t> first(count + 1, 0);
        for (const Link& link : links) ++first[link.from + 1];
        for (std::size_t t = 0; t < count; ++t) first[t + 1] += first[t];
        std::vector<signed char> turned(count, -1);
        std::size_t all_turned = 0;
        std::vector<int> sheet;
        for (std::size_t seed = 0; seed < count; ++seed) {
            if (turned[seed] >= 0) continue;
            sheet.assign(1, static_cast<int>(seed));
            turned[seed] = 0;
            std::size_t here = 0;
            for (std::size_t i = 0; i < sheet.size(); ++i) {
                here += turned[sheet[i]] == 1;
                for (std::size_t l = first[sheet[i]]; l < first[sheet[i] + 1]; ++l) {
                    signed char& other = turned[links[l].to];
                    if (other >= 0) continue;  // a sheet of one side fails the final check
                    other = links[l].agrees ? turned[sheet[i]] : 1 - turned[sheet[i]];
                    sheet.push_back(links[l].to);
                }
            }
            const bool turn_others = 2 * here > sheet.size();
            for (const int t : sheet)
                if ((turned[t] == 1) != turn_others) {
                    flip_triangle(mesh_, static_cast<std::size_t>(t));
                    ++all_turned;
                }
        }
        if (all_turned > 0)
            say(fmt::format("turned {} to agree with their neighbours",
                            counted(all_turned, "triangle", "triangles")));
    }

    void close_holes() {
        const HolesClosed done = swage::close_holes(mesh_);
        if (done.holes > 0)
            say(fmt::format("closed {}, {} edges in total, with {}, {:.2g} % of the surface",
                            counted(done.holes, "hole", "holes"), done.edges,
                            counted(done.triangles, "triangle", "triangles"), 100 * done.share));
        if (done.failed > 0)
            say(fmt::format("{} could not be closed", counted(done.failed, "hole", "holes")));
        if (done.sheets > 0)
            say(fmt::format("left out {} of {}, {:.2g} % of the surface: they enclose nothing",
                            counted(done.sheets, "open sheet", "open sheets"),
                            counted(done.sheet_triangles, "triangle", "triangles"),
                            100 * done.sheet_share));
    }

    void wrap(const std::string& reason) {
        const double diagonal = box_of(mesh_.position).size().norm();
        const double offset = diagonal / 2000;
        for (const double alpha : {diagonal / 100, diagonal / 20}) {
            log_info("repair: wrapping {} anew, openings below {} are closed",
                     counted(mesh_.triangle.size(), "triangle", "triangles"), length_text(alpha));
            TriMesh wrapped = wrap_triangles(mesh_, alpha, offset);
            const double volume = signed_volume(wrapped), area = surface_area(wrapped);
            // Twice the volume by the area is about the wall's thickness: of a bare sheet, the
            // offset to both sides.
            if (!(volume > 0) || 2 * volume / area < 4 * (2 * offset)) continue;
            const bool one_material = mesh_.material.size() == 1;
            if (one_material) {
                wrapped.material = mesh_.material;
                wrapped.material[0].texture.clear();
                wrapped.material[0].embedded_texture.reset();
                wrapped.triangle_material.assign(wrapped.triangle.size(), 0);
            }
            smooth_by_crease_angle(wrapped, crease_angle_);
            say(fmt::format(
                "wrapped the whole mesh anew, {} outside it and over openings below {}, because "
                "{}: {} became {}, the enclosed volume {} (before, with its faults: {}); texture "
                "coordinates, {}parts and vertex colours are lost",
                length_text(offset), length_text(alpha), reason,
                counted(mesh_.triangle.size(), "triangle", "triangles"), wrapped.triangle.size(),
                volume_text(volume), volume_text(signed_volume(mesh_)),
                one_material ? "" : "materials, "));
            mesh_ = std::move(wrapped);
            return;
        }
        fail(ExitCode::mesh,
             "this mesh cannot be given a volume: {}, and a wrap around it encloses only its thin "
             "sheets; close its openings or give it thickness first",
             reason);
    }

    TriMesh mesh_;
    double crease_angle_;
    std::vector<std::string> account_;
};

}  // namespace

Repair repair_mesh(const TriMesh& mesh, double crease_angle) {
    return Repairer(mesh, crease_angle).run();
}

}  // namespace swage
