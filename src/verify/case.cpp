// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "base/error.h"

namespace swage {

namespace {

double finest_order(const std::vector<Value>& values) {
    const Value &fine = values.back(), &coarse = values[values.size() - 2];
    return std::log(coarse.error / fine.error) / std::log(double(fine.across) / coarse.across);
}

std::vector<Series> series_of(const std::vector<Value>& values) {
    std::vector<Series> all;
    for (const Value& v : values) {
        if (v.across == 0 || !v.bounded()) continue;
        auto at = std::find_if(all.begin(), all.end(),
                               [&](const Series& series) { return series.what == v.what; });
        if (at == all.end()) at = all.insert(at, {v.what, {}, 0});
        at->value.push_back(v);
    }
    std::erase_if(all, [](const Series& series) { return series.value.size() < 2; });
    for (Series& series : all) series.order = finest_order(series.value);
    return all;
}

}  // namespace

void Values::add(Value value) {
    const Clock::time_point now = Clock::now();
    value.seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    value_.push_back(std::move(value));
}

Value relative(std::string what, int across, double expected, double got, double bound) {
    return {std::move(what), across, expected, got, std::abs(got / expected - 1), bound};
}

Value absolute(std::string what, int across, double expected, double got, double bound) {
    const std::size_t open = what.find('['), close = what.find(']');
    Value value = as_share(std::move(what), across, expected, got, bound);
    value.unit = close == std::string::npos ? "" : value.what.substr(open + 1, close - open - 1);
    return value;
}

Value as_share(std::string what, int across, double expected, double got, double bound) {
    return {std::move(what), across, expected, got, std::abs(got - expected), bound};
}

Value at_least(std::string what, int across, double least, double got) {
    return {std::move(what), across, least, got, got >= least ? 0 : 1 - got / least, 0.01};
}

Value told(std::string what, int across, double expected, double got) {
    return relative(std::move(what), across, expected, got,
                    std::numeric_limits<double>::infinity());
}

std::string order_text(const Series& series) {
    return std::isfinite(series.order) ? fmt::format("{:.2f}", series.order) : "-";
}

bool order_missed(const Case& verification, const Series& series) {
    return verification.least_order > 0 && !(series.order >= verification.least_order);
}

std::vector<Case> verification_cases() {
    std::vector<Case> cases;
    add_solid_cases(cases);
    add_plate_cases(cases);
    add_beam_cases(cases);
    add_large_bending_cases(cases);
    add_oblique_cases(cases);
    add_invariance_cases(cases);
    add_two_material_cases(cases);
    add_plastic_cases(cases);
    add_large_flow_cases(cases);
    add_reverse_flow_cases(cases);
    add_fracture_cases(cases);
    add_fast_fracture_cases(cases);
    add_motion_cases(cases);
    add_contact_cases(cases);
    add_flight_cases(cases);
    add_chosen_step_cases(cases);
    return cases;
}

Result run_case(const Case& verification, bool brief) {
    using Clock = std::chrono::steady_clock;
    const auto start = Clock::now();
    Result result;
    Values values;
    try {
        verification.run(brief, values);
    } catch (const Error& error) {
        if (error.code() != ExitCode::stopped) throw;
        result.failure = error.what();
    }
    result.seconds = std::chrono::duration<double>(Clock::now() - start).count();
    result.value = values.all();
    result.plot = values.plots();
    result.series = series_of(result.value);
    result.missed = !result.failure.empty();
    for (const Value& v : result.value) result.missed = result.missed || v.missed();
    for (const Series& series : result.series) {
        result.missed = result.missed || order_missed(verification, series);
    }
    return result;
}

}  // namespace swage
