// SPDX-License-Identifier: GPL-3.0-or-later
#include "geometry/zip.h"

#include <libdeflate.h>

#include <cstring>
#include <memory>
#include <new>
#include <string_view>

#include "base/error.h"

namespace swage {

namespace {

template <typename T>
T number_at(std::string_view bytes, std::size_t at) {
    T number{};
    if (at > bytes.size() || sizeof number > bytes.size() - at)
        fail(ExitCode::mesh, "its ZIP directory is damaged");
    std::memcpy(&number, bytes.data() + at, sizeof number);
    return number;
}

template <typename T>
void put(std::string& bytes, std::uint64_t value) {
    const auto number = static_cast<T>(value);
    bytes.append(reinterpret_cast<const char*>(&number), sizeof number);
}

}  // namespace

void Zip::take_large(Entry& entry, std::size_t at, std::size_t size) const {
    for (const std::size_t end = at + size; at + 4 <= end;) {
        const auto kind = number_at<std::uint16_t>(bytes_, at);
        const auto length = number_at<std::uint16_t>(bytes_, at + 2);
        at += 4;
        if (kind == 1) {
            std::size_t next = at;
            for (std::uint64_t* value : {&entry.size, &entry.packed, &entry.place}) {
                if (*value != 0xffffffff) continue;
                *value = number_at<std::uint64_t>(bytes_, next);
                next += 8;
            }
        }
        at += length;
    }
}

Zip::Zip(std::string& bytes, std::uint64_t limit) : bytes_(bytes), limit_(limit) {
    constexpr std::size_t kEnd = 22;  // without its comment
    std::size_t end = bytes.rfind("PK\5\6");
    if (end == std::string::npos || bytes.size() - end < kEnd)
        fail(ExitCode::mesh, "it is no ZIP file, or breaks off");
    directory_ = number_at<std::uint32_t>(bytes_, end + 16);
    std::uint64_t count = number_at<std::uint16_t>(bytes_, end + 10);
    // What does not fit stands in a larger record.
    if (end >= 20 && bytes.compare(end - 20, 4, "PK\6\7") == 0) {
        const auto large = number_at<std::uint64_t>(bytes_, end - 20 + 8);
        count = number_at<std::uint64_t>(bytes_, large + 32);
        directory_ = number_at<std::uint64_t>(bytes_, large + 48);
    }
    std::size_t at = directory_;
    for (std::uint64_t n = 0; n < count; ++n) {
        if (number_at<std::uint32_t>(bytes_, at) != 0x02014b50)
            fail(ExitCode::mesh, "its ZIP directory is damaged");
        Entry entry;
        const std::size_t name_size = number_at<std::uint16_t>(bytes_, at + 28);
        const std::size_t extra_size = number_at<std::uint16_t>(bytes_, at + 30);
        entry.begin = at;
        entry.end = at + 46 + name_size + extra_size + number_at<std::uint16_t>(bytes_, at + 32);
        number_at<char>(bytes_, entry.end);  // the end of the directory follows
        entry.method = number_at<std::uint16_t>(bytes_, at + 10);
        entry.crc = number_at<std::uint32_t>(bytes_, at + 16);
        entry.packed = number_at<std::uint32_t>(bytes_, at + 20);
        entry.size = number_at<std::uint32_t>(bytes_, at + 24);
        entry.place = number_at<std::uint32_t>(bytes_, at + 42);
        take_large(entry, at + 46 + name_size, extra_size);
        entry_[bytes.substr(at + 46, name_size)] = entry;
        at = entry.end;
    }
}

std::string Zip::contents(const std::string& name) const {
    const auto found = entry_.find(name);
    if (found == entry_.end()) fail(ExitCode::mesh, "its part '{}' is missing", name);
    const Entry& entry = found->second;
    const std::size_t begin = entry.place + 30 +
                              number_at<std::uint16_t>(bytes_, entry.place + 26) +
                              number_at<std::uint16_t>(bytes_, entry.place + 28);
    if (begin > bytes_.size() || entry.packed > bytes_.size() - begin)
        fail(ExitCode::mesh, "its part '{}' breaks off", name);
    if (entry.size > limit_)
        fail(ExitCode::mesh, "its part '{}' is larger than a file may be", name);
    if (entry.method != 0 && entry.method != 8)
        fail(ExitCode::mesh, "its part '{}' is packed in a way that cannot be read ({})", name,
             entry.method);
    std::string contents;
    bool is_whole = true;
    if (entry.method == 0) {
        contents = bytes_.substr(begin, entry.packed);
    } else {
        contents.resize(entry.size);
        const std::unique_ptr<libdeflate_decompressor, void (*)(libdeflate_decompressor*)> unpacker(
            libdeflate_alloc_decompressor(), libdeflate_free_decompressor);
        if (!unpacker) throw std::bad_alloc();
        std::size_t size = 0;
        is_whole = libdeflate_deflate_decompress(unpacker.get(), bytes_.data() + begin,
                                                 entry.packed, contents.data(), contents.size(),
                                                 &size) == LIBDEFLATE_SUCCESS &&
                   size == contents.size();
    }
    if (!is_whole || libdeflate_crc32(0, contents.data(), contents.size()) != entry.crc)
        fail(ExitCode::mesh, "its part '{}' is damaged", name);
    return contents;
}

void Zip::replace(const std::string& name, const std::string& contents) {
    std::string directory, out = bytes_.substr(0, directory_);
    std::string common;  // of the head before the part and the one in the directory
    put<std::uint16_t>(common, 20);
    common.append(4, '\0');  // as it is, no flags
    put<std::uint32_t>(common, 0x21);
    put<std::uint32_t>(common, libdeflate_crc32(0, contents.data(), contents.size()));
    put<std::uint32_t>(common, contents.size());
    put<std::uint32_t>(common, contents.size());
    put<std::uint16_t>(common, name.size());
    common.append(2, '\0');
    for (const auto& [one, entry] : entry_) {
        if (one != name) {
            directory += bytes_.substr(entry.begin, entry.end - entry.begin);
            continue;
        }
        put<std::uint32_t>(directory, 0x02014b50);
        put<std::uint16_t>(directory, 20);
        directory += common + std::string(10, '\0');
        put<std::uint32_t>(directory, out.size());
        directory += name;
    }
    put<std::uint32_t>(out, 0x04034b50);
    out += common + name + contents;
    const std::size_t begin = out.size();
    out += directory;
    if (out.size() > 0xffffffff || entry_.size() > 0xffff)
        fail(ExitCode::mesh, "it is larger than a ZIP file may be");
    out.append("PK\5\6\0\0\0\0", 8);
    put<std::uint16_t>(out, entry_.size());
    put<std::uint16_t>(out, entry_.size());
    put<std::uint32_t>(out, directory.size());
    put<std::uint32_t>(out, begin);
    out.append(2, '\0');
    bytes_ = std::move(out);
}

}  // namespace swage
