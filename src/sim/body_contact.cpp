// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/body_contact.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "geometry/near_pairs.h"
#include "sim/surface_forces.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 1024;  // contacts
constexpr double kWay = 0.45;         // spacings that anything may go between searches
constexpr int kSheet = 3;  // cells nearer than this to each other are one place of contact

std::array<double, 8> weights_at(const Vec3& p) {
    const double x[2] = {1 - p.x(), p.x()}, y[2] = {1 - p.y(), p.y()}, z[2] = {1 - p.z(), p.z()};
    std::array<double, 8> w;
    for (int c = 0; c < 8; ++c) w[c] = x[c & 1] * y[c >> 1 & 1] * z[c >> 2];
    return w;
}

// The cell's trilinear map.
struct CellMap {
    std::array<Vec3, 8> x;

    CellMap(const Vec3Array& position, const std::array<ParticleId, 8>& corner) {
        for (int c = 0; c < 8; ++c) x[c] = position.at(corner[c]);
    }
    Vec3 at(const Vec3& p, Mat3& gradient) const {
        const double qx = 1 - p.x(), qy = 1 - p.y(), qz = 1 - p.z();
        const Vec3 e0 = x[1] - x[0], e1 = x[3] - x[2], e2 = x[5] - x[4], e3 = x[7] - x[6];
        const Vec3 a0 = x[0] + p.x() * e0, a1 = x[2] + p.x() * e1, a2 = x[4] + p.x() * e2,
                   a3 = x[6] + p.x() * e3;
        const Vec3 b0 = qy * a0 + p.y() * a1, b1 = qy * a2 + p.y() * a3;
        gradient.col(0) = qz * (qy * e0 + p.y() * e1) + p.z() * (qy * e2 + p.y() * e3);
        gradient.col(1) = qz * (a1 - a0) + p.z() * (a3 - a2);
        gradient.col(2) = b1 - b0;
        (void)qx;
        return qz * b0 + p.z() * b1;
    }
};

Box box_of_cell(const Vec3Array& position, const std::array<ParticleId, 8>& corner) {
    Box box;
    for (ParticleId p : corner) box.grow(position.at(p));
    return box;
}

double box_gap(const Box& a, const Box& b) {
    return (a.low - b.high).cwiseMax(b.low - a.high).cwiseMax(0.0).norm();
}

}  // namespace

BodyContact::BodyContact(const std::vector<Aggregate*>& bodies, const SimSettings& settings)
    : settings_(settings), least_spacing_(std::numeric_limits<double>::infinity()) {
    if (bodies.size() < 2 && !settings.self_contact) return;
    for (Aggregate* body : bodies) {
        side_.emplace_back(*body, settings.self_contact);
        least_spacing_ = std::min(least_spacing_, body->lattice.spacing);
    }
    for (std::size_t a = 0; a < bodies.size(); ++a) {
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            if (a == b && !settings.self_contact) continue;
            const Material &m = bodies[a]->material, &n = bodies[b]->material;
            const double soft = m.young_modulus / bodies[a]->lattice.spacing,
                         other = n.young_modulus / bodies[b]->lattice.spacing;
            Way way{static_cast<int>(a), static_cast<int>(b), {}, {}, {}, {}};
            const double e = shared_restitution(m.restitution, soft, n.restitution, other);
            way.law = {.stiffness = 0,
                       .restitution = e,
                       .loss = restitution_loss(e),
                       .damping = restitution_damping(e),
                       .friction = 0.5 * (m.friction + n.friction),
                       .holding = 0.5 * (m.holding_friction() + n.holding_friction()),
                       .hold = 0};
            set_stiffness(way);
            way_.push_back(std::move(way));
        }
    }
}

void BodyContact::set_stiffness(Way& way) {
    const Aggregate &a = side_[way.from].matter(), &b = side_[way.onto].matter();
    const SurfacePoints& points = side_[way.from].points();
    const double one = a.material.young_modulus / a.lattice.spacing,
                 other = b.material.young_modulus / b.lattice.spacing;
    const double k = 0.5 * settings_.contact_stiffness * one * other / (one + other);
    // Both ways share the tension as they do the stiffness.
    const double hold = 0.25 * (a.material.stickiness + b.material.stickiness);
    way.stiffness.clear();
    way.hold.clear();
    for (std::size_t p = 0; p < points.size(); ++p) {
        way.stiffness.push_back(k * points.area[p]);
        way.hold.push_back(hold * points.area[p]);
        if (!(step_ > 0)) continue;
        const double most = 0.25 * lightest_carrier(a, points, p) / (step_ * step_);
        way.stiffness[p] = std::min(way.stiffness[p], most);
    }
}

