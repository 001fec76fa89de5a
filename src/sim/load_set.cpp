// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/load_set.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "base/parallel.h"
#include "matter/cell_gradient.h"
#include "matter/parted.h"
#include "sim/surface_forces.h"
#include "sim/vector_sums.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 1024;

Vec3 centre_of(const std::vector<double>& area, const std::vector<Vec3>& position) {
    Vec3 sum = Vec3::Zero();
    double all = 0;
    for (std::size_t n = 0; n < area.size(); ++n) {
        sum += area[n] * position[n];
        all += area[n];
    }
    return all > 0 ? Vec3(sum / all) : sum;
}

LoadSum sum_of(const std::vector<double>& area, const std::vector<Vec3>& position,
               const std::vector<Vec3>& force) {
    LoadSum sum;
    sum.centre = centre_of(area, position);
    for (std::size_t n = 0; n < area.size(); ++n) {
        sum.force += force[n];
        sum.torque += (position[n] - sum.centre).cross(force[n]);
    }
    return sum;
}

// Takes the sum and the torque off, evenly by area, and by a turn.
void balance(const std::vector<double>& area, const std::vector<Vec3>& position,
             std::vector<Vec3>& force) {
    const LoadSum sum = sum_of(area, position, force);
    double all = 0;
    Mat3 inertia = Mat3::Zero();
    for (std::size_t n = 0; n < area.size(); ++n) {
        const Vec3 r = position[n] - sum.centre;
        all += area[n];
        inertia += area[n] * (r.squaredNorm() * Mat3::Identity() - r * r.transpose());
    }
    if (!(all > 0)) return;
    const Vec3 push = sum.force / all, turn = solve_symmetric(inertia, sum.torque);
    for (std::size_t n = 0; n < area.size(); ++n) {
        force[n] -= area[n] * (push + turn.cross(position[n] - sum.centre));
    }
}

Vec3 mass_moment(const std::vector<double>& mass, const Vec3Array& x) {
    const auto of_chunk = [&](std::size_t begin, std::size_t end) {
        Vec3 sum = Vec3::Zero();
        for (std::size_t p = begin; p < end; ++p) sum += mass[p] * x.at(p);
        return sum;
    };
    Vec3 sum = Vec3::Zero();
    for (const Vec3& one : of_each_chunk(x.size(), of_chunk)) sum += one;
    return sum;
}

}  // namespace

LoadSet::LoadSet(const Apparatus& apparatus, const SimSettings& settings, int body)
    : apparatus_(&apparatus), body_(body), gravity_(settings.gravity) {}

void LoadSet::connections_changed(const Aggregate& matter) {
    if (apparatus_->load.empty()) return;
    const std::vector<Centre> centre = centres(matter);
    std::vector<std::vector<Vec3>> force_at(last_.moment.size());
    if (started_) {
        for_each_load(
            [&](std::size_t l, const Load& load) { force_at[l] = moments_of(load, matter); });
    }
    const std::shared_ptr<const Parted> before = std::exchange(parted_, nullptr);
    bool presses = false, is_torn_somewhere = false;
    Parted parted;
    parted.bearer.resize(apparatus_->load.size());
    for_each_load([&](std::size_t l, const Load& load) {
        presses = presses || load.force.empty();
        if (load.force.empty()) return;
        parted.bearer[l] = bearers(load, matter);
        is_torn_somewhere = is_torn_somewhere || !parted.bearer[l].empty();
    });
    if (presses) {
        parted.is_off.resize(matter.surface.size());
        parallel_each(parted.is_off.size(), kChunk,
                      [&](std::size_t p) { parted.is_off[p] = is_parted(matter, p); });
        presses = std::find(parted.is_off.begin(), parted.is_off.end(), 1) != parted.is_off.end();
    }
    for_each_load([&](std::size_t l, const Load& load) {
        if (!load.force.empty() || load.closed || !presses) return;
        parted.bearer[l] = pressed_bearers(load, matter, parted.is_off);
    });
    if (presses || is_torn_somewhere) {
        std::vector<OpenFace> open;
        if (presses) parted.pieces = find_pieces(matter), open = laid_open(matter);
        for (const Load& load : apparatus_->load) {
            parted.face.push_back(pressed(load, matter, parted.pieces, open));
        }
        parted_ = std::make_shared<const Parted>(std::move(parted));
    }
    renew_last(matter, before.get(), force_at);
    keep_centres(centre, matter);
}

