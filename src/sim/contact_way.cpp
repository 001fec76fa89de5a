// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact_way.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "base/bytes.h"
#include "base/parallel.h"
#include "sim/contact_search.h"
#include "sim/limited_stiffness.h"
#include "sim/surface_forces.h"
#include "sim/surface_modulus.h"

namespace swage {

namespace {

constexpr std::size_t kChunk = 256;  // contacts

// Trilinear weights of a place in a cell, in steps of 2^-23, so that as floats they still sum to
// exactly one.
std::array<float, 8> shares_at(const Vec3& place) {
    constexpr double kOne = 1 << 23;
    std::array<double, 8> weight = trilinear_weights(place);
    double sum = 0;
    for (double& w : weight) sum += w = std::round(w * kOne);
    *std::max_element(weight.begin(), weight.end()) += kOne - sum;
    std::array<float, 8> share;
    for (int c = 0; c < 8; ++c) share[c] = static_cast<float>(weight[c] / kOne);
    return share;
}

}  // namespace

std::size_t ContactWay::begin_of(std::size_t chunk) const {
    std::size_t n = std::min(list_.size(), chunk * kChunk);
    if (n == 0) return n;
    while (n < list_.size() && list_.contact[n].point == list_.contact[n - 1].point) ++n;
    return n;
}

ContactWay::ContactWay(ContactSide& from, ContactSide& onto, const SimSettings& settings)
    : from_(&from),
      onto_(&onto),
      solver_(settings.solver),
      scale_(settings.stiffness_of_contacts()),
      own_(from.matter().lattice.cell_count) {
    const Material &m = from.matter().material, &n = onto.matter().material;
    const double soft = from.give(settings.solver), other = onto.give(settings.solver);
    const double e = shared_restitution(m.restitution, soft, n.restitution, other);
    law_ = {.stiffness = 0,
            .restitution = e,
            .loss = restitution_loss(e),
            .damping = restitution_damping(e),
            .friction = 0.5 * (m.friction + n.friction),
            .holding = 0.5 * (m.holding_friction() + n.holding_friction()),
            .hold = 0};
    if (is_static()) law_.holding = law_.friction;
}

void ContactWay::come_near(double step) {
    if (!is_near()) set_stiffness(step);
}

void ContactWay::part() {
    list_ = spare_ = {};
    meeting_ = {};
    next_ = {};
    plane_ = {};
    chunk_ = {};
    points_ = {};
    point_push_ = cell_push_ = {};
    sums_ = {};
    own_gone_ = {};
    gone_ = broken_ = turned_ = kept_ = 0;
    is_found_ = false;
}

void ContactWay::keep_contacts(const std::function<bool(int point)>& meets) {
    std::size_t kept = 0;
    for (std::size_t n = 0; n < list_.size(); ++n) {
        if (!meets(list_.contact[n].point)) {
            const Contact& contact = list_.contact[n];
            const double stored = list_.memory[n].stored;
            if (!is_own()) {
                gone_ += stored;
            } else if (stored != 0) {
                own_gone_.push_back({own_way(contact), stored});
            }
            continue;
        }
        list_.contact[kept] = list_.contact[n];
        list_.memory[kept++] = list_.memory[n];
    }
    list_.contact.resize(kept);
    list_.memory.resize(kept);
}

void ContactWay::leave_out_let_be() {
    if (is_let_be_.empty()) return;
    is_let_be_.resize(from_->points().size(), 0);
    keep_contacts([&](int point) { return !is_let_be_[point]; });
}

void ContactWay::restore(const State& state) {
    list_ = state.contacts;
    gone_ = state.gone;
    own_gone_ = state.own_gone;
    leave_out_let_be();
    has_changed_ = state.has_changed;
    begins_ = state.begins;
    is_found_ = false;
    if (is_static()) meet_anew();
}

void ContactWay::hand_on(ByteWriter& out) {
    std::vector<double> asked;  // of each contact
    for (const Contact& contact : list_.contact) {
        asked.push_back(points_->asked[std::size_t(contact.point)]);
    }
    out(has_changed_, begins_, gone_, own_gone_, list_, is_near(), asked);
}

void ContactWay::take_on(ByteReader& in, double step) {
    bool was_near;
    std::vector<double> asked;
    in(has_changed_, begins_, gone_, own_gone_, list_, was_near, asked);
    if (!was_near) return;
    set_stiffness(step);
    for (std::size_t n = 0; n < list_.size(); ++n) {
        const double now = points_->asked[std::size_t(list_.contact[n].point)];
        if (asked[n] != now) list_.memory[n].soft *= asked[n] / now;
    }
}

void ContactWay::search(double margin) {
    find_contacts(*from_, *onto_, margin, list_, spare_);
    std::swap(list_, spare_);
    if (from_->is_thin() || onto_->is_thin()) {  // they may be many, and most have few contacts
        list_.contact.shrink_to_fit();
        list_.memory.shrink_to_fit();
        spare_ = {};
    }
    leave_out_let_be();
    is_found_ = false;
    if (is_static()) meet_anew();
    // An equilibrium is sought by any way, and a stage begins with bodies that may press each
    // other: what they find deep has been pressed in.
    const bool all_pressed = is_static() ? !has_changed_ : begins_;
    if (!all_pressed) return;
    for (ContactMemory& memory : list_.memory) memory.is_new = false;
}

void ContactWay::resolve() {
    const Lattice& lattice = onto_->matter().lattice;
    const SurfacePoints& points = from_->points();
    point_push_ = cell_push_ = {};
    CellId last = -1;
    std::array<int, 8> corner{};
    for (Contact& contact : list_.contact) {
        if (contact.cell != last) {
            last = contact.cell;
            const std::array<ParticleId, 8> particle = lattice.cell_corners(last);
            for (int c = 0; c < 8; ++c) {
                corner[c] = onto_->patch().slot_of(particle[c]);
                cell_push_.grow(corner[c]);
            }
        }
        contact.corner = corner;
        contact.carriers = 0;
        const auto point = static_cast<std::size_t>(contact.point);
        const std::array<ParticleId, 8> carrier = points.corner(point);
        const std::array<float, 8> share = shares_at(points.place(point));
        for (int c = 0; c < 8; ++c) {
            const float w = share[c];
            if (w == 0) continue;
            const int slot = from_->patch().slot_of(carrier[c]);
            point_push_.grow(slot);
            contact.carrier[contact.carriers] = slot;
            contact.share[contact.carriers++] = w;
        }
    }
}

void ContactWay::surfaces_changed(bool points_too, double step) {
    has_changed_ = true;
    for (ContactMemory& memory : list_.memory) memory.is_new = true;
    is_found_ = false;
    if (!is_near()) return;
    if (points_too) {
        keep_contacts([&](int point) { return from_->meets(point); });
        if (is_static()) meet_anew();
    }
    set_stiffness(step);
}

OtherSide ContactWay::as_other(ContactSide& side) const {
    const double hold =
        is_static()
            ? 0
            : 0.5 * (from_->matter().material.stickiness + onto_->matter().material.stickiness);
    return {.give = side.give(solver_),
            .spacing = side.matter().lattice.spacing,
            .hold = hold,
            .scale = scale_,
            .most = step_ > 0 ? kMeetShare / (step_ * step_) : 0,
            .is_itself = is_own()};
}

void ContactWay::set_stiffness(double step) {
    step_ = step;
    points_ = from_->stiffness_on(as_other(*onto_), solver_);
    borne_ = is_own() ? 1 : onto_->stiffness_on(as_other(*from_), solver_)->borne;
}

void ContactWay::Pushed::add_to(ContactPatch& patch, double share) const {
    for (std::size_t n = 0; n < force.size(); ++n)
        patch.force(low + int(n)) += share * force[n].value;
}

void ContactWay::find_met() {
    met_.clear();
    const bool is_met =
        std::any_of(chunk_.begin(), chunk_.end(), [](const Chunk& chunk) { return chunk.is_met; });
    if (!is_met || !(law_.loss > 0)) return;
    met_.resize(std::size_t(point_push_.high - point_push_.low + 1), 0.0);
    for (std::size_t n = 0; n < list_.size(); ++n) {
        const ImpactHistory& last = list_.memory[n].history;
        if (!last.touches || last.rests) continue;
        const Contact& contact = list_.contact[n];
        for (int c = 0; c < contact.carriers; ++c) {
            double& met = met_[std::size_t(contact.carrier[c] - point_push_.low)];
            met = std::max(met, last.speed);
        }
    }
}

void ContactWay::press_chunk(std::size_t chunk) {
    for (int n : chunk_[chunk].moved) {
        Contact& contact = list_.contact[n];
        const auto particle = onto_->matter().lattice.cell_corners(contact.cell);
        for (int c = 0; c < 8; ++c) {
            const int slot = onto_->patch().slot_of(particle[c]);
            contact.corner[c] = slot;
            cell_push_.take(slot);
        }
    }
    if (is_own()) return;
    push_chunk(chunk);
    pressed_.now += chunk_[chunk].held.now;
    pressed_.gone += chunk_[chunk].held.gone;
    pressed_.turned += chunk_[chunk].held.turned;
}

// A thread that is alone goes on with a chunk while it is near in memory: of two bodies a step's
// contacts take a quarter less.
void ContactWay::find(double step) {
    meeting_.resize(list_.size());
    if (is_own()) {
        own_spot_.resize(list_.size());
        own_held_.resize(list_.size());
    }
    chunk_.resize(chunks_of(list_.size(), kChunk));
    for (Pushed* pushed : {&point_push_, &cell_push_}) {
        pushed->force.assign(std::size_t(pushed->high - pushed->low + 1), {});
    }
    pressed_ = {.gone = std::exchange(gone_, 0)};
    at_once_ = thread_count() == 1;
    parallel_for(chunk_.size(), [&](std::size_t chunk) {
        find_chunk(chunk, step);
        if (at_once_) press_chunk(chunk);
    });
}

ContactHeld ContactWay::press() {
    for (std::size_t chunk = 0; chunk < chunk_.size() && !at_once_; ++chunk) press_chunk(chunk);
    return pressed_;
}

void ContactWay::push(double share, double gone, double turned) {
    share_ = share;
    broken_ = gone;
    turned_ = turned;
    point_push_.add_to(from_->patch(), share);
    cell_push_.add_to(onto_->patch(), share);
}

void ContactWay::share_own() {
    own_.begin(list_.size());
    for (std::size_t n = 0; n < list_.size(); ++n) {
        if (own_spot_[n].box == OwnSpot::kMixed) {
            own_.add_mixed(own_way(list_.contact[n]), own_held_[n]);
        } else {
            own_.add(own_spot_[n], own_held_[n]);
        }
    }
    for (const OwnGone& gone : own_gone_) own_.add_mixed(gone.way, {.gone = gone.held});
    own_gone_.clear();
    const ContactHeld all = own_.find();
    broken_ = all.gone;
    turned_ = all.turned;
}

void ContactWay::push_own() {
    share_own();
    for (std::size_t chunk = 0; chunk < chunk_.size(); ++chunk) push_chunk(chunk);
    point_push_.add_to(from_->patch(), 1);
    cell_push_.add_to(onto_->patch(), 1);
}

void ContactWay::keep_own() {
    if (!(law_.holding > 0)) return;
    for (std::size_t n = 0; n < list_.size(); ++n) own_.keep(n, own_held_[n].now);
    keep_more(own_.kept_more());
}

void ContactWay::respond(double step, Meet meet) {
    next_.resize(list_.size());
    // What a blade has cut is counted as gone once.
    for (std::size_t n = 0; meet == Meet::as_kept && n < list_.size(); ++n) {
        if (!meeting_[n].is_known()) list_.memory[n] = {};
    }
    find_met();
    parallel_for(chunk_.size(), [&](std::size_t chunk) {
        respond_chunk(chunk, step, meet);
        if (at_once_) answer_chunk(chunk);
    });
}

void ContactWay::answer() {
    for (std::size_t chunk = 0; chunk < chunk_.size() && !at_once_; ++chunk) answer_chunk(chunk);
    sums_ = {};
    sums_.damped = 0.5 * broken_;
    sums_.friction = 0.5 * turned_;
    kept_ = 0;
    for (const Chunk& chunk : chunk_) {
        sums_.took += 0.5 * chunk.took;
        sums_.join(chunk.sums);
        kept_ += chunk.kept;
    }
    is_found_ = true;
}

void ContactWay::keep_more(double energy) {
    if (!(law_.holding > 0)) return;  // round-off
    sums_.stored += 0.5 * energy;
    sums_.friction -= 0.5 * energy;
}

void ContactWay::add_stiffness(std::vector<double>& stiffness) const {
    const SurfacePoints& points = from_->points();
    const double share = is_own() ? most_share() : share_;  // a body's own go by the pair of boxes
    for (const Contact& contact : list_.contact) {
        const double k = share * points_->asked[std::size_t(contact.point)];
        const auto by = points.carriers(static_cast<std::size_t>(contact.point));
        for (int c = 0; c < 8; ++c) stiffness[by.corner[c]] += k * std::abs(by.weight[c]);
        // Until candidates are found anew the place may move by half a cell.
        const std::array<double, 8> weight = trilinear_weights(contact.place);
        const auto corner = onto_->matter().lattice.cell_corners(contact.cell);
        for (int c = 0; c < 8; ++c) {
            stiffness[corner[c]] += k * std::clamp(weight[c] + 0.3, 0.0, 1.0);
        }
    }
}

void ContactWay::add_pressed(std::vector<PressedPlaces>& pressed) const {
    for (std::size_t n = 0; is_found_ && n < next_.size(); ++n) {
        if (!next_[n].history.touches) continue;
        const Contact& contact = list_.contact[n];
        PressedPlaces& both = pressed.emplace_back();
        both.stiffness = next_[n].stiffness;
        const auto by = from_->points().carriers(static_cast<std::size_t>(contact.point));
        const auto corner = onto_->matter().lattice.cell_corners(contact.cell);
        const std::array<double, 8> weight = trilinear_weights(contact.place);
        for (std::size_t c = 0; c < 8; ++c) {
            both.particle[c] = by.corner[c], both.weight[c] = by.weight[c];
            both.particle[8 + c] = corner[c], both.weight[8 + c] = -weight[c];
        }
    }
}

int ContactWay::let_be(double deeper) {
    int count = 0;
    for (std::size_t n = 0; is_found_ && n < next_.size(); ++n) {
        if (!next_[n].history.touches || next_[n].pressed <= deeper) continue;
        is_let_be_.resize(from_->points().size(), 0);
        count += !std::exchange(is_let_be_[list_.contact[n].point], 1);
    }
    return count;
}

void ContactWay::commit() {
    if (is_found_) std::swap(list_.memory, next_);
    is_found_ = has_changed_ = begins_ = false;
}

}  // namespace swage