void BodyContact::limit_stiffness(double step) {
    step_ = step;
    for (Way& way : way_) set_stiffness(way);
}

void BodyContact::connections_changed(std::size_t body) {
    if (!acts()) return;
    side_[body].connections_changed();
    const int b = static_cast<int>(body);
    const int own = static_cast<int>(side_[body].own_points());
    for (Way& way : way_) {
        if (way.from != b) continue;
        std::erase_if(way.contact, [&](const Contact& c) { return c.point >= own; });
        set_stiffness(way);
    }
    allowance_ = -1;
}

struct BodyContact::State {
    std::vector<std::vector<Contact>> contact;
};

std::shared_ptr<const BodyContact::State> BodyContact::save() const {
    State state;
    for (const Way& way : way_) state.contact.push_back(way.contact);
    return std::make_shared<const State>(std::move(state));
}

void BodyContact::restore(const State& state) {
    for (std::size_t w = 0; w < way_.size(); ++w) way_[w].contact = state.contact[w];
    allowance_ = -1;
}

std::size_t BodyContact::candidates() const {
    std::size_t count = 0;
    for (const Way& way : way_) count += way.contact.size();
    return count;
}

void BodyContact::renew() {
    if (!acts()) return;
    double farthest = 0;
    for (std::size_t b = 0; b < listed_.size(); ++b) {
        const Vec3Array& x = side_[b].matter().particle_position;
        const std::vector<ParticleId>& skin = side_[b].skin();
        for (std::size_t n = 0; n < skin.size() && allowance_ >= 0; ++n) {
            farthest = std::max(farthest, (x.at(skin[n]) - listed_[b][n]).squaredNorm());
        }
    }
    if (!(farthest <= allowance_ * allowance_) || allowance_ < 0) renew_all();
}

void BodyContact::renew_all() {
    if (!acts()) return;
    std::vector<Box> box(side_.size());
    listed_.resize(side_.size());
    for (std::size_t b = 0; b < side_.size(); ++b) {
        listed_[b].clear();
        for (ParticleId p : side_[b].skin()) {
            listed_[b].push_back(side_[b].matter().particle_position.at(p));
            box[b].grow(listed_[b].back());
        }
    }
    const double step = kWay * least_spacing_;
    allowance_ = std::numeric_limits<double>::infinity();
    for (Way& way : way_) {
        const double gap = box_gap(box[way.from], box[way.onto]);
        const bool near = way.from == way.onto || gap <= 2 * step;
        allowance_ = std::min(allowance_, near ? step : 0.5 * gap);
        if (near) {
            find_pairs(way, 2 * step);
        } else {
            way.contact.clear();
        }
    }
}

void BodyContact::find_pairs(Way& way, double margin) {
    const ContactSide &from = side_[way.from], &onto = side_[way.onto];
    const Aggregate& other = onto.matter();
    // New surface lies up to half a cell outside the cells that hold it.
    margin += 0.5 * other.lattice.spacing * (onto.points().size() > onto.own_points());
    const std::size_t points = from.points().size();
    std::vector<Vec3> point(points);
    parallel_for((points + kChunk - 1) / kChunk, [&](std::size_t chunk) {
        const std::size_t stop = std::min(points, (chunk + 1) * kChunk);
        for (std::size_t p = chunk * kChunk; p < stop; ++p) {
            point[p] = from.position(static_cast<int>(p));
        }
    });
    Box all = box_of(point);
    all.low.array() -= margin;
    all.high.array() += margin;
    std::vector<CellId> cell;
    std::vector<Vec3i> site;
    std::vector<std::array<ParticleId, 8>> corner;
    std::vector<Box> box;
    auto run = other.lattice.cell_run.begin();
    for (CellId id : onto.surface().skin()) {
        if (!onto.is_whole(id)) continue;
        while (id >= run->first + run->count) ++run;
        const int n = id - run->first;
        std::array<ParticleId, 8> c;
        for (int q = 0; q < 8; ++q) c[q] = run->row[q >> 1] + n + (q & 1);
        Box one = box_of_cell(other.particle_position, c);
        if ((one.low.array() > all.high.array()).any() ||
            (one.high.array() < all.low.array()).any()) {
            continue;
        }
        one.low.array() -= margin;
        one.high.array() += margin;
        cell.push_back(id);
        site.emplace_back(run->i + n, run->j, run->k);
        corner.push_back(c);
        box.push_back(one);
    }
    const std::vector<NearPair> pair = near_pairs(point, box);

    std::vector<Contact> found;
    auto old = way.contact.begin();
    const auto one_place = [](const Vec3i& a, const Vec3i& b) {
        return ((a - b).array().abs() <= kSheet).all();
    };
    for (std::size_t n = 0; n < pair.size();) {
        const int p = pair[n].point;
        for (; old != way.contact.end() && old->point < p; ++old) {
            if (old->history.touches) found.push_back(*old);
        }
        const std::size_t first = found.size();
        for (; old != way.contact.end() && old->point == p; ++old) {
            if (old->history.touches) found.push_back(*old);
        }
        const std::size_t kept = found.size();
        std::vector<double> nearest;
        for (; n < pair.size() && pair[n].point == p; ++n) {
            const int b = pair[n].box;
            if (!from.meets(p)) continue;
            if (way.from == way.onto && from.is_neighbour(p, site[b])) continue;
            const double far = (box[b].center() - point[p]).squaredNorm();
            bool is_new = true;
            for (std::size_t m = first; m < found.size() && is_new; ++m) {
                if (!one_place(found[m].site, site[b])) continue;
                is_new = false;
                if (m < kept || far >= nearest[m - kept]) continue;
                nearest[m - kept] = far;
                found[m].cell = cell[b];
                found[m].site = site[b];
                found[m].corner = corner[b];
            }
            if (!is_new) continue;
            found.push_back({.point = p, .cell = cell[b], .site = site[b], .corner = corner[b]});
            nearest.push_back(far);
        }
    }
    for (; old != way.contact.end(); ++old) {
        if (old->history.touches) found.push_back(*old);
    }
    way.contact = std::move(found);
}