SurfacePoints::Carriers LoadSet::carriers(const Load& load, std::size_t n,
                                          const Aggregate& matter) const {
    const PointCarriage* const bearer = bearer_of(load, n);
    return bearer == nullptr ? matter.surface.carriers(std::size_t(load.point[n]))
                             : bearer->carriers();
}

const PointCarriage* LoadSet::bearer_of(const Load& load, std::size_t n) const {
    if (parted_ == nullptr) return nullptr;
    const std::vector<PointCarriage>& all = parted_->bearer[index_of(load)];
    return all.empty() ? nullptr : &all[n];
}

bool LoadSet::is_off(const Load& load, std::size_t n) const {
    if (parted_ == nullptr || !load.force.empty()) return false;
    const PointCarriage* const bearer = bearer_of(load, n);
    return bearer != nullptr ? !bearer->is_whole : parted_->is_off[std::size_t(load.point[n])] != 0;
}

Vec3 LoadSet::area_vector(const Load& load, std::size_t n, const Aggregate& matter) const {
    const PointCarriage* const bearer = bearer_of(load, n);
    const auto point = static_cast<std::size_t>(load.point[n]);
    if (bearer == nullptr) return surface_area_vector(matter, int(point));
    return present_area<double>(cell_gradient(matter, bearer->carriers().corner, bearer->place),
                                matter.surface.area(point) * matter.surface.normal(point));
}

std::vector<OpenFace> LoadSet::pressed(const Load& load, const Aggregate& matter,
                                       const Pieces& pieces,
                                       const std::vector<OpenFace>& open) const {
    std::vector<OpenFace> faces;
    if (!pushes(load) || !load.closed || !load.force.empty()) return faces;
    std::vector<char> is_pressed(matter.surface.size(), 0);
    for (int p : load.point) is_pressed[std::size_t(p)] = 1;
    std::vector<char> all_round(std::size_t(pieces.count), 1);
    for (std::size_t p = 0; p < is_pressed.size(); ++p) {
        if (!is_pressed[p]) {
            all_round[std::size_t(piece_of(carriage_on_side(matter, p), pieces))] = 0;
        }
    }
    for (const OpenFace& face : open) {
        if (all_round[pieces.particle_piece[face.corner[0]]]) faces.push_back(face);
    }
    return faces;
}

std::span<const OpenFace> LoadSet::faces_of(const Load& load) const {
    if (parted_ == nullptr) return {};
    return parted_->face[index_of(load)];
}

// What is laid open now has not moved since it was; nor does a force that acts elsewhere now.
void LoadSet::renew_last(const Aggregate& matter, const Parted* before,
                         const std::vector<std::vector<Vec3>>& force_at) {
    if (last_.force.empty()) return;  // not started
    for_each_load([&](std::size_t l, const Load& load) {
        const std::size_t points = load.point.size();
        const std::vector<Vec3> now = moments_of(load, matter);
        for (std::size_t n = 0; n < points; ++n) {
            if (now[n] != force_at[l][n]) last_.moment[l][n] += now[n] - force_at[l][n];
        }
        if (!load.force.empty()) return;
        std::map<std::array<ParticleId, 4>, std::size_t> known;
        for (std::size_t n = points; n < last_.force[l].size(); ++n) {
            known[before->face[l][n - points].corner] = n;
        }
        const std::vector<Vec3> moment = last_.moment[l], force = last_.force[l];
        last_.moment[l].resize(points);
        last_.force[l].resize(points);
        for (std::size_t n = points; n < now.size(); ++n) {
            const auto had = known.find(faces_of(load)[n - points].corner);
            const bool is_new = had == known.end();
            last_.moment[l].push_back(is_new ? now[n] : moment[had->second]);
            last_.force[l].push_back(is_new ? Vec3(Vec3::Zero()) : force[had->second]);
        }
    });
}

