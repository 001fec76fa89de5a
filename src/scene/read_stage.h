// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "scene/find.h"
#include "scene/parameter_ranges.h"
#include "scene/spec.h"
#include "scene/table_reader.h"

namespace swage {

// Reads the [[stage]]s of one scene in their order; a machine file is read once.
class StageReader {
  public:
    // `scene`: all before its stages has been read.
    StageReader(Reading& reading, const AssetPaths& assets, std::filesystem::path scene_folder,
                const SceneSpec& scene);

    StageSpec read(const Node& node);

    // The machine files, and the meshes that they name.
    const std::vector<std::filesystem::path>& inputs() const { return inputs_; }

  private:
    struct Loaded {
        std::optional<MachineSpec> machine;
        std::optional<ParameterRanges> ranges;
    };

    const Loaded* find_machine(TableReader& table, std::string& name);
    const Loaded* load(const std::filesystem::path& file);
    // Whether all that are given can be.
    bool read_parameters(TableReader& table, const Loaded& loaded, StageSpec& stage);
    void repeat_parts(TableReader& table, const Loaded& loaded, StageSpec& stage);
    void read_loads(TableReader& table, StageSpec& stage);
    void name_stage(TableReader& table, StageSpec& stage);

    Reading& reading_;
    std::filesystem::path scene_folder_;
    const SceneSpec& scene_;
    std::vector<MachineFile> known_;
    std::vector<std::filesystem::path> folders_;  // where those lie
    std::map<std::filesystem::path, Loaded> loaded_;
    std::map<std::string, int> line_of_name_;
    std::vector<std::filesystem::path> inputs_;
    std::size_t count_ = 0;
    double frames_ = 0;  // of all stages so far
};

// Whether a text can be the name of a file or folder in a run directory; else why not.
std::optional<std::string> why_no_file_name(const std::string& text);

// What a stage is called that nobody names: "1-bend". `machine`: as it says, a name or a path.
std::string usual_stage_name(std::size_t number, const std::string& machine);

// The keys axis and up, of a stage and of a machine.
void read_frame_words(TableReader& table, WorldAxis& axis, WorldAxis& up);

}  // namespace swage
