// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <csignal>
#include <utility>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/process.h"
#include "base/text.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

// A string of gnuplot in single quotes, in which only the quote itself is special.
std::string quoted(const std::string& text) {
    std::string result = "'";
    for (char c : text) {
        if (c == '\'')
            result += "''";
        else
            result += static_cast<unsigned char>(c) < ' ' ? ' ' : c;
    }
    return result + "'";
}

constexpr int kLongest = 30;  // s, that gnuplot may take

constexpr double kLever = 2e-3;  // below it the lattice makes torques of forces, or the reverse

// What is drawn of a load, by row.
using Felt = std::vector<double> (*)(const LoadCurve& load);

std::vector<double> sizes_of(const std::vector<Vec3>& felt) {
    std::vector<double> sizes;
    for (const Vec3& v : felt) sizes.push_back(v.norm());
    return sizes;
}
std::vector<double> force_of(const LoadCurve& load) { return sizes_of(load.force); }
std::vector<double> torque_of(const LoadCurve& load) {
    std::vector<double> sizes = load.axis ? load.axial_torque : sizes_of(load.torque);
    for (double& size : sizes) size = std::abs(size);
    return sizes;
}

double most_of(const StageCurves& curves, Felt felt) {
    double most = 0;
    for (const LoadCurve& load : curves.load()) {
        for (double size : felt(load)) most = std::max(most, size);
    }
    return most;
}

// One graph of what is felt, for every load that ever feels any; empty when none does.
std::string graph(const StageCurves& curves, const std::string& label, Felt felt) {
    const PlotAxis axis = plot_axis(curves);
    std::string program;
    std::vector<std::string> plots;
    for (std::size_t n = 0; n < curves.load().size(); ++n) {
        const LoadCurve& load = curves.load()[n];
        const std::vector<double> size = felt(load);
        // What is not known is left out.
        const auto is_drawn = [](double s) { return !std::isnan(s); };
        if (std::none_of(size.begin(), size.end(), [](double s) { return s > 0; })) continue;
        program += fmt::format("$load{} << EOD\n", n);
        for (std::size_t row = 0; row < curves.rows(); ++row) {
            if (!is_drawn(size[row])) continue;
            program += fmt::format("{:.9g} {:.9g}\n", axis.value[row], size[row]);
        }
        program += "EOD\n";
        const bool is_line = std::count_if(size.begin(), size.end(), is_drawn) > 1;
        plots.push_back(fmt::format("$load{} using 1:2 with {} linetype {} linewidth 2 title {}", n,
                                    is_line ? "lines" : "points", n + 1, quoted(load.name)));
    }
    if (plots.empty()) return {};
    return program + "set ylabel " + quoted(label) + "\n" + "plot " + joined(plots, ", \\\n     ") +
           "\n";
}

// Writes the SVG whole. What kept it from that; empty: nothing, or somebody who asked the process
// to end.
std::string draw_plot(const fs::path& program, const fs::path& svg) {
    const fs::path temporary = temporary_for(svg);
    std::string why;
    std::error_code error;
    try {
        // -d: without what the user has set for other plots.
        PipedProgram gnuplot({"gnuplot", "-d", "-e",
                              "set output " + quoted(fs::absolute(temporary).string()),
                              fs::absolute(program).string()});
        const int status = gnuplot.finish_within(kLongest);
        if (status == 0 && fs::exists(temporary, error)) {
            publish(temporary, svg);
            fs::remove(program, error);
            return {};
        }
        why = status == 128 + SIGKILL ? fmt::format("it was killed after at most {} s", kLongest)
                                      : gnuplot.last_error_line();
    } catch (const Error& failure) {
        why = failure.what();
    }
    fs::remove(temporary, error);
    if (asked_to_stop() != 0) return {};
    return fmt::format("{}: gnuplot could not draw it: {}", svg.string(), why);
}

}  // namespace

std::string plot_program(const StageCurves& curves, double size) {
    const double most_force = most_of(curves, force_of) * size;
    const double most_torque = most_of(curves, torque_of);
    std::string force, torque;
    if (most_force > kLever * most_torque) {
        force = graph(curves, "force on the matter [N]", force_of);
    }
    if (most_torque > kLever * most_force) {
        torque = graph(curves, "torque about the axis of its turn, or its centre [N m]", torque_of);
    }
    const int panels = !force.empty() + !torque.empty();
    std::string program = fmt::format(
        "set terminal svg size 900,{} noenhanced font 'sans-serif,14' background '#ffffff'\n"
        "set grid linecolor '#dddddd'\nset border linecolor '#444444'\n"
        "set key top left\nset yrange [0:*]\nset xlabel {}\n",
        panels == 2 ? 900 : 500, quoted(plot_axis(curves).label));
    const std::string title = quoted(curves.stage() + ": loads on the matter");
    if (panels == 2) {
        program += "set multiplot layout 2,1 title " + title + "\n";
    } else {
        program += "set title " + title + "\n";
    }
    program += force + torque;
    if (panels == 0) program += "set yrange [0:1]\nplot [0:1] 0 title 'no load'\n";
    if (panels == 2) program += "unset multiplot\n";
    return program + "set output\n";
}

fs::path plot_program_of(const fs::path& csv) { return fs::path(csv).replace_extension(".gp"); }

Plots::Plots(fs::path folder, std::vector<std::string> names)
    : folder_(std::move(folder)), names_(std::move(names)) {}

bool Plots::has_undrawn() const {
    std::error_code unknown;
    return std::any_of(names_.begin(), names_.end(), [&](const std::string& name) {
        return fs::exists(folder_ / (name + ".gp"), unknown);
    });
}

void Plots::forget_from(std::size_t table) const {
    std::error_code unknown;
    for (std::size_t n = table; n < names_.size(); ++n) {
        fs::remove(folder_ / (names_[n] + ".gp"), unknown);
    }
}

void Plots::draw() {
    std::error_code unknown;
    for (const std::string& name : names_) {
        const fs::path program = folder_ / (name + ".gp");
        if (asked_to_stop() != 0) return;
        if (missed_ || tried_.count(name) > 0 || !fs::exists(program, unknown)) continue;
        if (!program_exists("gnuplot")) {
            missed_ = true;
            tell(
                "gnuplot was not found, so the curves are not plotted (apt-get install "
                "gnuplot-nox; swage run then draws what is missing)");
            return;
        }
        tried_.insert(name);
        std::string why = draw_plot(program, folder_ / (name + ".svg"));
        if (!why.empty()) tell(std::move(why));
    }
}

void Plots::tell(std::string warning) {
    log_warning("{}", warning);
    warnings_.push_back(std::move(warning));
}

}  // namespace swage
