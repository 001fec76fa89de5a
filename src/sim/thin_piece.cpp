// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/thin_piece.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <utility>

#include "matter/open_faces.h"
#include "matter/particle_site.h"

namespace swage {

namespace {

// Half the width of the boxes about a corner that its particles are sought in [cells]: of a layer
// so wide that particles that go up and down by turns do not tilt it.
constexpr std::array<double, 3> kReach{0.5, 1.5, 2.5};
constexpr double kLayerReach = 2;
constexpr double kFolded = 0.3;  // of a layer's area, pressed together by less than that
constexpr double kFlat = 0.1;    // of their spread, across which particles lie in a plane, or a row

}  // namespace

std::vector<std::vector<ParticleId>> thin_pieces(const Aggregate& matter) {
    if (matter.breaks()) return {};
    const std::vector<char> whole = whole_cells(matter);
    if (std::find(whole.begin(), whole.end(), 0) == whole.end()) return {};
    const Pieces pieces = find_pieces(matter);
    std::vector<char> is_thin(std::size_t(pieces.count), 1);
    for (const CellRun& run : matter.lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            if (whole[std::size_t(run.first + n)]) {
                is_thin[std::size_t(pieces.particle_piece[std::size_t(run.corner(n, 0))])] = 0;
            }
        }
    }
    std::vector<std::vector<ParticleId>> all(is_thin.size());
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        const auto piece = std::size_t(pieces.particle_piece[p]);
        if (is_thin[piece]) all[piece].push_back(static_cast<ParticleId>(p));
    }
    std::erase_if(all, [](const std::vector<ParticleId>& one) { return one.empty(); });
    return all;
}

std::unique_ptr<ThinPiece> ThinPiece::find(const Aggregate& of, const RestSurface& molded,
                                           const ThinNear& near,
                                           std::vector<ParticleId> particles) {
    std::unique_ptr<ThinPiece> piece(new ThinPiece(of, std::move(particles)));
    for (std::size_t n = 0; n < piece->particle_.size(); ++n) {
        piece->by_site_.emplace_back(key_of(lattice_site(of, piece->particle_[n])), int(n));
    }
    std::sort(piece->by_site_.begin(), piece->by_site_.end());
    for (piece->axis_ = 2; piece->axis_ >= 0 && !piece->find_layer();) --piece->axis_;
    if (!piece->make_cells(molded)) return nullptr;
    for (std::size_t c = 0; c < piece->matter_.particle_count(); ++c) {
        if (!piece->add_corner(c)) return nullptr;
    }
    std::vector<Vec3i> sites;
    for (std::size_t n = 0; n < piece->particle_.size(); ++n) sites.push_back(piece->site_of(n));
    const ThinEnds ends(of, molded, near, sites,
                        [&](const Vec3i& at) { return piece->number_at(at); });
    piece->find_ends(ends);
    piece->add_molded(ends, near.point.around(sites, -1, 0));
    piece->molded_ = std::make_shared<const RestSurface>(piece->matter_, false);
    piece->add_new(ends, molded);
    if (piece->matter_.surface.size() == 0) return nullptr;  // only corners that matter shares
    piece->follow();
    return piece;
}

int ThinPiece::number_at(const Vec3i& site) const {
    const std::uint64_t key = key_of(site);
    const auto at = std::lower_bound(by_site_.begin(), by_site_.end(), std::pair{key, 0});
    return at != by_site_.end() && at->first == key ? at->second : -1;
}

int ThinPiece::number_of(ParticleId particle) const {
    const auto at = std::lower_bound(particle_.begin(), particle_.end(), particle);
    return at != particle_.end() && *at == particle ? int(at - particle_.begin()) : -1;
}

Vec3i ThinPiece::site_of(std::size_t number) const { return lattice_site(*of_, particle_[number]); }

