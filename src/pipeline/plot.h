// SPDX-License-Identifier: GPL-3.0-or-later
// The plots of a run's curves, drawn by gnuplot when it is found. Until one is drawn its program
// stands in its place, STAGE.gp for STAGE.svg: whoever goes on with the run draws it.
#pragma once

#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include "pipeline/curves.h"

namespace swage {

// A program for gnuplot, with the data inside; where it draws to is told beside it. Force above,
// torque below, each against plot_axis. Of a work-piece of this size [m]: torques that its forces
// make by a lever of no more than two thousandths of it are left out, and forces that are as small
// beside torques.
std::string plot_program(const StageCurves& curves, double size);

// Where the program of a table stands.
std::filesystem::path plot_program_of(const std::filesystem::path& csv);

class Plots {
  public:
    // Of the tables in this folder, of these names without endings, whether they are there or not.
    Plots(std::filesystem::path folder, std::vector<std::string> names);

    bool has_undrawn() const;
    // Those from this one on are of tables that are about to be made anew.
    void forget_from(std::size_t table) const;
    // Each that can be drawn, once in the life of this, until somebody asks the process to end.
    void draw();
    // What kept those that were tried from it, in the log already.
    const std::vector<std::string>& warnings() const { return warnings_; }

  private:
    void tell(std::string warning);

    std::filesystem::path folder_;
    std::vector<std::string> names_;
    std::set<std::string> tried_;
    std::vector<std::string> warnings_;
    bool missed_ = false;  // no gnuplot
};

}  // namespace swage
