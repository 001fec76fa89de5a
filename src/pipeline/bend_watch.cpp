// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/bend_watch.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <utility>

#include "base/text.h"
#include "base/text_error.h"

namespace swage {

namespace {

constexpr int kLooks = 64;       // at the machine's way
constexpr double kEnd = 0.1;     // of the work-piece's length, at either end
constexpr double kRound = 0.02;  // of its size: what a tool moves as it goes round
constexpr double kLeast = kPi / 180, kMost = 1.1 * kPi;
constexpr double kFew = 0.5;  // of what the tools turned, that is not told of

double degrees(double angle) { return 180 / kPi * angle; }

// About an axis, of a turn that was `before` a little earlier.
double turned(const Quat& turn, const Vec3& axis, double before) {
    const double angle = rotation_of(turn).dot(axis);
    return angle + 2 * kPi * std::round((before - angle) / (2 * kPi));
}

Quat against(const Quat& one, const Quat& other) { return (one * other.conjugate()).normalized(); }

// How far two tools turn against each other at the most; zero: neither goes round anything, as a
// roller does that turns in its place.
Vec3 most_turned(const Machine& machine, std::size_t a, std::size_t b) {
    const auto place = [&](std::size_t n, double t) {
        return machine.tool_motion[n].at(t) * machine.work_from_tool[n];
    };
    Vec3 most = Vec3::Zero();
    double round = 0;
    for (int n = 1; n <= kLooks; ++n) {
        const double t = double(n) / kLooks;
        const Pose pa = machine.tool_motion[a].at(t), pb = machine.tool_motion[b].at(t);
        const Vec3 turn = rotation_of(against(pa.rotation, pb.rotation));
        if (turn.norm() > most.norm()) most = turn;
        for (const std::size_t tool : {a, b}) {
            const Pose& own = tool == a ? pa : pb;
            if (!(rotation_of(own.rotation).norm() > kLeast)) continue;
            const double moved = (place(tool, t).translation - place(tool, 0).translation).norm();
            round = std::max(round, moved);
        }
    }
    return round > kRound * machine.frame.size.norm() ? most : Vec3(Vec3::Zero());
}

}  // namespace

BendWatch::BendWatch(const Machine& machine, const Drive& start, const Aggregate& work_piece)
    : particles_(work_piece.particle_count()) {
    const Apparatus& apparatus = machine.apparatus;
    if (!apparatus.grip.empty() || !apparatus.blade.empty()) return;
    const Pose work_from_world = machine.frame.world_from_work.inverse();
    Vec3 most = Vec3::Zero();
    try {
        for (std::size_t a = 0; a < apparatus.tool.size(); ++a) {
            for (std::size_t b = 0; b < a; ++b) {
                const Vec3 turn = most_turned(machine, a, b);
                if (turn.norm() > most.norm()) most = turn, tool_ = {a, b};
            }
        }
    } catch (const PlacedError&) {  // drive_at() tells that
        return;
    }
    if (most.norm() < kLeast || most.norm() > kMost) return;
    // The end beside each of the two.
    const auto along = [&](std::size_t tool) {
        return machine.work_from_tool[tool].translation.x();
    };
    const bool swapped = along(tool_[0]) < along(tool_[1]);
    const double half = 0.5 * machine.frame.size.x();
    for (std::size_t p = 0; p < particles_; ++p) {
        const Vec3 at = work_piece.particle_position.at(p);
        const double x = (work_from_world * at).x();
        if (std::abs(x) < half * (1 - 2 * kEnd)) continue;
        Ends& end = end_[(x < 0) == swapped ? 0 : 1];
        end.particle.push_back(p);
        end.place.push_back(at);
    }
    if (std::ranges::any_of(end_, [](const Ends& end) { return end.particle.size() < 4; })) return;
    axis_ = machine.frame.world_from_work.turn(most.normalized());
    was_parted_ = is_parted(work_piece);
    for (std::size_t n = 0; n < 2; ++n) tool_start_[n] = start.world_from_tool[tool_[n]].rotation;
}

void BendWatch::look(int frame, const Drive& now, const Aggregate& work_piece) {
    if (axis_.isZero(0) || work_piece.particle_count() != particles_) return;
    std::array<Quat, 2> tool, end;
    for (std::size_t n = 0; n < 2; ++n) {
        tool[n] = now.world_from_tool[tool_[n]].rotation * tool_start_[n].conjugate();
        const Ends& own = end_[n];
        Vec3 was = Vec3::Zero(), is = Vec3::Zero();
        for (std::size_t k = 0; k < own.particle.size(); ++k) {
            was += own.place[k], is += work_piece.particle_position.at(own.particle[k]);
        }
        was /= double(own.particle.size()), is /= double(own.particle.size());
        Mat3 map = Mat3::Zero();
        for (std::size_t k = 0; k < own.particle.size(); ++k) {
            const Vec3 at = work_piece.particle_position.at(own.particle[k]);
            map += (at - is) * (own.place[k] - was).transpose();
        }
        end[n] = Quat(nearest_rotation(map));
    }
    tools_ = turned(against(tool[0], tool[1]), axis_, tools_);
    ends_ = turned(against(end[0], end[1]), axis_, ends_);
    asked_ = std::max(asked_, tools_);
    if (ends_ > held_) held_ = ends_, frame_ = frame;
}

bool BendWatch::is_parted(const Aggregate& work_piece) const {
    if (work_piece.particle_count() != particles_) return true;
    const Pieces pieces = find_pieces(work_piece);
    std::set<int> of_first;
    for (const std::size_t p : end_[0].particle) of_first.insert(pieces.particle_piece[p]);
    return std::ranges::none_of(end_[1].particle, [&](std::size_t p) {
        return of_first.contains(pieces.particle_piece[p]);
    });
}

void BendWatch::add_to(Json& record, const Aggregate& work_piece) const {
    if (asked_ < kLeast) return;
    record["bend"] = {{"tools_deg", degrees(asked_)},
                      {"most_deg", degrees(held_)},
                      {"most_in_frame", frame_},
                      {"at_end_deg", degrees(ends_)},
                      {"joined", !is_parted(work_piece)}};
}

std::string BendWatch::warning(const Aggregate& work_piece) const {
    if (asked_ < kLeast) return {};
    if (was_parted_) {
        return "no matter joins the work-piece's ends: the tools turn pieces against each other, "
               "which bends none";
    }
    if (held_ >= kFew * asked_ || is_parted(work_piece)) return {};  // what it broke to is told
    return fmt::format(
        "the tools turned by {:.3g} deg against each other, the work-piece's ends by {:.2g} deg at "
        "the most: it slipped, rolled or tilted between them, and is hardly bent",
        degrees(asked_), degrees(held_));
}

std::string bend_text(const Json& stage) {
    if (!stage.contains("bend")) return {};
    const Json& bend = stage.at("bend");
    if (!bend.at("joined").get<bool>()) return {};
    const auto angle = [&](const char* key) { return bend.at(key).get<double>(); };
    return fmt::format(
        "{}: its ends turned by {:.3g} deg under tools that turned by {:.3g} deg (frame {}), and "
        "stand at {:.3g} deg as it ends",
        stage.at("name").get<std::string>(), angle("most_deg"), angle("tools_deg"),
        bend.at("most_in_frame").get<int>(), angle("at_end_deg"));
}

}  // namespace swage
