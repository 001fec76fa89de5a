// SPDX-License-Identifier: GPL-3.0-or-later
// Euler's column by what its ends are left: held along some axes only, or by smooth plates.
#include <algorithm>
#include <cmath>
#include <optional>
#include <string>

#include "sim/advance.h"
#include "tests/catch.h"
#include "tests/shared/block.h"

using namespace swage;
using namespace swage::test;

namespace {

constexpr double kSpacing = 0.1, kModulus = 1e6, kPoisson = 0.3;
constexpr int kSlender = 20;
const Vec3 kAll(1, 1, 1), kAlong(1, 0, 0), kAcross(0, 1, 1);

// A square bar along x, `cells` across. Ends are -1 and 1.
class Strut {
  public:
    explicit Strut(int cells)
        : side(cells * kSpacing),
          length(kSlender * side),
          matter_(make_block(kSlender * cells, cells, cells, kSpacing,
                             {.young_modulus = kModulus, .poisson_ratio = kPoisson})) {}

    const double side, length;

    Strut& hold(double end, const Vec3& axes) {
        const Vec3 at(end * 0.5 * length, 0, 0);
        Grip grip;
        grip.hold = axes;
        grip.point = face(end);
        for (int n : grip.point) grip.anchor.push_back(matter_.surface_reference(n) - at);
        apparatus_.grip.push_back(grip);
        drive_.world_from_grip.push_back({Quat::Identity(), at});
        return *this;
    }
    Strut& load(double end) {
        Load push;
        push.name = "push";
        push.point = face(end);
        push.force.assign(push.point.size(), Vec3(-end, 0, 0) / double(push.point.size()));
        apparatus_.load.push_back(push);
        drive_.load_strength.push_back(0.0);
        return *this;
    }
    Strut& plate(double end) {
        add_plate(Vec3(1, 8, 8), Vec3(end * (0.5 * length + 0.5), 0, 0), 0.1);
        return *this;
    }
    // Four plates that press a little: around the bar, from the end on.
    Strut& socket(double end, double deep) {
        for (int axis : {1, 2}) {
            for (double way : {-1.0, 1.0}) {
                Vec3 size(deep, 2 * side, 2 * side), at(end * 0.5 * (length - deep), 0, 0);
                size[axis] = 1;
                at[axis] = way * (0.5 * side + 0.5 - 0.02 * kSpacing);
                add_plate(size, at, 0);
            }
        }
        return *this;
    }

    // By its loads, else by what holds its second end, with this share of what it bears in theory:
    // pi^2 E I / L^2 times `squares`, and somewhat less for its shear. Whether it is told to
    // buckle.
    bool press(double share, double squares) {
        const double area = side * side, shear = kModulus / (2 * (1 + kPoisson));
        const double euler = squares * kPi * kPi * kModulus * area * area / 12 / (length * length);
        const double force = share * euler / (1 + euler / (0.85 * shear * area));
        Drive to = drive_;
        to.time += 1;
        for (double& strength : to.load_strength) strength = force;
        if (apparatus_.load.empty()) {
            Vec3& at = apparatus_.grip.size() < 2 ? to.world_from_tool.back().translation
                                                  : to.world_from_grip.back().translation;
            at.x() -= (force - borne_) / kModulus / area * length;
        }
        const FrameReport report = simulation_->advance(drive_, to);
        drive_ = to;
        const std::size_t last =
            apparatus_.grip.size() < 2 ? apparatus_.tool.size() - 1 : report.load.size() - 1;
        borne_ = apparatus_.load.empty() ? std::abs(report.load[last].force.x()) : force;
        borne_share = borne_ / force;
        return std::ranges::any_of(report.warning, [](const std::string& line) {
            return line == "the work-piece buckled: it changed to another shape";
        });
    }
    void begin() { simulation_.emplace(matter_, apparatus_, SimSettings{}); }

