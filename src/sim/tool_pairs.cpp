// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/tool_pairs.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "sim/surface_forces.h"

namespace swage {

namespace {

constexpr std::size_t kPointsPerChunk = 4096;
// Spacings that a point beyond the middle of a tool may lie beside it, and how much deeper than it
// did at rest where nothing has a speed: what is let go of there goes round tools and through them
// on its way to rest, and no tool goes farther at once (increments_between()).
constexpr double kBeside = 0.25, kDeepAtRest = 1;

// The farthest that any corner of the tool's bounds moves.
double bounds_travel(const Tool& tool, const Pose& from, const Pose& to) {
    const Box box = bounds_of(tool.shape);
    double farthest = 0;
    for (int c = 0; c < 8; ++c) {
        const Vec3 corner = box.corner(c);
        farthest = std::max(farthest, (to * corner - from * corner).norm());
    }
    return farthest;
}

}  // namespace

ToolPairs::ToolPairs(const Aggregate& matter, const Apparatus& apparatus,
                     const SimSettings& settings, int body)
    : apparatus_(&apparatus), body_(body), settings_(settings), spacing_(matter.lattice.spacing) {
    if (apparatus.tool.empty()) return;
    touch_ = std::make_shared<TouchPoints>(matter);
    layer_ = {matter, points(), settings_.solver};
}

double ToolPairs::point_stiffness(std::size_t point, double tool_says) const {
    return layer_.stiffness(points(), point, settings_.stiffness_of_contacts(tool_says));
}

double ToolPairs::stiffness(const Pair& pair) const {
    const double k = point_stiffness(pair.point, tool(pair).contact_stiffness);
    return stiffness_limit_.empty() ? k : std::min(k, stiffness_limit_[pair.point]);
}

void ToolPairs::limit_stiffness(const Aggregate& matter, double step) {
    limit_step_ = step;
    if (touch_ != nullptr) find_limits(matter);
}

void ToolPairs::find_limits(const Aggregate& matter) {
    std::vector<double> stiffness;
    for (std::size_t p = 0; p < points().size(); ++p) stiffness.push_back(point_stiffness(p, 0));
    stiffness_limit_ =
        stiffest_of_points(matter, points(), stiffness, kTouchShare / (limit_step_ * limit_step_));
}

// Saved states may have it too.
void ToolPairs::own_touch() {
    if (touch_.use_count() > 1) touch_ = std::make_shared<TouchPoints>(*touch_);
}

void ToolPairs::leave_out(std::vector<ParticleId> particles) {
    left_out_ = std::move(particles);
    if (touch_ == nullptr) return;
    own_touch();
    touch_->leave_out(left_out_);
}

void ToolPairs::connections_changed(const Aggregate& matter) {
    if (touch_ == nullptr) return;
    own_touch();
    const std::size_t before = touch_->size();
    const auto moved = touch_->connections_changed(matter);
    touch_->leave_out(left_out_);
    for (Pair& pair : pair_) pair.gone = pair.gone || !touch_->meets(pair.point);
    const bool limit_is_old = std::exchange(limit_is_old_, false);
    if (touch_->size() == before && moved.empty()) {
        if (limit_is_old && !stiffness_limit_.empty()) find_limits(matter);
        return;
    }
    layer_ = {matter, points(), settings_.solver};
    if (!stiffness_limit_.empty()) find_limits(matter);
    for (const auto& [point, was] : moved) {
        const auto p = static_cast<std::size_t>(point);
        if (p >= start_position_.size()) continue;
        start_position_[p] += points().position(p, matter.particle_position) - was.position(matter);
    }
    for (std::size_t p = start_position_.size(); p < points().size(); ++p) {
        start_position_.push_back(points().position(std::size_t(p), matter.particle_position));
    }
}

void ToolPairs::begin_move(const Aggregate& matter, const Drive& from) {
    tool_from_world_at_start_.clear();
    if (apparatus_->tool.empty()) return;
    start_position_.resize(points().size());
    parallel_each(start_position_.size(), kPointsPerChunk, [&](std::size_t p) {
        start_position_[p] = points().position(p, matter.particle_position);
    });
    for (const Pose& pose : from.world_from_tool)
        tool_from_world_at_start_.push_back(pose.inverse());
}

std::vector<int> ToolPairs::find_candidates(const Aggregate& matter, const Drive& now) {
    std::vector<int> before;
    if (touch_ == nullptr) return before;
    std::vector<Pair> found;
    std::vector<double> clearances;
    auto old = pair_.cbegin();
    const auto keep = [&](double clearance) {
        before.push_back(static_cast<int>(old - pair_.cbegin()));
        found.push_back(*old);
        clearances.push_back(clearance);
    };
    for (std::size_t t = 0; t < apparatus_->tool.size(); ++t) {
        const Tool& tool = apparatus_->tool[t];
        const Pose tool_from_world = now.world_from_tool[t].inverse();
        const Box reach = bounds_of(tool.shape).widened(spacing_);
        struct Near {
            int point;
            double clearance, distance;
        };
        // In this move, so that it touches though it is outside.
        const double thin = thinness_of(tool.shape);
        const auto may_be_through = [&](std::size_t p, const Vec3& local) {
            return p < start_position_.size() && t < tool_from_world_at_start_.size() &&
                   (local - tool_from_world_at_start_[t] * start_position_[p]).norm() >= thin;
        };
        const auto find_near = [&](std::size_t begin, std::size_t end, std::vector<Near>& near) {
            for (std::size_t p = begin; p < end; ++p) {
                if (!touch_->meets(int(p))) continue;
                const Vec3 local = tool_from_world * points().position(p, matter.particle_position);
                if (!reach.contains(local)) continue;
                const double distance = distance_to(tool.shape, local).value;
                if (distance >= spacing_) continue;
                double carried = 0;  // at most, of how far its particles move
                for (double w : points().carriers(p).weight) carried += std::abs(w);
                const double sure =
                    may_be_through(p, local) ? 0 : kSureShare * distance / std::sqrt(3.0);
                near.push_back({static_cast<int>(p), sure / carried, distance});
            }
        };
        const int tool_id = static_cast<int>(t);
        for (const auto& [p, clearance, distance] :
             parallel_collect<Near>(points().size(), kPointsPerChunk, find_near)) {
            for (; old != pair_.cend() && std::pair(old->tool, old->point) < std::pair(tool_id, p);
                 ++old) {
                if (old->stuck) keep(0);
            }
            if (old != pair_.cend() && old->tool == tool_id && old->point == p) {
                keep(old->stuck ? 0 : clearance);
                ++old;
            } else {
                before.push_back(-1);
                Pair& pair = found.emplace_back(Pair{tool_id, p});
                const bool is_new_surface = static_cast<std::size_t>(p) >= touch_->own();
                if (is_new_ || is_new_surface) pair.deep = std::max(0.0, -distance);
                clearances.push_back(clearance);
            }
        }
    }
    for (; old != pair_.cend(); ++old) {
        if (old->stuck) keep(0);
    }
    pair_ = std::move(found);
    clearance_ = std::move(clearances);
    return before;
}

void ToolPairs::add_stiffness(std::vector<double>& stiffness) const {
    // Normal and tangential stiffness are equal, so each point pulls with k in every direction.
    for (const Pair& pair : pair_) {
        spread_stiffness(points(), pair.point, this->stiffness(pair), stiffness);
    }
}

Vec3 ToolPairs::start_of(const Pair& pair) const {
    return tool_from_world_at_start_[pair.tool] * start_position_[pair.point];
}

Vec3 ToolPairs::anchor(const Pair& pair) const { return pair.stuck ? pair.anchor : start_of(pair); }

Distance ToolPairs::distance(const Pair& pair, const Vec3& from, const Vec3& now,
                             ToolEntry& entry) const {
    entry = pair.entry;
    Distance d = distance_by_entry(tool(pair).shape, reach_of(pair), from, now, entry);
    d.value += pair.deep;
    return d;
}

EntryReach ToolPairs::reach_of(const Pair& pair) const {
    return {kBeside * spacing_,
            in_motion(settings_.solver) ? kAnywhere : kDeepAtRest * spacing_ + pair.depth};
}

bool ToolPairs::is_beyond(const Pair& pair, const Vec3& now) const {
    return swage::is_beyond(tool(pair).shape, reach_of(pair), now, pair.entry);
}

Distance ToolPairs::distance_since_start(const Pair& pair, const Vec3& now,
                                         ToolEntry& entry) const {
    return distance(pair, pair.stuck ? now : start_of(pair), now, entry);
}

void ToolPairs::Pair::come_out(double depth) { deep = std::clamp(depth + deep, 0.0, deep); }

void ToolPairs::forget_gone() {
    std::size_t kept = 0;
    for (std::size_t n = 0; n < pair_.size(); ++n) {
        if (pair_[n].gone) continue;
        clearance_[kept] = clearance_[n];
        pair_[kept++] = pair_[n];
    }
    clearance_.resize(kept);
    pair_.erase(pair_.begin() + std::ptrdiff_t(kept), pair_.end());
}

double ToolPairs::travel(const Aggregate& matter, const Drive& from, const Drive& to,
                         std::size_t every) const {
    double farthest = 0;
    for (std::size_t t = 0; t < apparatus_->tool.size(); ++t) {
        const Tool& tool = apparatus_->tool[t];
        const double most = bounds_travel(tool, from.world_from_tool[t], to.world_from_tool[t]);
        if (most <= spacing_) {
            farthest = std::max(farthest, most);
            continue;
        }
        const Pose tool_from_world = from.world_from_tool[t].inverse();
        for (std::size_t p = 0; p < points().size(); p += every) {
            if (!touch_->meets(int(p))) continue;
            const Vec3 x = points().position(std::size_t(p), matter.particle_position);
            const Vec3 local = tool_from_world * x;
            if (distance_to(tool.shape, local).value > most + 2 * spacing_) continue;
            farthest = std::max(farthest, (to.world_from_tool[t] * local - x).norm());
        }
    }
    return farthest;
}

double ToolPairs::near_travel(const Drive& from, const Drive& to) const {
    double farthest = 0;
    for (std::size_t t = 0; t < apparatus_->tool.size(); ++t) {
        const int tool = static_cast<int>(t);
        const bool is_near =
            std::binary_search(pair_.begin(), pair_.end(), Pair{tool, 0},
                               [](const Pair& a, const Pair& b) { return a.tool < b.tool; });
        if (is_near) {
            const double own =
                bounds_travel(apparatus_->tool[t], from.world_from_tool[t], to.world_from_tool[t]);
            farthest = std::max(farthest, own);
        }
    }
    return farthest;
}

}  // namespace swage
