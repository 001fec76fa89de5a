// SPDX-License-Identifier: GPL-3.0-or-later
#include "base/memory.h"

#include <cmath>
#include <fstream>

#include "tests/catch.h"
#include "tests/shared/scratch.h"

using namespace swage;

namespace {

// What Linux shows, of a machine of our own.
class Shown {
  public:
    explicit Shown(const std::string& groups) {
        put("proc/meminfo", "MemTotal: 16000000 kB\nMemFree: 1 kB\nMemAvailable: 8000000 kB\n");
        put("proc/self/cgroup", groups);
    }
    void put(const std::string& name, const std::string& text) const {
        const std::filesystem::path file = root() / name;
        std::filesystem::create_directories(file.parent_path());
        std::ofstream(file) << text;
    }
    const std::filesystem::path& root() const { return scratch_.path(); }

  private:
    Scratch scratch_;
};

}  // namespace

TEST_CASE("without a group that limits it the machine's memory is all and free") {
    const Shown shown("0::/user.slice\n");
    shown.put("sys/fs/cgroup/user.slice/memory.max", "max\n");
    shown.put("sys/fs/cgroup/user.slice/memory.current", "9000000000000\n");
    CHECK(whole_memory(shown.root()) == 16000000 * 1024.0);
    CHECK(free_memory(shown.root()) == 8000000 * 1024.0);
}

TEST_CASE("the least limit counts of all groups that a process is in") {
    const Shown shown("1:name=systemd:/else\n0::/out/in/own\n");
    const std::string top = "sys/fs/cgroup/";
    shown.put(top + "out/memory.max", "5000000000\n");
    shown.put(top + "out/memory.current", "4500000000\n");
    shown.put(top + "out/in/memory.max", "max\n");
    shown.put(top + "out/in/own/memory.max", "3000000000\n");
    shown.put(top + "out/in/own/memory.current", "1000000000\n");
    shown.put(top + "else/memory.max", "1\n");
    CHECK(whole_memory(shown.root()) == 3e9);
    CHECK(free_memory(shown.root()) == 0.5e9);
    // Files that a group keeps in memory are let go of.
    shown.put(top + "out/memory.stat", "anon 7\ninactive_file 4000000000\nactive_file 0\n");
    CHECK(free_memory(shown.root()) == 2e9);
    shown.put(top + "memory.max", "2500000000\n");
    CHECK(whole_memory(shown.root()) == 2.5e9);
    shown.put(top + "memory.current", "9000000000\n");
    CHECK(free_memory(shown.root()) == 0);
}

TEST_CASE("limits of the older groups count, also where a container hides its own name") {
    const Shown shown("5:devices:/box\n4:cpuset,memory:/box/a:b\n0::/\n");
    const std::string top = "sys/fs/cgroup/memory/";
    shown.put(top + "memory.limit_in_bytes", "9223372036854771712\n");
    shown.put(top + "box/a:b/memory.limit_in_bytes", "2000000000\n");
    shown.put(top + "box/a:b/memory.usage_in_bytes", "1500000000\n");
    shown.put(top + "box/a:b/memory.stat",
              "inactive_file 7\ntotal_inactive_file 250000000\ntotal_active_file 250000000\n");
    CHECK(whole_memory(shown.root()) == 2e9);
    CHECK(free_memory(shown.root()) == 1e9);
    shown.put("proc/self/cgroup", "4:memory:/docker/0123\n");
    shown.put(top + "memory.limit_in_bytes", "1000000000\n");
    CHECK(whole_memory(shown.root()) == 1e9);
}

TEST_CASE("this machine has memory, some of it is free, and this process has addresses") {
    CHECK(free_memory() > 0);
    CHECK(free_memory() <= whole_memory());
    CHECK(std::isfinite(whole_memory()));
    CHECK(address_space_in_use() > 1 << 20);
}
