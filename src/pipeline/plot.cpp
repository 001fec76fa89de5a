// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <csignal>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/process.h"
#include "base/text.h"

namespace swage {

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

double most_of(const StageCurves& curves, std::vector<Vec3> LoadCurve::*felt) {
    double most = 0;
    for (const LoadCurve& load : curves.load()) {
        for (const Vec3& v : load.*felt) most = std::max(most, v.norm());
    }
    return most;
}

// One graph of what is felt, for every load that ever feels any; empty when none does.
std::string graph(const StageCurves& curves, const std::string& label,
                  std::vector<Vec3> LoadCurve::*felt) {
    const PlotAxis axis = plot_axis(curves);
    std::vector<std::string> lines;
    for (std::size_t n = 0; n < curves.load().size(); ++n) {
        const LoadCurve& load = curves.load()[n];
        if (std::all_of((load.*felt).begin(), (load.*felt).end(),
                        [](const Vec3& v) { return v.isZero(0); })) {
            continue;
        }
        std::string data = fmt::format("$load{} << EOD\n", n);
        for (std::size_t row = 0; row < curves.rows(); ++row) {
            data += fmt::format("{:.9g} {:.9g}\n", axis.value[row], (load.*felt)[row].norm());
        }
        lines.push_back(data + "EOD\n");
        lines.push_back(fmt::format("$load{} using 1:2 with lines linetype {} linewidth 2 title {}",
                                    n, n + 1, quoted(load.name)));
    }
    if (lines.empty()) return {};
    std::string program;
    std::vector<std::string> plots;
    for (std::size_t n = 0; n < lines.size(); n += 2) {
        program += lines[n];
        plots.push_back(lines[n + 1]);
    }
    return program + "set ylabel " + quoted(label) + "\n" + "plot " + joined(plots, ", \\\n     ") +
           "\n";
}

}  // namespace

StagePlot plot_of(const StageCurves& curves, double size) {
    const double most_force = most_of(curves, &LoadCurve::force) * size;
    const double most_torque = most_of(curves, &LoadCurve::torque);
    std::string force, torque;
    if (most_force > kLever * most_torque) {
        force = graph(curves, "force on the matter [N]", &LoadCurve::force);
    }
    if (most_torque > kLever * most_force) {
        torque = graph(curves, "torque about the tool's centre [N m]", &LoadCurve::torque);
    }
    const int panels = !force.empty() + !torque.empty();
    std::string program = fmt::format(
        "set terminal svg size 900,{} noenhanced font 'sans-serif,14' background '#ffffff'\n"
        "set grid linecolor '#dddddd'\nset border linecolor '#444444'\n"
        "set key top left\nset yrange [0:*]\nset xlabel {}\n",
        panels == 2 ? 900 : 500, quoted(plot_axis(curves).label));
    const std::string title = quoted(curves.stage() + ": what the matter felt");
    if (panels == 2) {
        program += "set multiplot layout 2,1 title " + title + "\n";
    } else {
        program += "set title " + title + "\n";
    }
    program += force + torque;
    if (panels == 0) program += "set yrange [0:1]\nplot [0:1] 0 title 'nothing was felt'\n";
    if (panels == 2) program += "unset multiplot\n";
    return {curves.stage(), program + "set output\n"};
}

bool gnuplot_is_present() { return program_exists("gnuplot"); }

std::string draw_plot(const StagePlot& plot, const std::filesystem::path& svg) {
    const std::filesystem::path temporary = temporary_for(svg);
    // In a file: a pipe that is not read would hold us up.
    const std::filesystem::path program = std::filesystem::path(temporary).concat(".gp");
    std::string why;
    std::error_code error;
    try {
        write_file_whole(program, "set output " + quoted(temporary.string()) + "\n" + plot.program);
        // -d: without what the user has set for other plots.
        PipedProgram gnuplot({"gnuplot", "-d", std::filesystem::absolute(program).string()});
        const int status = gnuplot.finish_within(kLongest);
        std::filesystem::remove(program, error);
        if (status == 0 && std::filesystem::exists(temporary, error)) {
            publish(temporary, svg);
            return {};
        }
        why = status == 128 + SIGKILL ? fmt::format("it was killed, after {} s at most", kLongest)
                                      : gnuplot.last_error_line();
    } catch (const Error& failure) {
        why = failure.what();
    }
    std::filesystem::remove(temporary, error);
    std::filesystem::remove(program, error);
    if (asked_to_stop() != 0) return {};
    why = fmt::format("{}: gnuplot could not draw it: {}", svg.string(), why);
    log_warning("{}", why);
    return why;
}

}  // namespace swage