// Walks from cell to cell to the one that holds x; false where there is none.
bool BodyContact::locate(const ContactSide& onto, const Vec3& x, Contact& contact,
                         Mat3& gradient) const {
    constexpr double kSlack = 1e-9;
    const Vec3Array& position = onto.matter().particle_position;
    const double a = onto.matter().lattice.spacing;
    for (int hop = 0; hop < 6; ++hop) {
        const CellMap map(position, contact.corner);
        Vec3& p = contact.place;
        bool found = false;
        for (int n = 0; n < 12 && !found; ++n) {
            const Vec3 left = x - map.at(p, gradient);
            const double volume = gradient.determinant();
            if (!(volume > 1e-6 * a * a * a)) return false;
            Vec3 way = gradient.inverse() * left;
            const double size = way.cwiseAbs().maxCoeff();
            if (size > 1) way /= size;
            p += way;
            found = size < 1e-8;
            // Far off: the cell there is a better place to go on from.
            if (n > 0 && ((p.array() < -0.5).any() || (p.array() > 1.5).any())) break;
        }
        const Vec3i out =
            Vec3i((p.array() > 1 + kSlack).cast<int>()) - Vec3i((p.array() < -kSlack).cast<int>());
        if (out.isZero()) return found;
        CellId next = -1;
        Vec3i step = out;
        bool opens =
            false;  // onto a cell that is cut or broken, half of which is still this side's
        const auto try_step = [&](const Vec3i& s) {
            const Vec3i site = contact.site + s;
            const CellId cell = onto.matter().lattice.cell_at(site.x(), site.y(), site.z());
            opens = opens || (cell >= 0 && !onto.is_whole(cell));
            if (!onto.may_hold(cell)) return false;
            next = cell;
            step = s;
            return true;
        };
        if (!try_step(out)) {
            const Vec3 excess = (p.array() - 0.5).abs() - 0.5;
            int most;
            excess.maxCoeff(&most);
            for (int d = 0; d < 3 && next < 0; ++d) {
                const int axis = (most + d) % 3;
                if (out[axis] != 0) try_step(Vec3i::Unit(axis) * out[axis]);
            }
        }
        if (next < 0) {
            return opens && found && (p.array() >= -0.5).all() && (p.array() <= 1.5).all();
        }
        contact.cell = next;
        contact.site += step;
        contact.corner = onto.matter().lattice.cell_corners(next);
        p -= step.cast<double>();
        p = p.cwiseMax(-0.5).cwiseMin(1.5);
    }
    return false;
}

BodyContact::Meeting BodyContact::meet(const Way& way, Contact& contact) const {
    Meeting meeting;
    const ContactSide& onto = side_[way.onto];
    const Vec3 x = side_[way.from].position(contact.point);
    const Vec3 was = contact.place;
    if (!locate(onto, x, contact, meeting.gradient)) {
        const Vec3 p = contact.place;
        // Outside, but what sticks may still hold it.
        const bool held = contact.history.touches && way.law.hold >= 0 &&
                          way.hold[contact.point] > 0 && (p.array() > -0.3).all() &&
                          (p.array() < 1.3).all();
        if (!held) {
            contact.place = was.cwiseMax(0.0).cwiseMin(1.0);
            return meeting;
        }
    }
    if (!onto.may_hold(contact.cell)) return meeting;
    const RestSurface::Depth depth = onto.surface().at(contact.cell, contact.place);
    const Vec3 slope = meeting.gradient.inverse().transpose() * depth.gradient;
    const double size = slope.norm();
    if (!(size > 0)) return meeting;
    if (way.from == way.onto &&
        onto.is_closed_crack(contact.point, contact.site.cast<double>() + contact.place)) {
        return meeting;
    }
    meeting.depth = -depth.distance / size;
    meeting.normal = slope / size;
    meeting.meets = meeting.depth > 0 || (contact.history.touches && way.hold[contact.point] > 0);
    return meeting;
}

