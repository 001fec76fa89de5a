// SPDX-License-Identifier: GPL-3.0-or-later
// Molding (S2.12, S2.16): a mesh becomes an aggregate that fills it.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "base/error.h"
#include "geometry/trimesh.h"
#include "matter/aggregate.h"

namespace swage {

enum class MoldKind { shape, block };

struct MoldSettings {
    MoldKind kind = MoldKind::shape;
    // One of the two. `across`: cells over the thinnest side of the box, 1 or more; start with 6.
    std::optional<int> across;
    std::optional<double> spacing;        // [m]
    std::size_t cell_limit = 50'000'000;  // of the box; more is refused with exit code 7
};

struct MoldEstimate {
    double spacing;       // [m]
    Vec3i cell_count;     // of the box
    double active_cells;  // about
    double particles;     // about
    double connections;   // about
    double bytes;         // about
};

double spacing_for(const TriMesh& mesh, const MoldSettings& settings);
MoldEstimate estimate_mold(const TriMesh& mesh, const MoldSettings& settings);

// Where the body is of another material: inside a closed surface, as far as that lies in the body.
// Of insets that overlap the last counts.
struct Inset {
    TriMesh solid;
    Material material;
};

// Of an inset that the body cannot have.
class InsetError : public Error {
  public:
    InsetError(std::size_t inset, const std::string& sentence)
        : Error(ExitCode::mesh, sentence), inset_(inset) {}
    std::size_t inset() const { return inset_; }  // its number, from 0

  private:
    std::size_t inset_;
};

// Of cells that are too large or too small for a mesh, or too many.
class FinenessError : public Error {
  public:
    FinenessError(ExitCode code, const std::string& sentence, bool is_limit = false)
        : Error(code, sentence), is_limit_(is_limit) {}
    bool is_limit() const { return is_limit_; }  // goes by `cell_limit` too

  private:
    bool is_limit_;
};

// Volume and mass equal the mesh's to 1e-6 at any spacing. Throws Error(mesh) when the mesh
// encloses nothing, InsetError, FinenessError. `told`: what is not as the mesh
// has it is added. `masses`: of each material [kg], of matter that is molded anew: densities give
// way to them, and insets may reach out of the body (mold/insets.h).
Aggregate mold(const TriMesh& mesh, const Material& material, const MoldSettings& settings,
               const std::vector<Inset>& insets = {}, std::vector<std::string>* told = nullptr,
               const std::vector<double>* masses = nullptr);

}  // namespace swage
