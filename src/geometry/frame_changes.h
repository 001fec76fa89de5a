// SPDX-License-Identifier: GPL-3.0-or-later
// What changes over the frames, for files whose readers go straight from one sample to the next:
// what stays has a second sample before it changes.
#pragma once

#include <vector>

#include "base/math.h"

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

// Of poses their turns as quaternions x, y, z, w. Between two a reader takes the shorter way, of
// signs that differ not all do: these do not.
std::vector<Eigen::Vector4f> steady_turns(const std::vector<Pose>& of_frame);

}  // namespace swage
