// SPDX-License-Identifier: GPL-3.0-or-later
// How a drive moves from one equilibrium to the next, and what follows from how it moved before.
#pragma once

#include <string>
#include <vector>

#include "matter/aggregate.h"
#include "matter/drive.h"
#include "sim/resting_contacts.h"

namespace swage {

// The moves in which a drive's way is solved: none takes a tool or grip farther than one spacing.
// `every`: as ToolPairs has it.
int increments_between(const RestingContacts& contacts, const Aggregate& matter, const Drive& from,
                       const Drive& to, std::size_t every = 1);

// Six numbers for each tool, then each grip: its way, and its turn times `size` [m]. Then one for
// each load and for gravity: how much stronger it becomes, times `size`.
using DriveMotion = std::vector<double>;
DriveMotion motion_between(const Apparatus& apparatus, const Drive& from, const Drive& to,
                           double size);

// Where a move will end, from the one before.
class Foresight {
  public:
    // Goes on as in the move before, by at most `most` [m] along each axis. Nothing is foreseen
    // where the drive starts, stops or turns back.
    void go_on(const DriveMotion& motion, double most, Vec3Array& position) const;
    // A move is kept that began there.
    void keep(const Vec3Array& start, DriveMotion motion);
    void forget() { motion_.clear(); }

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(start_, motion_);
    }

  private:
    Vec3Array start_;
    DriveMotion motion_;  // empty: nothing to go on from
};

// Which tools bear on the work-piece, and which of them have lost it.
class SlipWatch {
  public:
    explicit SlipWatch(const Apparatus& apparatus);

    // Whether any tool moves otherwise than it did when it last pressed.
    bool draws_back(const DriveMotion& motion) const;
    // A move is kept: what tools bear at its end, and the work that each did in it [J]. A tool that
    // loses its load has lost the work-piece, unless `may_part`: it is added to `lost`.
    void keep(const std::vector<PartSum>& load, const std::vector<double>& work,
              const DriveMotion& motion, bool may_part, std::vector<std::string>& lost);
    // Any of them may have lost its load.
    void forget();

    template <typename Io>
    void visit(Io& io) {  // what steps change
        io(tool_);
    }

  private:
    struct Bearing {
        std::string name;
        double most = 0;       // that it has borne so far [N]
        bool carries = false;  // it is loaded, and has not drawn back since
        // When it last pressed: loaded, and working on the matter. Six numbers.
        DriveMotion pressing = DriveMotion(6, 0.0);

        template <typename Io>
        void visit(Io& io) {
            io(name, most, carries, pressing);
        }
    };
    std::vector<Bearing> tool_;
};

}  // namespace swage
