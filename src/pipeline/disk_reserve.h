// SPDX-License-Identifier: GPL-3.0-or-later
// Room on a disk, held while large files are written, for small ones that have to be written after
// them however full it has become.
#pragma once

#include <cstdint>
#include <filesystem>

namespace swage {

class DiskReserve {
  public:
    DiskReserve() = default;
    ~DiskReserve() { release(); }
    DiskReserve(const DiskReserve&) = delete;
    DiskReserve& operator=(const DiskReserve&) = delete;

    // By a hidden file in that folder; where there is no such room, none is held.
    void hold(const std::filesystem::path& folder, std::uint64_t bytes);
    void release();

  private:
    std::filesystem::path file_;  // empty: none is held
};

}  // namespace swage
