// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/glb_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <stdexcept>

#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "pipeline/json.h"
#include "pipeline/run_identity.h"

namespace swage {

namespace {

static_assert(std::endian::native == std::endian::little, "as numbers stand in such a file");

constexpr std::uint32_t kGlb = 0x46546c67, kVersion2 = 2, kJson = 0x4e4f534a, kBinary = 0x004e4942;
constexpr std::size_t kHeader = 12, kChunkHeader = 8;
constexpr double kMostBytes = 4294967295.0;  // lengths are numbers of 32 bits
constexpr int kFloat = 5126, kUnsigned = 5125;
constexpr const char* kTypes[] = {"SCALAR", "VEC2", "VEC3", "VEC4"};
constexpr std::string_view kBegin = R"({"asset":{"generator":"swage)";

std::size_t padded(std::size_t bytes) { return (bytes + 3) / 4 * 4; }

template <typename T>
std::string as_bytes(std::span<const T> numbers) {
    std::string bytes(numbers.size_bytes(), '\0');
    if (!bytes.empty()) std::memcpy(bytes.data(), numbers.data(), bytes.size());
    return bytes;
}

std::string words(std::initializer_list<std::uint32_t> values) {
    return as_bytes(std::span<const std::uint32_t>(values.begin(), values.size()));
}

}  // namespace

bool is_our_glb(std::string_view bytes) {
    constexpr std::size_t kHead = kHeader + kChunkHeader;
    return bytes.substr(0, 4) == "glTF" && bytes.size() > kHead &&
           bytes.substr(kHead).starts_with(kBegin);
}

std::string glb_bytes(std::span<const float> numbers) { return as_bytes(numbers); }

GlbFile::GlbFile() : document_(std::make_unique<Json>()) {
    *document_ = {
        {"asset", {{"generator", fmt::format("swage {}", kVersion)}, {"version", "2.0"}}}};
}

GlbFile::~GlbFile() = default;

Json& GlbFile::document() { return *document_; }

int GlbFile::add_view(std::size_t bytes, Use use, Fill fill) {
    Json view = {{"buffer", 0}, {"byteOffset", std::uint64_t(bytes_)}, {"byteLength", bytes}};
    if (use != Use::other) view["target"] = static_cast<int>(use);
    Json& views = (*document_)["bufferViews"];
    views.push_back(std::move(view));
    part_.emplace_back(bytes, std::move(fill));
    bytes_ += static_cast<double>(padded(bytes));
    return static_cast<int>(views.size()) - 1;
}

int GlbFile::add_accessor(int view, std::size_t offset, const GlbFloats& floats) {
    Json accessor = {{"bufferView", view},
                     {"byteOffset", offset},
                     {"componentType", kFloat},
                     {"count", floats.count},
                     {"type", kTypes[floats.width - 1]}};
    if (!floats.low.empty()) accessor["min"] = floats.low, accessor["max"] = floats.high;
    Json& accessors = (*document_)["accessors"];
    accessors.push_back(std::move(accessor));
    return static_cast<int>(accessors.size()) - 1;
}

std::vector<int> GlbFile::add(const std::vector<GlbFloats>& floats, Use use, const Fill& fill) {
    const auto size_of = [](const GlbFloats& one) {
        return one.count * std::size_t(one.width) * sizeof(float);
    };
    std::size_t bytes = 0;
    for (const GlbFloats& one : floats) bytes += size_of(one);
    const int view = add_view(bytes, use, fill);
    if (floats.size() > 1) {
        (*document_)["bufferViews"].back()["byteStride"] =
            std::size_t(floats[0].width) * sizeof(float);
    }
    std::vector<int> accessor;
    std::size_t offset = 0;
    for (const GlbFloats& one : floats) {
        accessor.push_back(add_accessor(view, offset, one));
        offset += size_of(one);
    }
    return accessor;
}

int GlbFile::add_numbers(std::span<const float> numbers, int width, Use use) {
    GlbFloats floats{numbers.size() / std::size_t(width), width};
    for (int c = 0; use == Use::other && c < width; ++c) {  // animation asks for times'
        floats.low.push_back(numbers[std::size_t(c)]), floats.high.push_back(floats.low.back());
        for (std::size_t n = std::size_t(c); n < numbers.size(); n += std::size_t(width)) {
            floats.low.back() = std::min(floats.low.back(), numbers[n]);
            floats.high.back() = std::max(floats.high.back(), numbers[n]);
        }
    }
    return add({floats}, use, [bytes = glb_bytes(numbers)] { return bytes; })[0];
}

int GlbFile::add_times(const std::vector<float>& times) {
    const auto known = times_.find(times);
    if (known != times_.end()) return known->second;
    return times_[times] = add_numbers(times, 1);
}

int GlbFile::add_indices(std::vector<std::uint32_t> indices) {
    const std::size_t count = indices.size();
    const int view = add_view(count * sizeof(std::uint32_t), Use::indices,
                              [all = std::move(indices)] { return as_bytes(std::span(all)); });
    Json& accessors = (*document_)["accessors"];
    accessors.push_back({{"bufferView", view},
                         {"byteOffset", 0},
                         {"componentType", kUnsigned},
                         {"count", count},
                         {"type", "SCALAR"}});
    return static_cast<int>(accessors.size()) - 1;
}

int GlbFile::add_image(std::string bytes, std::string_view media_type) {
    const std::size_t size = bytes.size();
    const int view = add_view(size, Use::other, [all = std::move(bytes)] { return all; });
    Json& images = (*document_)["images"];
    images.push_back({{"bufferView", view}, {"mimeType", media_type}});
    Json& textures = (*document_)["textures"];
    textures.push_back({{"source", images.size() - 1}});
    return static_cast<int>(textures.size()) - 1;
}

void GlbFile::write(const std::filesystem::path& file) {
    if (bytes_ > 0) (*document_)["buffers"] = {{{"byteLength", std::uint64_t(bytes_)}}};
    std::string text = document_->dump(-1, ' ', false, Json::error_handler_t::replace);
    text.resize(padded(text.size()), ' ');
    const double binary = bytes_ > 0 ? bytes_ + double(kChunkHeader) : 0;
    const double all = double(kHeader + kChunkHeader + text.size()) + binary;
    if (all > kMostBytes) {
        fail(ExitCode::resources,
             "{}: would take {}, and a .glb holds 4 GiB at most: it must be fewer --frames, or a "
             ".usda",
             file.string(), bytes_text(all));
    }
    WholeFile out(file);
    out.put(words({kGlb, kVersion2, static_cast<std::uint32_t>(all)}));
    out.put(words({static_cast<std::uint32_t>(text.size()), kJson}));
    out.put(text);
    if (bytes_ > 0) out.put(words({static_cast<std::uint32_t>(bytes_), kBinary}));
    for (const auto& [size, fill] : part_) {
        std::string bytes = fill();
        if (bytes.size() != size) throw std::logic_error("a part of a .glb has another length");
        bytes.resize(padded(size), '\0');
        out.put(bytes);
    }
    out.finish();
}

}  // namespace swage
