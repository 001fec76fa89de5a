// SPDX-License-Identifier: GPL-3.0-or-later
// What the machines of a stage did and felt, frame by frame: the table of curves/<stage>.csv.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/math.h"
#include "matter/load_limit.h"
#include "pipeline/probes.h"
#include "sim/advance.h"

namespace swage {

// One tool, grip, blade or load over the stage, one entry a row.
struct LoadCurve {
    std::string name;
    std::vector<Pose> pose;
    // [rad] since the start of the stage, past 180 degrees too; about the axis of its first turn,
    // pointed so that its largest component is more than 0.
    std::vector<double> turn;
    // Of what it acts on, without the jumps of its place where that becomes other [m].
    std::vector<double> travel;  // of path since the start of the stage
    std::vector<Vec3> gone;      // from where it was at the start
    std::vector<Vec3> force;     // [N] exerted on the matter
    std::vector<Vec3> torque;    // [N m] about the pose's origin
    // Of a part that turns: the axis, pointed as that of `turn`, and the torque about it [N m].
    std::optional<TurnAxis> axis;
    std::vector<double> axial_torque;
    std::vector<double> work;         // [J] done on the matter
    std::vector<double> penetration;  // [m]
    std::vector<double> contacts;
    std::vector<double> strength;  // of a load, 1 being full; of a part of the machine empty

    template <typename Io>
    void visit(Io& io) {
        auto& [of, at, turned, path, way, pushes, turns, about, axial, done, deep, points, share] =
            *this;
        io(of, at, turned, path, way, pushes, turns, about, axial, done, deep, points, share);
    }
};

class StageCurves {
  public:
    // The first row is the start of the stage: names and poses, what loads push with, and what is
    // known of the bodies (Simulation::start); what contacts hold there the first add() tells. What
    // the machine's parts bear there is not known: NaN.
    // The first `parts` of the loads are of the machine, and go where they are driven.
    // `axis`: of those that turn about one (turn_axes()). `probes`: the same ones every time.
    StageCurves(std::string stage, int first_frame, const std::vector<ToolLoad>& start,
                FrameReport bodies, std::size_t parts,
                const std::vector<std::optional<TurnAxis>>& axis,
                const std::vector<ProbePlace>& probes);
    void add(int frame, const FrameReport& report, const std::vector<ProbePlace>& probes = {});
    // Where the loads are within a frame, so that no turn between its ends is missed.
    void pass(const std::vector<ToolLoad>& loads);

    const std::string& stage() const { return stage_; }
    std::size_t rows() const { return frame_.size(); }
    const std::vector<int>& frame() const { return frame_; }
    const std::vector<FrameReport>& report() const { return report_; }  // `load` is left out
    const std::vector<LoadCurve>& load() const { return load_; }
    std::size_t parts() const { return parts_; }
    const std::vector<std::vector<ProbePlace>>& probes() const { return probes_; }  // by row

    template <typename Io>
    void visit(Io& io) {
        auto& [stage, frame, report, load, probes, parts, way] = *this;
        io(stage, frame, report, load, probes, parts, way);
    }

  private:
    std::string stage_;
    std::vector<int> frame_;
    std::vector<FrameReport> report_;
    std::vector<LoadCurve> load_;
    std::vector<std::vector<ProbePlace>> probes_;
    std::size_t parts_;
    struct Way {
        using IsPlain = Way;

        Pose pose;                      // but for jumps
        Vec3 turn_axis = Vec3::Zero();  // its largest component more than 0
        double turn = 0, travel = 0;
    };
    std::vector<Way> way_;  // of each load, so far
};

// Comma separated; the first line names each column and its unit, as in "pusher force x [N]".
std::string csv_text(const StageCurves& curves);

// How far along the way to its farthest place it is, by row [m], so that what comes back comes back
// to 0; empty where it leaves that straight way by more than a twentieth, or goes nowhere.
std::vector<double> stroke_of(const LoadCurve& load);

// The most of what a tool, grip, blade or load did in the stage's frames, and the frame it was in.
struct Peak {
    double size = 0;
    int frame = 0;
};
struct LoadPeaks {
    std::string name;
    Peak force, torque;           // [N], [N m]
    std::optional<Peak> axial{};  // of a part that turns, about its axis, the most to either side
    // [m] from where it was at the start: the farthest that it bears a force at, of all where it
    // bears none.
    double stroke = 0;
    double turn = 0;  // [rad] since the start, the most to either side
};
std::vector<LoadPeaks> peaks_of(const StageCurves& curves);

// What to plot the loads against: the turn of the machine's part that turns most (when any turns by
// more than a degree), else the stroke of the one that travels most, or its travel where it has no
// stroke, else time.
struct PlotAxis {
    std::string label;  // with the unit
    std::vector<double> value;
};
PlotAxis plot_axis(const StageCurves& curves);

}  // namespace swage
