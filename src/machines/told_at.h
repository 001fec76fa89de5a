// SPDX-License-Identifier: GPL-3.0-or-later
// Values of a machine's expressions, with whose they are where they have none.
#pragma once

#include <fmt/format.h>

#include <string>

#include "base/text_error.h"
#include "machines/machine_spec.h"
#include "machines/motion.h"

namespace swage {

// What `value` gives; where an expression in it has none, with whose it is and when.
template <typename Value>
auto told_at(const std::string& whose, double t, const Value& value) {
    try {
        return value();
    } catch (const PlacedError& error) {
        throw PlacedError(error.place(),
                          fmt::format("{} at t = {:.4g}: {}", whose, t, error.what()));
    }
}

inline Pose pose_at(const Motion& motion, const std::string& whose, double t, double stop = 1) {
    return told_at("the motion of " + whose, t, [&] { return motion.at(t, stop); });
}

// What `act` gives; where it refuses, with whose machine it is.
template <typename Act>
auto naming(const MachineSpec& spec, const Act& act) {
    try {
        return act();
    } catch (const PlacedError& error) {
        throw PlacedError(error.place(), fmt::format("machine {}: {}", spec.name, error.what()),
                          error.code());
    }
}

}  // namespace swage
