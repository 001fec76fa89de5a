// SPDX-License-Identifier: GPL-3.0-or-later
#include "skin/skin_fields.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/principal_axes.h"
#include "matter/broken_cells.h"
#include "matter/mixed_place.h"

namespace swage {

namespace {

constexpr std::size_t kPerChunk = 256;
// Squared spread of the cells along an axis, in cells, below which no line is drawn along it: of a
// second layer that is filled by less than a twelfth.
constexpr double kLeastSpread = 0.02;
constexpr double kOfSprings = 0.25;  // Poisson's ratio

// Stress, plastic strain, and where it yields.
constexpr int kParts = 8, kYieldsAt = 7;
using Parts = Eigen::Matrix<double, kParts, 1>;

Parts parts_of(const StressSample& s) {
    Parts p;
    for (int i = 0; i < 6; ++i) p[i] = s.stress[static_cast<std::size_t>(i)];
    p[6] = s.plastic_strain;
    p[kYieldsAt] = std::isfinite(s.yields_at) ? s.yields_at : 0;
    return p;
}

// A linear field about a cell's centroid.
struct Line {
    Parts at;
    Eigen::Matrix<double, kParts, 3> slope;  // by the place in cells
    double least_yields_at;                  // of the cells that it is drawn through

    // `way`: from the centroid. What matter bears before it flows divides its stress, and a line
    // through a jump of that goes below 0 beside it.
    Parts after(const Vec3& way) const {
        Parts parts = at + slope * way;
        parts[kYieldsAt] = std::max(parts[kYieldsAt], least_yields_at);
        return parts;
    }
};

// What a particle is told of one material.
struct Told {
    std::uint8_t material;
    bool sound;
    double volume;
    Parts sum;
};

// How far the matter of a vertex may be strained.
struct Limit {
    double breaks_at, poisson_ratio;
    bool has_broken;
};

class Fitter {
  public:
    Fitter(const Mount& mount, const Aggregate& matter, const std::vector<StressSample>& samples)
        : mount_(mount), matter_(matter), sample_(samples), is_damaged_(any_damaged(matter)) {
        first_.assign(matter.cell_fill.size() + 1, 0);
        for (const StressSample& s : samples) ++first_[static_cast<std::size_t>(s.cell) + 1];
        for (std::size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
        site_.reserve(samples.size());
        for (const StressSample& s : samples) site_.push_back(matter.lattice.cell_site(s.cell));
        breaks_at_.assign(matter.material_count(), std::numeric_limits<double>::infinity());
        for (const StressSample& s : samples) breaks_at_[s.material] = s.breaks_at;
        draw_lines();
        tell_particles();
    }

    Parts at_vertex(const Mount::CellGroup& group, const CornerGroups& groups, int n) const {
        const int v = mount_.vertex[n];
        const Vec3& local = mount_.carrier[n].local;
        const CornerMask followed = followed_corners(groups, mount_.side[v], local);
        const std::uint8_t material = material_at(group.cell, local);
        const std::array<double, 8> weight = trilinear_weights(local);
        // The vertex's own material where it is sound, then whatever there is of it, then of
        // others.
        for (const bool own : {true, false}) {
            for (const bool sound : {true, false}) {
                Parts sum = Parts::Zero();
                double total = 0;
                for (int c = 0; c < 8; ++c) {
                    if (!(followed >> c & 1)) continue;
                    const Told* const told = told_at(group.corner[c], material, own, sound);
                    if (told == nullptr) continue;
                    const double share = std::max(weight[c], 0.0) + kLeastShare;
                    sum += share / told->volume * told->sum;
                    total += share;
                }
                if (total > 0) return sum / total;
            }
        }
        return Parts::Zero();
    }

    Limit limit_at(const Mount::CellGroup& group, int n) const {
        const std::uint8_t material = material_at(group.cell, mount_.carrier[n].local);
        const bool springs = matter_.material.mechanics == Mechanics::springs;
        const bool has_broken =
            is_damaged_ &&
            cell_has_broken(matter_, group.cell, matter_.lattice.cell_row(group.cell));
        return {breaks_at_[material],
                springs ? kOfSprings : matter_.material_at(material).poisson_ratio, has_broken};
    }

  private:
    // Not zero anywhere: a place on a face of which nothing is known still has someone to ask.
    static constexpr double kLeastShare = 1e-9;

    const Told* told_at(int slot, std::uint8_t material, bool own, bool sound) const {
        for (const Told& told : told_[static_cast<std::size_t>(slot)]) {
            if (told.sound == sound && (told.material == material) == own) return &told;
        }
        return nullptr;
    }

    // `local`: 0 to 1.
    std::uint8_t material_at(CellId cell, const Vec3& local) const {
        const MixedCell* const two = matter_.mixed_at(cell);
        if (two == nullptr) return static_cast<std::uint8_t>(matter_.material_number(cell));
        return static_cast<std::uint8_t>(swage::material_at(*two, local - Vec3::Constant(0.5)));
    }

    void draw_lines() {
        line_.resize(sample_.size());
        parallel_each(sample_.size(), kPerChunk, [&](std::size_t n) { line_[n] = drawn(n); });
    }

    Line drawn(std::size_t own) const {
        const StressSample& s = sample_[own];
        const Parts parts = parts_of(s);
        Line line{parts, Eigen::Matrix<double, kParts, 3>::Zero(), parts[kYieldsAt]};
        if (!s.sound) return line;
        double volume = 0;
        Vec3 place = Vec3::Zero();
        Parts mean = Parts::Zero();
        Mat3 spread = Mat3::Zero();
        Eigen::Matrix<double, kParts, 3> rise = Eigen::Matrix<double, kParts, 3>::Zero();
        // Sound cells have all their corners, so that neighbours share some.
        const auto each = [&](const auto& act) {
            matter_.lattice.for_each_cell_around(site_[own], [&](CellId cell, const Vec3i&) {
                for (int n = first_[cell]; n < first_[cell + 1]; ++n) {
                    const StressSample& other = sample_[n];
                    if (other.sound && other.material == s.material) act(other);
                }
            });
        };
        each([&](const StressSample& other) {
            const Parts theirs = parts_of(other);
            volume += other.volume;
            place += other.volume * other.place;
            mean += other.volume * theirs;
            line.least_yields_at = std::min(line.least_yields_at, theirs[kYieldsAt]);
        });
        if (!(volume > 0)) return line;
        place /= volume;
        mean /= volume;
        each([&](const StressSample& other) {
            const Vec3 way = other.place - place;
            spread += other.volume / volume * way * way.transpose();
            rise += other.volume / volume * (parts_of(other) - mean) * way.transpose();
        });
        const PrincipalAxes axes = principal_axes(spread);
        for (int i = 0; i < 3; ++i) {
            if (axes.value[i] < kLeastSpread) continue;
            const Vec3 axis = axes.axis.col(i);
            line.slope += rise * axis / axes.value[i] * axis.transpose();
        }
        const double full = std::min(1.0, s.volume);
        line.at = full * line.at + (1 - full) * (mean + line.slope * (s.place - place));
        return line;
    }

    void tell_particles() {
        told_.resize(mount_.particle.size());
        std::vector<int> slot(matter_.particle_count(), -1);
        for (std::size_t p = 0; p < mount_.particle.size(); ++p) {
            slot[mount_.particle[p]] = static_cast<int>(p);
        }
        for (std::size_t n = 0; n < sample_.size(); ++n) {
            const StressSample& s = sample_[n];
            const std::array<ParticleId, 8> corner = matter_.lattice.cell_corners(s.cell);
            for (int c = 0; c < 8; ++c) {
                if (!(s.corners >> c & 1) || slot[corner[c]] < 0 || !(s.volume > 0)) continue;
                const Vec3 place = (site_[n] + corner_step(c)).cast<double>();
                tell(told_[slot[corner[c]]], s, s.volume * line_[n].after(place - s.place));
            }
        }
    }
    static void tell(std::vector<Told>& all, const StressSample& s, const Parts& sum) {
        for (Told& told : all) {
            if (told.material != s.material || told.sound != s.sound) continue;
            told.volume += s.volume;
            told.sum += sum;
            return;
        }
        all.push_back({s.material, s.sound, s.volume, sum});
    }

    const Mount& mount_;
    const Aggregate& matter_;
    const std::vector<StressSample>& sample_;
    const bool is_damaged_;
    std::vector<double> breaks_at_;  // by material
    std::vector<int> first_;         // of a cell's samples; the end
    std::vector<Vec3i> site_;        // of each sample's cell
    std::vector<Line> line_;
    std::vector<std::vector<Told>> told_;  // to each of the mount's particles
};

// Of a vertex, of its stress and what it has flowed.
class Numbers {
  public:
    Numbers(const Parts& parts, const Limit& limit) : parts_(parts), limit_(limit) {
        const double mean = (parts[0] + parts[1] + parts[2]) / 3;
        Parts s = parts;
        for (int i = 0; i < 3; ++i) s[i] -= mean;
        double squares = 0;
        for (int i = 0; i < 6; ++i) squares += (i < 3 ? 1 : 2) * s[i] * s[i];
        equivalent_ = std::sqrt(1.5 * squares);
        mean_ = mean;
        const double most = parts[kYieldsAt];
        if (most > 0 && equivalent_ > most) {
            share_ = most / equivalent_;
            equivalent_ = most;
        }
    }
    double of(SkinField field) const {
        switch (field) {
            case SkinField::yield_use:
                return parts_[kYieldsAt] > 0 ? equivalent_ / parts_[kYieldsAt] : 0;
            case SkinField::strength_use:
                return strength_use();
            case SkinField::plastic_strain:
                return std::max(0.0, parts_[6]);
            case SkinField::stress:
                return equivalent_;
            case SkinField::pressure:
                return mean_ == 0 ? 0 : -mean_;
            case SkinField::principal_stress:
                break;
        }
        return largest_principal();
    }

