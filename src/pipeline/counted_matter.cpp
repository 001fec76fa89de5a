// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/counted_matter.h"

#include <algorithm>
#include <cmath>

#include "base/portable_math.h"
#include "mold/prepare.h"
#include "pipeline/folded_bodies.h"
#include "pipeline/probes.h"
#include "sim/advance.h"

namespace swage {

namespace {

constexpr double kWhole = 0.01;  // of a layer of cells: less is as good as whole

// The number of cells to which those bodies that have more come down.
double level_of(const std::vector<MoldEstimate>& estimate, double most) {
    std::vector<double> cells;
    for (const MoldEstimate& one : estimate) cells.push_back(one.active_cells);
    std::sort(cells.begin(), cells.end());
    for (std::size_t b = 0; b < cells.size(); ++b) {
        const double share = most / static_cast<double>(cells.size() - b);
        if (cells[b] > share) return share;
        most -= cells[b];
    }
    return cells.back();
}

}  // namespace

bool CountedMatter::is_whole() const {
    return std::all_of(coarser.begin(), coarser.end(), [](double c) { return c == 1; });
}

double CountedMatter::steps_per_second(std::size_t body, const StageSpec& stage) const {
    const bool is_cut = !stage.machine.blade.empty();
    return explicit_steps_per_second(matter[body], stage.sim, is_cut) * coarser[body];
}

std::vector<NamedMatter> CountedMatter::named(const SceneSpec& scene,
                                              const std::vector<InputMesh>& input) const {
    std::vector<NamedMatter> named;
    for (std::size_t b = 0; b < matter.size(); ++b) {
        const BodySpec& body = scene.body[b];
        const bool is_mesh = scene.skin.kind != SkinKind::boundary;
        const TriMesh& shown = is_mesh ? input[b].mesh : input[b].to_mold();
        named.push_back({body.name, &matter[b], box_at_start(body.start, input[b].to_mold(), shown),
                         coarser[b]});
    }
    return named;
}

std::vector<double> coarser_by(const std::vector<MoldEstimate>& estimate,
                               const std::vector<double>& across, double most) {
    const double level = level_of(estimate, most);
    std::vector<double> coarser;
    for (std::size_t b = 0; b < estimate.size(); ++b) {
        const double cells = estimate[b].active_cells, layers = across[b];
        if (cells <= level || layers <= 1) {
            coarser.push_back(1);
            continue;
        }
        double left = std::max(1.0, layers / portable::pow(cells / level, 1. / 3));
        if (std::abs(layers - std::round(layers)) < kWhole) left = std::floor(left);
        coarser.push_back(layers / left);
    }
    return coarser;
}

CountedMatter make_matter(const SceneSpec& scene, const std::vector<InputMesh>& input,
                          const std::vector<MoldEstimate>& estimate,
                          const std::vector<double>& coarser, std::vector<std::string>& warning) {
    CountedMatter made;
    made.coarser = coarser;
    made.inset.resize(input.size());
    std::vector<std::vector<std::string>> found;
    for (std::size_t b = 0; b < input.size(); ++b) {
        BodySpec body = scene.body[b];
        if (coarser[b] > 1) {
            body.mold.across.reset();
            body.mold.spacing = coarser[b] * estimate[b].spacing;
        }
        std::vector<std::string> findings;
        made.matter.push_back(mold_body(input[b], body, findings, &made.inset[b]));
        if (coarser[b] > 1) {
            findings.clear();
            const std::string gap = filled_gap_text(input[b].to_mold(), scene.body[b].mold);
            if (!gap.empty()) findings.push_back(gap);
        }
        found.push_back(std::move(findings));
        mount_probes(body, input[b].to_mold(), made.matter[b]);  // refuses those beside it
        place_at_start(body.start, input[b].to_mold(), made.matter[b]);
    }
    warning = folded_warnings(body_names(scene), found);
    return made;
}

MoldEstimate counted(const Aggregate& matter, const InputMesh& input, const MoldSettings& settings,
                     const MoldEstimate& estimate, double coarser) {
    MoldEstimate told = estimate;
    told.active_cells = static_cast<double>(matter.cell_fill.size());
    told.particles = static_cast<double>(matter.particle_count());
    told.connections = static_cast<double>(matter.connection_count());
    told.bytes = static_cast<double>(matter.bytes());
    if (coarser == 1) return told;
    MoldSettings coarse = settings;
    coarse.across.reset();
    coarse.spacing = coarser * estimate.spacing;
    const MoldEstimate of = estimate_mold(input.to_mold(), coarse);
    told.active_cells *= estimate.active_cells / of.active_cells;
    told.particles *= estimate.particles / of.particles;
    told.connections *= estimate.connections / of.connections;
    told.bytes *= estimate.bytes / of.bytes;
    return told;
}

}  // namespace swage
