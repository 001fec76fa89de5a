// SPDX-License-Identifier: GPL-3.0-or-later
// Verification: cases whose answers are known from elsewhere, run through the rooms as a user's
// scene would be. A case gives values, each beside what it should be and how far off it may be.
#pragma once

#include <chrono>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

namespace swage {

struct Value {
    std::string what;
    int across = 0;  // cells across; 0: does not depend on them
    double expected = 0, got = 0;
    double error = 0;  // relative to what is expected, or absolute
    double bound = std::numeric_limits<double>::infinity();  // infinite: only told
    double seconds = 0;
    // Of the error and its bound where they are absolute; %: of what is expected, or of one.
    std::string unit = "%";

    bool bounded() const { return bound < std::numeric_limits<double>::infinity(); }
    bool missed() const { return bounded() && !(error <= bound); }
};

Value relative(std::string what, int across, double expected, double got, double bound);
// In the unit that `what` has in brackets, if it has one.
Value absolute(std::string what, int across, double expected, double got, double bound);
// Absolute as well, of what is itself a share of something: %.
Value as_share(std::string what, int across, double expected, double got, double bound);
// Only told: there is nothing that it must be, or nothing sure enough.
Value told(std::string what, int across, double expected, double got);

// No less than this; the error is what lacks of it, as a share: a hundredth may.
Value at_least(std::string what, int across, double least, double got);

// For the page: lines of points, the ordinate logarithmic.
struct Plot {
    struct Line {
        std::string name;
        std::vector<std::pair<double, double>> point;
        bool dashed = false;
    };
    std::string title, abscissa, ordinate;
    std::vector<Line> line;
};

// Each takes the seconds since the one before.
class Values {
  public:
    void add(Value value);
    const std::vector<Value>& all() const { return value_; }
    void draw(Plot plot) { plot_.push_back(std::move(plot)); }
    const std::vector<Plot>& plots() const { return plot_; }

  private:
    using Clock = std::chrono::steady_clock;
    Clock::time_point last_ = Clock::now();
    std::vector<Value> value_;
    std::vector<Plot> plot_;
};

// Values of one `what` at two resolutions or more: error ~ across^-order.
struct Series {
    std::string what;
    std::vector<Value> value;  // from coarse to fine
    double order = 0;          // between the two finest: what coarse ones follow is no power yet
};

struct Result {
    std::vector<Value> value;
    std::vector<Series> series;
    std::vector<Plot> plot;
    std::string failure;  // why the case ended early, empty: it did not
    double seconds = 0;
    bool missed = false;  // a bound, the order, or the end
};

struct Case {
    std::string name;
    std::string help;
    std::string source;      // of what is expected
    double least_order = 0;  // of every series; 0: any. The order of an error that falls as the
                             // square of the spacing rounds to 2.
    bool quick = false;      // part of the short run, with its coarse resolutions alone
    // Adds its values one by one, so that those before a failure are kept.
    std::function<void(bool brief, Values& values)> run;
};

// In the order of importance.
std::vector<Case> verification_cases();

std::string order_text(const Series& series);  // -: of an error of nothing there is none
bool order_missed(const Case& verification, const Series& series);
Result run_case(const Case& verification, bool brief);

// One family a file.
void add_solid_cases(std::vector<Case>& cases);
void add_plate_cases(std::vector<Case>& cases);
void add_beam_cases(std::vector<Case>& cases);
void add_large_bending_cases(std::vector<Case>& cases);
void add_oblique_cases(std::vector<Case>& cases);
void add_invariance_cases(std::vector<Case>& cases);
void add_two_material_cases(std::vector<Case>& cases);
void add_plastic_cases(std::vector<Case>& cases);
void add_large_flow_cases(std::vector<Case>& cases);
void add_reverse_flow_cases(std::vector<Case>& cases);
void add_fracture_cases(std::vector<Case>& cases);
void add_fast_fracture_cases(std::vector<Case>& cases);
void add_motion_cases(std::vector<Case>& cases);
void add_contact_cases(std::vector<Case>& cases);
void add_flight_cases(std::vector<Case>& cases);
void add_chosen_step_cases(std::vector<Case>& cases);

}  // namespace swage
