// SPDX-License-Identifier: GPL-3.0-or-later
// Metal with a back stress that is pulled and pressed, and bent and bent back.
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "verify/case.h"
#include "verify/stand.h"

namespace swage {

namespace {

// Over E. What a pull bears rises by kRise; of that the back stress takes kBack.
constexpr double kYield = 0.002, kRise = 0.02, kBack = 0.0012, kOver = 0.01;

Material metal() {
    Material material = unit_material(0.3);
    material.yield_stress = kYield;
    material.hardening = kRise;
    material.back_stress = kBack;
    material.back_strain = kOver;
    return material;
}

// The same matter along one line: stress over logarithmic strain, by steps of its own.
class Fibre {
  public:
    // The stress at a strain near the last.
    double go(double strain) {
        double trial = strain - flowed_;
        const double side = trial > shift_ ? 1 : -1;
        if (side * (trial - shift_) > radius(gathered_)) {
            double low = 0, high = std::abs(trial) + kBack;
            while (high - low > 1e-14) {
                const double d = 0.5 * (low + high);
                const double beyond = side * (trial - side * d - shifted(side, d));
                (beyond > radius(gathered_ + d) ? low : high) = d;
            }
            shift_ = shifted(side, low);
            gathered_ += low, flowed_ += side * low, trial -= side * low;
        }
        return trial;
    }

  private:
    // The part that grows.
    static double radius(double p) { return kYield + kRise * p + kBack * std::expm1(-p / kOver); }
    double shifted(double side, double d) const {
        return side * kBack + (shift_ - side * kBack) * std::exp(-d / kOver);
    }
    double gathered_ = 0, flowed_ = 0, shift_ = 0;
};

// A cube whose ends are held along x alone, drawn to a strain, pressed back and drawn again: by how
// much its stress at most is off on the way.
void pulled_and_pressed(bool brief, Values& values) {
    struct Leg {
        const char* what;
        double strain;
    };
    constexpr int kFrames = 30;
    for (int across : {2, 4}) {
        if (brief && across > 2) break;
        Stand stand(block_of({1, 1, 1}, 1.0 / across, metal()), 1e-6);
        std::array<std::vector<int>, 2> end;
        for (int side : {0, 1}) {
            end[side] = end_face(stand.matter, (2 * side - 1) * Vec3::UnitX());
            stand.grip(end[side], Vec3::UnitX());
        }
        const Drive start = stand.drive;
        Fibre fibre;
        double from = 0;
        for (const auto& [what, strain] :
             {Leg{"pulled", 0.03}, Leg{"pressed back", -0.02}, Leg{"pulled again", 0.02}}) {
            double worst = 0;
            for (int frame = 1; frame <= kFrames; ++frame) {
                const double asked = std::expm1(from + (strain - from) * frame / kFrames);
                Drive to = stand.drive;
                for (int side : {0, 1}) {
                    to.world_from_grip[side].translation =
                        start.world_from_grip[side].translation + Vec3((side - 0.5) * asked, 0, 0);
                }
                const double force = stand.move(to).load[1].force.x();
                // Grips give way a little.
                const double length = mean_position(stand.matter, end[1]).x() -
                                      mean_position(stand.matter, end[0]).x();
                const double expected = fibre.go(std::log(length));
                worst = std::max(worst, std::abs(force * length - expected));
            }
            values.add(as_share(std::string("stress off, of first yield, ") + what, across, 0,
                                worst / kYield, 1e-5));
            from = strain;
        }
    }
}

// Moment of a section of side 1 that stays plane, layer by layer: the middle is at no strain.
class Section {
  public:
    double go(double curvature) {
        double sum = 0;
        for (std::size_t n = 0; n < layer_.size(); ++n) {
            const double z = (n + 0.5) / layer_.size() - 0.5;
            sum += z * layer_[n].go(curvature * z) / layer_.size();
        }
        return sum;
    }

  private:
    std::vector<Fibre> layer_{200};
};

// A square bar bent to five times first yield, straightened and bent as far the other way.
void bent_and_back(bool brief, Values& values) {
    constexpr double kLength = 12, kYieldCurvature = 2 * kYield;
    struct Level {
        int across;
        double bound;
    };
    for (const auto& [across, bound] : {Level{4, 0.06}, Level{8, 0.03}}) {
        if (brief && across > 4) break;
        Stand stand(unit_bar(kLength, across, metal()), 1e-5);
        stand.grip(end_face(stand.matter, -Vec3::UnitX()));
        stand.grip(end_face(stand.matter, Vec3::UnitX()));
        Section section;
        double expected = 0;
        const auto bend = [&](double from, double to, const char* what) {
            constexpr int kFrames = 8;
            ToolLoad load;
            for (int frame = 1; frame <= kFrames; ++frame) {
                const double turn =
                    0.5 * kLength * kYieldCurvature * (from + (to - from) * frame / kFrames);
                Drive drive = stand.drive;
                for (int side : {-1, 1}) {
                    const double half = side * turn;
                    // Along the circle: what is straight has no end of its radius.
                    const double along =
                        std::abs(turn) > 1e-9 ? std::sin(half) / (2 * turn) : 0.5 * side;
                    const double up = std::abs(turn) > 1e-9 ? (1 - std::cos(half)) / (2 * turn) : 0;
                    drive.world_from_grip[side > 0] = {
                        Quat(Eigen::AngleAxisd(-half, Vec3::UnitY())),
                        kLength * Vec3(along, 0, up)};
                }
                stand.move(drive);
                if (frame == kFrames) load = stand.settle().load[1];
                expected = section.go(middle_curvature(stand.matter));
            }
            const Vec3 about_middle = load.torque + load.pose.translation.cross(load.force);
            values.add(relative(std::string("moment, ") + what, across, expected / (kYield / 6),
                                -about_middle.y() / (kYield / 6), bound));
        };
        bend(0, 5, "bent");
        bend(5, 0, "straightened");
        bend(0, -5, "bent the other way");
        bend(-5, 0, "straightened again");
    }
}

void reverse_flow(bool brief, Values& values) {
    pulled_and_pressed(brief, values);
    bent_and_back(brief, values);
}

}  // namespace

void add_reverse_flow_cases(std::vector<Case>& cases) {
    cases.push_back(
        {"reverse-flow",
         "metal with a back stress: a block pulled and pressed back, a bar bent and back",
         "Armstrong & Frederick 1966; plane sections", 0, false, reverse_flow});
}

}  // namespace swage