    double borne_share = 0;  // of what it was pressed with last
    // How far its parts have gone sideways, one beyond another.
    double bend() const {
        Box box;
        for (std::size_t p = 0; p < matter_.particle_count(); ++p) {
            const Vec3 way = matter_.particle_position.at(p) - matter_.particle_reference.at(p);
            box.grow(way - Vec3(way.x(), 0, 0));
        }
        return (box.high - box.low).norm();
    }

  private:
    std::vector<int> face(double end) const {
        return points_where(matter_,
                            [&](const Vec3& x) { return end * x.x() > 0.5 * length - 1e-9; });
    }
    void add_plate(const Vec3& size, const Vec3& at, double rounding) {
        apparatus_.tool.push_back({"plate", BoxShape{size, rounding}, 0.0});
        drive_.world_from_tool.push_back({Quat::Identity(), at});
    }
    Aggregate matter_;
    Apparatus apparatus_;
    Drive drive_;
    std::optional<Simulation> simulation_;
    double borne_ = 0;  // [N]
};

void check_buckles(Strut& strut, double squares) {
    strut.begin();
    bool told = false;
    for (double share : {0.3, 0.6, 0.9}) told = strut.press(share, squares) || told;
    CHECK(!told);
    CHECK(strut.borne_share == Approx(1).epsilon(0.03));  // what holds the ends gives way too
    CHECK(strut.bend() < 0.02 * strut.side);
    CHECK(strut.press(1.15, squares));
    CHECK(strut.bend() > 0.1 * strut.side);
}

constexpr double kFixedPinned = 2.0457;  // tan u = u at u^2 = 2.0457 pi^2

}  // namespace

TEST_CASE("a strut held along some axes buckles at the load that is theirs") {
    const int cells = GENERATE(2, 3);
    INFO(cells << " cells across");
    Strut strut(cells);
    SECTION("one end fixed, the other guided along it") {
        strut.hold(-1, kAll).hold(1, kAlong);
        check_buckles(strut, 1);
    }
    SECTION("both guided: it may slide sideways and turn about itself") {
        if (cells > 2) return;  // takes longer than all else here
        strut.hold(-1, kAlong).hold(1, kAlong);
        check_buckles(strut, 1);
    }
    SECTION("both pinned") {
        strut.hold(-1, kAcross).hold(1, kAcross).load(-1).load(1);
        check_buckles(strut, 1);
    }
    SECTION("one fixed, the other free") {
        strut.hold(-1, kAll).load(1);
        check_buckles(strut, 0.25);
    }
    SECTION("one fixed, the other pinned") {
        strut.hold(-1, kAll).hold(1, kAcross).load(1);
        check_buckles(strut, kFixedPinned);
    }
}

TEST_CASE("a strut that is pressed on after a pause is seen to buckle") {
    Strut strut(3);
    strut.hold(-1, kAll).load(1).begin();
    for (double share : {0.3, 0.6, 0.9, 0.9, 0.9}) CHECK(!strut.press(share, 0.25));
    CHECK(strut.press(1.15, 0.25));
}

TEST_CASE("a strut between smooth plates buckles at the load that is theirs", "[stress]") {
    const int cells = GENERATE(2, 3);
    INFO(cells << " cells across");
    Strut strut(cells);
    const double deep = 2 * strut.side, part = strut.length / (strut.length - deep);
    SECTION("one end fixed, the other on a plate") {
        strut.hold(-1, kAll).plate(1);
        check_buckles(strut, 1);
    }
    SECTION("between two plates: it may slide sideways and turn about itself") {
        strut.plate(-1).plate(1);
        check_buckles(strut, 1);
    }
    SECTION("one on a plate, the other free") {
        strut.plate(-1).load(1);
        check_buckles(strut, 0.25);
    }
    SECTION("one in a socket, the other free") {
        if (cells > 2) return;  // the same
        strut.plate(-1).socket(-1, deep).load(1);
        check_buckles(strut, 0.25 * part * part);
    }
    SECTION("one in a socket, the other on a plate") {
        strut.plate(-1).socket(-1, deep).plate(1);
        check_buckles(strut, part * part);
    }
}
