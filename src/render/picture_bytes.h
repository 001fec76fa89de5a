// SPDX-License-Identifier: GPL-3.0-or-later
// What drawing takes of memory beside what is drawn, from the sizes of its targets and of what is
// on its way to files. Software renders into the process's own memory.
#pragma once

#include "render/settings.h"

namespace swage {

// Of all that is as large as a picture [byte]: targets, what is read back of one picture, and what
// is written of the one before it. `multisampled`: the surfaces are few enough for it.
double picture_bytes(const RenderSettings& settings, bool multisampled);

// Of a texture of so many pixels: what it is drawn with, and what else there is as it is read,
// which is before the first picture is drawn.
struct TextureBytes {
    double kept = 0, reading = 0;
};
TextureBytes texture_bytes(int width, int height);

}  // namespace swage