void BodyContact::respond(Way& way, const std::vector<Meeting>& meeting,
                          const std::vector<Vec3Array*>& force, double step,
                          std::vector<ContactSums>& sums) {
    const Aggregate &a = side_[way.from].matter(), &b = side_[way.onto].matter();
    const SurfacePoints& points = side_[way.from].points();
    Vec3Array &on_a = *force[way.from], &on_b = *force[way.onto];
    ContactSums &sum_a = sums[way.from], &sum_b = sums[way.onto];
    for (std::size_t n = 0; n < way.contact.size(); ++n) {
        Contact& contact = way.contact[n];
        contact.next = {};
        const Meeting& at = meeting[n];
        if (!at.meets) continue;
        const int point = contact.point;
        const auto& carrier = points.corner[point];
        const auto& share = points.weight[point];
        const std::array<double, 8> weight = weights_at(contact.place);
        Vec3 va = Vec3::Zero(), vb = va, pa = va, pb = va;  // v now; push f / m
        double give = 0;
        for (int c = 0; c < 8; ++c) {
            const double w = share[c];
            if (w == 0) continue;
            const double lightness = w / a.particle_mass[carrier[c]];
            va += w * a.particle_velocity.at(carrier[c]);
            pa += lightness * on_a.at(carrier[c]);
            give += w * lightness;
        }
        for (int c = 0; c < 8; ++c) {
            const double w = weight[c], lightness = w / b.particle_mass[contact.corner[c]];
            vb += w * b.particle_velocity.at(contact.corner[c]);
            pb += lightness * on_b.at(contact.corner[c]);
            give += w * lightness;
        }
        ImpactLaw law = way.law;
        law.stiffness = way.stiffness[point];
        law.hold = way.hold[point];
        const Vec3 here = contact.site.cast<double>() + contact.place;
        const Vec3 anchor = contact.history.touches ? contact.anchor : here;
        const Vec3 now = va - vb;
        const ImpactForce f = impact_force(law,
                                           {.depth = at.depth,
                                            .normal = at.normal,
                                            .now = now,
                                            .velocity = now + step * (pa - pb),
                                            .reach = at.gradient * (anchor - here),
                                            .give = give,
                                            .step = step},
                                           contact.history);
        contact.next = f.history;
        if (!f.history.touches) continue;
        contact.next_anchor = here + at.gradient.inverse() * f.reach;
        double give_a = 0, give_b = 0;
        for (int c = 0; c < 8; ++c) {
            const double w = share[c];
            if (w == 0) continue;
            on_a.add(carrier[c], w * f.force);
            give_a += w * w / a.particle_mass[carrier[c]];
        }
        for (int c = 0; c < 8; ++c) on_b.add(contact.corner[c], -weight[c] * f.force);
        give_b = give - give_a;
        sum_a.work += step * f.force.dot(va + step * (pa + give_a * f.force));
        sum_b.work -= step * f.force.dot(vb + step * (pb - give_b * f.force));
        for (ContactSums* sum : {&sum_a, &sum_b}) {
            sum->stored += 0.5 * f.stored;
            sum->damped += 0.5 * f.damped;
            sum->friction += 0.5 * f.friction;
            sum->penetration = std::max(sum->penetration, at.depth);
            ++sum->contacts;
            sum->sliding += f.history.slides;
        }
    }
}

void BodyContact::add_forces(const std::vector<Vec3Array*>& force, double step,
                             std::vector<ContactSums>& sums) {
    sums.assign(side_.size(), {});
    for (Way& way : way_) {
        const std::size_t count = way.contact.size();
        std::vector<Meeting> meeting(count);
        parallel_for((count + kChunk - 1) / kChunk, [&](std::size_t chunk) {
            const std::size_t stop = std::min(count, (chunk + 1) * kChunk);
            for (std::size_t n = chunk * kChunk; n < stop; ++n) {
                meeting[n] = meet(way, way.contact[n]);
            }
        });
        respond(way, meeting, force, step, sums);
    }
}

void BodyContact::commit() {
    for (Way& way : way_) {
        for (Contact& contact : way.contact) {
            contact.history = contact.next;
            contact.anchor = contact.next_anchor;
        }
    }
}

}  // namespace swage