// Whether it is a layer across this axis that is cut nowhere else: all of it that there is in the
// cells above and below is the piece's.
bool ThinPiece::find_layer() {
    layer_ = site_of(0)[axis_];
    const int u = (axis_ + 1) % 3, v = (axis_ + 2) % 3;
    for (std::size_t n = 0; n < particle_.size(); ++n) {
        const Vec3i site = site_of(n);
        if (site[axis_] != layer_) return false;
        bool is_corner = false;
        for (int c = 0; c < 8; ++c) {
            const Vec3i low = site - corner_step(c);
            if (of_->lattice.cell_at(low) < 0) continue;
            is_corner = true;
            Vec3i at = low;
            at[axis_] = layer_;
            for (int q = 0; q < 4; ++q) {
                if (number_at(at + (q & 1) * Vec3i::Unit(u) + (q >> 1) * Vec3i::Unit(v)) < 0) {
                    return false;
                }
            }
        }
        if (!is_corner) return false;
    }
    return true;
}

// Whether there is matter in the cell here, as molded, or its surface goes through it.
bool ThinPiece::may_hold_matter(const Vec3i& site, const RestSurface& molded) const {
    constexpr double kFromMiddle = 0.4331;  // of an eighth of the cell to its corners, sqrt(3) / 4
    const Vec3 to_low = axis_ < 0 ? Vec3(Vec3::Ones()) : Vec3(Vec3::Unit(axis_));
    for (int c = 0; c < 8; ++c) {
        const Vec3 middle = site.cast<double>() - 0.5 * to_low + Vec3::Constant(0.25) +
                            0.5 * corner_step(c).cast<double>();
        const Vec3i there = middle.array().floor().cast<int>();
        const CellId cell = of_->lattice.cell_at(there);
        if (cell < 0) continue;
        if (!molded.is_rim(cell)) return true;
        if (molded.at(cell, middle - there.cast<double>()).distance < kFromMiddle) return true;
    }
    return false;
}

// Those between the particles of a layer, else those about each particle, in their order: where
// there is matter, for of a cell outside of it nobody would know. False where there is none.
bool ThinPiece::make_cells(const RestSurface& molded) {
    const double a = of_->lattice.spacing;
    Vec3 origin = of_->lattice.origin - Vec3::Constant(0.5 * a);
    Vec3i count = of_->lattice.cell_count + Vec3i::Ones();
    std::vector<Vec3i> cells;
    std::vector<double> mass;
    for (std::size_t n = 0; n < particle_.size(); ++n) {
        const Vec3i site = site_of(n);
        if (!may_hold_matter(site, molded)) continue;
        cells.push_back(site);
        mass.push_back(of_->particle_mass[std::size_t(particle_[n])]);
    }
    if (cells.empty()) return false;
    if (axis_ >= 0) {
        origin = of_->lattice.origin - 0.5 * a * Vec3::Unit(axis_);
        count = of_->lattice.cell_count + Vec3i::Unit(axis_);
    }
    Aggregate& m = matter_;
    m.material = of_->material;
    m.inset = of_->inset;
    m.lattice = make_lattice(origin, a, count, cells);
    m.particle_reference = ReferencePlaces(origin, Vec3::Constant(a), m.lattice);
    const std::size_t corners = m.particle_reference.size();
    m.particle_position = m.particle_reference.all();
    m.particle_velocity.resize(corners);
    m.particle_mass.assign(corners, 0.0);
    for (ConnectionArrays& all : m.connection) {
        all.weight = SparseArray<float>(std::vector<float>(corners, 1.0f), 1.0f);
    }
    m.cell_fill.assign(cells.size(), 1.0f);
    m.cell_centroid = SparseArray<Eigen::Vector3f>(cells.size(), Eigen::Vector3f::Zero());
    for (std::size_t n = 0; n < cells.size() && axis_ < 0; ++n) {
        for (ParticleId c : m.lattice.cell_corners(static_cast<CellId>(n))) {
            m.particle_mass[std::size_t(c)] += mass[n] / 8;
        }
    }
    for (std::size_t n = 0; n < cells.size() && !m.inset.empty(); ++n) {
        for (int c = 0; c < 8; ++c) {
            const CellId cell = of_->lattice.cell_at(cells[n] - corner_step(c));
            if (cell < 0) continue;
            m.cell_material.push_back(of_->cell_material[std::size_t(cell)]);
            break;
        }
    }
    for (Vec3Array* all : {&force_, &before_}) all->resize(corners);
    done_.resize(particle_.size());
    return true;
}

