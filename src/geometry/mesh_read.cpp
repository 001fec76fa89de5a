// SPDX-License-Identifier: GPL-3.0-or-later
// The outer side of reading a mesh: checks the file, runs the reader in a child process under
// limits, checks what it hands back.
#include "geometry/mesh_read.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cctype>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <new>
#include <optional>
#include <stdexcept>
#include <utility>

#include "base/error.h"
#include "base/file_contents.h"
#include "base/interrupt.h"
#include "base/log.h"
#include "base/math.h"
#include "base/memory.h"
#include "base/process.h"
#include "geometry/mesh_check.h"
#include "geometry/mesh_numbered.h"
#include "geometry/mesh_read_child.h"

namespace swage {

namespace fs = std::filesystem;

namespace {

// The first byte of what the child sends; a mesh or a sentence follows.
constexpr char kMeshFollows = 'M', kReasonFollows = 'E';
constexpr int kOutOfMemory = 3;  // exit status of the child

// Sanitizers deadlock when the limit on address space leaves no room for their own report.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true;
#else
constexpr bool kSanitized = false;
#endif

std::optional<MeshFormat> format_of(const fs::path& file) {
    std::string ending = file.extension().string();
    for (char& c : ending) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    for (std::size_t n = 0; n < std::size(kMeshEnding); ++n) {
        if (ending == std::string(".") + kMeshEnding[n]) return static_cast<MeshFormat>(n);
    }
    return std::nullopt;
}

const char* kind_of(mode_t mode) {
    if (S_ISDIR(mode)) return "a directory";
    if (S_ISFIFO(mode)) return "a pipe";
    if (S_ISSOCK(mode)) return "a socket";
    return "a device";
}

// Opens regular files only, and never waits for anybody.
FileHandle open_checked(const fs::path& file, const ReadLimits& limits) {
    FileHandle handle(::open(file.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC | O_NOCTTY));
    if (handle.id() < 0) fail(ExitCode::mesh, "{}: {}", file.string(), std::strerror(errno));
    struct stat status {};
    if (::fstat(handle.id(), &status) != 0)
        fail(ExitCode::mesh, "{}: {}", file.string(), std::strerror(errno));
    if (!S_ISREG(status.st_mode))
        fail(ExitCode::mesh, "{}: this is {}, not a mesh file", file.string(),
             kind_of(status.st_mode));
    if (status.st_size == 0) fail(ExitCode::mesh, "{}: the file is empty", file.string());
    if (static_cast<std::uint64_t>(status.st_size) > limits.file_bytes)
        fail(ExitCode::mesh, "{}: {:.1f} MiB is more than the limit of {:.1f} MiB", file.string(),
             status.st_size / 1048576.0, static_cast<double>(limits.file_bytes) / 1048576.0);
    return handle;
}

void send_all(int pipe, std::string_view bytes) {
    while (!bytes.empty()) {
        const ssize_t sent = ::write(pipe, bytes.data(), bytes.size());
        if (sent < 0 && errno == EINTR) continue;
        if (sent <= 0) ::_exit(1);
        bytes.remove_prefix(static_cast<std::size_t>(sent));
    }
}

void set_limit(__rlimit_resource what, std::uint64_t value) {
    const rlimit limit = {value, value};
    ::setrlimit(what, &limit);
}

// The child holds nothing but its pipe, its file and its limits. It was forked without exec: a
// library has no program of its own to start. In a process with threads that is sound as long as
// the child stays clear of locks that another thread may hold: it logs nothing, starts no parallel
// loop, never returns; the heap is made safe for forks by glibc.
[[noreturn]] void run_child(MeshSource& source, int pipe, int file, const ReadLimits& limits,
                            std::uint64_t memory_limit, pid_t parent) {
    become_child(parent);
    for (const int signal :
         {SIGINT, SIGTERM, SIGHUP, SIGSEGV, SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGXCPU, SIGPIPE})
        std::signal(signal, SIG_DFL);
    const int nothing = ::open("/dev/null", O_RDWR);
    for (const int standard : {0, 1, 2})
        if (standard != pipe && standard != file) ::dup2(nothing, standard);
    const unsigned low = static_cast<unsigned>(std::min(pipe, file));
    const unsigned high = static_cast<unsigned>(std::max(pipe, file));
    if (low > 3) ::close_range(3, low - 1, 0);
    if (high > low + 1) ::close_range(std::max(3u, low + 1), high - 1, 0);
    ::close_range(std::max(3u, high + 1), ~0u, 0);
    set_limit(RLIMIT_CPU, static_cast<std::uint64_t>(std::max(1, limits.cpu_seconds)));
    if (!kSanitized) set_limit(RLIMIT_AS, memory_limit);
    try {
        std::string bytes;
        try {
            std::string why;
            std::optional<std::string> contents = rest_of_file(file, limits.file_bytes, why);
            if (!contents) fail(ExitCode::mesh, "{}", why);
            source.bytes = std::move(*contents);
            const RawMesh mesh = read_raw(source);
            check_raw(mesh);
            bytes = kMeshFollows + to_bytes(mesh);
        } catch (const std::bad_alloc&) {
            throw;
        } catch (const std::length_error&) {
            throw std::bad_alloc();
        } catch (const std::exception& error) {
            bytes = kReasonFollows + std::string(error.what());
        }
        send_all(pipe, bytes);
    } catch (...) {
        ::_exit(kOutOfMemory);
    }
    ::_exit(0);
}

// Everything the child sends until it closes the pipe; false when time or room runs out, or when
// somebody asks to stop.
bool receive(int pipe, const ReadLimits& limits, std::string& bytes, bool& too_large) {
    using Clock = std::chrono::steady_clock;
    const auto deadline = Clock::now() + std::chrono::seconds(std::max(1, limits.wall_seconds));
    constexpr std::size_t kBlock = 1 << 20;
    std::size_t have = 0;
    for (;;) {
        const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - Clock::now());
        if (left.count() <= 0 || asked_to_stop() != 0) return false;
        pollfd wait = {pipe, POLLIN, 0};
        const int ready =
            ::poll(&wait, 1, static_cast<int>(std::min<long long>(left.count(), 1000)));
        if (ready < 0 && errno != EINTR) return false;
        if (ready <= 0) continue;
        if (bytes.size() < have + kBlock) bytes.resize(std::max(2 * bytes.size(), have + kBlock));
        const ssize_t got = ::read(pipe, bytes.data() + have, bytes.size() - have);
        if (got < 0 && errno != EINTR) return false;
        if (got == 0) break;
        if (got > 0) have += static_cast<std::size_t>(got);
        too_large = have > limits.memory_bytes;
        if (too_large) return false;
    }
    bytes.resize(have);
    return true;
}

// What `make` has of the mesh as its file holds it.
template <typename Make>
TriMesh read_with(const fs::path& file, const ReadLimits& limits, bool looks, const Make& make) {
    const std::string name = file.string();
    if (name.find('\0') != std::string::npos || file.empty())
        fail(ExitCode::mesh, "a mesh file needs a name");
    const FileHandle opened = open_checked(file, limits);
    const std::optional<MeshFormat> format = format_of(file);
    if (!format)
        fail(ExitCode::mesh, "{}: '{}' is not a mesh format that can be read ({})", name,
             file.extension().string(), kMeshKinds);
    MeshSource source;
    source.format = *format;
    source.file = fs::absolute(file).lexically_normal();
    source.file_bytes = limits.file_bytes;
    source.memory_bytes = limits.memory_bytes;
    source.looks = looks;

    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0)
        fail(ExitCode::resources, "{}: cannot open a pipe to read it: {}", name,
             std::strerror(errno));
    const FileHandle from_child(ends[0]);
    FileHandle to_parent(ends[1]);
    const std::uint64_t memory_limit = address_space_in_use() + limits.memory_bytes;
    const pid_t parent = ::getpid();
    expect_children();
    const pid_t child = ::fork();
    if (child < 0)
        fail(ExitCode::resources, "{}: cannot start a process to read it: {}", name,
             std::strerror(errno));
    if (child == 0) run_child(source, to_parent.id(), opened.id(), limits, memory_limit, parent);
    to_parent.close();
    std::string bytes;
    bool too_large = false, in_time = false;
    try {
        in_time = receive(from_child.id(), limits, bytes, too_large);
    } catch (const std::bad_alloc&) {
        too_large = true;
    }
    if (!in_time) ::kill(child, SIGKILL);
    const std::optional<int> ended = wait_for(child);
    if (!ended)
        fail(ExitCode::resources, "{}: cannot tell how its reader ended: {}", name,
             std::strerror(errno));
    throw_if_interrupted();  // which a terminal tells the reader too
    const int outcome = *ended;
    const double limit_gib = static_cast<double>(limits.memory_bytes) / (1 << 30);
    if (too_large || (WIFEXITED(outcome) && WEXITSTATUS(outcome) == kOutOfMemory))
        fail(ExitCode::mesh, "{}: reading it takes more than the {:.3g} GiB allowed", name,
             limit_gib);
    if (!in_time)
        fail(ExitCode::mesh, "{}: reading it takes more than the {} s allowed", name,
             limits.wall_seconds);
    if (WIFSIGNALED(outcome)) {
        const int signal = WTERMSIG(outcome);
        if (signal == SIGXCPU || (signal == SIGKILL && bytes.empty()))
            fail(ExitCode::mesh,
                 "{}: reading it takes more than the {} s of processor time allowed", name,
                 limits.cpu_seconds);
        fail(ExitCode::mesh, "{}: the file is damaged: its reader crashed ({})", name,
             ::strsignal(signal));
    }
    if (bytes.empty() || (bytes[0] != kMeshFollows && bytes[0] != kReasonFollows))
        fail(ExitCode::mesh, "{}: the file is damaged: its reader ended without a message", name);
    const std::string_view body = std::string_view(bytes).substr(1);
    if (bytes[0] == kReasonFollows) fail(ExitCode::mesh, "{}: {}", name, body);
    try {
        RawMesh raw = from_bytes(body);
        bytes = {};
        check_raw(raw);
        return make(raw);
    } catch (const Error& error) {
        fail(ExitCode::mesh, "{}: {}", name, error.what());
    }
}

}  // namespace