void LoadSet::leave_alone(const Aggregate& matter, const std::vector<ParticleId>& particles) {
    if (particles.empty()) return;
    const std::vector<Centre> before = centres(matter);
    if (left_alone_.empty()) heavy_mass_ = matter.particle_mass;
    for (ParticleId p : particles) heavy_mass_[std::size_t(p)] = 0;
    left_alone_.insert(left_alone_.end(), particles.begin(), particles.end());
    keep_centres(before, matter);
    if (!started_) return;
    for_each_load(
        [&](std::size_t l, const Load& load) { last_.moment[l] = moments_of(load, matter); });
    last_.mass_moment = mass_moment(heavy_mass_, matter.particle_position);
}

void LoadSet::masses_changed(const Aggregate& matter, const std::vector<double>& was) {
    if (!has_gravity()) return;
    const auto heavy = [&](std::vector<double> mass) {
        for (ParticleId p : left_alone_) mass[std::size_t(p)] = 0;
        return mass;
    };
    const std::vector<double> before = heavy(was), now = heavy(matter.particle_mass);
    const Vec3 had = mass_moment(before, matter.particle_position);
    if (started_) last_.mass_moment += mass_moment(now, matter.particle_position) - had;
    std::vector<Centre> centre = centres(matter);
    const double mass = std::accumulate(before.begin(), before.end(), 0.0);
    if (mass > 0) centre.back().place = had / mass;
    if (!left_alone_.empty()) heavy_mass_ = now;
    keep_centres(centre, matter);
}

std::vector<double> LoadSet::areas_of(const Load& load, const Aggregate& matter) const {
    std::vector<double> area;
    area.reserve(load.point.size());
    const bool presses = load.force.empty();
    const bool is_forced = !presses && load.force[0] != Vec3::Zero();
    for (std::size_t n = 0; n < load.point.size(); ++n) {
        const double whole = is_forced ? load.force[n].norm()
                                       : load.share_of(n) * matter.surface.area(load.point[n]);
        area.push_back(is_off(load, n) ? 0 : whole);
    }
    const double whole = matter.lattice.spacing * matter.lattice.spacing;
    for (const OpenFace& face : faces_of(load)) area.push_back(face.share * whole);
    return area;
}

std::vector<Vec3> LoadSet::positions_of(const Load& load, const Aggregate& matter) const {
    std::vector<Vec3> position;
    position.reserve(load.point.size());
    for (std::size_t n = 0; n < load.point.size(); ++n) {
        const SurfacePoints::Carriers by = carriers(load, n, matter);
        Vec3 x = Vec3::Zero();
        for (int c = 0; c < 8; ++c) x += by.weight[c] * matter.particle_position.at(by.corner[c]);
        position.push_back(x);
    }
    for (const OpenFace& face : faces_of(load)) {
        position.push_back(face.mean(matter.particle_position));
    }
    return position;
}

LoadSet::Pushed LoadSet::pushed(const Load& load, std::size_t n, const Aggregate& matter) const {
    Pushed part;
    const auto add = [&](ParticleId p, double weight) {
        if (leaves_alone(p)) return;
        part.share += weight;
        part.moment += weight * matter.particle_position.at(p);
    };
    const std::size_t points = load.point.size();
    if (n < points) {
        const SurfacePoints::Carriers by = carriers(load, n, matter);
        for (int c = 0; c < 8; ++c) add(by.corner[c], by.weight[c]);
    } else {
        for (ParticleId p : faces_of(load)[n - points].corner) add(p, 0.25);
    }
    return part;
}

std::vector<Vec3> LoadSet::moments_of(const Load& load, const Aggregate& matter) const {
    std::vector<Vec3> moment = positions_of(load, matter);
    if (left_alone_.empty()) return moment;
    for (std::size_t n = 0; n < moment.size(); ++n) moment[n] = pushed(load, n, matter).moment;
    return moment;
}

double LoadSet::Patches::all() const { return std::accumulate(area.begin(), area.end(), 0.0); }

LoadSet::Patches LoadSet::patches_of(const Load& load, const Aggregate& matter) const {
    Patches of = {areas_of(load, matter), positions_of(load, matter), {}};
    of.share.assign(of.area.size(), 1);
    for (std::size_t n = 0; n < of.area.size() && !left_alone_.empty(); ++n) {
        const Pushed part = pushed(load, n, matter);
        of.share[n] = part.share;
        of.area[n] *= part.share;
        if (part.share != 0) of.position[n] = part.moment / part.share;
    }
    return of;
}

