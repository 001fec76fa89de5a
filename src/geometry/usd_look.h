// SPDX-License-Identifier: GPL-3.0-or-later
// Materials of meshes as USD has them: each a UsdPreviewSurface, with the image that it has beside
// the file.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "geometry/polygon.h"
#include "geometry/trimesh.h"
#include "geometry/usd_text.h"

namespace swage {

class UsdLooks {
  public:
    // Which look each polygon has, -1 for none; new ones are added. What has an image but no place
    // in it, or colours at its vertices, is a look of its own; an image is multiplied with the
    // colour that all vertices have.
    std::vector<int> of_polygons(const TriMesh& mesh, const PolygonCorners& polygons);
    // The look of a material without an image.
    int of_plain(SurfaceMaterial material) { return number_of(std::move(material), false); }

    std::size_t count() const { return look_.size(); }
    const std::string& identifier(int look) const { return look_.at(std::size_t(look)).identifier; }
    const SurfaceMaterial& material(int look) const { return look_.at(std::size_t(look)).material; }
    std::vector<SurfaceMaterial> materials() const;
    // Names of those whose image should be multiplied with colours of vertices that differ, which
    // UsdPreviewSurface does not: without these.
    const std::set<std::string>& without_colors() const { return without_colors_; }
    // The prims, at `path`; `image`: the name of the file of each, empty for none.
    void write(UsdText& out, const std::string& path, const std::vector<std::string>& image) const;

  private:
    struct Look {
        SurfaceMaterial material;
        bool reads_colors;  // of the vertices
        std::string identifier;
    };
    int number_of(SurfaceMaterial material, bool reads_colors);

    std::vector<Look> look_;
    std::set<std::string> taken_, without_colors_;
};

}  // namespace swage
