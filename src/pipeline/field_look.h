// SPDX-License-Identifier: GPL-3.0-or-later
// Bodies coloured by a field of their matter, from a run's motion file.
#pragma once

#include <array>

#include "pipeline/frame_store.h"
#include "render/color_map.h"
#include "render/image.h"
#include "render/settings.h"

namespace swage {

class FieldLook {
  public:
    // By settings.color, which is there. Throws Error(command_line) when the run holds no such
    // field. Its range is that of all frames, where the settings say none.
    FieldLook(const FrameStore& store, const RenderSettings& settings);

    const std::array<double, 2>& range() const { return range_; }
    // Whether anything in any frame lies below it, and above.
    std::array<bool, 2> beyond() const;
    // Colours a skin by the body's field now, whatever it looked like.
    void dress(const StoredBody& body, TriMesh& skin) const;
    bool add_legend(Image& image) const;

  private:
    ColorScale scale() const;

    SkinField field_;
    std::size_t number_ = 0;  // among the file's
    std::array<double, 2> extent_{}, range_{};
    SurfaceMaterial look_;
};

}  // namespace swage
