// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/usd_machine.h"

#include <algorithm>

#include "geometry/usd_mesh.h"
#include "geometry/usd_time.h"

namespace swage {

namespace {

void write(UsdText& out, const MachineTracks::Machine& machine, int first_frame,
           const std::vector<std::string>& look) {
    const std::vector<char>& is_seen = machine.is_seen;
    if (std::find(is_seen.begin(), is_seen.end(), 0) != is_seen.end()) {
        out.value(
            "token visibility", "", changes(is_seen, first_frame, Between::held), [&](int frame) {
                out.word(is_seen[std::size_t(frame - first_frame)] ? "inherited" : "invisible");
            });
    }
    std::set<std::string> taken;
    for (const MachineTracks::Part& part : machine.part) {
        const std::string& name = part.drawn.name;
        out.open(usd_prim("Mesh", name, usd_identifier(name, taken), kUsdBinds));
        write_usd_surface(out, part.drawn.surface, part.drawn.color);
        out.line(fmt::format("rel material:binding = <{}>", look.at(std::size_t(part.look))));
        write_usd_poses(out, machine.first, part.pose);
        out.close();
    }
}

}  // namespace

void write_usd_machines(UsdText& out, const MachineTracks& machines,
                        const std::vector<StageFrames>& stages,
                        const std::vector<std::string>& look) {
    if (machines.count() == 0) return;
    out.open("def Scope \"machine\"");
    std::set<std::string> taken;
    for (const MachineTracks::Machine& machine : machines.all()) {
        if (machine.part.empty()) continue;
        const std::string name = stage_of_machine(stages, machine.id, machine.first);
        out.open(usd_prim("Scope", name, usd_identifier(name, taken)));
        write(out, machine, machines.frames().first, look);
        out.close();
    }
    out.close();
}

}  // namespace swage
