// SPDX-License-Identifier: GPL-3.0-or-later
// Connections that hold cracked matter by a thread which has been bent. Springs have no moment: a
// layer of particles hinges about the next without any work, and what hangs on it coils up, where
// brittle matter snaps. How far a connection has turned is how far it is, at either end, from where
// the others of that end have it:
//
//     t = |x_q - x_p - R_p X_pq| / |X_pq|,    R_p: the rotation next to sum_q (x_q - x_p) X_pq^T.
//
// In a layer one spacing thick that bends, t is the strain of the outer fibre.
#pragma once

#include <functional>
#include <vector>

#include "matter/aggregate.h"

namespace swage {

struct Hinge {
    int direction;  // of the connection, into kForward
    ParticleId lower;
};

// Connections between particles of `loose` (a flag each) that have turned by more than `most` of
// theirs and, over that, most of all at one of their ends, in the order of the lattice; no edges
// that are pressed.
std::vector<Hinge> find_hinges(const Aggregate& matter, const std::vector<char>& loose,
                               const std::function<double(const Hinge& connection)>& most);

}  // namespace swage
