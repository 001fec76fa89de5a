// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/body_contact.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <tuple>
#include <utility>

#include "base/bytes.h"
#include "base/parallel.h"
#include "geometry/box.h"
#include "geometry/disjoint_sets.h"
#include "geometry/near_boxes.h"
#include "sim/contact_shares.h"

namespace swage {

namespace {

constexpr double kWay = 0.45;              // spacings that anything may go between searches
constexpr std::size_t kThreadShare = 128;  // contacts that a thread is worth waking for
constexpr std::size_t kNone = std::numeric_limits<std::size_t>::max();

}  // namespace

BodyContact::BodyContact(const std::vector<Aggregate*>& bodies, const SimSettings& settings)
    : settings_(settings), least_spacing_(std::numeric_limits<double>::infinity()) {
    if (bodies.size() < 2 && !settings.self_contact) return;
    bodies_ = bodies.size();
    for (Aggregate* body : bodies) {
        const auto alike = std::find_if(side_.begin(), side_.end(), [&](const auto& side) {
            return RestSurface::is_shared(side->matter(), *body);
        });
        side_.push_back(std::make_unique<ContactSide>(
            *body, settings.self_contact, alike == side_.end() ? nullptr : (*alike)->molded()));
        least_spacing_ = std::min(least_spacing_, body->lattice.spacing);
    }
    for (std::size_t a = 0; a < bodies.size(); ++a) {
        for (std::size_t b = 0; b < bodies.size(); ++b) {
            if (a == b && !settings.self_contact) continue;
            const std::size_t row = bodies.size() - !settings.self_contact;
            pair_.push_back({a, b, b * row + a - (!settings.self_contact && a > b)});
            way_.emplace_back(*side_[a], *side_[b], settings);
        }
    }
    between_bodies_ = way_.size();
    find_thin();
}

// Those that are as they were go on.
void BodyContact::find_thin() {
    if (!in_motion(settings_.solver)) return;
    // By body and first particle, which is no other's.
    std::map<std::pair<std::size_t, ParticleId>, std::size_t> known;
    for (std::size_t n = 0; n < thin_.size(); ++n) {
        known[{thin_[n].body, thin_[n].piece->particles()[0]}] = n;
    }
    std::vector<Thin> found;
    bool is_same = true;
    for (std::size_t b = 0; b < bodies_; ++b) {
        ContactSide& side = *side_[b];
        std::vector<ParticleId> all;
        std::optional<ThinNear> near;
        for (std::vector<ParticleId>& one : thin_pieces(side.matter())) {
            const auto at = known.find({b, one[0]});
            const bool was = at != known.end() && thin_[at->second].piece->particles() == one;
            const std::vector<ParticleId> particles = one;
            if (!was && !near) near.emplace(side.matter());
            std::unique_ptr<ThinPiece> piece =
                was ? std::move(thin_[at->second].piece)
                    : ThinPiece::find(side.matter(), *side.molded(), *near, std::move(one));
            if (piece == nullptr) continue;
            is_same = is_same && was && at->second == found.size();
            all.insert(all.end(), particles.begin(), particles.end());
            found.push_back({b, std::move(piece)});
        }
        if (!all.empty()) side.leave_out(all);
    }
    if (is_same && found.size() == thin_.size()) {
        thin_ = std::move(found);
    } else {
        replace_thin(std::move(found));
    }
}

// Ways between thin pieces that go on stay. What lies in a thin piece as that comes to be has not
// been pressed into it: its particles alone may have met all else until then.
void BodyContact::replace_thin(std::vector<Thin> thin) {
    std::map<const Aggregate*, std::size_t> known;
    for (std::size_t s = bodies_; s < side_.size(); ++s) known[&side_[s]->matter()] = s;
    std::vector<std::unique_ptr<ContactSide>> sides;
    std::vector<std::size_t> now(side_.size(), kNone);  // the number of each from now on
    for (std::size_t b = 0; b < bodies_; ++b) {
        now[b] = b;
        sides.push_back(std::move(side_[b]));
    }
    for (const Thin& one : thin) {
        const auto at = known.find(&one.piece->matter());
        if (at != known.end()) now[at->second] = sides.size();
        sides.push_back(at != known.end() ? std::move(side_[at->second])
                                          : one.piece->contact_side());
    }
    let_go_.resize(bodies_, 0.0);
    std::vector<Sides> stay;
    for (std::size_t w = between_bodies_; w < way_.size(); ++w) {
        auto& [from, onto, back] = pair_[w];
        if (now[from] != kNone && now[onto] != kNone) {
            from = now[from], onto = now[onto];
            stay.emplace_back(from, onto);
            continue;
        }
        for (std::size_t side : {from, onto}) let_go_[body_of(side)] += way_[w].sums().stored;
        from = onto = kNone;
    }
    side_ = std::move(sides);
    thin_ = std::move(thin);
    keep_ways(stay);
    listed_.clear();
    allowance_ = -1;
}

std::vector<BodyContact::Sides> BodyContact::thin_ways() const {
    std::vector<Sides> thin;
    for (std::size_t w = between_bodies_; w < pair_.size(); ++w) {
        thin.emplace_back(pair_[w].from, pair_[w].onto);
    }
    return thin;
}

// Of those with thin pieces these there are from now on, and those there are now of them go on.
void BodyContact::keep_ways(const std::vector<Sides>& thin) {
    std::map<Sides, std::size_t> were;
    for (std::size_t w = between_bodies_; w < way_.size(); ++w) {
        were[{pair_[w].from, pair_[w].onto}] = w;
    }
    std::vector<Sides> sorted = thin;
    std::sort(sorted.begin(), sorted.end(), [](const Sides& a, const Sides& b) {
        return std::tuple(std::max(a.first, a.second), std::min(a.first, a.second), a.first) <
               std::tuple(std::max(b.first, b.second), std::min(b.first, b.second), b.first);
    });
    std::vector<ContactWay> ways;
    std::vector<Pair> pairs;
    for (const auto& [from, onto] : sorted) {
        const std::size_t w = between_bodies_ + ways.size();
        pairs.push_back({from, onto, w + 1 - 2 * (ways.size() % 2)});
        const auto at = were.find({from, onto});
        if (at != were.end()) {
            ways.push_back(std::move(way_[at->second]));
        } else {
            ways.emplace_back(*side_[from], *side_[onto], settings_);
            ways.back().come_late();
        }
    }
    std::erase_if(near_, [&](std::size_t w) { return w >= between_bodies_; });
    for (std::size_t n = 0; n < ways.size(); ++n) near_.push_back(between_bodies_ + n);
    way_.erase(way_.begin() + std::ptrdiff_t(between_bodies_), way_.end());
    pair_.erase(pair_.begin() + std::ptrdiff_t(between_bodies_), pair_.end());
    std::move(ways.begin(), ways.end(), std::back_inserter(way_));
    pair_.insert(pair_.end(), pairs.begin(), pairs.end());
}

// Finds the pairs with thin pieces that are within this [m], which have ways from now on; what
// sleeps keeps those that it has. Returns how far any particle may go before others are, at most so
// far [m].
double BodyContact::find_near_thin(const std::vector<Box>& box, const std::vector<char>& asleep,
                                   double margin, double most) {
    if (thin_.empty()) return most;
    const auto least_gap = [&](double within, const auto& visit) {
        double least = std::numeric_limits<double>::infinity();
        for (const auto& [a, b] : near_boxes(box, within)) {
            const auto one = static_cast<std::size_t>(a), other = static_cast<std::size_t>(b);
            if (other < bodies_) continue;
            if (!settings_.self_contact && body_of(one) == body_of(other)) continue;
            least = std::min(least, gap_between(box[one], box[other]));
            visit(one, other);
        }
        return least;
    };
    std::vector<Sides> near;
    for (std::size_t w = between_bodies_; w < way_.size(); ++w) {
        if (pair_[w].sleeps(asleep)) near.emplace_back(pair_[w].from, pair_[w].onto);
    }
    const double least = least_gap(margin, [&](std::size_t one, std::size_t other) {
        if (asleep[one] && asleep[other]) return;
        near.emplace_back(one, other);
        near.emplace_back(other, one);
    });
    keep_ways(near);
    if (least <= margin || !std::isfinite(most)) return std::min(most, 0.5 * margin);
    for (double far = 2 * margin; 0.5 * margin < most; margin = far, far *= 2) {
        const double next = least_gap(far, [](std::size_t, std::size_t) {});
        if (next <= far) return std::min(most, 0.5 * next);
    }
    return most;
}

std::vector<char> BodyContact::of_sides(const std::vector<char>& of_bodies) const {
    std::vector<char> all = of_bodies;
    for (const Thin& thin : thin_) all.push_back(of_bodies[thin.body]);
    return all;
}

void BodyContact::follow() {
    for (const Thin& thin : thin_) thin.piece->follow();
}

void BodyContact::limit_stiffness(double step) {
    step_ = step;
    for (std::size_t w : near_) way_[w].set_stiffness(step);
}

void BodyContact::connections_changed(std::size_t body) {
    if (!acts()) return;
    side_[body]->connections_changed();
    find_thin();
    for (std::size_t w = 0; w < way_.size(); ++w) {
        if (pair_[w].from != body && pair_[w].onto != body) continue;
        way_[w].surfaces_changed(pair_[w].from == body, step_);
    }
    allowance_ = -1;
}

struct BodyContact::State {
    std::vector<std::size_t> near;
    std::vector<Sides> thin;  // of ways that are not between bodies
    std::vector<ContactWay::State> way;
    std::vector<double> let_go;
};

std::shared_ptr<const BodyContact::State> BodyContact::save() const {
    State state;
    state.near = near_;
    state.let_go = let_go_;
    state.thin = thin_ways();
    state.way.reserve(way_.size());
    for (const ContactWay& way : way_) state.way.push_back(way.save());
    return std::make_shared<const State>(std::move(state));
}

void BodyContact::restore(const State& state) {
    keep_ways(state.thin);
    near_ = state.near;
    let_go_ = state.let_go;
    for (std::size_t w : near_) way_[w].come_near(step_);
    for (std::size_t w = 0; w < way_.size(); ++w) way_[w].restore(state.way[w]);
    allowance_ = -1;
}

void BodyContact::hand_on(ByteWriter& out) {
    out(side_.size(), listed_, allowance_);
    for (const std::unique_ptr<ContactSide>& side : side_) {
        const bool is_broken = side->points().size() > side->own_points();
        out(is_broken);
        if (is_broken) side->visit_points(out);
    }
    out(std::uint64_t(way_.size()));
    for (std::size_t w = 0; w < way_.size(); ++w) {
        ByteWriter way;
        way_[w].hand_on(way);
        const bool near = std::binary_search(near_.begin(), near_.end(), w);
        out(Sides(pair_[w].from, pair_[w].onto), near, way.bytes());
    }
}

void BodyContact::take_on(ByteReader& in) {
    if (in.get<std::size_t>() != side_.size()) return;
    in(listed_, allowance_);
    for (const std::unique_ptr<ContactSide>& side : side_) {
        if (in.get<bool>()) side->visit_points(in);
    }
    struct HandedOn {
        bool near;
        std::string bytes;
    };
    std::map<Sides, HandedOn> handed_on;
    std::size_t between_bodies = 0;
    std::vector<Sides> thin;
    for (auto left = in.get<std::uint64_t>(); left > 0; --left) {
        Sides of;
        HandedOn way;
        in(of, way.near, way.bytes);
        const auto [low, high] = std::minmax(of.first, of.second);
        between_bodies += high < bodies_;
        const bool meet = settings_.self_contact || body_of(low) != body_of(high);
        if (high >= bodies_ && meet) thin.push_back(of);
        handed_on[of] = std::move(way);
    }
    if (between_bodies != between_bodies_) allowance_ = -1;
    near_.clear();
    keep_ways(thin);
    for (std::size_t w = 0; w < way_.size(); ++w) {
        const auto at = handed_on.find({pair_[w].from, pair_[w].onto});
        if (at == handed_on.end()) continue;
        if (w < between_bodies_ && at->second.near) near_.push_back(w);
        ByteReader way(at->second.bytes);
        way_[w].take_on(way, step_);
    }
    std::sort(near_.begin(), near_.end());
    for (const std::unique_ptr<ContactSide>& side : side_) side->patch().clear();
    for (std::size_t w : near_) way_[w].resolve();
}

std::size_t BodyContact::candidates() const {
    std::size_t count = 0;
    for (std::size_t w : near_) count += way_[w].contacts().size();
    return count;
}

void BodyContact::renew(const std::vector<char>& bodies_asleep) {
    if (!acts()) return;
    follow();
    const std::vector<char> asleep = of_sides(bodies_asleep);
    double farthest = 0;
    for (std::size_t b = 0; b < listed_.size(); ++b) {
        if (asleep[b]) continue;
        const Vec3Array& x = side_[b]->matter().particle_position;
        const std::vector<ParticleId>& skin = side_[b]->skin();
        for (std::size_t n = 0; n < skin.size() && allowance_ >= 0; ++n) {
            farthest = std::max(farthest, (x.at(skin[n]) - listed_[b][n]).squaredNorm());
        }
    }
    if (!(farthest <= allowance_ * allowance_) || allowance_ < 0) {
        renew_all(bodies_asleep);
    }
}

void BodyContact::begin_unpressed() {
    for (std::size_t w = 0; w < way_.size(); ++w) {
        if (body_of(pair_[w].from) == body_of(pair_[w].onto)) way_[w].come_late();
    }
}

void BodyContact::renew_all(const std::vector<char>& bodies_asleep) {
    if (!acts()) return;
    follow();
    const std::vector<char> asleep = of_sides(bodies_asleep);
    std::vector<Box> box(side_.size());
    listed_.resize(side_.size());
    for (std::size_t b = 0; b < side_.size(); ++b) {
        const Vec3Array& x = side_[b]->matter().particle_position;
        for (ParticleId p : side_[b]->skin()) box[b].grow(x.at(p));
        // What lies still is found where it was when it was listed.
        if (asleep[b] && !listed_[b].empty()) continue;
        listed_[b].clear();
        for (ParticleId p : side_[b]->skin()) listed_[b].push_back(x.at(p));
    }
    const double step = kWay * least_spacing_;
    allowance_ = std::numeric_limits<double>::infinity();
    std::vector<std::size_t> were = std::exchange(near_, {});
    for (std::size_t w = 0; w < between_bodies_; ++w) {
        const auto [from, onto, back] = pair_[w];
        const double gap = gap_between(box[from], box[onto]);
        const bool near = from == onto || gap <= 2 * step;
        allowance_ = std::min(allowance_, near ? step : 0.5 * gap);
        const bool was_near = std::binary_search(were.begin(), were.end(), w);
        // What they are to each other stands, also for when they wake.
        const bool stands = pair_[w].sleeps(asleep);
        if (stands ? was_near : near) {
            near_.push_back(w);
            way_[w].come_near(step_);
            if (!stands) way_[w].search(2 * step);
        } else if (was_near) {
            way_[w].part();
        }
    }
    allowance_ = find_near_thin(box, asleep, 2 * step, allowance_);
    for (std::size_t w = between_bodies_; w < way_.size(); ++w) {
        way_[w].come_near(step_);
        if (!pair_[w].sleeps(asleep)) way_[w].search(2 * step);
    }
    for (const std::unique_ptr<ContactSide>& side : side_) side->patch().clear();
    for (std::size_t w : near_) way_[w].resolve();
}

std::vector<std::size_t> BodyContact::groups() const {
    DisjointSets sets(bodies_);
    for (std::size_t w : near_) {
        if (way_[w].contacts().contact.empty()) continue;
        sets.unite(static_cast<int>(body_of(pair_[w].from)),
                   static_cast<int>(body_of(pair_[w].onto)));
    }
    std::vector<std::size_t> group;
    for (int b = 0; b < static_cast<int>(bodies_); ++b) {
        group.push_back(static_cast<std::size_t>(sets.root(b)));
    }
    return group;
}

void BodyContact::add_forces(const std::vector<Vec3Array*>& body_force, const Vec3& gravity,
                             double step, const std::vector<char>& bodies_asleep,
                             std::vector<ContactSums>& sums, Meet meet) {
    const std::vector<char> asleep = of_sides(bodies_asleep);
    std::vector<Vec3Array*> force = body_force;
    for (const Thin& thin : thin_) {
        force.push_back(&thin.piece->begin_forces(*body_force[thin.body]));
    }
    std::vector<char> acts(side_.size(), 0);
    std::vector<std::size_t> awake;
    sums.assign(side_.size(), {});
    for (std::size_t w : near_) {
        if (pair_[w].sleeps(asleep)) {
            way_[w].freeze();
            continue;
        }
        awake.push_back(w);
        acts[pair_[w].from] = acts[pair_[w].onto] = 1;
    }
    for (std::size_t b = 0; b < side_.size(); ++b) {
        if (acts[b]) side_[b]->patch().read(*force[b]);
    }
    std::vector<ContactHeld> held(way_.size());
    const std::size_t threads = candidates() / kThreadShare;
    parallel_for(awake.size(), threads, [&](std::size_t n) { way_[awake[n]].find(step); });
    for (std::size_t w : awake) held[w] = way_[w].press();
    for (std::size_t w : awake) {
        const ContactHeld& own = held[w];
        if (pair_[w].back == w) {
            way_[w].push_own();
            continue;
        }
        const ContactHeld& other = held[pair_[w].back];
        const ContactHeld both = held_by_both(own, other);
        way_[w].push(share_of(own.now, other.now), 0.5 * both.gone, 0.5 * both.turned);
    }
    for (std::size_t b = 0; b < side_.size(); ++b) {
        if (acts[b]) side_[b]->patch().find_springs();
    }
    parallel_for(awake.size(), threads, [&](std::size_t n) { way_[awake[n]].respond(step, meet); });
    for (std::size_t w : awake) way_[w].answer();
    // NOTE: what friction lets go of may be any part of what a way holds, however short the step,
    // and the shares that both have then are others. With those from before it counted as less that
    // is kept, and more that friction took; the next step found energy that came from nowhere.
    for (std::size_t w : awake) {
        const std::size_t back = pair_[w].back;
        if (back == w) {
            way_[w].keep_own();
            continue;
        }
        const double own = way_[w].kept(), other = way_[back].kept();
        const double counted = share_of(held[w].now, held[back].now) * own +
                               share_of(held[back].now, held[w].now) * other;
        way_[w].keep_more(0.5 * (held_by_both(own, other) - counted));
    }
    for (std::size_t b = 0; b < side_.size(); ++b) {
        if (acts[b]) side_[b]->patch().write(*force[b], gravity, step, sums[b]);
        if (!acts[b] || b < bodies_) continue;
        const Thin& thin = thin_[b - bodies_];
        thin.piece->end_forces(gravity, step, *body_force[thin.body], sums[b]);
    }
    for (std::size_t w : near_) {
        sums[pair_[w].from].join(way_[w].sums());
        sums[pair_[w].onto].join(way_[w].sums());
    }
    for (std::size_t b = bodies_; b < side_.size(); ++b) sums[body_of(b)].join(sums[b]);
    sums.resize(bodies_);
    for (std::size_t b = 0; b < let_go_.size(); ++b) {
        if (!bodies_asleep[b]) sums[b].damped += std::exchange(let_go_[b], 0.0);
    }
}

void BodyContact::add_stiffness(std::vector<double>& stiffness) const {
    for (std::size_t w : near_) way_[w].add_stiffness(stiffness);
}

std::vector<PressedPlaces> BodyContact::pressed() const {
    std::vector<PressedPlaces> all;
    for (std::size_t w : near_) way_[w].add_pressed(all);
    return all;
}

int BodyContact::let_be(double deeper) {
    int count = 0;
    for (std::size_t w : near_) count += way_[w].let_be(deeper);
    return count;
}

void BodyContact::meet_anew() {
    for (std::size_t w : near_) way_[w].meet_anew();
}

void BodyContact::commit(const std::vector<char>& bodies_asleep) {
    const std::vector<char> asleep = of_sides(bodies_asleep);
    for (std::size_t w = 0; w < way_.size(); ++w) {
        if (!pair_[w].sleeps(asleep)) way_[w].commit();
    }
}

}  // namespace swage