std::vector<LoadSet::Centre> LoadSet::centres(const Aggregate& matter) const {
    std::vector<Centre> centres = centre_;
    centres.resize(count());
    const auto put = [&](std::size_t n, double all, const Vec3& moment) {
        centres[n].is_of_nothing = !(all > 0);
        if (all > 0) centres[n].place = moment / all;
    };
    for_each_load([&](std::size_t l, const Load& load) {
        const Patches of = patches_of(load, matter);
        Vec3 moment = Vec3::Zero();
        for (std::size_t n = 0; n < of.area.size(); ++n) moment += of.area[n] * of.position[n];
        put(l, of.all(), moment);
    });
    if (has_gravity()) {
        const std::vector<double>& heavy = heavy_mass(matter);
        put(apparatus_->load.size(), std::accumulate(heavy.begin(), heavy.end(), 0.0),
            mass_moment(heavy, matter.particle_position));
    }
    return centres;
}

void LoadSet::keep_centres(const std::vector<Centre>& before, const Aggregate& matter) {
    centre_ = before;
    centre_ = centres(matter);
    for (std::size_t n = 0; n < centre_.size(); ++n) {
        centre_[n].jump += centre_[n].place - before[n].place;
    }
}

void LoadSet::balance(const Load& load, const Aggregate& matter, const std::vector<double>& area,
                      std::vector<Vec3>& force) const {
    const std::vector<Vec3> position = positions_of(load, matter);
    if (parted_ == nullptr) return swage::balance(area, position, force);
    const Pieces& pieces = parted_->pieces;
    std::vector<std::vector<std::size_t>> of_piece(std::size_t(pieces.count));
    const std::size_t points = load.point.size();
    for (std::size_t n = 0; n < force.size(); ++n) {
        if (area[n] == 0) continue;
        const ParticleId by = n < points ? matter.surface.row(load.point[n])[0]
                                         : faces_of(load)[n - points].corner[0];
        of_piece[pieces.particle_piece[by]].push_back(n);
    }
    for (const std::vector<std::size_t>& piece : of_piece) {
        std::vector<double> own_area;
        std::vector<Vec3> own_position, own;
        for (std::size_t n : piece) {
            own_area.push_back(area[n]);
            own_position.push_back(position[n]);
            own.push_back(force[n]);
        }
        swage::balance(own_area, own_position, own);
        for (std::size_t n = 0; n < piece.size(); ++n) force[piece[n]] = own[n];
    }
}

std::vector<Vec3> LoadSet::forces_of(const Load& load, double strength,
                                     const Aggregate& matter) const {
    const std::size_t points = load.point.size();
    const std::span<const OpenFace> face = faces_of(load);
    std::vector<Vec3> force(points + face.size(), Vec3::Zero());
    if (!load.force.empty()) {
        for (std::size_t n = 0; n < points; ++n) force[n] = strength * load.force[n];
        return force;
    }
    const double pressure = strength * load.pressure;
    if (pressure == 0) return force;
    const std::vector<double> area = areas_of(load, matter);
    parallel_each(points, kChunk, [&](std::size_t n) {
        if (area[n] == 0) return;
        force[n] = load.share_of(n) * pressure_force(pressure, area_vector(load, n, matter));
    });
    for (std::size_t n = 0; n < face.size(); ++n) {
        force[points + n] = pressure_force(pressure, face[n].outward(matter.particle_position));
    }
    if (load.closed) balance(load, matter, area, force);
    return force;
}

void LoadSet::add_forces(const Aggregate& matter, const Drive& now, Vec3Array& force) const {
    std::vector<Vec3> kept;
    for (ParticleId p : left_alone_) kept.push_back(force.at(p));
    for_each_load([&](std::size_t l, const Load& load) {
        if (now.load_strength[l] == 0) return;
        const std::vector<Vec3> push = forces_of(load, now.load_strength[l], matter);
        const std::size_t points = load.point.size();
        for (std::size_t n = 0; n < points; ++n) {
            const SurfacePoints::Carriers by = carriers(load, n, matter);
            for (int c = 0; c < 8; ++c) force.add(by.corner[c], by.weight[c] * push[n]);
        }
        const std::span<const OpenFace> face = faces_of(load);
        for (std::size_t n = 0; n < face.size(); ++n) spread(face[n], push[points + n], force);
    });
    for (std::size_t n = 0; n < kept.size(); ++n) force.set(left_alone_[n], kept[n]);
}

