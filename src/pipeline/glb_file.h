// SPDX-License-Identifier: GPL-3.0-or-later
// Binary glTF 2.0 (Khronos, "glTF 2.0 Specification", section 4.4): a document, and behind it the
// numbers and images that it tells of. These are put together as the file is written, piece by
// piece, so that no more than one is held at once.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pipeline/json_name.h"

namespace swage {

// What such a file begins with, up to the name of what wrote it; `bytes`: its first ones.
bool is_our_glb(std::string_view bytes);

// A document's array of floats, with its bounds by component, which some must tell.
struct GlbFloats {
    std::size_t count;  // of vectors
    int width;          // of each: 1, 2, 3 or 4
    std::vector<float> low = {}, high = {};
};

class GlbFile {
  public:
    using Fill = std::function<std::string()>;
    enum class Use { other = 0, vertices = 34962, indices = 34963 };

    GlbFile();
    ~GlbFile();

    // Numbers of accessors. Those of `floats`, vectors of one width, stand one behind the other in
    // what `fill` makes.
    std::vector<int> add(const std::vector<GlbFloats>& floats, Use use, const Fill& fill);
    int add_numbers(std::span<const float> numbers, int width, Use use = Use::other);
    int add_times(const std::vector<float>& times);  // [s]; once for all that have the same
    int add_indices(std::vector<std::uint32_t> indices);
    int add_image(std::string bytes, std::string_view media_type);  // the texture of it

    Json& document();
    double bytes() const { return bytes_; }  // but for the document
    // Throws Error(output), and Error(resources) where it is more than such a file can hold.
    void write(const std::filesystem::path& file);

  private:
    int add_view(std::size_t bytes, Use use, Fill fill);
    int add_accessor(int view, std::size_t offset, const GlbFloats& floats);

    std::unique_ptr<Json> document_;
    std::vector<std::pair<std::size_t, Fill>> part_;  // bytes, and what makes them
    std::map<std::vector<float>, int> times_;
    double bytes_ = 0;
};

// As bytes of such a file.
std::string glb_bytes(std::span<const float> numbers);

}  // namespace swage
