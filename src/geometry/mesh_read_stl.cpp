// SPDX-License-Identifier: GPL-3.0-or-later
// What assimp 5.2 takes an STL file wrongly for is set right before it reads it: which of the two
// forms it has, what follows its last facet, words in capitals; text that breaks off or has other
// facets than triangles is refused.
#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "geometry/mesh_read_child.h"
#include "geometry/text_scan.h"

namespace swage {

namespace {

constexpr std::size_t kStlHead = 84, kStlFacet = 50;  // bytes of a binary STL file

// Of a binary STL file as it counts its facets; nothing where it is text.
std::optional<std::uint64_t> binary_stl_size(const std::string& bytes) {
    if (bytes.size() < kStlHead) return std::nullopt;
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + 80, 4);
    const std::uint64_t size = kStlHead + std::uint64_t{kStlFacet} * count;
    const bool is_text = lower(bytes.substr(0, 5)) == "solid" && size != bytes.size() &&
                         bytes.find('\0') == std::string::npos;
    return is_text ? std::nullopt : std::optional(size);
}

// assimp takes any file that begins with "solid" for text unless its size is right to the byte.
void settle_binary_stl(MeshSource& source, std::uint64_t size) {
    if (size > source.bytes.size()) return;  // it breaks off: assimp says so
    if (const std::uint64_t more = source.bytes.size() - size; more > 0)
        source.finding.push_back(
            fmt::format("{} byte{} after its last facet left out", more, more == 1 ? "" : "s"));
    source.bytes.resize(size);
    if (lower(source.bytes.substr(0, 5)) == "solid") source.bytes.replace(0, 5, "     ");
}

// assimp knows words in small letters only, and takes facets of four vertices and files that break
// off.
void settle_text_stl(std::string& bytes) {
    std::size_t facet_vertices = 3, facets = 0;
    std::string_view text = bytes, line;
    const auto check = [&] {
        if (facet_vertices != 3)
            fail(ExitCode::mesh, "facet {} has {} vertices", facets, facet_vertices);
    };
    while (next_line(text, line)) {
        const auto begin = static_cast<std::size_t>(line.data() - bytes.data());
        const std::size_t whole = line.size();
        const std::string key = lower(std::string(next_word(line)));
        // The name of a solid stays as it is.
        const std::size_t words = key.ends_with("solid") ? whole - line.size() : whole;
        const std::string low = lower(bytes.substr(begin, words));
        if (key == "facet") {
            check();
            ++facets;
            facet_vertices = 0;
        } else if (key == "vertex") {
            ++facet_vertices;
            for (int k = 0; k < 3; ++k) {
                double value = 0;
                const std::string_view word = next_word(line);
                if (!to_number(word, value))
                    fail(ExitCode::mesh, "facet {}: '{}' is not a number", facets,
                         word.substr(0, 40));
            }
        }
        std::copy(low.begin(), low.end(), bytes.begin() + static_cast<std::ptrdiff_t>(begin));
    }
    check();
}

}  // namespace

void patch_stl(MeshSource& source) {
    if (const auto size = binary_stl_size(source.bytes)) {
        settle_binary_stl(source, *size);
    } else {
        settle_text_stl(source.bytes);
    }
}

}  // namespace swage
