// SPDX-License-Identifier: GPL-3.0-or-later
// Whether a canvas can be had, and drawn on as is asked, found out in a process of its own: a
// driver that crashes, or that the environment names and that is not there, takes nothing with it.
#pragma once

#include "render/settings.h"

namespace swage {

// Throws Error(output) where there would be none, or none for pictures of that size.
void try_canvas(const RenderSettings& settings, int threads);

}  // namespace swage