  private:
    double largest_principal() const {
        Mat3 s;
        s << parts_[0], parts_[3], parts_[5], parts_[3], parts_[1], parts_[4], parts_[5], parts_[4],
            parts_[2];
        s = mean_ * Mat3::Identity() + share_ * (s - mean_ * Mat3::Identity());
        return principal_values(s)[2];
    }
    // By Hooke's law, as what breaks does so at small strains.
    double strength_use() const {
        if (limit_.has_broken) return 1;
        if (!std::isfinite(limit_.breaks_at)) return 0;
        const double strain =
            (1 + limit_.poisson_ratio) * largest_principal() - 3 * limit_.poisson_ratio * mean_;
        return std::clamp(strain / limit_.breaks_at, 0.0, 1.0);
    }

    const Parts parts_;
    const Limit limit_;
    double mean_ = 0, equivalent_ = 0, share_ = 1;
};

}  // namespace

std::vector<CellId> cells_under(const Mount& mount, const Aggregate& matter) {
    // What a vertex is told comes from the cells at its corners, and theirs from those around.
    std::vector<char> asked(matter.cell_fill.size(), 0);
    for (const Mount::CellGroup& group : mount.group) asked[group.cell] = 2;
    for (char ring = 2; ring > 0; --ring) {
        std::vector<char> more = asked;
        for (std::size_t c = 0; c < asked.size(); ++c) {
            if (asked[c] != ring) continue;
            const Vec3i site = matter.lattice.cell_site(static_cast<CellId>(c));
            matter.lattice.for_each_cell_around(site, [&](CellId near, const Vec3i&) {
                if (more[near] == 0) more[near] = static_cast<char>(ring == 2 ? 1 : 3);
            });
        }
        asked = std::move(more);
    }
    std::vector<CellId> cells;
    for (std::size_t c = 0; c < asked.size(); ++c) {
        if (asked[c] != 0) cells.push_back(static_cast<CellId>(c));
    }
    return cells;
}

SkinFieldValues skin_fields(const Mount& mount, const Aggregate& matter,
                            const std::vector<StressSample>& samples,
                            const std::vector<SkinField>& fields) {
    SkinFieldValues values(fields.size(), std::vector<float>(mount.reference.size(), 0.0f));
    const Fitter fitter(mount, matter, samples);
    parallel_each(mount.group.size(), kPerChunk, [&](std::size_t g) {
        const Mount::CellGroup& group = mount.group[g];
        std::array<ParticleId, 8> corner;
        for (int c = 0; c < 8; ++c) corner[c] = mount.particle[group.corner[c]];
        const CornerGroups groups = corner_groups(matter, corner);
        for (int n = group.first; n < group.first + group.count; ++n) {
            const Numbers of(fitter.at_vertex(group, groups, n), fitter.limit_at(group, n));
            for (std::size_t f = 0; f < fields.size(); ++f) {
                values[f][mount.vertex[n]] = static_cast<float>(of.of(fields[f]));
            }
        }
    });
    return values;
}

}  // namespace swage
