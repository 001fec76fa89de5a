// SPDX-License-Identifier: GPL-3.0-or-later
// What assimp 5.2 takes an STL file wrongly for is set right before it reads it: which of the two
// forms it has, what follows its last facet, words in capitals, blank lines before the first; text
// that breaks off, has other facets than triangles or other words than an STL file's is refused.
#include <algorithm>
#include <cstring>

#include "base/error.h"
#include "geometry/mesh_read_child.h"
#include "geometry/text_scan.h"

namespace swage {

namespace {

constexpr std::size_t kStlHead = 84, kStlFacet = 50;  // bytes of a binary STL file

bool is_white(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r' || c == '\f'; }

// Text with nothing before its first word, words in small letters.
class StlText {
  public:
    explicit StlText(std::string& bytes) : bytes_(bytes) {}

    // The corners of its facets, in their order.
    std::vector<Vec3> settle() {
        do {
            expect("solid");
            skip_name();
            std::string_view word = next();
            for (; word == "facet"; word = next()) read_facet();
            if (word != "endsolid") refuse(word, "endsolid");
            skip_name();
        } while (skip_white());
        return std::move(corner_);
    }

  private:
    void read_facet() {
        ++facets_;
        expect("normal");
        read_numbers();
        expect("outer");
        expect("loop");
        int vertices = 0;
        std::string_view word = next();
        for (; word == "vertex"; word = next()) {
            corner_.push_back(read_numbers());
            ++vertices;
        }
        if (word != "endloop") refuse(word, "endloop");
        if (vertices != 3) fail(ExitCode::mesh, "facet {} has {} vertices", facets_, vertices);
        expect("endfacet");
    }

    Vec3 read_numbers() {
        Vec3 numbers;
        for (double& value : numbers) {
            const std::string_view word = next();
            if (word.empty()) refuse(word, "a number");
            if (!to_number(word, value))
                fail(ExitCode::mesh, "facet {}: '{}' is not a number", facets_, word.substr(0, 40));
        }
        return numbers;
    }

    void expect(const char* what) {
        if (const std::string_view word = next(); word != what) refuse(word, what);
    }

    [[noreturn]] void refuse(std::string_view word, const char* what) const {
        if (word.empty())
            fail(ExitCode::mesh, "it ends after facet {}, where {} was expected", facets_, what);
        const auto end = bytes_.begin() + static_cast<std::ptrdiff_t>(at_);
        fail(ExitCode::mesh, "line {}: '{}' where {} was expected",
             1 + std::count(bytes_.begin(), end, '\n'), word.substr(0, 40), what);
    }

    // False at the end.
    bool skip_white() {
        while (at_ < bytes_.size() && is_white(bytes_[at_])) ++at_;
        return at_ < bytes_.size();
    }

    // Empty at the end.
    std::string_view next() {
        skip_white();
        const std::size_t begin = at_;
        for (; at_ < bytes_.size() && !is_white(bytes_[at_]); ++at_)
            bytes_[at_] = static_cast<char>(std::tolower(static_cast<unsigned char>(bytes_[at_])));
        return std::string_view(bytes_).substr(begin, at_ - begin);
    }

    // To the line's end. Of a name assimp takes the first word, others for the file's own.
    void skip_name() {
        std::string_view name = std::string_view(bytes_).substr(at_);
        const std::size_t line = std::min(name.find_first_of("\r\n"), name.size());
        name = name.substr(0, line);
        const std::size_t whole = name.size();
        next_word(name);
        std::fill_n(bytes_.begin() + static_cast<std::ptrdiff_t>(at_ + whole - name.size()),
                    name.size(), ' ');
        at_ += line;
    }

    std::string& bytes_;
    std::size_t at_ = 0;
    std::size_t facets_ = 0;
    std::vector<Vec3> corner_;
};

// Of a binary STL file as it counts its facets; nothing where it is text, whose first bytes hold
// no zero: the last of a count is one.
std::optional<std::uint64_t> binary_stl_size(const std::string& bytes, bool says_solid) {
    if (bytes.size() < kStlHead) return std::nullopt;
    std::uint32_t count = 0;
    std::memcpy(&count, bytes.data() + 80, 4);
    const std::uint64_t size = kStlHead + std::uint64_t{kStlFacet} * count;
    const bool is_text = says_solid && size != bytes.size() && bytes.find('\0') >= kStlHead;
    return is_text ? std::nullopt : std::optional(size);
}

// assimp takes any file that begins with "solid" for text unless its size is right to the byte.
void settle_binary_stl(MeshSource& source, std::uint64_t size) {
    std::string& bytes = source.bytes;
    if (size > bytes.size())
        fail(ExitCode::mesh,
             "it is not text beginning with 'solid', and as a binary file it is cut short: its {} "
             "facets take {} bytes, it has {}",
             (size - kStlHead) / kStlFacet, size, bytes.size());
    if (const std::uint64_t more = bytes.size() - size; more > 0)
        source.finding.push_back(
            fmt::format("{} byte{} after its last facet left out", more, more == 1 ? "" : "s"));
    bytes.resize(size);
}

}  // namespace

std::vector<Vec3> patch_stl(MeshSource& source) {
    std::string& bytes = source.bytes;
    std::size_t begin = bytes.starts_with("\xef\xbb\xbf") ? 3 : 0;
    while (begin < bytes.size() && is_white(bytes[begin])) ++begin;
    const bool says_solid = lower(bytes.substr(begin, 5)) == "solid";
    if (const auto size = binary_stl_size(bytes, says_solid)) {
        settle_binary_stl(source, *size);
        if (says_solid) bytes.replace(begin, 5, "     ");
        return {};
    }
    bytes.resize(bytes.find_last_not_of('\0') + 1);  // what pads it
    bytes.erase(0, std::min(begin, bytes.size()));
    return StlText(bytes).settle();
}

}  // namespace swage
