// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/failure.h"

#include <filesystem>
#include <new>
#include <string_view>
#include <system_error>

namespace swage {

namespace {

// A thread that could not be started; TBB has no type for it.
bool is_want_of_threads(const std::exception& error) {
    const auto* system = dynamic_cast<const std::system_error*>(&error);
    return system != nullptr ? system->code() == std::errc::resource_unavailable_try_again
                             : std::string_view(error.what()).starts_with("pthread_create");
}

}  // namespace

std::optional<Error> failure_of(const std::exception& error) {
    if (const auto* known = dynamic_cast<const Error*>(&error)) return *known;
    if (dynamic_cast<const std::bad_alloc*>(&error) != nullptr) {
        return Error(ExitCode::resources, "not enough memory; a larger [mold] spacing needs less");
    }
    if (const auto* file = dynamic_cast<const std::filesystem::filesystem_error*>(&error)) {
        return Error(ExitCode::output,
                     fmt::format("{}: {}", file->path1().string(), file->code().message()));
    }
    if (is_want_of_threads(error)) {
        return Error(ExitCode::resources,
                     "not enough memory, or no permission, for so many threads; --threads 1 needs "
                     "the least");
    }
    return std::nullopt;
}

}  // namespace swage
