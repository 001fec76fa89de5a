// SPDX-License-Identifier: GPL-3.0-or-later
#include "pipeline/stage_record.h"

#include <algorithm>
#include <numeric>

#include "base/hash.h"
#include "geometry/mesh_objects.h"
#include "pipeline/given_record.h"
#include "pipeline/json.h"
#include "pipeline/machine_place.h"
#include "skin/skin_pieces.h"

namespace swage {

namespace {

Json parameters_json(const Machine& machine) {
    Json json = Json::object();
    for (const ParameterSpec& spec : machine.spec.parameter) {
        json[spec.name] = {{"value", machine.parameter.at(spec.name)},
                           {"unit", si_unit(spec.quantity)}};
    }
    return json;
}

Json peaks_json(const StageCurves& curves) {
    Json json = Json::object();
    for (const LoadPeaks& peaks : peaks_of(curves)) {
        json[peaks.name] = {{"force_N", peaks.force.size},     {"force_frame", peaks.force.frame},
                            {"torque_N_m", peaks.torque.size}, {"torque_frame", peaks.torque.frame},
                            {"stroke_m", peaks.stroke},        {"turn_rad", peaks.turn}};
        if (!peaks.axial) continue;
        json[peaks.name]["torque_about_axis_N_m"] = peaks.axial->size;
        json[peaks.name]["torque_about_axis_frame"] = peaks.axial->frame;
    }
    return json;
}

Json energies_json(const Books& books) {
    Json json = Json::object();
    for (const BookSide side : {BookSide::given, BookSide::held, BookSide::passed, BookSide::taken,
                                BookSide::remaining}) {
        for (const BookEntry& entry : kBookEntries) {
            if (entry.side != side) continue;
            json[entry.key] = books.*entry.value;
            if (entry.at_start == nullptr) continue;
            json[std::string(entry.key) + "_at_start"] = books.*entry.at_start;
        }
    }
    return json;
}

// Of each body whose pieces its OBJ has as objects, in their order: a triangle of each shell of a
// piece in its skin, the largest shell first.
Json skin_pieces_json(const std::vector<WorkPiece>& bodies) {
    Json json = Json::object();
    for (const WorkPiece& body : bodies) {
        const std::vector<int> piece = skin_pieces(body.skin, body.mount, body.matter);
        if (objects_of_pieces(body.skin, piece, body.label).triangle.empty()) continue;
        const Components shells = surface_components(body.skin);
        const std::vector<double> volume = component_volumes(body.skin, shells);
        std::vector<int> order(volume.size()), triangle(volume.size(), -1);
        std::iota(order.begin(), order.end(), 0);
        std::stable_sort(order.begin(), order.end(),
                         [&](int a, int b) { return volume[a] > volume[b]; });
        for (std::size_t t = piece.size(); t-- > 0;) {
            triangle[shells.triangle_component[t]] = static_cast<int>(t);
        }
        std::vector<std::vector<int>> told;
        for (const int shell : order) {
            const auto own = static_cast<std::size_t>(piece[triangle[shell]]);
            told.resize(std::max(told.size(), own + 1));
            told[own].push_back(triangle[shell]);
        }
        json[body.name] = told;
    }
    return json;
}

}  // namespace

std::size_t particle_count(const std::vector<WorkPiece>& bodies) {
    std::size_t count = 0;
    for (const WorkPiece& body : bodies) count += body.matter.particle_count();
    return count;
}

std::size_t connection_count(const std::vector<WorkPiece>& bodies) {
    std::size_t count = 0;
    for (const WorkPiece& body : bodies) count += body.matter.connection_count();
    return count;
}

int piece_count(const std::vector<WorkPiece>& bodies) {
    int count = 0;
    for (const WorkPiece& body : bodies) count += find_pieces(body.matter).count;
    return count;
}

Json stage_record(const StageEnd& end, const StageCurves& curves, double overlap,
                  const std::vector<std::string>& warnings) {
    const StageTotals& totals = end.totals;
    const Expression& strength = end.machine.spec.gravity_strength;  // of gravity; null: 1
    const FrameReport& last = end.last;
    Json probes = Json::object(), probe_fields = Json::object();
    for (const ProbePlace& probe : end.probes) {
        probes[probe.name] = {probe.place.x(), probe.place.y(), probe.place.z()};
        for (std::size_t f = 0; f < probe.field.size(); ++f) {
            const SkinFieldWords& words = words_of(probe.field[f]);
            const std::string unit = *words.unit == 0 ? "" : fmt::format("_{}", words.unit);
            probe_fields[probe.name][words.name + unit] = probe.value[f];
        }
    }
    Json by_body = Json::array();
    Json masses = Json::object();
    for (const WorkPiece& body : end.bodies) masses[body.name] = body.matter.mass();
    for (const Books& books : last.body) by_body.push_back(energies_json(books));
    return {
        {"name", end.stage.name},
        {"machine", end.stage.machine.name},
        {"parameters", parameters_json(end.machine)},
        {"axes", axes_json(end.machine.frame)},
        {"loads", loads_json(end.machine)},
        {"gravity_strength", strength.empty() ? Json(nullptr) : Json(strength.text)},
        {"frames", {end.first_frame, end.last_frame}},
        {"legs", end.legs},
        {"duration_s", end.stage.duration},
        {"remolded", end.stage.remold},
        {"masses_kg", masses},
        {"volumes_m3", volumes_json(end.bodies, end.volumes_before)},
        {"particles", particle_count(end.bodies)},
        {"connections_before", end.connections_before},
        {"connections_after", connection_count(end.bodies)},
        {"severed", totals.severed},
        {"broken", totals.broken},
        {"pieces", last.pieces},
        {"skin_pieces", skin_pieces_json(end.bodies)},
        {"iterations", totals.iterations},
        {"increments", totals.increments},
        {"halvings", totals.halvings},
        {"solver", name_of(end.stage.sim.solver)},
        {"settings", settings_json(end.stage.sim)},
        {"steps", totals.steps},
        {"steps_implicit_instead", totals.rescued},
        {"steps_rejected", totals.rejected},
        {"bodies_asleep", last.asleep},
        {"shortest_step_s", totals.shortest_step},
        {"largest_residual", totals.residual},
        {"deepest_penetration_m", totals.penetration},
        {"own_overlap_m", overlap},
        {"peaks", peaks_json(curves)},
        {"probes_m", probes},
        {"probe_fields", probe_fields},
        {"energies_J", energies_json(last)},
        {"energies_by_body_J", by_body},
        {"notes", end.machine.notes},
        {"warnings", warnings},
        {"state_hash", hash_text(state_hash(end.bodies))},
    };
}

}  // namespace swage
