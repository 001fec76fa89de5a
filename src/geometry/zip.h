// SPDX-License-Identifier: GPL-3.0-or-later
// The files within a ZIP file. Source: APPNOTE.TXT of the ZIP format, 6.3.
#pragma once

#include <cstdint>
#include <map>
#include <string>

namespace swage {

class Zip {
  public:
    // `limit`: of what one file within may hold. Throws Error(mesh), as all here does.
    Zip(std::string& bytes, std::uint64_t limit);

    std::string contents(const std::string& name) const;
    // In the bytes that it was made of; everything else stays where it is in them. Once only.
    void replace(const std::string& name, const std::string& contents);

  private:
    struct Entry {
        std::size_t begin = 0, end = 0;  // in the directory
        int method = 0;
        std::uint32_t crc = 0;
        std::uint64_t packed = 0, size = 0, place = 0;
    };
    // Sizes and places beyond 32 bits.
    void take_large(Entry& entry, std::size_t at, std::size_t size) const;

    std::string& bytes_;
    std::uint64_t limit_;
    std::size_t directory_ = 0;
    std::map<std::string, Entry> entry_;
};

}  // namespace swage
