// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstring>
#include <random>

#include "laws/cell_return.h"
#include "laws/dual.h"
#include "laws/flow_forms.h"
#include "tests/catch.h"

using namespace swage;

namespace {

constexpr double kShear = 8e10;

double stress_at(const std::vector<FlowPoint>& point, double strain) {
    for (std::size_t n = 1; n < point.size(); ++n) {
        const auto& [from, low] = point[n - 1];
        const auto& [to, high] = point[n];
        if (strain < to) return low + (high - low) * ((strain - from) / (to - from));
    }
    return point.back().stress;
}

// Rising here and there, level elsewhere.
std::vector<FlowPoint> random_points(std::mt19937& engine) {
    std::uniform_real_distribution<double> draw(0, 1);
    std::vector<FlowPoint> point = {{0, 2e8}};
    const int count = 1 + static_cast<int>(9 * draw(engine));
    for (int n = 0; n < count; ++n) {
        const double rise = draw(engine) < 0.3 ? 0 : 1e8 * draw(engine);
        point.push_back(
            {point.back().strain + 1e-4 + 0.1 * draw(engine), point.back().stress + rise});
    }
    return point;
}

}  // namespace

TEST_CASE("a return along a flow curve ends on it, over however many of its points it goes") {
    std::mt19937 engine(3);
    std::uniform_real_distribution<double> draw(0, 1);
    int flowed = 0, far = 0;
    for (int n = 0; n < 2000; ++n) {
        const std::vector<FlowPoint> point = random_points(engine);
        const double alpha = n % 3 ? 0.5 * draw(engine) : 0.0;
        const double at = stress_at(point, alpha);
        const double q = n % 7 == 6 ? 0.99 * at : at + 3 * kShear * 0.5 * draw(engine);
        const FlowCurve curve = flow_curve(point, kShear);
        CellModuli law{};
        law.shear = kShear;
        const CellReturn<double> back =
            return_to(law, line_at(curve, q + 3 * kShear * alpha), q, alpha);
        const double d = back.d_alpha;
        CHECK((d > 0) == (q > at));
        if (q < at) continue;
        CHECK(back.kept * q == Approx(q - 3 * kShear * d).epsilon(1e-12));
        ++flowed;
        far += part_at(curve, q + 3 * kShear * alpha) > part_at(curve, at + 3 * kShear * alpha) + 2;
        const double left = q - 3 * kShear * d;
        CHECK(left == Approx(stress_at(point, alpha + d)).epsilon(1e-12 * q / left + 1e-12));
    }
    CHECK(flowed > 1000);
    CHECK(far > 300);
}

TEST_CASE("at the points of a flow curve themselves a return is right from both sides") {
    const std::vector<FlowPoint> point = {{0, 2e8}, {0.01, 3e8}, {0.02, 3e8}, {0.5, 4e8}};
    const FlowCurve curve = flow_curve(point, kShear);
    for (const auto& [strain, stress] : point) {
        for (double off : {-1e-9, 0.0, 1e-9}) {
            const double reached = stress + 3 * kShear * strain + off * kShear;
            const FlowLine<double> line = line_at(curve, reached);
            const double end = (reached - line.stress) / (3 * kShear + line.slope);
            CHECK(end == Approx(strain).margin(1e-9));
            CHECK(line.stress + line.slope * end == Approx(stress).epsilon(1e-6));
        }
    }
    // Behind its end it is level.
    CHECK(line_at(curve, 1e15).slope == 0);
    CHECK(line_at(curve, 1e15).stress == 4e8);
}

TEST_CASE("lanes find the lines that plain numbers find, and so do those with a slope") {
    std::mt19937 engine(5);
    std::uniform_real_distribution<double> draw(0, 1);
    for (int n = 0; n < 50; ++n) {
        const FlowCurve curve = flow_curve(random_points(engine), kShear);
        Lanes reached;
        for (int l = 0; l < kLanes; ++l) reached[l] = 3 * kShear * draw(engine);
        const FlowLine<Lanes> line = line_at(curve, reached);
        const FlowLine<Dual<Lanes>> dual = line_at(curve, Dual<Lanes>{reached, reached});
        for (int l = 0; l < kLanes; ++l) {
            const FlowLine<double> one = line_at(curve, reached[l]);
            CHECK(line.stress[l] == one.stress);
            CHECK(line.slope[l] == one.slope);
            CHECK(dual.stress.value[l] == one.stress);
            CHECK(dual.slope.slope[l] == 0);
        }
    }
}

TEST_CASE("what flow takes is the integral of its curve") {
    std::mt19937 engine(7);
    std::uniform_real_distribution<double> draw(0, 1);
    for (int n = 0; n < 40; ++n) {
        const std::vector<FlowPoint> point = random_points(engine);
        const FlowCurve curve = flow_curve(point, kShear);
        const double alpha = 0.3 * draw(engine), by = 0.5 * draw(engine);
        double sum = 0;
        constexpr int kParts = 20000;
        for (int k = 0; k < kParts; ++k) sum += stress_at(point, alpha + by * (k + 0.5) / kParts);
        CHECK(mean_flow_stress(curve, alpha, by) == Approx(sum / kParts).epsilon(1e-8));
        // Of next to nothing, the stress there.
        for (double little : {1e-12, 1e-30}) {
            CHECK(mean_flow_stress(curve, alpha, little) ==
                  Approx(stress_at(point, alpha)).epsilon(1e-9));
        }
    }
}

namespace {

template <typename Form>
void check_form(const Form& form, double stress_at_start, std::size_t most) {
    const std::vector<FlowPoint> point = points_of(form);
    CAPTURE(point.size());
    CHECK(point.size() < most);
    CHECK(point.front().strain == 0);
    CHECK(point.front().stress == Approx(stress_at_start));
    CHECK(point.back().strain == kFormEnd);
    double worst = 0;
    for (std::size_t n = 1; n < point.size(); ++n) {
        const auto& [from, low] = point[n - 1];
        const auto& [to, high] = point[n];
        REQUIRE(to > from);
        REQUIRE(high >= low);
        for (int k = 0; k <= 200; ++k) {
            const double share = (k / 200.0) * (k / 200.0);
            const double is = form(from + share * (to - from));
            worst = std::max(worst, std::abs(low + share * (high - low) - is) / is);
        }
    }
    CHECK(worst < kFormError);
}

}  // namespace

TEST_CASE("the points of a closed form are within 1e-5 of it, however steep it begins") {
    check_form(SwiftForm{530e6, 0.0035, 0.23}, 530e6 * std::pow(0.0035, 0.23), 500);
    check_form(SwiftForm{1e9, 1e-9, 0.5}, 1e9 * std::sqrt(1e-9), 1500);
    check_form(SwiftForm{1e9, 0.01, 1}, 1e7, 500);
    check_form(LudwikForm{90e6, 292e6, 0.31}, 90e6, 1200);
    check_form(LudwikForm{1e6, 1e9, 0.1}, 1e6, 6000);
    check_form(LudwikForm{90e6, 0, 0.31}, 90e6, 500);
    check_form(VoceForm{140e6, 160e6, 9}, 140e6, 500);
    check_form(VoceForm{140e6, 1e9, 2000}, 140e6, 1000);
}
