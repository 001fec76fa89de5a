// SPDX-License-Identifier: GPL-3.0-or-later
// What changes over the frames, in USD. Readers go straight from one sample of a float to the next
// where both are of one length: what stays has a second sample before it changes. Whole numbers and
// words they hold.
#pragma once

#include <vector>

#include "base/math.h"
#include "geometry/usd_text.h"

namespace swage {

// What readers make of the time between two samples.
enum class Between { held, straight };

// Times at which something is another than before; where readers go straight also those right
// before.
template <typename T>
std::vector<int> changes(const std::vector<T>& of_frame, int first, Between between) {
    std::vector<int> time = {first};
    for (std::size_t f = 1; f < of_frame.size(); ++f) {
        if (of_frame[f] == of_frame[f - 1]) continue;
        const int now = first + static_cast<int>(f);
        if (between == Between::straight && time.back() < now - 1) time.push_back(now - 1);
        time.push_back(now);
    }
    return time;
}

// Into a prim that is open: where it stands in each frame from the first on.
void write_usd_poses(UsdText& out, int first, const std::vector<Pose>& of_frame);

}  // namespace swage
