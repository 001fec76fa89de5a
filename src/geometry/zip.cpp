// SPDX-License-Identifier: GPL-3.0-or-later
// The one file that sees libzip.
#include "geometry/zip.h"

#include <zip.h>

#include <memory>
#include <new>

#include "base/error.h"

namespace swage {

namespace {

[[noreturn]] void fail_by(zip_error_t* error, const std::string& what) {
    const int code = zip_error_code_zip(error);
    if (code == ZIP_ER_MEMORY) throw std::bad_alloc();
    if (code == ZIP_ER_OK) fail(ExitCode::mesh, "{}", what);
    fail(ExitCode::mesh, "{} ({})", what, zip_error_strerror(error));
}

struct Free {
    void operator()(zip_source_t* source) const { zip_source_free(source); }
    void operator()(zip_t* zip) const { zip_discard(zip); }
    void operator()(zip_file_t* file) const { zip_fclose(file); }
};

class Archive {
  public:
    explicit Archive(const std::string& bytes)  // which outlive it
        : source_(zip_source_buffer_create(bytes.data(), bytes.size(), 0, nullptr)) {
        if (!source_) throw std::bad_alloc();
        zip_error_t error;
        zip_error_init(&error);
        zip_.reset(zip_open_from_source(source_.get(), 0, &error));
        if (!zip_) fail_by(&error, "it is not a ZIP file, or is damaged");
        zip_source_keep(source_.get());  // the other hold on it is the archive's
    }

    zip_t* get() const { return zip_.get(); }

    std::uint64_t index_of(const std::string& name) const {
        const zip_int64_t index = zip_name_locate(get(), name.c_str(), ZIP_FL_ENC_RAW);
        if (index < 0) fail(ExitCode::mesh, "its part '{}' is missing", name);
        return static_cast<std::uint64_t>(index);
    }

    [[noreturn]] void fail_with(const std::string& what) const {
        fail_by(zip_get_error(get()), what);
    }

    // What the bytes become by the changes that were asked for.
    std::string written() {
        if (zip_close(get()) != 0) fail_with("it cannot be assembled");
        static_cast<void>(zip_.release());
        zip_stat_t whole;
        if (zip_source_open(source_.get()) != 0 || zip_source_stat(source_.get(), &whole) != 0)
            fail_by(zip_source_error(source_.get()), "it cannot be assembled");
        std::string bytes(whole.size, '\0');
        if (zip_source_read(source_.get(), bytes.data(), bytes.size()) !=
            static_cast<zip_int64_t>(bytes.size()))
            fail_by(zip_source_error(source_.get()), "it cannot be assembled");
        return bytes;
    }

  private:
    std::unique_ptr<zip_source_t, Free> source_;
    std::unique_ptr<zip_t, Free> zip_;
};

}  // namespace

std::string zip_contents(const std::string& zip, const std::string& name, std::uint64_t limit) {
    const Archive archive(zip);
    const std::uint64_t index = archive.index_of(name);
    zip_stat_t part;
    if (zip_stat_index(archive.get(), index, 0, &part) != 0)
        archive.fail_with(fmt::format("its part '{}' is damaged", name));
    if (part.size > limit) fail(ExitCode::mesh, "its part '{}' is larger than a file may be", name);
    if (part.comp_method != ZIP_CM_STORE && part.comp_method != ZIP_CM_DEFLATE)
        fail(ExitCode::mesh, "its part '{}' uses a compression that cannot be read ({})", name,
             part.comp_method);
    const std::unique_ptr<zip_file_t, Free> file(zip_fopen_index(archive.get(), index, 0));
    if (!file) archive.fail_with(fmt::format("its part '{}' cannot be unpacked", name));
    std::string contents(part.size, '\0');
    char beyond = 0;  // at the end the sum is checked
    if (zip_fread(file.get(), contents.data(), contents.size()) !=
            static_cast<zip_int64_t>(contents.size()) ||
        zip_fread(file.get(), &beyond, 1) != 0)
        fail_by(zip_file_get_error(file.get()), fmt::format("its part '{}' is damaged", name));
    return contents;
}

void replace_in_zip(std::string& zip, const std::string& name, const std::string& contents) {
    Archive archive(zip);
    const std::uint64_t index = archive.index_of(name);
    std::unique_ptr<zip_source_t, Free> part(
        zip_source_buffer(archive.get(), contents.data(), contents.size(), 0));
    if (!part || zip_file_replace(archive.get(), index, part.get(), 0) != 0)
        archive.fail_with("it cannot be assembled");
    static_cast<void>(part.release());  // it is the archive's
    if (zip_set_file_compression(archive.get(), index, ZIP_CM_STORE, 0) != 0)
        archive.fail_with("it cannot be assembled");
    zip = archive.written();
}

}  // namespace swage