bool is_mesh_file_name(const fs::path& file) { return format_of(file).has_value(); }

bool keeps_numbers_beside(const fs::path& file) { return format_of(file) == MeshFormat::gltf; }

bool goes_by_crease_angle(const fs::path& file) {
    TriMesh smooth;
    const TriMesh sharp = read_with(file, {}, false, [&](RawMesh& raw) {
        RawMesh same = raw;
        smooth = weld(same, kPi);
        return weld(raw, 0);
    });
    return sharp.triangle_smooth != smooth.triangle_smooth || !check_mesh(sharp).is_one_body();
}

TriMesh read_mesh(const fs::path& file, const ReadLimits& limits, std::vector<std::string>* finding,
                  double crease_angle, bool looks) {
    return read_with(file, limits, looks, [&](RawMesh& raw) {
        TriMesh mesh = weld(raw, crease_angle);
        if (finding != nullptr) {
            finding->insert(finding->end(), raw.finding.begin(), raw.finding.end());
        } else {
            for (const std::string& text : raw.finding) log_warning("{}: {}", file.string(), text);
        }
        return mesh;
    });
}

TriMesh read_as_numbered(const fs::path& file) {
    return read_with(file, {}, false, [](RawMesh& raw) {
        TriMesh mesh;
        mesh.position = std::move(raw.position);
        mesh.triangle = std::move(raw.triangle);
        return mesh;
    });
}

}  // namespace swage