// On each axis.
std::vector<int> ThinPiece::numbers_within(double reach, const Vec3& place) const {
    const Lattice& lattice = of_->lattice;
    const Vec3 far = Vec3::Constant(reach), at = (place - lattice.origin) / lattice.spacing;
    const Vec3i low = (at - far).array().ceil().cast<int>(),
                high = (at + far).array().floor().cast<int>();
    std::vector<int> near;
    for (int k = low.z(); k <= high.z(); ++k) {
        for (int j = low.y(); j <= high.y(); ++j) {
            for (int i = low.x(); i <= high.x(); ++i) {
                const int number = number_at({i, j, k});
                if (number >= 0) near.push_back(number);
            }
        }
    }
    return near;
}

bool ThinPiece::add_corner(std::size_t corner) {
    const Vec3 place = matter_.particle_reference.at(corner);
    if (axis_ < 0) {
        return std::any_of(kReach.begin(), kReach.end(),
                           [&](double reach) { return add_corner(place, reach, -1); });
    }
    const Vec3 at = (place - of_->lattice.origin) / of_->lattice.spacing;
    Vec3i site = at.array().round().cast<int>();
    site[axis_] = layer_;
    const ParticleId own = particle_[std::size_t(number_at(site))];
    matter_.particle_mass[corner] = of_->particle_mass[std::size_t(own)] / 2;
    return add_corner(place, kLayerReach, own);
}

// False where the particles so near do not tell.
bool ThinPiece::add_corner(const Vec3& place, double reach, ParticleId own) {
    const std::vector<int> near = numbers_within(reach + 0.1, place);
    if (near.size() < 3) return false;
    const auto at = [&](int number) {
        return of_->particle_reference.at(std::size_t(particle_[std::size_t(number)]));
    };
    Vec3 middle = Vec3::Zero();
    for (int n : near) middle += at(n) / double(near.size());
    Mat3 spread = Mat3::Zero();
    for (int n : near) spread += (at(n) - middle) * (at(n) - middle).transpose();
    const Eigen::SelfAdjointEigenSolver<Mat3> axes(spread);
    const Vec3 size = axes.eigenvalues();
    if (size[1] < kFlat * size[2]) return false;
    const bool is_flat = size[0] < kFlat * size[2];
    Mat3 along = axes.eigenvectors();  // across, then the plane
    if (along.determinant() < 0) along.col(0) *= -1;
    const Vec3 out = along.transpose() * (place - middle);
    const double off = is_flat ? out[0] * std::sqrt(1 + kFolded * kFolded) : 0;
    Corner corner{static_cast<int>(share_.size()), 0, off};
    for (int n : near) {
        const ParticleId p = particle_[std::size_t(n)];
        const Vec3 way = along.transpose() * (at(n) - middle);
        const Vec3 by = way.cwiseQuotient(size);
        double weight = 1.0 / double(near.size()) + by[1] * out[1] + by[2] * out[2];
        if (!is_flat) weight += by[0] * out[0];
        if (own >= 0) weight = p == own ? 1 : 0;
        share_.push_back({p, n, weight, by[1], by[2]});
    }
    corner.end = static_cast<int>(share_.size());
    corner_.push_back(corner);
    return true;
}

// At a place [m] in one of its cells.
void ThinPiece::add_point(const Vec3i& cell, const Vec3& at, double area, const Vec3& normal) {
    const Lattice& lattice = matter_.lattice;
    const CellId number = lattice.cell_at(cell);
    if (number < 0) return;
    const Vec3 place = (at - lattice.origin) / lattice.spacing - cell.cast<double>();
    matter_.surface.add(lattice.cell_row(number), place, area, normal);
}

