// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/curves.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "base/text.h"
#include "pipeline/csv.h"

namespace swage {

namespace {

// That way or the opposite one, whichever has its largest component above 0.
Vec3 forward(const Vec3& way) {
    int most;
    way.cwiseAbs().maxCoeff(&most);
    return way[most] < 0 ? Vec3(-way) : way;
}

void begin_row(LoadCurve& load, const Pose& pose) {
    load.pose.push_back(pose);
    load.gone.push_back(Vec3::Zero());
    load.force.push_back(Vec3::Zero());
    load.torque.push_back(Vec3::Zero());
    load.axial_torque.push_back(0);
    for (std::vector<double>* column : {&load.turn, &load.travel, &load.work, &load.penetration}) {
        column->push_back(column->empty() ? 0.0 : column->back());
    }
    load.contacts.push_back(0);
}

// What a part bears where nothing has been looked for.
void forget_felt(LoadCurve& load) {
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    load.force.back() = load.torque.back() = Vec3::Constant(kUnknown);
    for (std::vector<double>* column : {&load.axial_torque, &load.penetration, &load.contacts}) {
        column->back() = kUnknown;
    }
}

// Of each load.
struct LoadColumn {
    const char* name;
    double (*value)(const LoadCurve& load, std::size_t row);
    bool is_of_axis = false;  // only of what turns about one
    bool is_work = false;
    bool is_of_load = false;
};
template <int axis>
double place(const LoadCurve& load, std::size_t row) {
    return load.pose[row].translation[axis];
}
template <std::vector<Vec3> LoadCurve::*felt, int axis>
double part(const LoadCurve& load, std::size_t row) {
    return (load.*felt)[row][axis];
}
template <auto entry>
double value(const LoadCurve& load, std::size_t row) {
    return (load.*entry)[row];
}
constexpr LoadColumn kLoadColumns[] = {
    {"x [m]", place<0>},
    {"y [m]", place<1>},
    {"z [m]", place<2>},
    {"turn [rad]", value<&LoadCurve::turn>},
    {"travel [m]", value<&LoadCurve::travel>},
    {"strength", value<&LoadCurve::strength>, false, false, true},
    {"force x [N]", part<&LoadCurve::force, 0>},
    {"force y [N]", part<&LoadCurve::force, 1>},
    {"force z [N]", part<&LoadCurve::force, 2>},
    {"torque x [N m]", part<&LoadCurve::torque, 0>},
    {"torque y [N m]", part<&LoadCurve::torque, 1>},
    {"torque z [N m]", part<&LoadCurve::torque, 2>},
    {"torque about its axis [N m]", value<&LoadCurve::axial_torque>, true},
    {"work [J]", value<&LoadCurve::work>, false, true},
    {"penetration [m]", value<&LoadCurve::penetration>},
    {"contacts", value<&LoadCurve::contacts>},
};
template <typename Act>
void for_columns(const LoadCurve& load, const Act& act) {
    for (const LoadColumn& column : kLoadColumns) {
        // Gravity's work is an entry of the books.
        const bool stands_twice = column.is_work && load.name == "gravity";
        const bool has =
            (load.axis || !column.is_of_axis) && (!load.strength.empty() || !column.is_of_load);
        if (!stands_twice && has) act(column);
    }
}

// Of all bodies together, which pass nothing to each other in sum.
template <typename Act>
void for_sums(const Act& act) {
    for (const BookEntry& entry : kBookEntries) {
        if (entry.side != BookSide::passed) act(entry);
    }
}

// Of each frame.
struct CountColumn {
    const char* name;
    long (*value)(const FrameReport& report);
};
constexpr CountColumn kCountColumns[] = {
    {"severed connections", [](const FrameReport& report) -> long { return report.severed; }},
    {"broken connections", [](const FrameReport& report) -> long { return report.broken; }},
    {"pieces", [](const FrameReport& report) -> long { return report.pieces; }},
    {"iterations", [](const FrameReport& report) { return report.iterations; }},
    {"increments", [](const FrameReport& report) { return report.increments; }},
    {"halvings", [](const FrameReport& report) { return report.halvings; }},
    {"steps", [](const FrameReport& report) { return report.steps; }},
    {"steps taken back", [](const FrameReport& report) { return report.rejected; }},
};

// A tool may go farther back from its work than it went into it.
Vec3 farthest_at_work(const LoadCurve& load) {
    Vec3 farthest = Vec3::Zero(), of_all = Vec3::Zero();
    for (std::size_t row = 0; row < load.gone.size(); ++row) {
        const Vec3& gone = load.gone[row];
        if (gone.norm() > of_all.norm()) of_all = gone;
        if (load.force[row].norm() > 0 && gone.norm() > farthest.norm()) farthest = gone;
    }
    return farthest.isZero(0) ? of_all : farthest;
}

}  // namespace

StageCurves::StageCurves(std::string stage, int first_frame, const std::vector<ToolLoad>& start,
                         FrameReport bodies, std::size_t parts,
                         const std::vector<std::optional<TurnAxis>>& axis,
                         const std::vector<ProbePlace>& probes)
    : stage_(std::move(stage)),
      frame_{first_frame},
      report_{std::move(bodies)},
      probes_{probes},
      parts_(parts) {
    for (std::size_t n = 0; n < start.size(); ++n) {
        load_.emplace_back();
        load_.back().name = start[n].name;
        if (n < axis.size() && axis[n]) {
            TurnAxis about = *axis[n];
            about.along =
                start[n].pose.rotation.conjugate() * forward(start[n].pose.turn(about.along));
            load_.back().axis = about;
        }
        begin_row(load_.back(), start[n].pose);
        if (n < parts_) {
            forget_felt(load_.back());
        } else {
            load_.back().force.back() = start[n].force;
            load_.back().torque.back() = start[n].torque;
            load_.back().contacts.back() = start[n].contacts;
            load_.back().strength = {start[n].strength};
        }
        way_.push_back({start[n].pose});
    }
}

void StageCurves::pass(const std::vector<ToolLoad>& loads) {
    for (std::size_t n = 0; n < way_.size() && n < loads.size(); ++n) {
        Way& way = way_[n];
        Pose now = loads[n].pose;
        now.translation -= loads[n].jump;
        const Vec3 turn = turn_between(way.pose, now);
        const double angle = turn.norm();
        if (way.turn_axis.isZero() && angle > 1e-12) {
            const std::optional<TurnAxis>& axis = load_[n].axis;
            way.turn_axis = axis ? now.turn(axis->along) : forward(turn / angle);
        }
        way.turn += turn.dot(way.turn_axis) < 0 ? -angle : angle;
        way.travel += (now.translation - way.pose.translation).norm();
        way.pose = now;
    }
}

void StageCurves::add(int frame, const FrameReport& report, const std::vector<ProbePlace>& probes) {
    pass(report.load);
    if (std::isnan(report_.front().contact)) report_.front().contact = report.contact_at_start;
    frame_.push_back(frame);
    report_.push_back(report);
    report_.back().load.clear();
    probes_.push_back(probes);
    for (std::size_t n = 0; n < load_.size() && n < report.load.size(); ++n) {
        const ToolLoad& felt = report.load[n];
        LoadCurve& load = load_[n];
        begin_row(load, felt.pose);
        load.turn.back() = way_[n].turn;
        load.travel.back() = way_[n].travel;
        load.gone.back() = way_[n].pose.translation - load.pose.front().translation;
        load.force.back() = felt.force;
        load.torque.back() = felt.torque;
        if (load.axis) {
            load.axial_torque.back() = load.axis->torque_of(felt.force, felt.torque, felt.pose);
        }
        load.work.back() = felt.work;
        load.penetration.back() = felt.penetration;
        load.contacts.back() = felt.contacts;
        if (!load.strength.empty()) load.strength.push_back(felt.strength);
    }
}

std::string csv_text(const StageCurves& curves) {
    std::vector<std::string> names = {"frame", "time [s]"};
    for (const LoadCurve& load : curves.load()) {
        for_columns(load, [&](const LoadColumn& column) {
            names.push_back(csv_text_cell(load.name + " " + column.name));
        });
    }
    for (const ProbePlace& probe : curves.probes().front()) {
        for (const char* axis : {"x [m]", "y [m]", "z [m]"}) {
            names.push_back(csv_text_cell(probe.name + " " + axis));
        }
        for (const SkinField field : probe.field) {
            const SkinFieldWords& words = words_of(field);
            const std::string unit = *words.unit == 0 ? "" : fmt::format(" [{}]", words.unit);
            names.push_back(csv_text_cell(probe.name + " " + words.name + unit));
        }
    }
    for_sums([&](const BookEntry& entry) { names.emplace_back(entry.column); });
    for (const CountColumn& column : kCountColumns) names.emplace_back(column.name);
    names.emplace_back("residual");
    std::string text = joined(names, ",") + '\n';
    for (std::size_t row = 0; row < curves.rows(); ++row) {
        const FrameReport& report = curves.report()[row];
        std::vector<std::string> cells = {std::to_string(curves.frame()[row]),
                                          csv_number(report.time)};
        for (const LoadCurve& load : curves.load()) {
            for_columns(load, [&](const LoadColumn& column) {
                cells.push_back(csv_number(column.value(load, row)));
            });
        }
        for (const ProbePlace& probe : curves.probes()[row]) {
            for (int c = 0; c < 3; ++c) cells.push_back(csv_number(probe.place[c]));
            for (const double value : probe.value) cells.push_back(csv_number(value));
        }
        for_sums([&](const BookEntry& entry) { cells.push_back(csv_number(report.*entry.value)); });
        for (const CountColumn& column : kCountColumns) {
            cells.push_back(std::to_string(column.value(report)));
        }
        cells.push_back(csv_number(report.residual));
        text += joined(cells, ",") + '\n';
    }
    return text;
}

std::vector<double> stroke_of(const LoadCurve& load) {
    constexpr double kStraight = 0.05;  // of the way
    const Vec3 farthest = farthest_at_work(load);
    std::vector<double> stroke;
    if (farthest.isZero()) return stroke;
    const Vec3 along = farthest.normalized();
    for (const Vec3& gone : load.gone) {
        stroke.push_back(along.dot(gone));
        const Vec3 beside = gone - stroke.back() * along;
        if (beside.norm() > kStraight * farthest.norm()) return {};
    }
    return stroke;
}

std::vector<LoadPeaks> peaks_of(const StageCurves& curves) {
    std::vector<LoadPeaks> all;
    for (const LoadCurve& load : curves.load()) {
        LoadPeaks peaks{load.name, {0, curves.frame().front()}, {0, curves.frame().front()}};
        peaks.stroke = farthest_at_work(load).norm();
        if (load.axis) peaks.axial = {0, curves.frame().front()};
        // The first row is none of the stage's frames.
        for (std::size_t row = 1; row < curves.rows(); ++row) {
            const auto raise = [&](Peak& peak, double size) {
                if (size > peak.size) peak = {size, curves.frame()[row]};
            };
            raise(peaks.force, load.force[row].norm());
            raise(peaks.torque, load.torque[row].norm());
            if (load.axis) {
                const double axial = load.axial_torque[row];
                if (std::abs(axial) > std::abs(peaks.axial->size)) {
                    peaks.axial = {axial, curves.frame()[row]};
                }
            }
            if (std::abs(load.turn[row]) > std::abs(peaks.turn)) peaks.turn = load.turn[row];
        }
        all.push_back(peaks);
    }
    return all;
}

PlotAxis plot_axis(const StageCurves& curves) {
    PlotAxis axis;
    const LoadCurve *turns = nullptr, *travels = nullptr;
    double most_turn = 0, least_turn = kPi / 180, most_travel = 1e-12;
    for (std::size_t n = 0; n < curves.parts(); ++n) {
        const LoadCurve& load = curves.load()[n];
        for (double turn : load.turn) {
            if (std::abs(turn) <= std::max(std::abs(most_turn), least_turn)) continue;
            most_turn = turn;
            turns = &load;
        }
        if (load.travel.back() > most_travel) {
            most_travel = load.travel.back();
            travels = &load;
        }
    }
    if (turns != nullptr) {
        axis.label = fmt::format("turn of {} [deg]", turns->name);
        const double way = most_turn < 0 ? -1 : 1;
        for (double t : turns->turn) axis.value.push_back(way * t * 180 / kPi);
    } else if (travels != nullptr) {
        const std::vector<double> stroke = stroke_of(*travels);
        axis.label =
            fmt::format("{} of {} [mm]", stroke.empty() ? "travel" : "stroke", travels->name);
        for (double t : stroke.empty() ? travels->travel : stroke) axis.value.push_back(1e3 * t);
    } else {
        axis.label = "time [s]";
        for (const FrameReport& report : curves.report()) axis.value.push_back(report.time);
    }
    return axis;
}

}  // namespace swage