double LoadSet::size(const Aggregate& matter, const Drive& now) const {
    double largest = has_gravity() ? matter.mass() * gravity(now).norm() : 0;
    for_each_load([&](std::size_t l, const Load& load) {
        double sum = 0;
        for (const Vec3& force : load.force) sum += force.norm();
        if (load.force.empty()) {
            for (double area : areas_of(load, matter)) sum += std::abs(load.pressure) * area;
        }
        largest = std::max(largest, std::abs(now.load_strength[l]) * sum);
    });
    return largest;
}

bool LoadSet::eases(const Drive& from, const Drive& to) const {
    bool eases = has_gravity() && gravity(to).norm() < gravity(from).norm();
    for_each_load([&](std::size_t l, const Load&) {
        eases = eases || std::abs(to.load_strength[l]) < std::abs(from.load_strength[l]);
    });
    return eases;
}

bool LoadSet::is_stirred(const Drive& since, const Drive& now) const {
    constexpr double kLeast = 1e-6;  // of what is there: a strength may be small and the load large
    const auto changed = [](double change, double was, double is) {
        return change > kLeast * std::max(was, is);
    };
    const Vec3 was = gravity(since), is = gravity(now);
    bool stirred = changed((is - was).norm(), was.norm(), is.norm());
    for_each_load([&](std::size_t l, const Load&) {
        const double before = since.load_strength[l], after = now.load_strength[l];
        stirred = stirred || changed(std::abs(after - before), std::abs(before), std::abs(after));
    });
    return stirred;
}

LoadSet::Settled LoadSet::settled(const Aggregate& matter, const Drive& now) const {
    Settled state;
    state.moment.resize(apparatus_->load.size());
    state.force.resize(apparatus_->load.size());
    for_each_load([&](std::size_t l, const Load& load) {
        state.moment[l] = moments_of(load, matter);
        state.force[l] = forces_of(load, now.load_strength[l], matter);
    });
    if (has_gravity()) {
        state.mass_moment = mass_moment(heavy_mass(matter), matter.particle_position);
        state.gravity = gravity(now);
    }
    return state;
}

void LoadSet::start(const Aggregate& matter, const Drive& now) {
    if (started_ || count() == 0) return;
    connections_changed(matter);
    last_ = settled(matter, now);
    started_ = true;
}

void LoadSet::commit(const Aggregate& matter, const Drive& now, std::vector<double>& work) {
    if (count() == 0) return;
    Settled state = settled(matter, now);
    for (std::size_t l = 0; l < state.force.size(); ++l) {
        for (std::size_t n = 0; n < state.force[l].size(); ++n) {
            work[l] += 0.5 * (last_.force[l][n] + state.force[l][n])
                                 .dot(state.moment[l][n] - last_.moment[l][n]);
        }
    }
    if (has_gravity()) {
        work.back() +=
            0.5 * (last_.gravity + state.gravity).dot(state.mass_moment - last_.mass_moment);
    }
    last_ = std::move(state);
}

std::vector<LoadSum> LoadSet::sums(const Aggregate& matter, const Drive& now) const {
    std::vector<LoadSum> sums(apparatus_->load.size());
    for_each_load([&](std::size_t l, const Load& load) {
        const Patches of = patches_of(load, matter);
        std::vector<Vec3> force = forces_of(load, now.load_strength[l], matter);
        for (std::size_t n = 0; n < force.size(); ++n) force[n] *= of.share[n];
        sums[l] = sum_of(of.area, of.position, force);
        if (!(of.all() > 0) && !centre_.empty()) sums[l].centre = centre_[l].place;
    });
    if (has_gravity()) {
        const std::vector<double>& heavy = heavy_mass(matter);
        const double mass = std::accumulate(heavy.begin(), heavy.end(), 0.0);
        Vec3 centre = mass_moment(heavy, matter.particle_position);
        if (mass > 0) {
            centre /= mass;
        } else if (!centre_.empty()) {
            centre = centre_.back().place;
        }
        sums.push_back({centre, mass * gravity(now)});
    }
    for (std::size_t n = 0; n < centre_.size(); ++n) sums[n].jump = centre_[n].jump;
    return sums;
}

}  // namespace swage