// As molded: what lies before the planes that end the nearest of its particles for which it does.
// Of patches that a plane goes through what is left: they are half a cell wide.
void ThinPiece::add_molded(const ThinEnds& ends, const std::vector<int>& points) {
    constexpr double kAlong = 0.3;  // sine of the angle to a plane that hardly parts them
    const Lattice& lattice = of_->lattice;
    for (int point : points) {
        const auto p = static_cast<std::size_t>(point);
        if (of_->surface.is_loose(p)) continue;
        const std::array<ParticleId, 8> corner = of_->surface.corner(p);
        const Vec3 normal = of_->surface.normal(p),
                   at = (of_->surface_reference(p) - lattice.origin) / lattice.spacing;
        const double half = 0.5 * std::sqrt(of_->surface.area(p)) / lattice.spacing;
        std::vector<std::pair<double, int>> near;
        for (int c = 0; c < 8; ++c) {
            const int number = number_of(corner[std::size_t(c)]);
            if (number < 0) continue;
            const Vec3 way = site_of(std::size_t(number)).cast<double>() - at;
            near.emplace_back(way.squaredNorm(), c);
        }
        std::sort(near.begin(), near.end());
        for (const auto& [far, c] : near) {
            const int number = number_of(corner[std::size_t(c)]);
            const Vec3i site = site_of(std::size_t(number));
            Vec3 place = at;
            double left = 1;
            for (const CutPlane& plane : planes_of(site, ends)) {
                const double out = (place - plane.place).dot(plane.normal);
                const Vec3 way = plane.normal - plane.normal.dot(normal) * normal;
                const double sine = way.norm();
                if (sine < kAlong) {
                    if (out > 0) left = 0;
                    continue;
                }
                const double past = out / sine;
                if (past <= -half) continue;
                if (past >= half) left = 0;
                left *= (half - past) / (2 * half);
                place -= 0.5 * (past + half) / sine * way;
            }
            if (left <= 0) continue;
            Vec3i cell = site;
            if (axis_ >= 0) {
                const Vec3i flat = Vec3i::Ones() - Vec3i::Unit(axis_);
                cell -= Vec3i(corner_step(c)).cwiseProduct(flat);
            }
            if (matter_.lattice.cell_at(cell) < 0) continue;
            add_point(cell, lattice.origin + lattice.spacing * place, left * of_->surface.area(p),
                      normal);
            break;
        }
    }
}

// Quarters of the faces toward what is not the piece's, brought to the planes that end it there,
// where that lies in the matter. As many look out along an axis as a plane's area has that way.
void ThinPiece::add_new(const ThinEnds& ends, const RestSurface& molded) {
    constexpr double kOn = 1e-3;  // cells
    const Lattice& lattice = of_->lattice;
    const double a = lattice.spacing;
    for (std::size_t n = 0; n < particle_.size(); ++n) {
        const Vec3i site = site_of(n);
        const std::vector<CutPlane> all = planes_of(site, ends);
        for (int c = 0; c < 8; ++c) {
            const Vec3i step = corner_step(c), low = site - step;
            if (lattice.cell_at(low) < 0) continue;
            for (int axis = 0; axis < 3; ++axis) {
                const Vec3i way = (1 - 2 * step[axis]) * Vec3i::Unit(axis);
                const CutPlane* plane = ends.toward(static_cast<int>(n), way);
                if (plane == nullptr) continue;
                Vec3 place = low.cast<double>() + (Vec3::Ones() + 2 * step.cast<double>()) / 4;
                place[axis] = low[axis] + 0.5;
                place -= (place - plane->place).dot(plane->normal) * plane->normal;
                const bool is_out = std::ranges::any_of(all, [&](const CutPlane& other) {
                    return (place - other.place).dot(other.normal) > kOn;
                });
                const Vec3i there = (place - kOn * plane->normal).array().floor().cast<int>();
                const CellId cell = lattice.cell_at(there);
                if (is_out || cell < 0 ||
                    (molded.is_rim(cell) &&
                     molded.at(cell, place - there.cast<double>()).distance >= 0)) {
                    continue;
                }
                const Vec3i home = axis_ < 0 ? site : Vec3i(low + step[axis_] * Vec3i::Unit(axis_));
                add_point(home, lattice.origin + a * place,
                          plane->normal.dot(way.cast<double>()) * a * a / 4, plane->normal);
            }
        }
    }
}

// Of one of its cells.
std::vector<CutPlane> ThinPiece::planes_of(const Vec3i& cell, const ThinEnds& ends) const {
    const Vec3i far = axis_ < 0 ? Vec3i(Vec3i::Zero()) : Vec3i(Vec3i::Ones() - Vec3i::Unit(axis_));
    std::vector<int> own, beside;
    for (int k = -1; k <= 1 + far.z(); ++k) {
        for (int j = -1; j <= 1 + far.y(); ++j) {
            for (int i = -1; i <= 1 + far.x(); ++i) {
                const Vec3i step(i, j, k);
                const int number = number_at(cell + step);
                if (number < 0) continue;
                const bool is_own = (step.array() >= 0).all() && (far - step).minCoeff() >= 0;
                (is_own ? own : beside).push_back(number);
            }
        }
    }
    return ends.around(cell.cast<double>() + 0.5 * far.cast<double>(), own, beside);
}

