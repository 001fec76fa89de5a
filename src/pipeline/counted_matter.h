// SPDX-License-Identifier: GPL-3.0-or-later
// The matter of a scene, molded to be counted before a run is begun. What has very many cells is
// molded of larger ones and counted in their stead: how the machines stand at it, what they meet
// and how it breaks up into cells of all kinds is known then too, and numbers go by the size of
// the cells, without a step between what is counted and what is not.
#pragma once

#include <string>
#include <vector>

#include "mold/mold.h"
#include "pipeline/named_matter.h"
#include "pipeline/start_warnings.h"
#include "pipeline/work_piece.h"
#include "scene/spec.h"

namespace swage {

struct CountedMatter {
    std::vector<Aggregate> matter;  // of each body, where it is at its start
    std::vector<double> coarser;    // its spacing, over the one that is asked for: 1 or more
    std::vector<std::vector<TriMesh>> inset;  // of each body

    bool is_whole() const;  // none is coarser
    // At what is asked.
    double steps_per_second(std::size_t body, const StageSpec& stage) const;
    std::vector<NamedMatter> named(const SceneSpec& scene,
                                   const std::vector<InputMesh>& input) const;
};

// By how much, so that all bodies together have no more than about `most` cells: those of most
// cells are. Never so much that a body is less than a layer; whole layers stay whole.
// `estimate`: of each body at the spacing that is asked for.
std::vector<double> coarser_by(const std::vector<MoldEstimate>& estimate,
                               const std::vector<double>& across, double most);

// Throws as mold_body() and mount_probes(). `warning`: what is found as it is made, if that is at
// the spacing that is asked for; else of gaps alone, at that spacing.
CountedMatter make_matter(const SceneSpec& scene, const std::vector<InputMesh>& input,
                          const std::vector<MoldEstimate>& estimate,
                          const std::vector<double>& coarser, std::vector<std::string>& warning);

// What a body has at the spacing that is asked for: counted, or as its coarser matter has it, in
// the ratio in which estimates of both are.
MoldEstimate counted(const Aggregate& matter, const InputMesh& input, const MoldSettings& settings,
                     const MoldEstimate& estimate, double coarser);

}  // namespace swage
