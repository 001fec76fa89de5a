// SPDX-License-Identifier: GPL-3.0-or-later
// The looks of what is exported: its materials, each once.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "geometry/polygon.h"
#include "geometry/trimesh.h"

namespace swage {

bool has_image(const SurfaceMaterial& material);
std::string name_of(const SurfaceMaterial& material);  // "material" where it has none

class MeshLooks {
  public:
    struct Look {
        SurfaceMaterial material;
        bool reads_colors;  // of the vertices
    };

    // Whether the file's images are multiplied with colours of vertices.
    explicit MeshLooks(bool images_take_colors) : images_take_colors_(images_take_colors) {}

    // Which look each polygon has, -1 for none; new ones are added. What has an image but no place
    // in it, or colours at its vertices, is a look of its own. Where images take no colours they
    // are multiplied with that which all vertices have.
    std::vector<int> of_polygons(const TriMesh& mesh, const PolygonCorners& polygons);
    int of_plain(SurfaceMaterial material, bool reads_colors = false) {
        return number_of(std::move(material), reads_colors);
    }

    const std::vector<Look>& all() const { return look_; }
    std::vector<SurfaceMaterial> materials() const;
    // Names of those whose image is without colours of vertices that differ.
    const std::set<std::string>& without_colors() const { return without_colors_; }

  private:
    int number_of(SurfaceMaterial material, bool reads_colors);

    bool images_take_colors_;
    std::vector<Look> look_;
    std::set<std::string> without_colors_;
};

}  // namespace swage