void ThinPiece::find_ends(const ThinEnds& ends) {
    const Lattice& lattice = matter_.lattice;
    const Vec3 origin = (lattice.origin - of_->lattice.origin) / lattice.spacing;
    std::vector<std::vector<CutSurface::Plane>> planes(matter_.cell_fill.size());
    for (const CellRun& run : lattice.cell_run) {
        for (int n = 0; n < run.count; ++n) {
            const Vec3i cell(run.i + n, run.j, run.k);
            const Vec3 low = cell.cast<double>() + origin;
            for (const CutPlane& plane : planes_of(cell, ends)) {
                planes[std::size_t(run.first + n)].push_back(
                    {plane.normal, plane.normal.dot(low - plane.place)});
            }
        }
    }
    ends_ = std::make_shared<const CutSurface>(std::move(planes));
}

void ThinPiece::follow() {
    frame_.resize(corner_.size());
    for (std::size_t c = 0; c < corner_.size(); ++c) {
        const Blend at = blend(c, [&](std::size_t p) { return of_->particle_position.at(p); });
        const Vec3 across = at.first.cross(at.second);
        const double size = std::sqrt(across.squaredNorm() + kFolded * kFolded);
        const Vec3 normal = across / size;
        frame_[c] = {at.first, at.second, normal, size};
        matter_.particle_position.set(c, at.middle + corner_[c].off * normal);
        const auto speed = [&](std::size_t p) { return of_->particle_velocity.at(p); };
        matter_.particle_velocity.set(c, rate(c, blend(c, speed)));
    }
}

Vec3 ThinPiece::rate(std::size_t c, const Blend& of) const {
    const Frame& frame = frame_[c];
    if (corner_[c].off == 0) return of.middle;
    const Vec3 turn = (of.first.cross(frame.second) + frame.first.cross(of.second)) / frame.size;
    return of.middle + corner_[c].off * (turn - frame.normal * frame.normal.dot(turn));
}

Vec3Array& ThinPiece::begin_forces(const Vec3Array& of) {
    for (std::size_t c = 0; c < corner_.size(); ++c) {
        const auto push = [&](std::size_t p) -> Vec3 { return of.at(p) / of_->particle_mass[p]; };
        force_.set(c, matter_.particle_mass[c] * rate(c, blend(c, push)));
    }
    before_ = force_;
    return force_;
}

void ThinPiece::end_forces(const Vec3& gravity, double step, Vec3Array& of, ContactSums& sums) {
    for (std::size_t n = 0; n < particle_.size(); ++n) done_.set(n, Vec3::Zero());
    for (std::size_t c = 0; c < corner_.size(); ++c) {
        const Corner& corner = corner_[c];
        const Frame& frame = frame_[c];
        const Vec3 f = force_.at(c) - before_.at(c);
        if (f.isZero(0)) continue;
        Vec3 first = Vec3::Zero(), second = Vec3::Zero();
        if (corner.off != 0) {
            const Vec3 turns = corner.off / frame.size * (f - frame.normal * frame.normal.dot(f));
            first = frame.second.cross(turns);
            second = turns.cross(frame.first);
        }
        for (int n = corner.begin; n < corner.end; ++n) {
            const Share& by = share_[std::size_t(n)];
            done_.add(std::size_t(by.number),
                      by.weight * f + by.first * first + by.second * second);
        }
    }
    sums.came = sums.goes = 0;
    for (std::size_t n = 0; n < particle_.size(); ++n) {
        const auto p = static_cast<std::size_t>(particle_[n]);
        const Vec3 f = done_.at(n), v = of_->particle_velocity.at(p);
        of.add(p, f);
        sums.came += f.dot(v);
        sums.goes += f.dot(v + step * (gravity + of.at(p) / of_->particle_mass[p]));
    }
}

}  // namespace swage
