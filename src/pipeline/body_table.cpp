// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/body_table.h"

#include <cmath>
#include <limits>
#include <utility>

#include "base/text.h"
#include "pipeline/csv.h"

namespace swage {

namespace {

// Three, along x, y and z.
struct MotionColumns {
    const char *name, *unit;
    Vec3 BodyMotion::*value;
};
constexpr MotionColumns kMotionColumns[] = {
    {"", "m", &BodyMotion::centre},
    {"velocity ", "m/s", &BodyMotion::velocity},
    {"angular momentum ", "kg m2/s", &BodyMotion::angular_momentum},
    {"spin ", "rad/s", &BodyMotion::spin},
};

}  // namespace

BodyMotion motion_of(const Aggregate& matter) {
    BodyMotion motion{matter.centre(), matter.mean_velocity(), Vec3::Zero(), Vec3::Zero()};
    Mat3 inertia = Mat3::Zero();
    for (std::size_t p = 0; p < matter.particle_count(); ++p) {
        const double m = matter.particle_mass[p];
        const Vec3 arm = matter.particle_position.at(p) - motion.centre;
        motion.angular_momentum += m * arm.cross(matter.particle_velocity.at(p) - motion.velocity);
        inertia += m * (arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose());
    }
    motion.spin = solve_symmetric(inertia, motion.angular_momentum);
    return motion;
}

BodyTable::BodyTable(int first_frame, const std::vector<WorkPiece>& bodies,
                     const FrameReport& start) {
    for (const WorkPiece& body : bodies) name_.push_back(body.name);
    add(first_frame, bodies, start);
    for (Row& row : row_) row.books.contact = std::numeric_limits<double>::quiet_NaN();
}

void BodyTable::add(int frame, const std::vector<WorkPiece>& bodies, const FrameReport& report) {
    for (std::size_t b = 0; b < bodies.size(); ++b) {
        const Books& books = report.body[b];
        if (row_.size() >= bodies.size() && std::isnan(row_[b].books.contact)) {
            row_[b].books.contact = books.contact_at_start;
        }
        row_.push_back({frame, report.time, b, motion_of(bodies[b].matter), books});
    }
}

std::string BodyTable::csv_text() const {
    std::vector<std::string> cells = {"frame", "time [s]", "body"};
    for (const MotionColumns& columns : kMotionColumns) {
        for (char axis : {'x', 'y', 'z'}) {
            cells.push_back(fmt::format("{}{} [{}]", columns.name, axis, columns.unit));
        }
    }
    for (const BookEntry& entry : kBookEntries) cells.emplace_back(entry.column);
    std::string text = joined(cells, ",") + '\n';
    for (const Row& row : row_) {
        cells = {std::to_string(row.frame), csv_number(row.time), csv_text_cell(name_[row.body])};
        for (const MotionColumns& columns : kMotionColumns) {
            const Vec3& v = row.motion.*columns.value;
            for (int d = 0; d < 3; ++d) cells.push_back(csv_number(v[d]));
        }
        for (const BookEntry& entry : kBookEntries) {
            cells.push_back(csv_number(row.books.*entry.value));
        }
        text += joined(cells, ",") + '\n';
    }
    return text;
}

}  // namespace swage
